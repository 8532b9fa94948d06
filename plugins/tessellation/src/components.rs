//! What is spawned: patches.

use std::marker::PhantomData;
use std::sync::Arc;

use bevy::prelude::*;

use super::PatchMesh;

/// Patches of kind `K`, placed by the entity's transform. Entities may share one mesh.
///
/// Not reflected: a mesh is made by code, and shared.
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
