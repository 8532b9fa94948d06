//! Where the samples of edits lie.

use super::tile::CELLS;
use crate::ground::{GroundPoint, GroundRect};
use crate::height_map::{Filter, HeightMap};
use crate::noise::Frequency;
use bevy::math::DVec2;

/// Samples of edits, from a corner on: as far apart as those of a height map, or half, a quarter … of that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EditLattice {
    /// Place of sample (0, 0).
    pub(crate) origin: GroundPoint,
    /// Samples a metre along x and z.
    pub(crate) frequency: [Frequency; 2],
    /// Tiles along x and z.
    pub(crate) tiles: [u32; 2],
    pub(crate) filter: Filter,
}

impl EditLattice {
    /// Distance of samples where no map says another, metres; those of a map are halved until they are no farther apart
    /// than half as much again.
    pub const SPACING: f64 = 1.0;
    /// Most samples along a side.
    pub const MAX_SIDE: f64 = 4_194_304.0;

    /// A lattice of samples every `spacing` metres over an extent, one of them at `through`. `None` where spacing or
    /// extent cannot be: fewer than [`HeightMap::MIN_SPACING`], or more than [`Self::MAX_SIDE`] samples a side.
    #[must_use]
    pub fn over(
        extent: &GroundRect,
        through: DVec2,
        spacing: DVec2,
        filter: Filter,
    ) -> Option<Self> {
        let usable = spacing.is_finite()
            && extent.is_valid()
            && through.is_finite()
            && spacing.min_element() >= HeightMap::MIN_SPACING * 0.5;
        let [Some(x), Some(z)] = [spacing.x, spacing.y].map(Frequency::from_wavelength) else {
            return None;
        };
        // Three samples more on every side: interpolation reaches two, and the outermost are never edited.
        let first = ((extent.min - through) / spacing).floor() - 3.0;
        let last = ((extent.max - through) / spacing).ceil() + 3.0;
        let cells = last - first;
        if !usable || cells.is_nan() || cells.max_element() > Self::MAX_SIDE {
            return None;
        }
        let tiles = (cells / f64::from(CELLS)).ceil().as_uvec2();
        Some(Self {
            origin: GroundPoint::new(through + first * spacing),
            frequency: [x, z],
            tiles: tiles.to_array(),
            filter,
        })
    }

    /// Distance of samples, metres.
    #[must_use]
    pub fn spacing(&self) -> DVec2 {
        let [x, z] = self.frequency.map(|frequency| 1.0 / frequency.value());
        DVec2::new(x, z)
    }

    /// Samples a metre.
    pub(crate) fn scale(&self) -> DVec2 {
        let [x, z] = self.frequency.map(Frequency::value);
        DVec2::new(x, z)
    }

    /// Where a sample lies, metres.
    #[must_use]
    pub fn place(&self, [x, z]: [i64; 2]) -> DVec2 {
        self.origin.to_dvec2() + DVec2::new(x as f64, z as f64) / self.scale()
    }

    /// Samples along x and z; the outermost two on each side are never edited.
    #[must_use]
    pub fn samples(&self) -> [i64; 2] {
        self.tiles.map(|tiles| i64::from(tiles) * i64::from(CELLS))
    }

    /// How heights between samples are found.
    #[must_use]
    pub const fn filter(&self) -> Filter {
        self.filter
    }

    /// Levels of the tree above tiles.
    #[must_use]
    pub(crate) fn level(&self) -> u32 {
        let [x, z] = self.tiles;
        x.max(z).max(1).next_power_of_two().trailing_zeros()
    }

    /// A place in samples.
    pub(crate) fn coordinates(&self, xz: DVec2) -> DVec2 {
        (xz - self.origin.to_dvec2()) * self.scale()
    }
}
