//! The ground of a [`Terrain`](dolomite_terrain::Terrain), drawn for Bevy.
//!
//! ```no_run
//! use bevy::{math::DVec2, prelude::*};
//! use dolomite_ground::{GroundPlugin, TerrainMaterial, TerrainView};
//! use dolomite_terrain::{Fractal, GroundRect, Layer, Source, Terrain, TerrainData};
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
//! app.add_plugins(GroundPlugin).add_systems(Startup, setup);
//! ```
//!
//! | part | what it does |
//! |---|---|
//! | [`cover`] | the ground as patches of the tessellation stage: a balanced quadtree around the focus |
//! | [`detail`] | the ground with its error bounded in pixels, chosen on the GPU |
//! | `render` | both on the GPU, textures and look (feature `render`) |

pub mod cover;
pub mod detail;
#[cfg(feature = "render")]
pub mod render;

#[cfg(feature = "render")]
pub use cover::TerrainMaterial;
pub use cover::{
    GroundPlugin, MaterialBands, PatchBounds, TerrainCover, TerrainCoverSystems, TerrainView,
};
