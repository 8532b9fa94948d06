//! Tessellation on the GPU, for Bevy, in two parts that need nothing of each other.
//!
//! The **stage** ([`stage`], `render::stage`) is what WebGPU lacks: patches of triangles, quads or
//! isolines, refined by control and evaluate functions in WGSL as OpenGL and Vulkan have them.
//!
//! The **terrain** is quad patches over the ground, refined by compute passes each time the view
//! changes. Both are drawn into Bevy's G-buffer, so that Bevy lights them, shadows them and composites
//! everything else with them.
//!
//! ```no_run
//! use bevy::{math::DVec2, prelude::*};
//! use dolomite_terrain::{Fractal, GroundRect, Layer, Source, Terrain, TerrainData};
//! use dolomite_tessellation::{TerrainMaterial, TerrainTessellationPlugin, TerrainView};
//!
//! fn setup(mut commands: Commands, assets: Res<AssetServer>) -> Result {
//!     let terrain = Terrain::new(TerrainData {
//!         extent: GroundRect::square(DVec2::ZERO, 4000.0),
//!         layers: vec![Layer { source: Source::Fractal(Fractal::default()), mask: None }],
//!         base: 0.0,
//!         sea_level: Some(0.0),
//!     })?;
//!     let albedo = assets.load("textures/terrain_albedo_height.png");
//!     let normal = assets.load("textures/terrain_normal_roughness.png");
//!     commands.spawn((terrain, TerrainMaterial::new(albedo, normal)));
//!     commands.spawn((Camera3d::default(), Msaa::Off, TerrainView::default()));
//!     Ok(())
//! }
//!
//! # let mut app = App::new();
//! app.add_plugins(TerrainTessellationPlugin).add_systems(Startup, setup);
//! ```
//!
//! | part | what it does |
//! |---|---|
//! | [`stage`] | the tessellation stage for any patches, in Rust; patch meshes, components |
//! | `render::stage` | the same on the GPU, programmed by control and evaluate functions in WGSL (feature `render`) |
//! | [`cover`] | chooses the patches: a balanced quadtree around the focus; corners and edges have one owner |
//! | [`twin`] | the compute passes in Rust, for tests and for machines without a GPU |
//! | [`pattern`] | the triangles of one patch from the levels of its edges |
//! | `render` | the same on the GPU, the G-buffer and shadow draws (feature `render`) |
//!
//! Cost: per camera one vertex and one index pool (16 MiB and 24 MiB by default, set in
//! [`TerrainView`]); three dispatches in a frame whose view or terrain changed, none else.

pub mod cover;
pub mod layout;
pub mod pattern;
mod plugin;
#[cfg(feature = "render")]
pub mod render;
mod settings;
pub mod stage;
mod stats;
pub mod twin;

pub use plugin::{PatchBounds, TerrainCover, TerrainCoverSystems, TerrainTessellationPlugin};
#[cfg(feature = "render")]
pub use settings::TerrainMaterial;
pub use settings::{MaterialBands, TerrainView};
pub use stats::TessellationStats;
