//! A lattice whose lines stand on the samples of a height map.
//!
//! A map with a linear filter has creases along its rows and columns. Where these lie between the lattice's
//! lines, every cell has a crease in its middle that no triangle can follow; on the lines they cost nothing.
//!
//! Samples seldom begin at the border of the extent (texels have theirs half a spacing inside), and one column
//! more or less would be no power of two. So all columns are as wide as the map's but the outermost ones: their
//! outer line stands at the border, ½ to 2 spacings from the next, and what is finer in them evenly. Across
//! their inner line the lattice is uneven: a triangle that reaches across is not what halving on the lattice
//! makes of it. The errors of blocks take that into account (`blocks/triangle.rs`).

use bevy::math::{DVec2, UVec2};
use dolomite_terrain::{GroundPoint, GroundRect};

use super::lattice::{Border, DetailLattice, MAX_DEPTH, STEPS};

/// Most roots along a side of a lattice that is aligned to a map.
pub const MOST_ALIGNED: u32 = 4;

/// Columns of one axis of an aligned lattice.
#[derive(Clone, Copy, Debug)]
struct Columns {
    count: u32,
    /// Width of the first, in spacings.
    first: f64,
}

impl Columns {
    /// Every way to cut `size` spacings at the lines `offset` + n, with outermost columns ½ to 2 spacings wide.
    fn all(size: f64, offset: f64) -> Vec<Self> {
        // A hundred-thousandth of a spacing is no column.
        let is_width = |width: f64| (0.499_99..=2.000_01).contains(&width);
        let least = offset.rem_euclid(1.0);
        let mut all = Vec::new();
        for first in [least, least + 1.0, least + 2.0]
            .into_iter()
            .filter(|w| is_width(*w))
        {
            for inner in 0..3 {
                let inner = (size - first).round() - f64::from(inner);
                if (0.0..1e6).contains(&inner) && is_width(size - first - inner) {
                    all.push(Self {
                        count: inner as u32 + 2,
                        first,
                    });
                }
            }
        }
        all
    }
}

impl DetailLattice {
    /// A lattice whose lines stand on the samples of a map that has one every `spacing` metres along both axes,
    /// from `origin` on: then its creases lie on edges. Only the outermost lines do not: they stand at the
    /// border of the extent, ½ to 2 spacings from the next. `None` where so many columns are no power of two
    /// times [`MOST_ALIGNED`] roots at most.
    #[must_use]
    pub fn aligned(extent: GroundRect, origin: DVec2, spacing: DVec2, finest: f32) -> Option<Self> {
        let axis = |k: usize| {
            let (size, first) = (extent.size()[k] / spacing[k], origin[k] - extent.min[k]);
            Columns::all(size, first / spacing[k])
        };
        let (x, z) = (axis(0), axis(1));
        // The most halvings from a root to the map's own cells.
        let pairs = x.iter().flat_map(|x| z.iter().map(move |z| (*x, *z)));
        let halvings = |(x, z): &(Columns, Columns)| (x.count | z.count).trailing_zeros();
        let (x, z) = pairs.max_by_key(halvings)?;
        let m = halvings(&(x, z));
        let roots = UVec2::new(x.count >> m, z.count >> m);
        if roots.max_element() > MOST_ALIGNED {
            return None;
        }
        let finest = f64::from(finest).max(1e-4);
        let mut depth = m;
        while depth < MAX_DEPTH
            && spacing.max_element() / f64::from(1_u32 << (depth - m)) > finest * 1.000_001
        {
            depth += 1;
        }
        let width = 1_u32 << (depth + 1 - m);
        let steps = |columns: f64, spacing: f64| columns * spacing * STEPS / f64::from(width);
        let step = [spacing.x, spacing.y].map(|spacing| steps(1.0, spacing).round() as u64);
        let first = [
            steps(x.first, spacing.x).round() as u64,
            steps(z.first, spacing.y).round() as u64,
        ];
        // What is left: so that nothing of the extent is left out, and less than 2⁻⁸ m drawn beyond.
        let last = |k: usize, columns: Columns| {
            let whole = (extent.size()[k] * STEPS).ceil() as u64;
            let inner = step[k] * u64::from(width) * u64::from(columns.count - 2);
            whole
                .saturating_sub(inner + first[k] * u64::from(width))
                .div_ceil(u64::from(width))
        };
        Some(Self {
            origin: GroundPoint::new(extent.min),
            step,
            roots,
            depth,
            border: Border {
                width,
                first,
                last: [last(0, x), last(1, z)],
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines between the outermost ones stand on samples, and the outermost ones at the border of the extent.
    #[test]
    fn an_aligned_lattice_stands_on_samples_and_covers_the_extent() {
        // Texels of a metre about a square of 1024 m, their centres half a metre inside; samples to the very
        // border, one column too many for a power of two; another spacing along each axis.
        let cases = [
            (
                DVec2::splat(-512.0),
                DVec2::splat(1024.0),
                DVec2::splat(0.5),
                DVec2::ONE,
                [1024; 2],
            ),
            (
                DVec2::new(3.0, 8.0),
                DVec2::splat(99.0),
                DVec2::ZERO,
                DVec2::splat(3.0),
                [32; 2],
            ),
            (
                DVec2::ZERO,
                DVec2::new(130.0, 65.0),
                DVec2::new(1.0, 0.5),
                DVec2::new(2.0, 1.0),
                [64; 2],
            ),
        ];
        for (min, size, offset, spacing, columns) in cases {
            let extent = GroundRect::new(min, min + size);
            let lattice = DetailLattice::aligned(extent, min + offset, spacing, 0.1).expect("fits");
            let width = lattice.border.width;
            let count = (lattice.roots << (lattice.depth + 1)) / width;
            assert_eq!(count.to_array(), columns);
            for k in 0..=count.max_element() {
                let at = UVec2::splat(k).min(count) * width;
                let point = lattice.point(at).to_dvec2();
                for axis in 0..2 {
                    let sample = (point - min - offset)[axis] / spacing[axis];
                    let (k, point) = (k.min(count[axis]), point[axis]);
                    if k == 0 {
                        assert_eq!(point, min[axis]);
                    } else if k == count[axis] {
                        let beyond = point - (min + size)[axis];
                        assert!((0.0..1.0 / 256.0).contains(&beyond), "{beyond}");
                    } else {
                        assert!((sample - sample.round()).abs() < 1e-6, "{k} {sample}");
                    }
                }
                let found = lattice.coordinates(lattice.point(at));
                assert!(
                    (found - at.as_dvec2()).abs().max_element() < 1e-3,
                    "{found} {at}"
                );
            }
            // Between lines, places keep their order.
            let mut last = lattice.point(UVec2::ZERO).to_dvec2().x;
            for x in 1..=count.x * width {
                let next = lattice.point(UVec2::new(x, 0)).to_dvec2().x;
                assert!(next > last);
                last = next;
            }
        }
        // 37 samples are no power of two, whatever the border does.
        let extent = GroundRect::square(DVec2::ZERO, 36.0);
        let none = DetailLattice::aligned(extent, extent.min, DVec2::ONE, 0.1);
        assert_eq!(none, None);
    }
}
