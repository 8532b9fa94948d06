//! Meshes without gaps: while blocks are made, after looking away, and where there is little room.

use super::support::{MOST, closed, params, terrain, view};
use dolomite_ground::detail::layout::DetailParams;
use dolomite_ground::detail::{DetailGround, Metric};
use dolomite_testkit::blocks::{BlockRun, BlockStage};
use dolomite_testkit::gpu::for_test;

/// Triangles by the bits of their corners.
fn sorted(run: &BlockRun) -> Vec<[[u32; 3]; 3]> {
    let at = |k: u32| run.positions[k as usize].map(f32::to_bits);
    let mut all: Vec<_> = run
        .triangles
        .iter()
        .map(|corners| corners.map(at))
        .collect();
    for corners in &mut all {
        let least = (0..3).min_by_key(|&k| corners[k]).expect("three");
        corners.rotate_left(least);
    }
    all.sort_unstable();
    all
}

/// A view of all directions.
fn everywhere(params: DetailParams) -> DetailParams {
    let mut all = params;
    all.view.planes = [[0.0, 0.0, 0.0, 1.0]; 6];
    all
}

#[test]
fn gpu_blocks_make_a_closed_mesh_while_they_are_made_and_after() {
    let Some(gpu) = for_test() else { return };
    let terrain = terrain();
    let laid = DetailGround::new(terrain.clone(), 0.25);
    let mut stage = BlockStage::new(&gpu, &laid, 4096).expect("passes");
    let metric = Metric::ErrorBound { pixels: 4.0 };
    let looking = |yaw| params(&laid, view(&terrain, yaw, 3.0, metric));
    let mut last = f32::INFINITY;
    for frame in 0.. {
        let run = stage.run(looking(0.0), 16).expect("runs");
        closed(&run);
        assert!(
            run.coarsening <= last,
            "frame {frame}: {} after {last}",
            run.coarsening
        );
        last = run.coarsening;
        if run.made == 0 {
            assert!(
                frame > 5 && run.coarsening == 1.0,
                "{frame} {}",
                run.coarsening
            );
            break;
        }
    }
    let (all, _) = stage
        .settle(everywhere(looking(0.0)), 64, MOST)
        .expect("runs");
    closed(&all);
    let (before, _) = stage.settle(looking(0.0), 64, MOST).expect("runs");
    let (away, _) = stage.settle(looking(2.5), 64, MOST).expect("runs");
    closed(&away);
    assert!(sorted(&before) != sorted(&away));
    let again = stage.run(looking(0.0), 64).expect("runs");
    assert!(sorted(&before) == sorted(&again), "the same bits");
    let mut fresh = BlockStage::new(&gpu, &laid, 4096).expect("passes");
    let (fresh, _) = fresh.settle(looking(0.0), 7, MOST).expect("runs");
    assert!(sorted(&before) == sorted(&fresh), "in whichever slots");
}

#[test]
fn gpu_blocks_stay_closed_where_there_is_little_room() {
    let Some(gpu) = for_test() else { return };
    let terrain = terrain();
    let laid = DetailGround::new(terrain.clone(), 0.25);
    let given = everywhere(params(
        &laid,
        view(&terrain, 0.0, 3.0, Metric::ErrorBound { pixels: 4.0 }),
    ));
    // Slots; blocks made a frame; pools.
    for (slots, budget, pools) in [
        (4096, 0, [1 << 17, 1 << 18]),
        (3, 16, [1 << 17, 1 << 18]),
        (4, 16, [1 << 17, 1 << 18]),
        (64, 1, [1 << 17, 1 << 18]),
        (4096, 64, [8000, 1 << 18]),
        (4096, 64, [1 << 17, 6000]),
        (4096, 64, [1100, 2100]),
    ] {
        let mut stage = BlockStage::new(&gpu, &laid, slots).expect("passes");
        let given = DetailParams {
            max_vertices: pools[0],
            max_triangles: pools[1],
            ..given
        };
        let mut last = None;
        for _ in 0..80 {
            let run = stage.run(given, budget).expect("runs");
            closed(&run);
            let rests = run.made == 0;
            last = Some(run);
            if rests {
                break;
            }
        }
        let run = last.expect("a choice");
        println!(
            "{slots} slots, {budget} a frame, {pools:?}: {} blocks, {} vertices, {} triangles, coarsening {}",
            run.used,
            run.positions.len(),
            run.triangles.len(),
            run.coarsening
        );
        assert!(run.coarsening > 1.2 && run.used < slots);
        assert!(
            run.positions.len() <= pools[0] as usize && run.triangles.len() <= pools[1] as usize
        );
    }
}

/// With slots for one look alone, blocks of another make room, and come back with the same bits.
#[test]
fn gpu_blocks_that_were_dropped_come_back_with_the_same_bits() {
    let Some(gpu) = for_test() else { return };
    let terrain = terrain();
    let laid = DetailGround::new(terrain.clone(), 0.25);
    let metric = Metric::ErrorBound { pixels: 4.0 };
    let looking = |yaw| params(&laid, view(&terrain, yaw, 3.0, metric));
    let mut roomy = BlockStage::new(&gpu, &laid, 4096).expect("passes");
    let (whole, _) = roomy.settle(looking(0.0), 64, MOST).expect("runs");
    let (both, _) = roomy.settle(looking(2.5), 64, MOST).expect("runs");
    let slots = whole.used + (both.used - whole.used) / 2;
    let mut stage = BlockStage::new(&gpu, &laid, slots).expect("passes");
    for (round, yaw) in [0.0, 2.5, 0.0, 2.5, 0.0].into_iter().enumerate() {
        let mut run = None;
        for _ in 0..MOST {
            // What the last choice did not look at is dropped.
            let given = DetailParams {
                oldest: stage.stamp(),
                ..looking(yaw)
            };
            let last = stage.run(given, 64).expect("runs");
            closed(&last);
            let rests = last.made == 0 && last.wishes == 0;
            run = Some(last);
            if rests {
                break;
            }
        }
        let run = run.expect("a choice");
        assert!(
            run.coarsening == 1.0 && run.used <= slots,
            "{round}: {}",
            run.coarsening
        );
        if yaw == 0.0 {
            assert!(sorted(&run) == sorted(&whole), "{round}");
        }
    }
    // Without dropping there is no room for the other look.
    let mut full = BlockStage::new(&gpu, &laid, slots).expect("passes");
    full.settle(looking(0.0), 64, MOST).expect("runs");
    for _ in 0..30 {
        full.run(looking(2.5), 64).expect("runs");
    }
    let run = full.run(looking(2.5), 64).expect("runs");
    assert!(run.coarsening > 1.0 && run.wishes > 0, "{}", run.coarsening);
}
