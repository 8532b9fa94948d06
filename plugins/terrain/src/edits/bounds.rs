//! What a part of a layer of edits can reach: by the extremes that its tree keeps.
//!
//! The weights of the filters and of their derivatives are those of height maps (`height_map/pyramid.rs`).

use super::extremes::Extremes;
use super::layer::Edits;
use super::tile::{CELLS, STEP};
use super::tree;
use crate::ground::GroundRect;
use crate::height_map::Filter;
use crate::interval::{CellBounds, Interval, SecondOrder};
use bevy::math::DVec2;

/// Samples beyond which a lattice made for the spacing of edits is wider by a rounding.
const WIDER: f64 = 1.001;

impl Edits {
    /// Bounds over a rectangle centred on `centre` with half sides `half`, metres.
    pub(crate) fn cell_bounds(&self, centre: DVec2, half: DVec2) -> CellBounds {
        let nothing = CellBounds {
            height: Interval::point(0.0),
            slope: 0.0,
        };
        let Some(found) = self.extremes_over(centre - half, centre + half) else {
            return nothing;
        };
        if found == Extremes::default() {
            return nothing;
        }
        let spacing = self.lattice.spacing();
        let metres = |steps: i32| f64::from(steps) * STEP;
        let step = DVec2::new(metres(found.step[0]), metres(found.step[1])) / spacing;
        let sample = self.sample_f64(centre);
        let (low, high) = (metres(found.low), metres(found.high));
        match self.lattice.filter {
            Filter::Bilinear => {
                let reach = step.dot(half);
                let near = Interval::new(sample.height - reach, sample.height + reach);
                CellBounds {
                    height: near.intersect(Interval::new(low, high)),
                    slope: step.length(),
                }
            }
            Filter::Bicubic => {
                let (middle, range) = ((low + high) * 0.5, (high - low) * 0.5);
                let overshoot = 1.25 * 1.25 * range;
                let wide = Interval::new(middle - overshoot, middle + overshoot);
                let [xx, zz, xz] = found.bend.map(metres);
                let second = SecondOrder {
                    xx: 3.0 * 1.25 * xx / (spacing.x * spacing.x),
                    xz: 1.5 * 1.5 * xz / (spacing.x * spacing.y),
                    zz: 3.0 * 1.25 * zz / (spacing.y * spacing.y),
                };
                let near = second.bounds(sample.height, sample.gradient, half);
                CellBounds {
                    height: near.height.intersect(wide),
                    slope: near.slope.min((step * (1.5 * 1.25)).length()),
                }
            }
        }
    }

    /// Extremes over the tiles that a rectangle touches; `None` beyond the lattice.
    fn extremes_over(&self, low: DVec2, high: DVec2) -> Option<Extremes> {
        // One cell more, against rounding at the borders of cells.
        let tile = |xz: DVec2, more: f64| {
            let cells = self.lattice.coordinates(xz).floor() + more;
            (cells / f64::from(CELLS)).floor().as_i64vec2().to_array()
        };
        let (low, high) = (tile(low, -1.0), tile(high, 1.0));
        tree::extremes(&self.root, self.lattice.level(), [0; 2], low, high)
    }

    /// By how much a plane through three heights, anywhere in `rect` and no more than `spacing` metres apart along
    /// either axis, may miss the surface between them, metres. 0 where the samples of edits are no closer than that.
    ///
    /// Heights stay within the range of the samples about them, and so does what is between. With bounds M of the
    /// second derivatives, a plane through three places of a square of side L is at p no farther from the surface than
    /// ½ Σ λᵢ dᵢᵀ M dᵢ, with λ the weights of p, d the ways to the places; Σ λᵢ dᵢ² is L²/4 along an axis at most.
    pub(crate) fn missed(&self, rect: &GroundRect, spacing: f64) -> f32 {
        let own = self.lattice.spacing();
        if self.root.is_none() || spacing <= own.min_element() * WIDER {
            return 0.0;
        }
        let low = self.lattice.coordinates(rect.min) - 1.0;
        let high = self.lattice.coordinates(rect.max) + 1.0;
        let level = self.level_for((high - low).max_element());
        let side = f64::from(CELLS) * f64::from(1_u32 << level);
        // Before the first node and behind the last there is nothing.
        let across = f64::from(1_u32 << (self.lattice.level() - level));
        let node = |at: f64| (at / side).floor().clamp(-1.0, across) as i64;
        let mut found: Option<Extremes> = None;
        for z in node(low.y)..=node(high.y) {
            for x in node(low.x)..=node(high.x) {
                let own = self.node_extremes(level, [x, z]);
                found = Some(found.map_or(own, |known| known.join(own)));
            }
        }
        let apart = DVec2::splat(spacing) / own;
        found.map_or(0.0, |found| missed_by(&found, self.lattice.filter, apart))
    }

    /// How far beyond a rectangle whose longer side is `size` an edit may change what is known of the surface between samples
    /// `spacing` apart in it (as part of [`Terrain::unseen`](crate::Terrain::unseen)), metres: that is told for whole nodes of
    /// the tree of edits. 0 where no edit changes it, as samples of edits are no closer.
    #[must_use]
    pub fn told_beyond(&self, size: f64, spacing: f64) -> f64 {
        let own = self.lattice.spacing();
        if spacing <= own.min_element() * WIDER {
            return 0.0;
        }
        // As in `missed`, and a little more: one of two levels is as good as the other where a window just fits.
        let samples = (size / own.min_element() + 2.0) * WIDER;
        let side = f64::from(CELLS) * f64::from(1_u32 << self.level_for(samples));
        (side + 1.0) * own.max_element()
    }

    /// The level whose nodes are as long as so many samples, or the root's.
    fn level_for(&self, samples: f64) -> u32 {
        let top = self.lattice.level();
        (0..top)
            .find(|level| f64::from(CELLS) * f64::from(1_u32 << level) >= samples)
            .unwrap_or(top)
    }

    fn node_extremes(&self, level: u32, place: [i64; 2]) -> Extremes {
        let top = self.lattice.level();
        let across = 1_i64 << (top - level);
        if place.iter().any(|k| !(0..across).contains(k)) {
            return Extremes::default();
        }
        let tile = place.map(|k| (k << level) as u32);
        tree::find(&self.root, top, tile, level)
            .map_or_else(Extremes::default, tree::Node::extremes)
    }
}

/// See [`Edits::missed`].
fn missed_by(found: &Extremes, filter: Filter, apart: DVec2) -> f32 {
    let metres = |steps: i32| steps as f32 * STEP as f32;
    let range = metres(found.high - found.low);
    // Numbers of up to 2²⁷ steps are rounded by 6e-8.
    const UP: f32 = 1.000_001;
    match filter {
        Filter::Bilinear => range * UP,
        Filter::Bicubic => {
            let [xx, zz, xz] = found.bend.map(metres);
            let apart = apart.as_vec2();
            let bend = 3.75 * (xx * apart.x * apart.x + zz * apart.y * apart.y)
                + 4.5 * xz * apart.x * apart.y;
            (1.5625 * range).min(0.125 * bend) * UP
        }
    }
}
