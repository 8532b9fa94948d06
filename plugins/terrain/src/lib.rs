//! Heights of the ground: noise, height maps and hills, with exact gradients.
//!
//! The simulation half of Dolomite's terrain: no window, no GPU. A [`Terrain`] is one function of
//! the ground plane, given three times over: in f64 ([`Ground`], what gameplay stands on), in f32
//! for one point, tiles and lists ([`Terrain::sample`], [`Terrain::fill_tile`]), and in WGSL
//! (`dolomite_shaders`, folder `terrain`), for which [`Terrain::gpu`] lays out the data.
//!
//! ```
//! use bevy::math::DVec2;
//! use dolomite_terrain::{Fractal, Ground, GroundRect, Layer, Source, Terrain, TerrainData};
//!
//! let terrain = Terrain::new(TerrainData {
//!     extent: GroundRect::square(DVec2::ZERO, 4000.0),
//!     layers: vec![Layer { source: Source::Fractal(Fractal::default()), mask: None }],
//!     base: 0.0,
//!     sea_level: None,
//! })?;
//! let ground = terrain.height(DVec2::new(12.0, -7.5));
//! assert!(ground.abs() < 200.0);
//! # Ok::<(), dolomite_terrain::TerrainError>(())
//! ```

pub mod batch;
pub mod bounds;
pub mod editing;
pub mod edits;
mod gpu_layout;
mod ground;
mod height_map;
mod hill;
mod interval;
pub mod noise;
mod plugin;
mod probe;
mod streaming;
mod terrain;

/// Files of elevation, read without a renderer.
pub use dolomite_elevation as elevation;

pub use batch::{BatchError, HeightTile, Planes};
pub use bounds::HeightBounds;
pub use editing::{Edit, EditError, EditFileError, EditKind, TerrainEdits};
pub use edits::{EditLattice, EditRoom, EditTable, EditWrite, Edits};
pub use gpu_layout::{GpuLayer, GpuTerrain, GpuTerrainUniform, LayerKind};
pub use ground::{Ground, GroundPoint, GroundRect, GroundSample, Height};
pub use height_map::{
    Filter, HeightMap, HeightMapError, HeightMapFile, Holes, LEVEL_WORDS, MOST_LEVELS, MapFormat,
    MapNews, MapWrite, RawFormat, Readable, Stream, TileRequest, metres_per_degree,
};
pub use hill::Hill;
pub use noise::{Fractal, NoiseError, PermutationNoise, Sum, Warp};
pub use plugin::TerrainPlugin;
pub use probe::{
    AnswerSource, DrawnAnswer, GroundAnswer, GroundProbe, GroundProbeSystems, ProbeAnswer,
    ProbeBatch, ProbeError, ProbePart, ProbeQuestion,
};
pub use streaming::{MapFaults, MapFocus, MapStreaming, MapStreamingStats};
pub use terrain::{Layer, Mask, Source, Terrain, TerrainData, TerrainError, terrain_at};
