//! The programmable tessellation stage: control and evaluate functions in WGSL, any patches, drawn
//! by [`dolomite_geometry`] into Bevy's G-buffer and shadow maps.
//!
//! A frame, in order: `extract` copies what changed; `prepare` uploads it and decides which kinds of
//! which views have to be tessellated anew; `pass` records, in `Core3d` before Bevy's own prepass,
//! control → measure → plan → place → emit (only after a change). What comes out is drawn by
//! [`dolomite_geometry::render`], and counted there.
//!
//! Each view tessellates for itself: levels depend on it. Shadow views draw what their camera
//! tessellated. Nothing exists on the GPU until a [`GeometryCamera`](dolomite_geometry::GeometryCamera) and
//! [`Patches`](crate::Patches) of a kind are in the world.

mod extract;
mod host;
mod kind;
mod layers;
mod pass;
mod pipeline;
mod plugin;
mod prepare;
mod ranges;
#[doc(hidden)]
pub mod record;
mod variants;
mod view;

pub use dolomite_geometry::render::{
    GeometryCensus, GeometryFault, GeometryMaterial, GeometryStats, Viewpoint, census,
};
pub use kind::{PatchKind, PatchPool, PatchShader};
pub use plugin::PatchPlugin;
#[doc(hidden)]
pub use variants::{KindVariants, StageVariant, stage_variants};
