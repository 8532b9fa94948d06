//! Height queries through the pass on whatever adapter there is: the drawn triangle, in f64 from the mesh
//! that came back, and the true surface.

use bevy::math::{DVec2, UVec2};
use dolomite_geometry::ring::Ring;
use dolomite_ground::detail::Metric;
use dolomite_lab::scenes::cameras::{Kind, camera};
use dolomite_lab::scenes::selection::ground_of;
use dolomite_lab::studies::ground::measure::{BUDGET, MOST, check, ground, params, places};
use dolomite_terrain::{GroundPoint, ProbeAnswer};
use dolomite_testkit::blocks::BlockStage;
use dolomite_testkit::gpu::for_test;

const PIXELS: Metric = Metric::ErrorBound { pixels: 24.0 };

#[test]
fn gpu_ten_thousand_answers_lie_on_the_drawn_triangles() {
    let Some(gpu) = for_test() else { return };
    for centre in [DVec2::ZERO, DVec2::new(1e6, -1e6)] {
        let terrain = ground(1, centre);
        let on_lattice = ground_of(&terrain, 0.25);
        let mut stage = BlockStage::new(&gpu, &on_lattice, 1 << 12).expect("passes");
        for (kind, seed) in [(Kind::Standing, 3), (Kind::Flying, 4)] {
            let camera = camera(&terrain, kind, seed);
            let told = params(&on_lattice, &camera, PIXELS);
            let places = places(&terrain, &camera, 10_000, seed);
            let (run, _) = stage.settle(told, BUDGET, MOST).expect("runs");
            let answers = stage.answers(&places).expect("runs");
            let verdict = check(&terrain, &camera, (&told, &run), &places, &answers);
            assert_eq!(answers.head.count, 10_000);
            let drawn = run.triangles.len();
            assert!(drawn > 1500 && run.coarsening == 1.0, "{kind:?}: {drawn}");
            // All the ground is drawn, coarsely where the camera does not look.
            let found = verdict.checked.len();
            println!(
                "{found} answered, {} not, {} wrong",
                verdict.nothing, verdict.wrong
            );
            assert!(found > 9_900, "{kind:?}: {found}");
            assert_eq!(verdict.wrong, 0, "{kind:?}");
            let max = |pick: fn(&_) -> f64| verdict.checked.iter().map(pick).fold(0.0, f64::max);
            let (off, slope) = (max(|c| c.from_drawn), max(|c| c.slope));
            println!("{centre} {kind:?}: {found} of 10000, {off:e} m, slope {slope:e}");
            assert!(off <= 1e-4, "{kind:?}: {off} m from the drawn triangle");
            // f32: some 2⁻²² of slopes around 1.
            assert!(slope <= 1e-6, "{kind:?}: {slope} from the triangle's");
            for checked in &verdict.checked {
                assert!(checked.from_truth <= checked.bound, "{kind:?}: {checked:?}");
            }
            let used = max(|c| c.from_truth / c.bound.max(1e-3));
            assert!(used > 0.3, "the bound is of what it bounds: {used}");
            // An answer that is off by a millimetre, and one that finds nothing, are seen.
            let mut off = answers.clone();
            off.answers[0].rise += 1e-3;
            off.answers[1] = ProbeAnswer::NOTHING;
            let judged = check(&terrain, &camera, (&told, &run), &places, &off);
            assert_eq!(judged.wrong, 1);
            let largest = judged.checked.iter().map(|c| c.from_drawn);
            assert!(largest.fold(0.0, f64::max) > 5e-4);
            // The choice is kept: the same bits once more.
            let again = stage.answers(&places).expect("runs");
            assert_eq!(again, answers);
        }
    }
}

#[test]
fn gpu_hostile_places_and_small_pools_have_no_wrong_answer() {
    let Some(gpu) = for_test() else { return };
    let terrain = ground(1, DVec2::ZERO);
    let on_lattice = ground_of(&terrain, 0.25);
    let mut stage = BlockStage::new(&gpu, &on_lattice, 1 << 12).expect("passes");
    let camera = camera(&terrain, Kind::Flying, 2);
    let mut told = params(&on_lattice, &camera, Metric::ErrorBound { pixels: 4.0 });
    // All is seen, and far more is asked for than there is room for.
    told.view.planes = [[0.0, 0.0, 0.0, 1.0]; 6];
    (told.max_vertices, told.max_triangles) = (3000, 6000);
    let mut hostile: Vec<GroundPoint> = [
        DVec2::new(f64::INFINITY, 0.0),
        DVec2::new(0.0, -1e300),
        DVec2::splat(2e9),
        DVec2::new(-8192.01, 0.0),
        DVec2::new(0.0, 8192.01),
    ]
    .map(GroundPoint::new)
    .to_vec();
    let outside = hostile.len();
    // The very ends of the ground, and corners of blocks.
    let lattice = on_lattice.lattice;
    let far = lattice.roots << (lattice.depth + 1);
    hostile.extend([UVec2::ZERO, far, far / 2, far / 4].map(|at| lattice.point(at)));
    hostile.extend(places(&terrain, &camera, 4000, 7));
    let (run, _) = stage.settle_in_room(told, BUDGET, MOST).expect("runs");
    let answers = stage.answers(&hostile).expect("runs");
    let verdict = check(&terrain, &camera, (&told, &run), &hostile, &answers);
    assert!(run.coarsening > 2.0, "{}", run.coarsening);
    assert!(answers.answers[..outside].iter().all(|a| !a.is_hit()));
    assert!(
        answers.answers[outside..].iter().all(|a| a.is_hit()),
        "all else is drawn"
    );
    assert_eq!((verdict.nothing, verdict.wrong), (outside, 0));
    let mut above = 0;
    for checked in &verdict.checked {
        // Places up to 10 km from the anchor are stored to half a millimetre.
        assert!(checked.from_drawn <= 5e-4, "{checked:?}");
        // Blocks know their ground from samples: in the few large triangles that are left here, a narrow
        // ridge may lie farther off than they know, seldom and by little.
        above += usize::from(checked.from_truth > checked.bound);
        assert!(checked.from_truth <= 1.1 * checked.bound, "{checked:?}");
    }
    assert!(above * 200 <= verdict.checked.len(), "{above}");
}

#[test]
fn gpu_answers_come_back_while_nobody_waits_for_them() {
    let Some(gpu) = for_test() else { return };
    let terrain = ground(1, DVec2::ZERO);
    let on_lattice = ground_of(&terrain, 1.0);
    let mut stage = BlockStage::new(&gpu, &on_lattice, 1 << 12).expect("passes");
    let mut ring = Ring::default();
    let mut eye = camera(&terrain, Kind::Flying, 2);
    let places = places(&terrain, &eye, 1000, 7);
    let mut newest = None;
    for frame in 0..12_u32 {
        eye.eye.x += 5.0;
        let told = params(&on_lattice, &eye, Metric::ErrorBound { pixels: 16.0 });
        let arrived = stage
            .frame(told, BUDGET, (frame, &places), &mut ring)
            .expect("runs");
        for (asked, answers) in arrived {
            assert_eq!((answers.head.frame, answers.head.count), (asked, 1000));
            assert!(newest < Some(asked), "in order");
            newest = Some(asked);
        }
        // As a renderer that waits for the display: its next frame begins when this one is drawn.
        gpu.finish().expect("drawn");
    }
    // The last frame's answer is on its way.
    assert_eq!(newest, Some(10));
}
