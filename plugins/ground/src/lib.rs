//! The ground of a [`Terrain`](dolomite_terrain::Terrain), drawn for Bevy.
//!
//! ```no_run
//! use bevy::{math::DVec2, prelude::*};
//! use dolomite_ground::{GroundMaterial, GroundPlugin, Sea, TerrainView};
//! use dolomite_terrain::{Fractal, GroundRect, Layer, Source, Terrain, TerrainData};
//!
//! fn setup(mut commands: Commands) -> Result {
//!     let terrain = Terrain::new(TerrainData {
//!         extent: GroundRect::square(DVec2::ZERO, 4000.0),
//!         layers: vec![Layer { source: Source::Fractal(Fractal::default()), mask: None }],
//!         base: 0.0,
//!         sea_level: Some(0.0),
//!     })?;
//!     commands.spawn((terrain, GroundMaterial::default(), Sea::default()));
//!     commands.spawn((Camera3d::default(), Msaa::Off, TerrainView));
//!     Ok(())
//! }
//!
//! # let mut app = App::new();
//! app.add_plugins(GroundPlugin::default()).add_systems(Startup, setup);
//! ```
//!
//! | part | what it does |
//! |---|---|
//! | [`blocks`] | level of detail in blocks, chosen by numbers that are kept with them |
//! | [`cover`] | the ground as patches of the tessellation stage: a balanced quadtree around the focus |
//! | [`detail`] | the ground with its error bounded in pixels, chosen on the GPU |
//! | [`inspection`] | level, error and overdraw of the drawn ground in each pixel |
//! | [`material`] | what the ground is made of, and how the sea looks: data |
//! | `render` | both on the GPU, textures and look (feature `render`) |

/// A warning; where nothing draws there is no log, and what is left out is left out of pictures alone.
macro_rules! tell {
    ($($text:tt)*) => {{
        #[cfg(feature = "render")]
        bevy::log::warn!($($text)*);
        #[cfg(not(feature = "render"))]
        let _ = format_args!($($text)*);
    }};
}

pub mod blocks;
pub mod cover;
pub mod detail;
mod idle_budget;
pub mod inspection;
pub mod material;
mod plugin;
mod range;
#[cfg(feature = "render")]
pub mod render;
mod sets;
mod shown;
mod streaming;

pub use cover::{PatchDetail, TerrainCover, TerrainCoverSystems, TerrainView};
pub use inspection::GroundInspection;
pub use material::{
    Band, Canopy, CanopyLayer, GroundCanopy, GroundLayer, GroundMaterial, GroundShading,
    MaterialBands, Measure, Sea, Surface,
};
pub use plugin::GroundPlugin;
#[cfg(feature = "render")]
pub use render::GroundTextures;
pub use sets::GroundSystems;
pub use shown::MOST_TERRAINS;
