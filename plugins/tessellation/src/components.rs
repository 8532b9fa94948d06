//! What is spawned: patches, and the camera setting that tessellates them.

use std::marker::PhantomData;
use std::sync::Arc;

use bevy::math::DVec3;
use bevy::prelude::*;

use super::PatchMesh;

/// Patches of kind `K`, placed by the entity's transform. Entities may share one mesh.
#[derive(Component)]
#[require(Transform)]
#[cfg_attr(feature = "render", require(Visibility))]
pub struct Patches<K: Send + Sync + 'static> {
    /// The patches; an empty mesh draws nothing.
    pub mesh: Arc<PatchMesh>,
    /// Numbers of this entity that the kind's functions read by `entity_params`.
    pub params: [Vec4; 4],
    /// The only camera that sees them; `None`: all do.
    pub camera: Option<Entity>,
    kind: PhantomData<fn() -> K>,
}

impl<K: Send + Sync + 'static> Patches<K> {
    /// The patches of `mesh`, all parameters 0.
    #[must_use]
    pub const fn new(mesh: Arc<PatchMesh>) -> Self {
        Self {
            mesh,
            params: [Vec4::ZERO; 4],
            camera: None,
            kind: PhantomData,
        }
    }

    /// The same with parameter `k` of 0 to 3 set; others are passed over.
    #[must_use]
    pub fn with(mut self, k: usize, value: Vec4) -> Self {
        if let Some(param) = self.params.get_mut(k) {
            *param = value;
        }
        self
    }
}

impl<K: Send + Sync + 'static> Clone for Patches<K> {
    fn clone(&self) -> Self {
        Self {
            mesh: self.mesh.clone(),
            params: self.params,
            camera: self.camera,
            kind: PhantomData,
        }
    }
}

/// Makes a camera tessellate and draw the patches in the world.
///
/// The camera also needs Bevy's deferred G-buffer: `DepthPrepass`, `DeferredPrepass` and `Msaa::Off`
/// (with the `render` feature they are required automatically, except `Msaa`).
#[derive(Component, Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "render",
    require(
        bevy::core_pipeline::prepass::DepthPrepass,
        bevy::core_pipeline::prepass::DeferredPrepass
    )
)]
pub struct StageCamera {
    /// Length of an edge that control functions aim at, pixels; 1 to 1000.
    pub pixels_per_edge: f32,
    /// The point that detail follows, world space; the camera's own place without.
    pub focus: Option<DVec3>,
    /// How far outside the frustum patches may stand and still cast their shadow into it, metres;
    /// 0 and above.
    pub shadow_reach: f32,
    /// Draw filled triangles. Default true.
    pub fill: bool,
    /// Draw the edges of triangles as lines, over the fill or alone. Default false.
    pub lines: bool,
}

impl Default for StageCamera {
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
