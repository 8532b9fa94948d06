//! A terrain: layers of sources, one function of the ground plane.

use crate::edits::Edits;
use crate::ground::{Ground, GroundPoint, GroundRect, GroundSample, Height, in_range};
use crate::height_map::{HeightMap, HeightMapError, Stream};
use crate::hill::Hill;
use crate::noise::{Fractal, NoiseError, PermutationNoise, PreparedFractal, PreparedPermutation};
use bevy::ecs::component::Component;
use bevy::math::DVec2;
use bevy::reflect::Reflect;
use dolomite_elevation::ElevationError;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use thiserror::Error;

/// What a terrain is made of; see [`Terrain::new`].
#[derive(Clone, Debug)]
pub struct TerrainData {
    /// Where there is ground to draw and walk on. The height function itself has no border.
    pub extent: GroundRect,
    /// Added up from first to last; at most [`Terrain::MAX_LAYERS`].
    pub layers: Vec<Layer>,
    /// Height before the first layer, metres.
    pub base: f32,
    /// Height of the water, metres, if there is any.
    pub sea_level: Option<f32>,
}

/// One source of a terrain: height += mask(height so far) × source.
#[derive(Clone, Debug)]
pub struct Layer {
    /// What is added.
    pub source: Source,
    /// Where, by the height that the layers below have reached; everywhere if `None`.
    pub mask: Option<Mask>,
}

/// A smooth step over the height so far: 0 at `low`, 1 at `high`, flat beyond, with zero slope at
/// both. With low > high it is 1 at and below `high` and 0 at and above `low`.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mask {
    /// Where the layer is absent, metres.
    pub low: f32,
    /// Where the layer is fully there, metres; must differ from `low`.
    pub high: f32,
}

/// Where heights come from. Any `noise::NoiseFn<f64, 2>` comes in as a map:
/// [`HeightMap::from_noise_fn`].
#[derive(Clone, Debug)]
pub enum Source {
    /// Endless fractal ground.
    Fractal(Fractal),
    /// The method of the literature: permutation table, four gradients.
    Permutation(PermutationNoise),
    /// Measured or stored heights.
    Map(HeightMap),
    /// One round hill (or, with a negative height, hollow).
    Hill(Hill),
}

/// A source, validated and laid out for evaluation.
#[derive(Clone, Debug)]
pub(crate) enum Prepared {
    Fractal(PreparedFractal),
    Permutation(PreparedPermutation),
    Map(HeightMap),
    Hill(Hill),
    Edits(Edits),
}

/// The ground: an immutable, cheaply cloned function from place to height and gradient.
///
/// Its f32 value ([`Terrain::sample`], the batch functions, and `terrain_height` in WGSL) and its
/// f64 value ([`Terrain::sample_f64`], the [`Ground`] that gameplay uses) are the same function up
/// to rounding.
///
/// What was edited lies over it ([`Terrain::with_edits`]): an edited terrain is another value that shares what it is made
/// of with the one before, and what differs is told by [`Terrain::changed_since`].
#[derive(Component, Clone, Debug)]
pub struct Terrain {
    base: Arc<Inner>,
    /// Without its water.
    dry: bool,
    /// A [`Prepared::Edits`], if there is a layer of them.
    edits: Option<Arc<Prepared>>,
    /// What had arrived of a map that is read by tiles.
    arrived: u64,
}

#[derive(Debug)]
struct Inner {
    data: TerrainData,
    prepared: Vec<Prepared>,
}

/// Why a terrain cannot be made.
#[derive(Debug, Error)]
pub enum TerrainError {
    /// The extent has a number that is not finite, or no area.
    #[error("extent {0:?} must be finite, with max above min on both axes")]
    Extent(GroundRect),
    /// The extent leaves the range of positions.
    #[error("extent {0:?} must stay within 1e8 m of the origin")]
    ExtentRange(GroundRect),
    /// The base or the sea level is not a usable height.
    #[error("{field} is {value} m, but it must be a finite height of at most 1e6 m either way")]
    Height {
        /// `base` or `sea_level`.
        field: &'static str,
        /// What it was, metres.
        value: f32,
    },
    /// More layers than the GPU evaluates.
    #[error("{0} layers, but a terrain may have at most {max}", max = Terrain::MAX_LAYERS)]
    LayerCount(usize),
    /// A mask without extent or with a number that is not finite.
    #[error(
        "layer {layer}: mask from {low} m to {high} m must have two different finite ends, at least 1 mm apart"
    )]
    Mask {
        /// Index of the layer.
        layer: usize,
        /// The mask's `low`, metres.
        low: f32,
        /// The mask's `high`, metres.
        high: f32,
    },
    /// A source with an unusable setting.
    #[error("layer {layer}: {source}")]
    Source {
        /// Index of the layer.
        layer: usize,
        /// Which setting, and what it may be.
        source: NoiseError,
    },
    /// More than one map that is read by tiles.
    #[error(
        "layers {0:?}: one map of a terrain may be read by tiles, but these are; give the smaller ones more room in memory (`budget`)"
    )]
    Streams(Vec<usize>),
    /// A height map that cannot be used.
    #[error("layer {layer}: {source}")]
    Map {
        /// Index of the layer.
        layer: usize,
        /// What is wrong with it.
        source: HeightMapError,
    },
}

impl Terrain {
    /// Most layers of a terrain; bounds what a GPU thread may be asked to loop over.
    pub const MAX_LAYERS: usize = 32;

    /// Checks the data and prepares it for evaluation.
    ///
    /// # Errors
    /// A [`TerrainError`] that names the layer and the setting.
    pub fn new(data: TerrainData) -> Result<Self, TerrainError> {
        let extent = data.extent;
        let size = extent.size();
        if !extent.is_valid() || size.x <= 0.0 || size.y <= 0.0 {
            return Err(TerrainError::Extent(extent));
        }
        if extent
            .min
            .abs()
            .max_element()
            .max(extent.max.abs().max_element())
            > 1e8
        {
            return Err(TerrainError::ExtentRange(extent));
        }
        for (field, value) in [("base", Some(data.base)), ("sea_level", data.sea_level)] {
            if let Some(value) = value.filter(|v| !(v.is_finite() && v.abs() <= 1e6)) {
                return Err(TerrainError::Height { field, value });
            }
        }
        if data.layers.len() > Self::MAX_LAYERS {
            return Err(TerrainError::LayerCount(data.layers.len()));
        }
        let mut prepared = Vec::with_capacity(data.layers.len());
        for (layer, Layer { source, mask }) in data.layers.iter().enumerate() {
            if let Some(Mask { low, high }) = *mask
                && !(low.is_finite() && high.is_finite() && (high - low).abs() >= 1e-3)
            {
                return Err(TerrainError::Mask { layer, low, high });
            }
            let named = |source| TerrainError::Source { layer, source };
            prepared.push(match source {
                Source::Fractal(fractal) => Prepared::Fractal(fractal.prepare().map_err(named)?),
                Source::Permutation(permutation) => {
                    Prepared::Permutation(permutation.prepare().map_err(named)?)
                }
                Source::Map(map) => Prepared::Map(map.clone()),
                Source::Hill(hill) => {
                    hill.validate().map_err(named)?;
                    Prepared::Hill(*hill)
                }
            });
        }
        let streams = prepared
            .iter()
            .enumerate()
            .filter(|(_, source)| matches!(source, Prepared::Map(map) if map.stream().is_some()));
        let streams: Vec<_> = streams.map(|(layer, _)| layer).collect();
        if streams.len() > 1 {
            return Err(TerrainError::Streams(streams));
        }
        Ok(Self {
            base: Arc::new(Inner { data, prepared }),
            dry: false,
            edits: None,
            arrived: 0,
        }
        .with_arrived())
    }

    /// Its map that is read by tiles, if there is one.
    #[must_use]
    pub fn streamed(&self) -> Option<&HeightMap> {
        self.base.prepared.iter().find_map(|source| match source {
            Prepared::Map(map) if map.stream().is_some() => Some(map),
            _ => None,
        })
    }

    /// Reads what lies under (x, z), metres, of its map that is read by tiles, if there is one: see [`HeightMap::read_about`].
    ///
    /// # Errors
    /// As there.
    pub fn read_about(&self, xz: DVec2) -> Result<(), ElevationError> {
        self.streamed().map_or(Ok(()), |map| map.read_about(xz))
    }

    /// What the terrain was made from.
    #[must_use]
    pub fn data(&self) -> &TerrainData {
        &self.base.data
    }

    /// Where there is ground.
    #[must_use]
    pub fn extent(&self) -> GroundRect {
        self.base.data.extent
    }

    /// Height of the water, metres, if there is any.
    #[must_use]
    pub fn sea_level(&self) -> Option<f32> {
        self.base.data.sea_level.filter(|_| !self.dry)
    }

    /// The same ground without its water.
    #[must_use]
    pub fn without_sea(&self) -> Self {
        Self {
            dry: true,
            ..self.clone()
        }
    }

    /// Whether two handles are the same terrain, edits too: what was computed for one then holds for the other.
    #[must_use]
    pub fn same(&self, other: &Self) -> bool {
        self.same_base(other) && self.edits() == other.edits()
    }

    /// Whether two handles are made of the same (the same allocation), whatever was edited.
    #[must_use]
    pub fn same_base(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.base, &other.base) && self.sea_level() == other.sea_level()
    }

    /// What was edited, if there is a layer of edits.
    #[must_use]
    pub fn edits(&self) -> Option<&Edits> {
        match self.edits.as_deref() {
            Some(Prepared::Edits(edits)) => Some(edits),
            _ => None,
        }
    }

    /// The same terrain with other edits, or with none.
    #[must_use]
    pub fn with_edits(&self, edits: Option<Edits>) -> Self {
        Self {
            edits: edits.map(|edits| Arc::new(Prepared::Edits(edits))),
            ..self.clone()
        }
    }

    /// Rectangles beyond which this terrain is the same as another one, metres: those in which they were edited
    /// otherwise, and those in which tiles of its map have arrived. Found in time in proportion to what differs. `None` for terrains that are made of something else.
    #[must_use]
    pub fn changed_since(&self, other: &Self) -> Option<Vec<GroundRect>> {
        if !self.same_base(other) {
            return None;
        }
        let mut rects = match (other.edits(), self.edits()) {
            (None, None) => Some(Vec::new()),
            (Some(before), None) => Edits::none(*before.lattice()).changed_since(before),
            (None, Some(now)) => now.changed_since(&Edits::none(*now.lattice())),
            (Some(before), Some(now)) => now.changed_since(before),
        }?;
        if let Some(map) = self.streamed() {
            rects.extend(map.arrived_between(other.arrived, self.arrived));
        }
        Some(rects)
    }

    /// The same terrain, which knows what has arrived of its map that is read by tiles: [`Terrain::changed_since`] tells where the
    /// heights have become finer. Heights themselves are of what is there, whichever handle is asked.
    #[must_use]
    pub fn with_arrived(&self) -> Self {
        let stream = self.streamed().and_then(HeightMap::stream);
        Self {
            arrived: stream.map_or(0, Stream::arrived),
            ..self.clone()
        }
    }

    /// Whether as much had arrived for both.
    #[must_use]
    pub const fn same_arrived(&self, other: &Self) -> bool {
        self.arrived == other.arrived
    }

    /// Layers with what evaluates them, first to last, edits behind all.
    pub(crate) fn prepared(&self) -> impl Iterator<Item = (&Prepared, Option<Mask>)> {
        let masks = self.base.data.layers.iter().map(|layer| layer.mask);
        let edits = self.edits.as_deref().map(|edits| (edits, None));
        self.base.prepared.iter().zip(masks).chain(edits)
    }

    /// Height and gradient in f32: the CPU reference of `terrain_height` in WGSL. About 20 ns an octave;
    /// many points are cheaper by [`Terrain::fill_tile`] and [`Terrain::fill_points`].
    #[must_use]
    pub fn sample(&self, point: GroundPoint) -> Height {
        let base = Height {
            value: self.base.data.base,
            ..Height::default()
        };
        self.prepared().fold(base, |below, (source, mask)| {
            MaskStep::new(mask).apply(below, source.sample(point))
        })
    }

    /// Height and gradient in f64: the oracle of the f32 value, and the ground that gameplay
    /// stands on. `xz` in metres, taken to ±2³¹ m; a NaN is taken as 0.
    #[must_use]
    pub fn sample_f64(&self, xz: DVec2) -> GroundSample {
        let xz = in_range(xz);
        let base = GroundSample {
            height: f64::from(self.base.data.base),
            gradient: DVec2::ZERO,
        };
        self.prepared().fold(base, |below, (source, mask)| {
            let added = match source {
                Prepared::Fractal(fractal) => fractal.sample_f64(xz),
                Prepared::Permutation(permutation) => permutation.sample_f64(xz),
                Prepared::Map(map) => map.sample_f64(xz),
                Prepared::Hill(hill) => hill.sample_f64(xz),
                Prepared::Edits(edits) => edits.sample_f64(xz),
            };
            masked_f64(mask, below, added)
        })
    }
}

/// The terrain that answers at (x, z), metres: the first one whose extent contains the place, and where
/// none does the one whose extent is nearest to it (the first of those that are equally near). `None`
/// where there are no terrains, or the place is not finite.
#[must_use]
pub fn terrain_at<'a>(
    terrains: impl IntoIterator<Item = &'a Terrain>,
    xz: DVec2,
) -> Option<&'a Terrain> {
    if !xz.is_finite() {
        return None;
    }
    let mut nearest: Option<(f64, &Terrain)> = None;
    for terrain in terrains {
        let distance = terrain.extent().distance(xz);
        if distance == 0.0 {
            return Some(terrain);
        }
        if nearest.is_none_or(|(least, _)| distance < least) {
            nearest = Some((distance, terrain));
        }
    }
    nearest.map(|(_, terrain)| terrain)
}

impl Prepared {
    /// One source in f32.
    pub(crate) fn sample(&self, point: GroundPoint) -> Height {
        match self {
            Self::Fractal(fractal) => fractal.sample(point),
            Self::Permutation(permutation) => permutation.sample(point),
            Self::Map(map) => map.sample(point),
            Self::Hill(hill) => hill.sample(point),
            Self::Edits(edits) => edits.sample(point),
        }
    }
}

impl Ground for Terrain {
    fn sample(&self, xz: DVec2) -> GroundSample {
        self.sample_f64(xz)
    }

    fn changed_rects(&self, before: &dyn Ground) -> Option<Vec<GroundRect>> {
        let before = before.as_any()?.downcast_ref::<Self>()?;
        self.changed_since(before)
    }

    fn as_any(&self) -> Option<&dyn core::any::Any> {
        Some(self)
    }
}

/// A mask as it is evaluated in f32: t = (h − low) × scale. A scale of 0 stands for no mask.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MaskStep {
    pub low: f32,
    pub scale: f32,
}

impl MaskStep {
    pub(crate) fn new(mask: Option<Mask>) -> Self {
        mask.map_or(
            Self {
                low: 0.0,
                scale: 0.0,
            },
            |Mask { low, high }| Self {
                low,
                scale: 1.0 / (high - low),
            },
        )
    }

    /// Whether what is added at this height counts nothing: t ≤ 0.
    #[inline]
    pub(crate) fn hides(self, below: f32) -> bool {
        self.scale != 0.0 && (below - self.low) * self.scale <= 0.0
    }

    /// height += s(t)·added; gradient by the product and chain rules.
    #[inline(always)]
    pub(crate) fn apply(self, below: Height, added: Height) -> Height {
        if self.scale == 0.0 {
            return Height {
                value: below.value + added.value,
                gradient: below.gradient + added.gradient,
            };
        }
        let t = ((below.value - self.low) * self.scale).clamp(0.0, 1.0);
        let step = t * t * (3.0 - 2.0 * t);
        let slope = 6.0 * t * (1.0 - t) * self.scale;
        Height {
            value: below.value + step * added.value,
            gradient: below.gradient * (1.0 + slope * added.value) + added.gradient * step,
        }
    }
}

/// The same in f64.
fn masked_f64(mask: Option<Mask>, below: GroundSample, added: GroundSample) -> GroundSample {
    let Some(Mask { low, high }) = mask else {
        return GroundSample {
            height: below.height + added.height,
            gradient: below.gradient + added.gradient,
        };
    };
    let scale = 1.0 / (f64::from(high) - f64::from(low));
    let t = ((below.height - f64::from(low)) * scale).clamp(0.0, 1.0);
    let step = t * t * (3.0 - 2.0 * t);
    let slope = 6.0 * t * (1.0 - t) * scale;
    GroundSample {
        height: below.height + step * added.height,
        gradient: below.gradient * (1.0 + slope * added.height) + added.gradient * step,
    }
}
