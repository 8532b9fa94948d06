//! Tessellation on the GPU, for Bevy.
//!
//! The **stage** ([`stage`], `render::stage`) is what WebGPU lacks: patches of triangles, quads or
//! isolines, refined by control and evaluate functions in WGSL as OpenGL and Vulkan have them. What
//! comes out is drawn into Bevy's G-buffer, so that Bevy lights it, shadows it and composites
//! everything else with it.
//!
//! The **terrain** ([`ground`], `render::ground`) is one of its kinds of patches, ready to use.
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
//! | [`ground`] | the terrain as patches of the stage: a balanced quadtree around the focus |
//! | [`classic`] | a scene to compare methods on |
//! | `render::stage` | the stage on the GPU, programmed by control and evaluate functions in WGSL (feature `render`) |
//! | `render::ground` | the terrain's functions, textures and look (feature `render`) |
//! | `render::classic` | the classic scene's kind of patches (feature `render`) |
//!
//! Cost: per camera and kind one vertex and one index pool (`PatchKind::pool`,
//! [`TerrainView`]); seven dispatches in a frame whose view or patches
//! changed, none else.

pub mod classic;
pub mod detail;
pub mod ground;
#[cfg(feature = "render")]
pub mod render;
pub mod stage;

#[cfg(feature = "render")]
pub use ground::TerrainMaterial;
pub use ground::{
    MaterialBands, PatchBounds, TerrainCover, TerrainCoverSystems, TerrainTessellationPlugin,
    TerrainView,
};
