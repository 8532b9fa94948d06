//! The level of detail in blocks through its passes on whatever adapter there is, against the CPU reference.

use super::support::{MOST, by_place, params, terrain, view};
use dolomite_ground::blocks::choose::{Limits, settle};
use dolomite_ground::blocks::kept::{KeptBlocks, Wish};
use dolomite_ground::blocks::mesh::mesh;
use dolomite_ground::blocks::place::{VERTICES, vertex_at};
use dolomite_ground::blocks::record::Block;
use dolomite_ground::detail::{DetailGround, DetailView, Metric};
use dolomite_terrain::GroundPoint;
use dolomite_testkit::blocks::{BlockRun, BlockStage, MadeBlock};
use dolomite_testkit::gpu::for_test;
use std::collections::HashMap;

/// Made on the CPU as well, in the order of their sizes.
pub fn made_again(kept: &mut KeptBlocks, blocks: &[MadeBlock]) -> HashMap<[u32; 2], u32> {
    let mut sorted: Vec<&MadeBlock> = blocks.iter().collect();
    sorted.sort_by_key(|made| std::cmp::Reverse(made.block.head.half));
    for made in sorted {
        let place = made.block.head.place().expect("a block");
        if place.is_root(&kept.lattice) {
            continue;
        }
        let slots = kept.by_place();
        let parent = slots[&place.parent().cell().centre];
        let wish = Wish {
            parent,
            quarter: place.quarter(),
            ratio: 1.0,
        };
        assert_eq!(kept.make(&[wish]), 1);
    }
    let slots = kept.by_place();
    slots
        .into_iter()
        .map(|(at, slot)| (at.to_array(), slot))
        .collect()
}

/// The largest differences between two records: of heights, errors, intervals, gradients' bits by more than one.
pub fn differences(a: &Block, b: &Block) -> [f32; 3] {
    let largest = |a: &[f32], b: &[f32]| {
        let both = a.iter().zip(b);
        // What is always there, and empty intervals, are the same.
        let off = both.map(|(a, b)| if a == b { 0.0 } else { (a - b).abs() });
        off.fold(0.0, f32::max)
    };
    let errors = largest(&a.errors, &b.errors).max(largest(&a.ring_errors, &b.ring_errors));
    let intervals = largest(&a.lows, &b.lows)
        .max(largest(&a.highs, &b.highs))
        .max(largest(&a.cell_lows, &b.cell_lows))
        .max(largest(&a.cell_highs, &b.cell_highs));
    [largest(&a.heights, &b.heights), errors, intervals]
}

/// Every vertex has the same bits in all blocks that have it. How often one is in two blocks of a size, and of two.
pub fn same_bits(blocks: &[MadeBlock]) -> [usize; 2] {
    let mut known: HashMap<[u32; 2], ([u32; 5], u32)> = HashMap::new();
    let (mut shared, mut unequal) = (0, 0);
    for MadeBlock { block, .. } in blocks {
        let place = block.head.place().expect("a block");
        for k in 0..VERTICES {
            let at = place.lattice_point(vertex_at(k)).to_array();
            let own = [
                block.heights[k],
                block.errors[k],
                block.lows[k],
                block.highs[k],
            ];
            let [a, b, c, d] = own.map(f32::to_bits);
            let own = [a, b, c, d, block.gradients[k]];
            let half = block.head.half;
            let (first, other) = *known.entry(at).or_insert((own, half));
            assert_eq!(first, own, "{at:?} in blocks of {half} and {other}");
            shared += 1;
            unequal += usize::from(half != other);
        }
    }
    [shared - known.len(), unequal]
}

/// The largest differences between blocks and those of the CPU, see [`differences`].
pub fn unlike_the_cpu(laid: &DetailGround, blocks: &[MadeBlock]) -> [f32; 3] {
    let mut kept = KeptBlocks::on(laid.terrain().clone(), laid.lattice);
    let slots = made_again(&mut kept, blocks);
    let mut largest = [0.0_f32; 3];
    for made in blocks {
        let slot = slots[&made.block.head.centre.to_array()];
        let found = differences(&made.block, kept.block(slot));
        largest = std::array::from_fn(|k| largest[k].max(found[k]));
        let (ours, theirs) = (made.block.head, kept.block(slot).head);
        assert!((ours.low - theirs.low).abs() < 1e-3 && (ours.high - theirs.high).abs() < 1e-3);
    }
    println!(
        "largest differences: heights {:.2e}, errors {:.2e}, intervals {:.2e} m",
        largest[0], largest[1], largest[2]
    );
    largest
}

#[test]
fn gpu_blocks_are_made_as_on_the_cpu_and_have_the_same_bits_where_they_meet() {
    let Some(gpu) = for_test() else { return };
    let terrain = terrain();
    let laid = DetailGround::new(terrain.clone(), 0.25);
    let mut stage = BlockStage::new(&gpu, &laid, 4096).expect("passes");
    let view = view(&terrain, 0.0, 3.0, Metric::ErrorBound { pixels: 8.0 });
    let (run, frames) = stage.settle(params(&laid, view), 64, MOST).expect("runs");
    let blocks = stage.blocks().expect("read");
    assert_eq!(blocks.len(), run.used as usize);
    println!(
        "{frames} choices, {} blocks, {} triangles",
        blocks.len(),
        run.triangles.len()
    );
    assert!(blocks.len() > 60, "{}", blocks.len());
    let [shared, unequal] = same_bits(&blocks);
    assert!(shared > 10_000 && unequal > 10_000, "{shared} {unequal}");
    let largest = unlike_the_cpu(&laid, &blocks);
    // Heights of 160 m: some roundings (1.5e-5 m each). An error is a difference of a few heights, grown five times by a
    // quarter, and of both surfaces.
    assert!(largest[0] < 1e-4, "{largest:?}");
    assert!(largest[1] < 1e-3 && largest[2] < 1e-3, "{largest:?}");
}

fn metrics() -> [Metric; 3] {
    [
        Metric::ErrorBound { pixels: 2.0 },
        Metric::EdgeLength { pixels: 24.0 },
        Metric::Classic {
            patch: 64.0,
            least: 1.0,
            greatest: 16.0,
            reach: 800.0,
            height: 10.0,
        },
    ]
}

#[test]
fn gpu_blocks_choose_what_the_cpu_reference_does() {
    let Some(gpu) = for_test() else { return };
    let terrain = terrain();
    let laid = DetailGround::new(terrain.clone(), 0.25);
    let mut stage = BlockStage::new(&gpu, &laid, 4096).expect("passes");
    let mut kept = KeptBlocks::on(terrain.clone(), laid.lattice);
    for (k, metric) in metrics().into_iter().enumerate() {
        let view = view(&terrain, k as f32 * 2.0, 2.0 + 30.0 * k as f32, metric);
        let (run, frames) = stage.settle(params(&laid, view), 64, MOST).expect("runs");
        println!(
            "{metric:?}: {frames} choices, {} blocks looked at, {} drawn",
            run.candidates, run.drawn
        );
        draws_what_the_cpu_does(&mut kept, &view, &run);
    }
}

/// Compares what the passes draw with the CPU reference.
pub fn draws_what_the_cpu_does(kept: &mut KeptBlocks, view: &DetailView, run: &BlockRun) {
    let lattice = kept.lattice;
    let choice = settle(kept, view, Limits::default());
    let reference = mesh(kept, &choice);
    println!(
        "{} of {} triangles, left {} of {}",
        run.triangles.len(),
        reference.triangles.len(),
        run.left,
        choice.held,
    );
    assert_eq!(run.coarsening, 1.0);
    let anchor = GroundPoint::from(view.anchor().as_dvec2());
    let place = |k: u32| {
        let vertex = reference.vertices[k as usize];
        let place = lattice.point(vertex.at).relative_to(anchor);
        [place.x, vertex.height, place.y]
    };
    let theirs = by_place(reference.triangles.iter().map(|corners| corners.map(place)));
    let at = |k: u32| run.positions[k as usize];
    let ours = by_place(run.triangles.iter().map(|corners| corners.map(at)));
    assert_eq!(ours.len(), run.triangles.len(), "no triangle twice");
    assert!(theirs.len() > 2000, "{}", theirs.len());
    // Heights, hence errors, differ by roundings: ratios a hair from a threshold fall on the other side of it.
    let other = ours.symmetric_difference(&theirs).count();
    assert!(
        other as f64 <= 2e-3 * theirs.len() as f64,
        "{other} of {}",
        theirs.len()
    );
    // Places to 1/1024 m: steps that are no dyadic fraction are rounded twice on the GPU.
    let key = |x: f32, z: f32| [x, z].map(|v| (v * 1024.0).round() as i32);
    let heights: HashMap<[i32; 2], f32> = run
        .positions
        .iter()
        .map(|&[x, y, z]| (key(x, z), y))
        .collect();
    let mut compared = 0;
    for k in 0..reference.vertices.len() as u32 {
        let [x, y, z] = place(k);
        if let Some(height) = heights.get(&key(x, z)) {
            // A vertex on its way moves by its error times the difference of its ratios, both small.
            assert!((height - y).abs() < 1e-3, "{x} {z}: {height} {y}");
            compared += 1;
        }
    }
    assert!(compared * 100 > reference.vertices.len() * 99, "{compared}");
}
