//! Blocks of ground that changed are those of ground that never was another, at work in proportion to the change.

use std::collections::HashMap;

use bevy::math::{DQuat, DVec2, DVec3, IVec2, UVec2};
use dolomite_terrain::{
    Edit, EditKind, Fractal, GroundRect, Hill, Layer, Source, Terrain, TerrainData, TerrainEdits,
};

use crate::blocks::changed::{EditReach, is_reached};
use crate::blocks::choose::{Limits, settle};
use crate::blocks::kept::{KeptBlocks, lattice_of};
use crate::blocks::make::make;
use crate::blocks::others::{Others, copiers, cutters, refreshed};
use crate::blocks::place::{BlockPlace, CELLS, CORNER_COUNT, VERTICES, vertex_at};
use crate::blocks::record::{Block, RINGED, RINGED_COUNT, ring_number};
use crate::blocks::remade::Remade;
use crate::detail::{DetailLattice, DetailView, Lens, Metric, TerrainLod};

/// Noise with as many hills as are given.
pub fn ground(hills: &[Hill]) -> Terrain {
    let noise = Source::Fractal(Fractal {
        octaves: 9,
        amplitude: 40.0,
        wavelength: 300.0,
        ..Fractal::default()
    });
    let sources = [noise]
        .into_iter()
        .chain(hills.iter().copied().map(Source::Hill));
    Terrain::new(TerrainData {
        extent: GroundRect::new(DVec2::new(-512.0, -256.0), DVec2::new(512.0, 256.0)),
        layers: sources.map(|source| Layer { source, mask: None }).collect(),
        base: 0.0,
        sea_level: None,
    })
    .expect("valid")
}

fn view(eye: DVec3) -> DetailView {
    let turn = DQuat::from_rotation_x(-0.6);
    let lens = Lens::Perspective(0.577);
    let mut view = DetailView::new(eye, turn, lens, UVec2::new(320, 180), 0.1);
    view.set_metric(&TerrainLod {
        metric: Metric::ErrorBound { pixels: 3.0 },
        ..TerrainLod::default()
    });
    view
}

/// What there is, by place, but for slots.
fn by_place(blocks: &KeptBlocks) -> HashMap<[u32; 2], Block> {
    let of = |slot: u32| {
        let mut block = blocks.block(slot).clone();
        block.head.parent = 0;
        block.head.children = [0; 4];
        block.head.looked = 0;
        (block.head.centre.to_array(), block)
    };
    blocks.used().map(of).collect()
}

/// Blocks are those of ground that was never another.
fn same_as_fresh(blocks: &KeptBlocks, terrain: Terrain, eyes: &[DVec3]) {
    let mut fresh = KeptBlocks::new(terrain, 0.125);
    for &eye in eyes {
        settle(&mut fresh, &view(eye), Limits::default());
    }
    let (changed, fresh) = (by_place(blocks), by_place(&fresh));
    let both = fresh.keys().filter(|place| changed.contains_key(*place));
    assert!(both.clone().count() > 40);
    for place in both {
        assert!(changed[place] == fresh[place], "{place:?}");
    }
}

/// As much is made anew as the change reaches, and half as much more at most: what cuts by coarse cells that have become others.
/// Of the rest what has copies of others is refreshed.
fn in_proportion(remade: Remade, reached: usize, all: usize) {
    let Remade { made, refreshed } = remade;
    assert!(
        made >= reached && 2 * made <= 3 * reached,
        "{remade:?} of {all}, {reached} reached"
    );
    assert!(made + refreshed <= all, "{remade:?} of {all}");
}

/// What is between samples of an edit is known of whole nodes of its tree: they count for blocks beside it.
#[test]
fn blocks_of_edited_ground_are_those_of_ground_that_was_always_so() {
    let eyes = [
        DVec3::new(-300.0, 60.0, 120.0),
        DVec3::new(260.0, 50.0, 200.0),
    ];
    let mut now = ground(&[]);
    let mut edits = TerrainEdits::new(&now).expect("fits");
    let mut blocks = KeptBlocks::new(now.clone(), 0.125);
    for eye in eyes {
        settle(&mut blocks, &view(eye), Limits::default());
    }
    let before = by_place(&blocks);
    for k in 0..6_u32 {
        let stroke = Edit {
            kind: [EditKind::Raise, EditKind::Lower][k as usize % 2].clone(),
            place: DVec2::new(-330.0 + 37.0 * f64::from(k), 30.0 - 11.0 * f64::from(k)),
            radius: 4.0 + 5.0 * f64::from(k),
            strength: 3.0,
            falloff: 0.7,
        };
        let next = edits.apply(&now, &stroke).expect("valid").terrain;
        let changed = next.changed_since(&now).expect("the same ground");
        let reach = EditReach::between(&now, &next, &blocks.lattice);
        now = next;
        let reached = blocks
            .used()
            .filter(|&slot| is_reached(&blocks.lattice, blocks.place(slot), reach, &changed));
        let reached = reached.count();
        let remade = blocks.change(now.clone(), 0.125, &changed);
        println!("{reached} of {} reached, {remade:?}", blocks.len());
        in_proportion(remade, reached, blocks.len());
        same_as_fresh(&blocks, now.clone(), &eyes);
    }
    while let Some(undone) = edits.undo(&now) {
        let changed = undone.changed_since(&now).expect("the same ground");
        now = undone;
        blocks.change(now.clone(), 0.125, &changed);
    }
    assert!(by_place(&blocks) == before, "to the bit");
}

#[test]
fn blocks_of_changed_ground_are_those_of_ground_that_was_never_another() {
    let eyes = [
        DVec3::new(-300.0, 60.0, 120.0),
        DVec3::new(260.0, 50.0, 200.0),
    ];
    let hill = |x: f64, z: f64, radius: f32| Hill {
        centre: DVec2::new(x, z),
        radius,
        height: 25.0,
    };
    let mut blocks = KeptBlocks::new(ground(&[]), 0.125);
    for eye in eyes {
        settle(&mut blocks, &view(eye), Limits::default());
    }
    let all = blocks.len();
    assert!(all > 40, "{all}");
    // One after the other, so that the second change finds what the first left; then both are taken back.
    let mut hills = vec![hill(-310.0, 20.0, 8.0)];
    let first = [GroundRect::square(hills[0].centre, 16.0)];
    let remade = blocks.change(ground(&hills), 0.125, &first);
    assert!(remade.made > 4 && remade.made < all, "{remade:?} of {all}");
    hills.push(hill(250.0, 90.0, 30.0));
    let second = [GroundRect::square(hills[1].centre, 60.0)];
    blocks.change(ground(&hills), 0.125, &second);
    let compare = |blocks: &KeptBlocks, terrain: Terrain| {
        same_as_fresh(blocks, terrain, &eyes);
    };
    compare(&blocks, ground(&hills));
    blocks.change(ground(&[]), 0.125, &[first[0], second[0]]);
    compare(&blocks, ground(&[]));
    // A wrong rectangle leaves blocks of the old ground: the comparison sees it.
    let elsewhere = [GroundRect::square(DVec2::new(5000.0, 0.0), 10.0)];
    blocks.change(ground(&hills), 0.125, &elsewhere);
    let stale = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        compare(&blocks, ground(&hills));
    }));
    assert!(stale.is_err());
}

/// A block whose ring is all on the ground.
fn within(terrain: &Terrain, lattice: &DetailLattice) -> (BlockPlace, Box<Block>) {
    let mut place = BlockPlace::roots(lattice).next().expect("a root");
    let (mut block, _) = make(terrain, lattice, place, None);
    for quarter in [2, 0] {
        place = place.child(quarter).expect("coarse");
        block = make(terrain, lattice, place, Some(&block)).0;
    }
    (place, block)
}

/// A record in which those words are others that are wanted by who takes them, by a lot: errors and intervals cut more.
fn altered(block: &Block, wanted: impl Fn(u32) -> bool) -> Block {
    let mut block = block.clone();
    for k in 0..VERTICES {
        let copied = copiers(k).0;
        let is_centre = k >= CORNER_COUNT;
        let cut = if is_centre {
            cutters(vertex_at(k) / 2).0
        } else {
            0
        };
        if wanted(copied | cut) {
            block.errors[k] *= 0.01;
        }
        if wanted(copied) {
            block.heights[k] += 1.0;
            block.gradients[k] ^= 1;
            block.lows[k] += 1.0;
            block.highs[k] -= 1.0;
        }
    }
    for k in 0..RINGED_COUNT {
        let cell = IVec2::new((k % RINGED) as i32, (k / RINGED) as i32) - 1;
        if !wanted(cutters(cell).0) {
            continue;
        }
        if let Some(k) = ring_number(cell) {
            block.ring_errors[k] *= 0.01;
        }
        block.cell_lows[k] += 1000.0;
        block.cell_highs[k] -= 1000.0;
    }
    block
}

/// What a quarter has that its parent changes: nothing, what it copies, or more than that.
#[test]
fn quarters_depend_on_what_they_copy_and_cut_by_alone() {
    let (terrain, lattice) = (ground(&[]), lattice_of(&ground(&[]), 0.125));
    let (place, parent) = within(&terrain, &lattice);
    for quarter in 0..4 {
        let own = place.child(quarter).expect("coarse");
        let made = |parent: &Block| make(&terrain, &lattice, own, Some(parent)).0;
        let before = made(&parent);
        assert!(*refreshed(&before, own, &parent) == *before);
        let bit = |shift: u32| 1 << (shift + quarter as u32);
        let (copies, cuts) = (bit(0), bit(4));

        let elsewhere = altered(&parent, |who| who & (copies | cuts) == 0);
        let others = Others::between(&parent, &elsewhere);
        assert!(!others.are_copied(quarter) && !others.are_cut_by(quarter));
        assert_ne!(others, Others::default());
        assert!(*made(&elsewhere) == *before);

        let copied = altered(&parent, |who| who & copies != 0 && who & cuts == 0);
        let others = Others::between(&parent, &copied);
        assert!(others.are_copied(quarter) && !others.are_cut_by(quarter));
        let after = made(&copied);
        assert!(*after != *before && *after == *refreshed(&before, own, &copied));

        let both = altered(&parent, |who| who & cuts != 0);
        let others = Others::between(&parent, &both);
        assert!(others.are_copied(quarter) && others.are_cut_by(quarter));
        assert!(*made(&both) != *refreshed(&before, own, &both));
    }
}

/// The ring that a quarter cuts by is no wider than what it looks at, on any side; nor is what it copies.
#[test]
fn quarters_look_at_every_cell_and_vertex_that_is_said_to_be_theirs() {
    let (terrain, lattice) = (ground(&[]), lattice_of(&ground(&[]), 0.125));
    let (place, parent) = within(&terrain, &lattice);
    let half = CELLS / 2;
    for quarter in [0, 2] {
        let own = place.child(quarter).expect("coarse");
        let (before, _) = make(&terrain, &lattice, own, Some(&parent));
        let first = if quarter == 0 { -1 } else { half - 1 };
        for cell in [
            IVec2::new(first, first + 4),
            IVec2::new(first + 9, first + 4),
            IVec2::new(first + 4, first),
            IVec2::new(first + 4, first + 9),
        ] {
            assert_eq!(cutters(cell).0 >> 4 >> quarter & 1, 1, "{cell}");
            let mut other = parent.clone();
            let k = (cell.y + 1) as usize * RINGED + (cell.x + 1) as usize;
            other.cell_highs[k] -= 1000.0;
            let (after, _) = make(&terrain, &lattice, own, Some(&other));
            assert!(*after != *before, "{quarter} {cell}");
        }
        let beyond = if quarter == 0 { half + 1 } else { half - 2 };
        for cell in [IVec2::new(beyond, first + 4), IVec2::new(first + 4, beyond)] {
            assert_eq!(cutters(cell).0 >> 4 >> quarter & 1, 0, "{cell}");
        }
        let takes = |k: &usize| copiers(*k).0 >> quarter & 1 == 1;
        // Corners 9 × 9, centres 8 × 8: as many as a block has that are not of mixed parity.
        assert_eq!((0..VERTICES).filter(takes).count(), 81 + 64);
    }
}
