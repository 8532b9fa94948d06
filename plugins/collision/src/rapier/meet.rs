//! Bodies of Rapier's as movers see them.

use super::counters::BridgeCounters;
use crate::mesh::{MeshError, TriangleMesh};
use crate::plugin::{Collider, MeetsMovers};
use crate::tree::{TreeKind, TreeSettings, TriangleTree};
use bevy::ecs::prelude::*;
use bevy::math::{DVec3, Vec3};
use bevy_rapier3d::geometry::Collider as RapierCollider;
use bevy_rapier3d::parry::shape::{Shape, TypedShape};
use std::sync::Arc;

/// On a body whose [`Collider`] is of this module's making.
#[derive(Component)]
pub(super) struct Met;

/// Divisions of a full turn of round shapes: corners lie on them, faces up to 1 − cos(π / 24) = 0.9 % of a radius
/// below.
const DIVISIONS: u32 = 24;

/// Triangles above which a tree is walked sooner than a list.
const FEW: usize = 24;

/// Gives bodies that are new, or have another shape, the triangles that movers meet.
pub(super) fn shape(
    bodies: Query<
        (Entity, &RapierCollider),
        (
            With<MeetsMovers>,
            Or<(Changed<RapierCollider>, Added<MeetsMovers>)>,
        ),
    >,
    mut commands: Commands,
    mut counters: ResMut<BridgeCounters>,
) {
    for (entity, collider) in &bodies {
        match triangles(&*collider.raw.0) {
            Ok(mesh) => {
                let kind = match mesh.triangles().len() {
                    0..=FEW => TreeKind::List,
                    _ => TreeKind::default(),
                };
                let settings = TreeSettings {
                    kind,
                    ..TreeSettings::default()
                };
                let tree = Arc::new(TriangleTree::new(mesh, settings));
                commands.entity(entity).insert((Collider(tree), Met));
            }
            // No triangles, or none that a mesh may have.
            Err(_) => {
                counters.refused += 1;
                commands.entity(entity).remove::<(Collider, Met)>();
            }
        }
    }
}

/// Takes the triangles from bodies that movers meet no more.
pub(super) fn forget(
    gone: Query<
        Entity,
        (
            With<Met>,
            Or<(Without<MeetsMovers>, Without<RapierCollider>)>,
        ),
    >,
    mut commands: Commands,
) {
    for entity in &gone {
        commands.entity(entity).remove::<(Collider, Met)>();
    }
}

/// The surface of a shape.
fn triangles(shape: &dyn Shape) -> Result<TriangleMesh, MeshError> {
    let (vertices, triangles) = match shape.as_typed_shape() {
        TypedShape::Ball(ball) => ball.to_trimesh(DIVISIONS, DIVISIONS / 2),
        TypedShape::Cuboid(cuboid) => {
            return TriangleMesh::cuboid(DVec3::ZERO, cuboid.half_extents);
        }
        TypedShape::Capsule(capsule) => capsule.to_trimesh(DIVISIONS, DIVISIONS / 2),
        TypedShape::Cylinder(cylinder) => cylinder.to_trimesh(DIVISIONS),
        TypedShape::Cone(cone) => cone.to_trimesh(DIVISIONS),
        TypedShape::ConvexPolyhedron(hull) => hull.to_trimesh(),
        TypedShape::TriMesh(mesh) => (mesh.vertices().to_vec(), mesh.indices().to_vec()),
        _ => {
            let bounds = shape.compute_local_aabb();
            let (center, half): (Vec3, Vec3) = (bounds.center(), bounds.half_extents());
            return TriangleMesh::cuboid(center.as_dvec3(), half);
        }
    };
    TriangleMesh::new(DVec3::ZERO, vertices, triangles)
}
