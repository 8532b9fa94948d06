//! What comes from the main world: entities of each kind.

use std::any::TypeId;
use std::collections::HashMap;

use bevy::camera::visibility::RenderLayers;
use bevy::prelude::*;
use bevy::render::Extract;
use bevy::shader::Shader;
use dolomite_geometry::render::{Producers, camera_number};

use super::kind::PatchKind;
use super::layers::{LAYERS, layer_bits};
use super::prepare::{StageKinds, has_entities};
use super::variants::evaluated;
use crate::Patches;
use crate::tables::Instance;

type AnyChange<K> = Or<(
    Changed<Patches<K>>,
    Changed<GlobalTransform>,
    Changed<InheritedVisibility>,
    Changed<RenderLayers>,
)>;

type Placed<'a, K> = (
    Entity,
    &'a Patches<K>,
    &'a GlobalTransform,
    &'a InheritedVisibility,
    Option<&'a RenderLayers>,
);

/// Whether a kind has entities, or had some until now, which have to be let go of.
pub fn is_in_use<K: PatchKind>(
    kinds: Res<StageKinds>,
    patches: Extract<Query<(), With<Patches<K>>>>,
) -> bool {
    has_entities::<K>(kinds) || !patches.is_empty()
}

/// The entities of a kind, when any of them changed.
pub fn kind<K: PatchKind>(
    mut kinds: ResMut<StageKinds>,
    mut producers: ResMut<Producers>,
    settings: Extract<Option<Res<K>>>,
    entities: Extract<Query<Placed<K>>>,
    changed: Extract<Query<(), (With<Patches<K>>, AnyChange<K>)>>,
    mut removed: Extract<RemovedComponents<Patches<K>>>,
    mut unlayered: Extract<RemovedComponents<RenderLayers>>,
    mut files: Extract<MessageReader<AssetEvent<Shader>>>,
    mut moved: Local<bool>,
    mut before: Local<HashMap<Entity, [[f32; 4]; 3]>>,
    mut told: Local<bool>,
) {
    let Some(kind) = kinds.0.get_mut(&TypeId::of::<K>()) else {
        return;
    };
    let Some(producer) = producers.get_mut(kind.key) else {
        return;
    };
    if let Some(settings) = settings.as_ref()
        && (settings.is_changed() || kind.version == 0)
    {
        kind.pool = settings.pool();
        producer.still = settings.still();
        let stored = !K::MOVES && !evaluated::<K>() && K::AMPLIFIED == 0;
        kind.host = settings.host().filter(|_| stored);
        producer.materials = settings.materials();
        producer.materials_changed = true;
        kind.version += 1;
    }
    // The user's functions were changed: what they made is out of date.
    let file = kind.shaders.user.as_ref().map(Handle::id);
    let changed_file = |event: &AssetEvent<Shader>| file.is_some_and(|id| event.is_modified(id));
    if files.read().any(changed_file) {
        kind.version += 1;
    }
    // After a move everything is read once more, so that the last frame's place is this one's.
    let gone = removed.read().count() + unlayered.read().count();
    let any = !changed.is_empty() || gone > 0;
    if !(any || *moved) {
        return;
    }
    *moved = false;
    let mut now = HashMap::with_capacity(before.len());
    kind.instances.clear();
    kind.seen_by.clear();
    let mut skipped = 0;
    for (entity, patches, transform, visibility, layers) in &entities {
        if !visibility.get() || patches.mesh.patches() == 0 {
            continue;
        }
        if patches.mesh.layout() != K::LAYOUT {
            skipped += 1;
            continue;
        }
        let (bits, more) = layers.map_or((1, false), layer_bits);
        if more && !std::mem::replace(&mut *told, true) {
            warn!(
                "{}: patches are drawn in render layers 0 to {}; those beyond are passed over",
                kind.name,
                LAYERS - 1
            );
        }
        if bits == 0 {
            continue;
        }
        let rows = rows(transform);
        let previous = before.get(&entity).copied().unwrap_or(rows);
        // Others do not read where they were.
        *moved |= (K::MOVES || evaluated::<K>()) && previous != rows;
        now.insert(entity, rows);
        let only = patches.camera.map_or(0.0, camera_number);
        kind.seen_by.add(only, bits);
        let instance = Instance {
            rows,
            previous,
            params: patches.params.map(|param| param.to_array()),
            camera: [only, 0.0, 0.0, 0.0],
        };
        kind.instances
            .push((patches.mesh.clone(), instance.in_layers(bits)));
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
