//! Entities of a glTF scene follow the joints: Bevy's skinned meshes hang on them.

use super::{Character, CharacterPose};
use bevy::ecs::prelude::*;
use bevy::reflect::prelude::*;
use bevy::transform::components::Transform;

/// The entities below a figure whose transforms follow its joints; found by their names as soon as the
/// scene is there.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, PartialEq)]
pub struct CharacterJoints {
    /// One for each joint; `None` where the scene has no entity of that name.
    pub entities: Vec<Option<Entity>>,
}

/// Looks for a scene under figures that have none yet.
pub(super) fn bind(
    mut commands: Commands,
    figures: Query<(Entity, &Character), (Without<CharacterJoints>, With<Children>)>,
    children: Query<&Children>,
    names: Query<&Name>,
) {
    for (entity, character) in &figures {
        let skeleton = &character.figure.rig.skeleton;
        let mut entities = vec![None; skeleton.len()];
        for below in children.iter_descendants(entity) {
            let joint = names.get(below).ok().and_then(|name| skeleton.find(name));
            if let Some(joint) = joint {
                // The first of a name, as in the skeleton.
                entities[joint].get_or_insert(below);
            }
        }
        if entities.iter().any(Option::is_some) {
            commands.entity(entity).insert(CharacterJoints { entities });
        }
    }
}

/// Writes local transforms of figures whose pose changed.
pub(super) fn follow(
    figures: Query<(&CharacterJoints, &CharacterPose), Changed<CharacterPose>>,
    mut transforms: Query<&mut Transform, Without<Character>>,
) {
    for (joints, pose) in &figures {
        let posed = joints.entities.iter().take(pose.local.len()).enumerate();
        for (joint, entity) in posed {
            // A scene that was despawned has no transform any more.
            let Some(mut transform) = entity.and_then(|entity| transforms.get_mut(entity).ok())
            else {
                continue;
            };
            let local = pose.local.get(joint);
            let next = Transform {
                translation: local.translation,
                rotation: local.rotation,
                scale: local.scale,
            };
            transform.set_if_neq(next);
        }
    }
}
