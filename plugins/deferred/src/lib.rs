//! Deferred lighting for Bevy, in place of its own: a component on a camera, and light that scales.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use dolomite_deferred::{DeferredLighting, DeferredPlugin};
//!
//! fn setup(mut commands: Commands) {
//!     commands.spawn((Camera3d::default(), DeferredLighting::default()));
//! }
//!
//! # let mut app = App::new();
//! app.add_plugins(DeferredPlugin)
//!     .insert_resource(bevy::pbr::DefaultOpaqueRendererMethod::deferred())
//!     .add_systems(Startup, setup);
//! ```
//!
//! Everything that writes Bevy's G-buffer is lit: `StandardMaterial`, skinned and morphed meshes, what other
//! plugins draw. A camera without [`DeferredLighting`] is Bevy's own, and costs nothing here.
//!
//! | part | what it does |
//! |---|---|
//! | [`DeferredLighting`], [`Way`] | which camera is lit, and how |
//! | [`StillShadows`] | shadow maps that are drawn where something moved |
//! | [`LightingDifference`] | how far a camera's picture is from that of the reference |
//! | [`gbuffer`] | the words of a pixel, as in `shaders/src/deferred/gbuffer.wgsl` |
//! | [`light`] | point and spot lights as the GPU reads them; which are refused, and why |
//! | [`cull`] | which of them a view can see |
//! | [`model`] | shading models beside Bevy's standard material |
//! | [`pyramid`] | what lies behind what is drawn |
//! | [`occlusion`] | ambient occlusion in screen space |
//! | [`choice`] | the way that `Auto` takes |
//! | `render` | the passes (feature `render`) |
//!
//! Lengths are metres, intensities candela, colours linear sRGB; +Y is up, −Z forward, depth is reversed.

pub mod choice;
mod components;
pub mod cull;
pub mod gbuffer;
pub mod light;
pub mod model;
pub mod occlusion;
pub mod pyramid;
#[cfg(feature = "render")]
pub mod render;

pub use components::{DeferredLighting, LightingDifference, StillShadows, Way};
pub use model::{ModelError, ShadingModels};
pub use occlusion::{AmbientOcclusion, OcclusionQuality, OcclusionResolution};
#[cfg(feature = "render")]
pub use render::{BlinnPhongMaterial, BlinnPhongPlugin, DeferredPlugin, DeferredStats, StillStats};
