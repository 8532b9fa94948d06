//! Height queries through the pass on whatever adapter there is: the drawn triangle, in f64 from the mesh
//! that came back, and the true surface.

use bevy::math::{DVec2, UVec2};
use dolomite_geometry::ring::Ring;
use dolomite_ground::detail::{DetailCells, Metric};
use dolomite_lab::scenes::cameras::{Kind, camera};
use dolomite_lab::studies::ground::measure::{check, ground, params, places};
use dolomite_terrain::GroundPoint;
use dolomite_testkit::detail::DetailStage;
use dolomite_testkit::gpu::for_test;

const PIXELS: Metric = Metric::ErrorBound { pixels: 24.0 };

#[test]
fn gpu_ten_thousand_answers_lie_on_the_drawn_triangles() {
    let Some(gpu) = for_test() else { return };
    for centre in [DVec2::ZERO, DVec2::new(1e6, -1e6)] {
        let terrain = ground(1, centre);
        let cells = DetailCells::new(terrain.clone(), 0.25);
        let mut stage = DetailStage::new(&gpu, &cells, 1 << 20).expect("passes");
        for (kind, seed) in [(Kind::Standing, 3), (Kind::Flying, 4)] {
            let camera = camera(&terrain, kind, seed);
            let told = params(&cells, &camera, PIXELS);
            let places = places(&terrain, &camera, 10_000, seed);
            let run = stage.run(told).expect("runs");
            let (answers, _) = stage.answer(&places, 1).expect("runs");
            let verdict = check(&terrain, &camera, (&told, &run), &places, &answers);
            assert_eq!(answers.head.count, 10_000);
            let drawn = run.triangles.len();
            assert!(drawn > 1500 && run.coarsening == 1.0, "{kind:?}: {drawn}");
            // Half stand before the camera, from 1 m on.
            let found = verdict.checked.len();
            println!(
                "{found} answered, {} not, {} wrong",
                verdict.nothing, verdict.wrong
            );
            assert!(found > 2000 && verdict.nothing > 2000, "{kind:?}: {found}");
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
            // The mesh is kept: the same bits once more.
            let (again, _) = stage.answer(&places, 1).expect("runs");
            assert_eq!(again, answers);
        }
    }
}

#[test]
fn gpu_hostile_places_and_small_pools_have_no_wrong_answer() {
    let Some(gpu) = for_test() else { return };
    let terrain = ground(1, DVec2::ZERO);
    let cells = DetailCells::new(terrain.clone(), 0.25);
    let mut stage = DetailStage::new(&gpu, &cells, 1 << 16).expect("passes");
    let camera = camera(&terrain, Kind::Flying, 2);
    let mut told = params(&cells, &camera, Metric::ErrorBound { pixels: 4.0 });
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
    // The very ends of the ground, and the corners of cells.
    let far = cells.lattice.roots << (cells.lattice.depth + 1);
    hostile.extend([UVec2::ZERO, far, far / 2, far / 4].map(|at| cells.lattice.point(at)));
    hostile.extend(places(&terrain, &camera, 4000, 7));
    let run = stage.run(told).expect("runs");
    let (answers, _) = stage.answer(&hostile, 1).expect("runs");
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
        // Cells know their ground from 81 samples each: of the few large ones that are left here, a narrow
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
    let cells = DetailCells::new(terrain.clone(), 1.0);
    let mut stage = DetailStage::new(&gpu, &cells, 1 << 16).expect("passes");
    let mut ring = Ring::default();
    let mut eye = camera(&terrain, Kind::Flying, 2);
    let places = places(&terrain, &eye, 1000, 7);
    let mut newest = None;
    for frame in 0..12_u32 {
        eye.eye.x += 5.0;
        let told = params(&cells, &eye, Metric::ErrorBound { pixels: 16.0 });
        let arrived = stage
            .frame(told, (frame, &places), &mut ring)
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
