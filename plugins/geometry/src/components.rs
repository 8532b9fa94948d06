//! The camera setting.

use bevy::math::DVec3;
use bevy::prelude::*;

/// Makes a camera see what producers make: patches, the ground.
///
/// The camera also needs Bevy's deferred G-buffer: `DepthPrepass`, `DeferredPrepass` and `Msaa::Off`
/// (with the `render` feature they are required automatically, except `Msaa`). With the prepasses removed
/// from the entity, triangles are drawn straight into its picture, without light.
///
/// Costs nothing by itself; what a producer keeps for a view stands in its own settings, and in
/// `GeometryStats`.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "render",
    require(
        bevy::core_pipeline::prepass::DepthPrepass,
        bevy::core_pipeline::prepass::DeferredPrepass
    )
)]
pub struct GeometryCamera {
    /// Length of an edge that control functions aim at, pixels; 1 to 1000. Half of it costs four times the
    /// triangles. Default 8.
    pub pixels_per_edge: f32,
    /// The point that detail follows, world space; the camera's own place without.
    pub focus: Option<DVec3>,
    /// How far outside the frustum patches may stand and still cast their shadow into it, metres;
    /// 0 and above. Default 50.
    pub shadow_reach: f32,
    /// Draw filled triangles. Default true.
    pub fill: bool,
    /// Draw the edges of triangles as lines, over the fill or alone: vertices are then fetched by the
    /// shader, three a triangle, which costs about twice the vertex work. Default false.
    pub lines: bool,
}

impl Default for GeometryCamera {
    fn default() -> Self {
        Self {
            pixels_per_edge: 8.0,
            focus: None,
            shadow_reach: 50.0,
            fill: true,
            lines: false,
        }
    }
}
