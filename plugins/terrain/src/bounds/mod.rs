//! Conservative bounds of height and slope over a rectangle.
//!
//! The rectangle is cut into n × n cells. In each, every source gives an interval that holds its
//! heights and a number that no slope exceeds; masks and sums follow by interval arithmetic; the
//! bounds are the union over the cells. A source that is smooth at the size of a cell is bounded
//! by Taylor's theorem about the cell's centre, |h(c + d) − h(c) − ∇h(c)·d| ≤ ½ dᵀMd with M
//! a bound of the second derivatives, and by its global range where that is narrower. The
//! result is never too narrow (f32 rounding included). It is too wide: for FBM by some 15 to 70 %
//! of the true range on patches of 16 m to one wavelength, for other sums and warps by up to that
//! range; slopes of eroded sums are the loosest, up to ten times the truth.

mod fractal;
mod hidden;
mod sum;
mod unseen;

use crate::ground::{GroundRect, in_range};
use crate::hill::Hill;
use crate::interval::{CellBounds, Interval};
use crate::noise::Sum;
use crate::terrain::{Mask, Prepared, Terrain};
use bevy::math::DVec2;

/// What the ground of a rectangle stays within.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeightBounds {
    /// No height is lower, metres.
    pub min: f32,
    /// No height is higher, metres.
    pub max: f32,
    /// No gradient is longer, rise over run.
    pub max_slope: f32,
}

/// A rectangle cut into n × n cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cells {
    /// Cells along a side.
    pub n: usize,
    /// Centre of the first cell, metres.
    pub first: DVec2,
    /// Half the sides of a cell, metres.
    pub half: DVec2,
}

impl Cells {
    fn new(rect: &GroundRect, n: usize) -> Self {
        let half = rect.size() / (2.0 * n as f64);
        Self {
            n,
            first: rect.min + half,
            half,
        }
    }

    pub(crate) fn centre(&self, index: usize) -> DVec2 {
        let at = DVec2::new((index % self.n) as f64, (index / self.n) as f64);
        self.first + self.half * 2.0 * at
    }

    pub(crate) fn len(&self) -> usize {
        self.n * self.n
    }
}

/// Cells along a side that a source can afford: with 12 octaves all of these take some 50 to
/// 100 µs a rectangle on one core.
fn affordable(source: &Prepared) -> usize {
    match source {
        Prepared::Fractal(fractal) if fractal.sum != Sum::Fbm => 16,
        Prepared::Fractal(fractal) if fractal.warp.is_some() => 24,
        Prepared::Fractal(_) | Prepared::Hill(_) => 32,
        Prepared::Permutation(_) | Prepared::Map(_) | Prepared::Edits(_) => 16,
    }
}

impl Terrain {
    /// Lowest and highest height and steepest slope that `rect` may contain: never too narrow,
    /// and wider than the truth by a little (see [`crate::bounds`]). Some 10 µs a layer.
    #[must_use]
    pub fn bounds(&self, rect: &GroundRect) -> HeightBounds {
        bounds(self, rect)
    }
}

fn bounds(terrain: &Terrain, rect: &GroundRect) -> HeightBounds {
    // A rectangle given the wrong way round is the same rectangle; NaN counts as 0, as it does
    // where heights are asked for.
    let (a, b) = (in_range(rect.min), in_range(rect.max));
    let rect = GroundRect::new(a.min(b), a.max(b));
    let n = terrain
        .prepared()
        .map(|(source, _)| affordable(source))
        .min()
        .unwrap_or(1);
    let cells = Cells::new(&rect, n);
    let base = Interval::point(f64::from(terrain.data().base));
    let mut sum = vec![
        CellBounds {
            height: base,
            slope: 0.0
        };
        cells.len()
    ];
    for (source, mask) in terrain.prepared() {
        let added = source_bounds(source, &cells);
        for (sum, added) in sum.iter_mut().zip(added) {
            *sum = masked(mask, *sum, added);
        }
    }
    let start = CellBounds {
        height: Interval::new(f64::INFINITY, f64::NEG_INFINITY),
        slope: 0.0,
    };
    let all = sum.iter().fold(start, |all, cell| CellBounds {
        height: Interval::new(
            all.height.low.min(cell.height.low),
            all.height.high.max(cell.height.high),
        ),
        slope: all.slope.max(cell.slope),
    });
    // The f32 evaluators err by a few ulp of the height (8 of 2⁻²³ allowed here, besides what the
    // sources allow for); the same margin rounds outward.
    let ulps = |v: f64| v.abs() * 1e-6 + 1e-6;
    HeightBounds {
        min: (all.height.low - ulps(all.height.low)) as f32,
        max: (all.height.high + ulps(all.height.high)) as f32,
        max_slope: (all.slope + ulps(all.slope)) as f32,
    }
}

fn source_bounds(source: &Prepared, cells: &Cells) -> Vec<CellBounds> {
    match source {
        Prepared::Fractal(fractal) => fractal::fractal(fractal, cells),
        Prepared::Permutation(permutation) => fractal::permutation(permutation, cells),
        Prepared::Map(map) => (0..cells.len())
            .map(|i| map.cell_bounds(cells.centre(i), cells.half))
            .collect(),
        Prepared::Edits(edits) => (0..cells.len())
            .map(|i| edits.cell_bounds(cells.centre(i), cells.half))
            .collect(),
        Prepared::Hill(hill) => (0..cells.len())
            .map(|i| hill_bounds(hill, cells, i))
            .collect(),
    }
}

/// The hill falls with the distance from its centre, so its extremes lie at the nearest and the
/// farthest place of the cell; its slope has one maximum, at r = R/√5.
fn hill_bounds(hill: &Hill, cells: &Cells, index: usize) -> CellBounds {
    let from_centre = (cells.centre(index) - hill.centre).abs();
    let radius = f64::from(hill.radius);
    let nearest = ((from_centre - cells.half).max(DVec2::ZERO).length() / radius).min(1.0);
    let farthest = ((from_centre + cells.half).length() / radius).min(1.0);
    let ((h0, s0), (h1, s1)) = (hill.profile(nearest), hill.profile(farthest));
    let steepest = 1.0 / 5.0_f64.sqrt();
    let peak = if (nearest..=farthest).contains(&steepest) {
        hill.profile(steepest).1
    } else {
        0.0
    };
    CellBounds {
        height: Interval::new(h0.min(h1), h0.max(h1)),
        slope: s0.max(s1).max(peak),
    }
}

/// height += s(t)·added over intervals; see `MaskStep`.
fn masked(mask: Option<Mask>, below: CellBounds, added: CellBounds) -> CellBounds {
    let Some(Mask { low, high }) = mask else {
        return CellBounds {
            height: below.height.plus(added.height),
            slope: below.slope + added.slope,
        };
    };
    let scale = 1.0 / (f64::from(high) - f64::from(low));
    let t = |h: f64| ((h - f64::from(low)) * scale).clamp(0.0, 1.0);
    let (t0, t1) = (t(below.height.low), t(below.height.high));
    let (t0, t1) = (t0.min(t1), t0.max(t1));
    // s = t²(3 − 2t) rises with t; s′ ∝ t(1 − t) is largest at the t nearest ½.
    let step = |t: f64| t * t * (3.0 - 2.0 * t);
    let weight = Interval::new(step(t0), step(t1));
    let middle = 0.5_f64.clamp(t0, t1);
    let steepest = 6.0 * middle * (1.0 - middle) * scale;
    let turn = Interval::new(steepest.min(0.0), steepest.max(0.0)).times(added.height);
    let stretch = (1.0 + turn.low).abs().max((1.0 + turn.high).abs());
    CellBounds {
        height: below.height.plus(weight.times(added.height)),
        slope: below.slope * stretch + weight.high * added.slope,
    }
}
