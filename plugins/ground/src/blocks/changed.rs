//! Ground that changes within rectangles: which blocks are made anew, and which are kept.
//!
//! A block is a function of the heights at its samples, of what may lie between them, and of its parent's record. So one
//! whose samples a change does not reach is as it was, unless its parent has become another; and what is below it likewise:
//! the samples of a block lie within its parent's.

use bevy::math::DVec2;
use dolomite_terrain::{GroundRect, Terrain};

use super::kept::{KeptBlocks, lattice_of};
use super::make::make;
use super::place::BlockPlace;
use crate::detail::DetailLattice;

/// How far outside of a block heights count for it, its cells: the ring of three that it samples, and the windows of a map that
/// say what may lie between samples, which are less than a cell wide.
const RING: i64 = 4;

/// Where heights count for a block, metres.
#[must_use]
pub fn reach(lattice: &DetailLattice, place: BlockPlace) -> GroundRect {
    let cell = place.cell();
    let out = i64::from(cell.half) + 2 * RING * i64::from(place.cell_half());
    let centre = cell.centre.as_i64vec2();
    let corner = |by: i64| lattice.signed_point((centre + by).to_array()).to_dvec2();
    GroundRect::new(corner(-out), corner(out))
}

/// Whether heights of a block may be others, where the ground changed within these rectangles and nowhere else. A rectangle
/// with a side that is no number holds everything.
#[must_use]
pub fn is_reached(lattice: &DetailLattice, place: BlockPlace, changed: &[GroundRect]) -> bool {
    let own = reach(lattice, place);
    let apart = |from: DVec2, to: DVec2| to.cmplt(from).any();
    changed
        .iter()
        .any(|rect| !apart(own.min, rect.max) && !apart(rect.min, own.max))
}

/// The same of any root: whether blocks of the ground are others at all.
#[must_use]
pub fn reaches_any(lattice: &DetailLattice, changed: &[GroundRect]) -> bool {
    BlockPlace::roots(lattice).any(|root| is_reached(lattice, root, changed))
}

impl KeptBlocks {
    /// The ground is `terrain` from now on, which differs within these rectangles alone: blocks that are others are made anew in
    /// their slots, parents first. How many that were. Afterwards blocks are those of a ground that never was another. Where
    /// the terrain has another lattice all begins anew.
    pub fn change(&mut self, terrain: Terrain, finest: f32, changed: &[GroundRect]) -> usize {
        if lattice_of(&terrain, finest) != self.lattice {
            let keep = self.keep;
            *self = Self::new(terrain, finest);
            self.keep = keep;
            return self.len();
        }
        self.set_terrain(terrain);
        let mut made = 0;
        let mut open: Vec<(u32, bool)> = self.roots().iter().map(|&root| (root, false)).collect();
        while let Some((slot, parent_changed)) = open.pop() {
            let place = self.place(slot);
            if !parent_changed && !is_reached(&self.lattice, place, changed) {
                continue;
            }
            let old = self.block(slot);
            let parent = (!place.is_root(&self.lattice)).then(|| self.block(old.head.parent));
            let (mut block, _) = make(self.terrain(), &self.lattice, place, parent);
            block.head.parent = old.head.parent;
            block.head.children = old.head.children;
            block.head.looked = old.head.looked;
            // Heights that are no numbers differ from themselves: more is made then than has to be.
            let is_other = *block != *old;
            let children = block.head.children.into_iter().filter(|&child| child != 0);
            open.extend(children.map(|child| (child, is_other)));
            self.replace(slot, block);
            made += 1;
        }
        made
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blocks::choose::{Limits, settle};
    use crate::blocks::record::Block;
    use crate::detail::{DetailView, Lens, Metric, TerrainLod};
    use bevy::math::{DQuat, DVec3, UVec2};
    use dolomite_terrain::{Fractal, Hill, Layer, Source, TerrainData};
    use std::collections::HashMap;

    /// Noise with as many hills as are given, and their rectangles.
    fn ground(hills: &[Hill]) -> Terrain {
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
        let made = blocks.change(ground(&hills), 0.125, &first);
        assert!(made > 4 && made < all, "{made} of {all}");
        hills.push(hill(250.0, 90.0, 30.0));
        let second = [GroundRect::square(hills[1].centre, 60.0)];
        blocks.change(ground(&hills), 0.125, &second);
        let compare = |blocks: &KeptBlocks, terrain: Terrain| {
            let mut fresh = KeptBlocks::new(terrain, 0.125);
            for eye in eyes {
                settle(&mut fresh, &view(eye), Limits::default());
            }
            let (changed, fresh) = (by_place(blocks), by_place(&fresh));
            let both = fresh.keys().filter(|place| changed.contains_key(*place));
            assert!(both.clone().count() > 40);
            for place in both {
                assert!(changed[place] == fresh[place], "{place:?}");
            }
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

    #[test]
    fn changes_beyond_the_ground_reach_nothing_and_others_whoever_samples_them() {
        let terrain = ground(&[]);
        let lattice = lattice_of(&terrain, 0.125);
        let beyond = GroundRect::square(DVec2::new(5000.0, 0.0), 100.0);
        assert!(!reaches_any(&lattice, &[beyond]) && !reaches_any(&lattice, &[]));
        // Within the ring of the western root, outside of its square.
        let beside = GroundRect::square(DVec2::new(60.0, 0.0), 1.0);
        let reached = |rect| {
            let roots = BlockPlace::roots(&lattice);
            roots
                .map(|root| is_reached(&lattice, root, &[rect]))
                .collect::<Vec<_>>()
        };
        assert_eq!(reached(beside), [true, true]);
        let far = GroundRect::square(DVec2::new(400.0, 0.0), 1.0);
        assert_eq!(reached(far), [false, true]);
        let nothing = GroundRect::new(DVec2::splat(f64::NAN), DVec2::splat(f64::NAN));
        assert!(reaches_any(&lattice, &[nothing]));
    }
}
