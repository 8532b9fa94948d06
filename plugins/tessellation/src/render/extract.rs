//! What comes from the main world: entities of each kind, cameras, the sun.

use std::any::TypeId;
use std::collections::HashMap;
use std::sync::Arc;

use bevy::prelude::*;
use bevy::render::Extract;
use bevy::render::sync_world::RenderEntity;
use bevy::shader::Shader;

use super::kind::PatchKind;
use super::prepare::StageKinds;
use crate::tables::Instance;
use crate::{PatchMesh, Patches, StageCamera};

/// A camera that tessellates, in the render world.
#[derive(Component, Clone)]
pub struct ExtractedStageCamera {
    pub settings: StageCamera,
    /// What entities that one camera alone sees name it by; see [`camera_number`].
    pub number: f32,
}

/// A number above 0 for a camera, exact as f32: entity indices stay below 2²⁴.
fn camera_number(camera: Entity) -> f32 {
    (camera.index_u32() + 1) as f32
}

/// What all kinds share.
#[derive(Resource, Default)]
pub struct StageScene {
    /// Seconds, wrapped at an hour, of this frame and the last.
    pub time: [f32; 2],
    /// Direction that the sunlight travels, where it casts shadows.
    pub sun: Option<Vec3>,
}

pub fn scene(
    mut scene: ResMut<StageScene>,
    time: Extract<Option<Res<Time>>>,
    lights: Extract<Query<(&DirectionalLight, &GlobalTransform)>>,
) {
    let now = time
        .as_ref()
        .map_or(0.0, |time| time.elapsed_secs_wrapped());
    scene.time = [now, scene.time[0]];
    scene.sun = lights
        .iter()
        .filter(|(light, _)| light.shadow_maps_enabled)
        .map(|(_, transform)| *transform.forward())
        .next();
}

pub fn cameras(
    mut commands: Commands,
    cameras: Extract<Query<(Entity, RenderEntity, &StageCamera)>>,
    mut removed: Extract<RemovedComponents<StageCamera>>,
    entities: Extract<Query<RenderEntity>>,
) {
    for entity in removed
        .read()
        .filter_map(|entity| entities.get(entity).ok())
    {
        if let Ok(mut entity) = commands.get_entity(entity) {
            entity.remove::<ExtractedStageCamera>();
        }
    }
    for (camera, entity, settings) in &cameras {
        commands.entity(entity).insert(ExtractedStageCamera {
            settings: settings.clone(),
            number: camera_number(camera),
        });
    }
}

type AnyChange<K> = Or<(
    Changed<Patches<K>>,
    Changed<GlobalTransform>,
    Changed<InheritedVisibility>,
)>;

/// The entities of a kind, when any of them changed.
pub fn kind<K: PatchKind>(
    mut kinds: ResMut<StageKinds>,
    settings: Extract<Option<Res<K>>>,
    entities: Extract<Query<(Entity, &Patches<K>, &GlobalTransform, &InheritedVisibility)>>,
    changed: Extract<Query<(), (With<Patches<K>>, AnyChange<K>)>>,
    mut removed: Extract<RemovedComponents<Patches<K>>>,
    mut files: Extract<MessageReader<AssetEvent<Shader>>>,
    mut moved: Local<bool>,
    mut before: Local<HashMap<Entity, [[f32; 4]; 3]>>,
) {
    let Some(kind) = kinds.0.get_mut(&TypeId::of::<K>()) else {
        return;
    };
    if let Some(settings) = settings.as_ref()
        && (settings.is_changed() || kind.version == 0)
    {
        kind.pool = settings.pool();
        kind.still = settings.still();
        kind.given = settings.given();
        let stored = !K::MOVES && !super::evaluated::<K>() && K::AMPLIFIED == 0;
        kind.host = settings.host().filter(|_| stored);
        kind.materials = settings.materials();
        kind.materials_changed = true;
        kind.version += 1;
    }
    // The user's functions were changed: what they made is out of date.
    let file = kind.shaders.user.as_ref().map(Handle::id);
    let changed_file = |event: &AssetEvent<Shader>| file.is_some_and(|id| event.is_modified(id));
    if files.read().any(changed_file) {
        kind.version += 1;
    }
    // After a move everything is read once more, so that the last frame's place is this one's.
    let any = !changed.is_empty() || removed.read().count() > 0;
    if !(any || *moved) {
        return;
    }
    *moved = false;
    let mut now = HashMap::with_capacity(before.len());
    kind.instances.clear();
    let mut skipped = 0;
    for (entity, patches, transform, visibility) in &entities {
        if !visibility.get() || patches.mesh.patches() == 0 {
            continue;
        }
        if patches.mesh.layout() != K::LAYOUT {
            skipped += 1;
            continue;
        }
        let rows = rows(transform);
        let previous = before.get(&entity).copied().unwrap_or(rows);
        // Others do not read where they were.
        *moved |= (K::MOVES || super::evaluated::<K>()) && previous != rows;
        now.insert(entity, rows);
        kind.instances.push((
            patches.mesh.clone(),
            Instance {
                rows,
                previous,
                params: patches.params.map(|param| param.to_array()),
                camera: [patches.camera.map_or(0.0, camera_number), 0.0, 0.0, 0.0],
            },
        ));
    }
    *before = now;
    if kind.other_layout != skipped {
        kind.other_layout = skipped;
        if skipped > 0 {
            error!(
                "{}: {skipped} entities have patches of another layout than the kind's; they are not drawn",
                kind.name
            );
        }
    }
    kind.version += 1;
    kind.instances_changed = true;
}

/// The matrix to the world, row by row.
fn rows(transform: &GlobalTransform) -> [[f32; 4]; 3] {
    let columns = transform.affine();
    let m = columns.matrix3;
    let t = columns.translation;
    [
        [m.x_axis.x, m.y_axis.x, m.z_axis.x, t.x],
        [m.x_axis.y, m.y_axis.y, m.z_axis.y, t.y],
        [m.x_axis.z, m.y_axis.z, m.z_axis.z, t.z],
    ]
}

/// Meshes are told apart by their place in memory.
pub fn same_meshes(a: &[Arc<PatchMesh>], b: &[(Arc<PatchMesh>, Instance)]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, (b, _))| Arc::ptr_eq(a, b))
}
