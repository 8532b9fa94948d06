//! Stored heights: a grid of samples, interpolated, with its gradient.
//!
//! Conventions: sample (column, row) lies at origin + (column, row) × spacing; columns run along
//! +X (east), rows along +Z (south), so row 0 of a north-up picture is its northern edge. Beyond
//! the border the border samples go on.

mod deviation;
mod error;
mod file;
mod geodesy;
mod interpolate;
mod joined;
mod pyramid;
mod stream;

pub use error::HeightMapError;
pub use file::{HeightMapFile, Holes, MapFormat, RawFormat};
pub use geodesy::metres_per_degree;
pub(crate) use interpolate::{slopes, weights, weights_f64};
pub use stream::{LEVEL_WORDS, MOST_LEVELS, MapNews, MapWrite, Readable, Stream, TileRequest};

use crate::ground::{GroundPoint, GroundRect};
use crate::noise::Frequency;
use bevy::math::DVec2;
use deviation::Deviations;
use dolomite_elevation::{Georeference, TiledMap};
use noise::NoiseFn;
use pyramid::Pyramid;
use serde::{Deserialize, Serialize};
use std::sync::{Arc, OnceLock};

/// How heights between samples are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Filter {
    /// Four samples; exact at samples, never beyond its neighbours; creases along the grid lines.
    Bilinear,
    /// Sixteen samples, Catmull-Rom (E. Catmull, R. Rom, 1974): exact at samples, smooth gradient;
    /// may overshoot its neighbours by up to 28 % of their range.
    #[default]
    Bicubic,
}

/// A grid of heights on the ground. Immutable and cheap to clone.
#[derive(Clone, Debug)]
pub struct HeightMap(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    width: u32,
    height: u32,
    samples: Vec<f32>,
    origin: DVec2,
    spacing: DVec2,
    filter: Filter,
    lattice: Lattice,
    pyramid: Pyramid,
    /// Where the samples lie on the Earth, if a file told it.
    georeference: Option<Georeference>,
    /// Made when first asked for: it takes ten looks at each sample.
    deviations: OnceLock<Deviations>,
    /// Of a map that is read by tiles; `samples` and `pyramid` are empty then.
    stream: Option<Arc<Stream>>,
}

/// The grid as the integer implementations see it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lattice {
    /// Place of sample (0, 0).
    pub origin: GroundPoint,
    /// Samples a metre along x and z.
    pub frequency: [Frequency; 2],
}

impl HeightMap {
    /// Most samples along a side.
    pub const MAX_SIDE: u32 = 65_537;
    /// Most samples of a map: 16 385 × 16 385, 1 GiB of f32. What a GPU can bind is its own limit: 128 MiB (some 5 000 × 5 000
    /// samples) is what WebGPU grants a storage buffer.
    pub const MAX_SAMPLES: usize = 16_385 * 16_385;
    /// Smallest distance of samples, metres; with it every place within 1e8 m has its own cell.
    pub const MIN_SPACING: f64 = 0.1;

    /// A map from heights in metres, row after row.
    ///
    /// `origin`: place of the first sample (x, z), metres. `spacing`: distance of columns and of
    /// rows, metres.
    ///
    /// # Errors
    /// A size of 0 or beyond [`Self::MAX_SIDE`] or [`Self::MAX_SAMPLES`]; a number of samples
    /// that is not width × height; a sample that is not a finite height of at most 1e6 m; an
    /// unusable origin or spacing.
    pub fn new(
        width: u32,
        height: u32,
        samples: Vec<f32>,
        origin: DVec2,
        spacing: DVec2,
        filter: Filter,
    ) -> Result<Self, HeightMapError> {
        Self::named(
            "(made in memory)",
            [width, height],
            samples,
            (origin, spacing),
            filter,
        )
    }

    /// As [`Self::new`], with the name that errors give.
    fn named(
        name: &str,
        [width, height]: [u32; 2],
        samples: Vec<f32>,
        (origin, spacing): (DVec2, DVec2),
        filter: Filter,
    ) -> Result<Self, HeightMapError> {
        let file = || name.to_owned();
        error::check_size(name, width, height)?;
        let expected = width as usize * height as usize;
        if samples.len() != expected {
            return Err(HeightMapError::SampleCount {
                file: file(),
                expected,
                found: samples.len(),
            });
        }
        if let Some(at) = samples
            .iter()
            .position(|s| !(s.is_finite() && s.abs() <= 1e6))
        {
            return Err(HeightMapError::NotAHeight {
                file: file(),
                column: at as u32 % width,
                row: at as u32 / width,
                value: samples[at],
            });
        }
        let usable = |s: f64| (Self::MIN_SPACING..=1e6).contains(&s);
        let frequency = [spacing.x, spacing.y].map(Frequency::from_wavelength);
        let [Some(x), Some(z)] = frequency else {
            return Err(HeightMapError::Spacing {
                file: file(),
                spacing,
            });
        };
        if !usable(spacing.x) || !usable(spacing.y) {
            return Err(HeightMapError::Spacing {
                file: file(),
                spacing,
            });
        }
        if !(origin.is_finite() && origin.abs().max_element() <= 1e8) {
            return Err(HeightMapError::Origin {
                file: file(),
                origin,
            });
        }
        let pyramid = Pyramid::new(&samples, width as usize, height as usize);
        let lattice = Lattice {
            origin: GroundPoint::new(origin),
            frequency: [x, z],
        };
        Ok(Self(Arc::new(Inner {
            width,
            height,
            samples,
            origin,
            spacing,
            filter,
            lattice,
            pyramid,
            georeference: None,
            deviations: OnceLock::new(),
            stream: None,
        })))
    }

    /// A map that is read by tiles about a place ([`Self::follow`]), within so many bytes of memory, as many on a GPU: no less than 4 × 4
    /// tiles of each level. Waits for the levels that fit in as a whole.
    ///
    /// A height is `number × scale + offset` in metres, rounded to f32 twice, as where a file is read as a whole.
    ///
    /// # Errors
    /// As [`Self::new`], and a file that cannot be read.
    pub fn by_tiles(
        tiles: TiledMap,
        [scale, offset]: [f32; 2],
        (centre, spacing): (DVec2, DVec2),
        filter: Filter,
        budget: u64,
    ) -> Result<Self, HeightMapError> {
        let file = tiles.about().file.clone();
        let georeference = tiles.georeference().cloned();
        let [width, height] = tiles.size();
        let ends = tiles.bounds([0; 2], [width - 1, height - 1]);
        let in_metres = |number: f32| number * scale + offset;
        for value in [ends.low, ends.high].map(in_metres) {
            if !(value.is_finite() && value.abs() <= 1e6) {
                return Err(HeightMapError::NotAHeight {
                    file,
                    column: 0,
                    row: 0,
                    value,
                });
            }
        }
        let steps = DVec2::new(f64::from(width - 1), f64::from(height - 1));
        let origin = centre - spacing * steps * 0.5;
        // Place and spacing are checked as of any map.
        let one = Self::named(
            &file,
            [1, 1],
            vec![in_metres(ends.low)],
            (origin, spacing),
            filter,
        )?;
        let metres = stream::InMetres { scale, offset };
        // What else the ground needs on a GPU is bound with it.
        let stream = Stream::new(tiles, metres, filter, budget.saturating_sub(1 << 20))?;
        Ok(Self(Arc::new(Inner {
            width,
            height,
            samples: Vec::new(),
            origin,
            spacing,
            filter,
            lattice: one.lattice(),
            pyramid: Pyramid::new(&[], 0, 0),
            georeference,
            deviations: OnceLock::new(),
            stream: Some(Arc::new(stream)),
        })))
    }

    /// The same, with where it lies on the Earth.
    fn lying_at(mut self, georeference: Option<Georeference>) -> Self {
        // It was just made: nobody else has it.
        if let Some(inner) = Arc::get_mut(&mut self.0) {
            inner.georeference = georeference;
        }
        self
    }

    /// Where the first sample lies on the Earth and how far the next ones are, in the file's own
    /// coordinates and to the bit, if a file told it: the offset of the ground, whose middle lies at
    /// [`HeightMapFile::centre`].
    #[must_use]
    pub fn georeference(&self) -> Option<&Georeference> {
        self.0.georeference.as_ref()
    }

    /// Samples any function of the `noise` crate over `rect`, every `spacing` metres or a little
    /// less: height = `amplitude` × f(x / `wavelength`, z / `wavelength`), with the bicubic filter.
    ///
    /// The map then *is* the source, for the CPU and for the GPU alike: choose the spacing well
    /// below the finest detail of the function.
    ///
    /// # Errors
    /// As [`Self::new`]; also a function that returns numbers that are not finite.
    pub fn from_noise_fn(
        function: &(impl NoiseFn<f64, 2> + ?Sized),
        rect: &GroundRect,
        spacing: f64,
        wavelength: f64,
        amplitude: f64,
    ) -> Result<Self, HeightMapError> {
        let name = "(noise function)";
        let steps = (rect.size() / spacing).ceil();
        let count = |steps: f64| (steps as u32).saturating_add(1);
        let [width, height] = [count(steps.x), count(steps.y)];
        error::check_size(name, width, height)?;
        let step = rect.size() / steps;
        let mut samples = Vec::with_capacity(width as usize * height as usize);
        for row in 0..height {
            for column in 0..width {
                let xz = rect.min + step * DVec2::new(f64::from(column), f64::from(row));
                let at = xz / wavelength;
                samples.push((amplitude * function.get([at.x, at.y])) as f32);
            }
        }
        Self::named(
            name,
            [width, height],
            samples,
            (rect.min, step),
            Filter::Bicubic,
        )
    }

    /// Columns.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.0.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.0.height
    }

    /// The samples, metres, row after row; none of a map that is read by tiles.
    #[must_use]
    pub fn samples(&self) -> &[f32] {
        &self.0.samples
    }

    /// Place of the first sample (x, z), metres.
    #[must_use]
    pub fn origin(&self) -> DVec2 {
        self.0.origin
    }

    /// Distance of columns and of rows, metres.
    #[must_use]
    pub fn spacing(&self) -> DVec2 {
        self.0.spacing
    }

    /// How heights between samples are found.
    #[must_use]
    pub fn filter(&self) -> Filter {
        self.0.filter
    }

    /// The rectangle from the first to the last sample, metres.
    ///
    /// That of a map which is read by tiles is larger by as much as makes both sides one to four times the same power of two of
    /// samples: its border goes on there. So the ground's lattice can stand on the samples of every level.
    #[must_use]
    pub fn rect(&self) -> GroundRect {
        let steps = [self.0.width - 1, self.0.height - 1];
        let steps = if self.0.stream.is_some() {
            let side = (0..32).find(|&m| steps.iter().all(|n| n.div_ceil(1 << m) <= 4));
            steps.map(|n| n.max(1).next_multiple_of(1 << side.unwrap_or(0)))
        } else {
            steps
        };
        let steps = DVec2::new(f64::from(steps[0]), f64::from(steps[1]));
        GroundRect::new(self.0.origin, self.0.origin + steps * self.0.spacing)
    }

    pub(crate) fn deviations(&self) -> &Deviations {
        self.0.deviations.get_or_init(|| Deviations::new(self))
    }

    /// By how much a plane through three heights, anywhere in `rect` and no more than `spacing` metres
    /// apart along either axis, may miss the surface between them, metres. 0 where the samples of the map
    /// are no closer than that: what lies between is then theirs.
    #[must_use]
    pub fn missed(&self, rect: &GroundRect, spacing: f64) -> f32 {
        // 1.001: a lattice made for the map's own spacing may be wider by a rounding.
        if spacing <= self.0.spacing.min_element() * 1.001 {
            return 0.0;
        }
        let place = |xz: DVec2| ((xz - self.0.origin) / self.0.spacing).to_array();
        let apart = spacing / self.0.spacing.min_element();
        if let Some(stream) = self.stream() {
            let missed = stream.missed(place(rect.min), place(rect.max), apart);
            return missed.unwrap_or_else(|| self.range());
        }
        self.deviations()
            .missed(place(rect.min), place(rect.max), apart)
            .unwrap_or_else(|| self.range())
    }

    pub(crate) fn lattice(&self) -> Lattice {
        self.0.lattice
    }
}
