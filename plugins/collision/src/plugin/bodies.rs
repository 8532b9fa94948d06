//! What movers meet: meshes and boxes of entities.

use crate::mesh::TriangleMesh;
use crate::motion::Pose;
use crate::tree::{TreeKind, TreeSettings, TriangleTree};
use bevy::ecs::prelude::*;
use bevy::math::{DVec3, Vec3};
use bevy::reflect::prelude::*;
use bevy::transform::components::Transform;
use std::sync::Arc;

/// Triangles that movers meet, shared by all that have the same.
#[derive(Component, Clone, Debug)]
#[require(Transform)]
pub struct Collider(pub Arc<TriangleTree>);

/// A box around an entity that whoever walks into it slides along. It stands upright: a turn of the entity is not
/// used. A half size above 10¹² m, not finite, or 0 or less along an axis, blocks nothing.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq)]
#[require(Transform)]
pub struct Blocker {
    /// Half of its size, metres.
    pub half_size: Vec3,
}

impl Default for Blocker {
    /// A cube of 1 m.
    fn default() -> Self {
        Self {
            half_size: Vec3::splat(0.5),
        }
    }
}

/// Movers meet what this is on, stand on it and are pushed by it: with the feature `terrain`, ground as
/// `GroundTiles`; with `rapier`, a body of Rapier's by its own shape. Round shapes are met as polyhedra whose corners lie on them; shapes of
/// several parts as their box. Removed again, or without the body's collider, nothing is met any more.
#[derive(Component, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Component, Default, Clone)]
pub struct MeetsMovers;

/// The triangles of a blocker.
#[derive(Component)]
pub(crate) struct BlockerTree(Arc<TriangleTree>);

/// One body of this step.
pub(crate) struct Placed {
    pub entity: Entity,
    pub tree: Arc<TriangleTree>,
    pub before: Pose,
    pub after: Pose,
}

/// All bodies, by entity.
#[derive(Resource, Default)]
pub(crate) struct Bodies {
    pub placed: Vec<Placed>,
    /// The last step's.
    last: Vec<Placed>,
}

impl Bodies {
    /// The number of an entity's body.
    pub fn find(&self, entity: Entity) -> Option<u32> {
        find(&self.placed, entity).map(|index| index as u32)
    }
}

/// Whether there is anything to forget.
pub(super) fn remembered(bodies: Res<Bodies>) -> bool {
    !bodies.placed.is_empty()
}

fn find(placed: &[Placed], entity: Entity) -> Option<usize> {
    placed
        .binary_search_by_key(&entity, |body| body.entity)
        .ok()
}

/// Triangles of blockers that are new or changed.
pub(super) fn build_blockers(
    blockers: Query<(Entity, &Blocker), Changed<Blocker>>,
    mut commands: Commands,
) {
    for (entity, blocker) in &blockers {
        let half = blocker.half_size;
        let whole = half.is_finite() && half.min_element() > 0.0;
        let mesh = whole.then(|| TriangleMesh::cuboid(DVec3::ZERO, half));
        // Twelve triangles are tested sooner than a tree is walked.
        let settings = TreeSettings {
            kind: TreeKind::List,
            ..TreeSettings::default()
        };
        match mesh {
            Some(Ok(mesh)) => {
                let tree = Arc::new(TriangleTree::new(mesh, settings));
                commands.entity(entity).insert(BlockerTree(tree));
            }
            _ => {
                commands.entity(entity).remove::<BlockerTree>();
            }
        }
    }
}

fn pose(transform: &Transform, turned: bool) -> Pose {
    Pose {
        translation: transform.translation.as_dvec3(),
        rotation: if turned {
            transform.rotation.as_dquat().normalize()
        } else {
            bevy::math::DQuat::IDENTITY
        },
    }
}

/// Where bodies were and are.
pub(crate) fn gather(
    mut bodies: ResMut<Bodies>,
    colliders: Query<(Entity, &Collider, &Transform)>,
    blockers: Query<(Entity, &BlockerTree, &Transform), (With<Blocker>, Without<Collider>)>,
) {
    let Bodies { placed, last } = &mut *bodies;
    std::mem::swap(placed, last);
    placed.clear();
    let mut add = |entity, tree: &Arc<TriangleTree>, after: Pose| {
        let known = find(last, entity).map(|index| last[index].after);
        placed.push(Placed {
            entity,
            tree: Arc::clone(tree),
            before: known.unwrap_or(after),
            after,
        });
    };
    for (entity, collider, transform) in &colliders {
        add(entity, &collider.0, pose(transform, true));
    }
    for (entity, tree, transform) in &blockers {
        add(entity, &tree.0, pose(transform, false));
    }
    // Ground has several bodies of one entity, which keep their order.
    placed.sort_by_key(|body| body.entity);
}
