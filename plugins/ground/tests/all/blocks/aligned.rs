//! Lattices on the samples of a map, whose outermost columns and rows have another width.

use super::reference::{draws_what_the_cpu_does, same_bits, unlike_the_cpu};
use super::support::{MOST, classic, closed_about, laid_on_samples, params, rough_map, view_at};
use bevy::math::DVec2;
use dolomite_ground::blocks::kept::KeptBlocks;
use dolomite_ground::detail::DetailView;
use dolomite_terrain::Terrain;
use dolomite_testkit::blocks::BlockStage;
use dolomite_testkit::gpu::{Gpu, for_test};

fn compare(gpu: &Gpu, terrain: &Terrain, finest: f32, pixels: f32) {
    let laid = laid_on_samples(terrain, finest);
    assert!(laid.lattice.border.width > 0);
    let mut stage = BlockStage::new(gpu, &laid, 8192).expect("passes");
    let mut kept = KeptBlocks::on(terrain.clone(), laid.lattice);
    let side = terrain.extent().size().x;
    // Along two borders from a corner, over a corner, and from the middle.
    let views = [
        (-0.48, -0.49, 1.5, [3.6, -0.2]),
        (0.49, 0.47, 0.5, [0.6, -0.3]),
        (0.1, 0.05, 20.0, [2.0, -0.2]),
    ];
    for (x, z, above, turn) in views {
        let xz = DVec2::new(x, z) * side;
        let view: DetailView = view_at(terrain, xz, above, turn, pixels);
        let (run, frames) = stage.settle(params(&laid, view), 64, MOST).expect("runs");
        println!("{frames} choices, {} blocks", run.used);
        closed_about(&run, 4.0 * side);
        draws_what_the_cpu_does(&mut kept, &view, &run);
    }
    let blocks = stage.blocks().expect("read");
    let [shared, unequal] = same_bits(&blocks);
    assert!(shared > 5000 && unequal > 5000, "{shared} {unequal}");
    let largest = unlike_the_cpu(&laid, &blocks);
    // As on an even lattice; heights are less.
    assert!(largest[0] < 1e-4, "{largest:?}");
    assert!(largest[1] < 1e-3 && largest[2] < 1e-3, "{largest:?}");
}

#[test]
fn gpu_blocks_on_the_samples_of_a_map_are_those_of_the_cpu_to_the_border() {
    let Some(gpu) = for_test() else { return };
    // First columns half as wide as the others, twice as wide, and of different widths on both sides.
    compare(&gpu, &rough_map(128, 2.0, -1.0, 256.0), 0.125, 1.0);
    compare(&gpu, &rough_map(35, 2.0, 0.0, 68.0), 0.125, 0.5);
    compare(&gpu, &rough_map(66, 1.0, 0.3, 64.5), 0.125, 0.5);
}

#[test]
fn gpu_blocks_on_the_classic_map_are_those_of_the_cpu() {
    let Some(gpu) = for_test() else { return };
    let Some(terrain) = classic() else {
        eprintln!("skipped: DOLOMITE_SHARED names no data");
        return;
    };
    compare(&gpu, &terrain, 0.25, 4.0);
}
