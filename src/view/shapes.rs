//! What collision knows, drawn as lines over the picture: shapes in white, contacts and their normals in red, tiles of
//! the ground in green, each cell as it is cut.

use bevy::prelude::*;
use bevy_rapier3d::parry::shape::TypedShape;
use bevy_rapier3d::prelude::Collider as RapierCollider;
use dolomite::collision::{Blocker, CharacterBody, Collider, MoveState};

use super::lines::{Drawn, Lines};
use crate::play::Switches;
use crate::play::things::Solid;

/// How long a normal is drawn, metres.
const NORMAL: f32 = 0.4;

/// Lines lie this far above the ground that they are drawn for, metres.
const ABOVE: f32 = 0.01;

const SHAPE: Vec4 = Vec4::new(1.0, 1.0, 1.0, 1.0);
const CONTACT: Vec4 = Vec4::new(1.0, 0.05, 0.02, 1.0);
const TILE: Vec4 = Vec4::new(0.05, 0.6, 0.1, 1.0);

/// Draws them while [`Switches::shapes`] is on.
pub struct ShapesPlugin;

impl Plugin for ShapesPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(PostUpdate, (draw, clear))
            .init_resource::<ShapesDrawn>();
    }
}

/// The mesh of all lines, while they are drawn.
#[derive(Resource, Default)]
struct ShapesDrawn(Drawn);

fn draw(
    switches: Res<Switches>,
    movers: Query<(&CharacterBody, &MoveState)>,
    blockers: Query<(&Blocker, &Transform)>,
    colliders: Query<(&Collider, &Transform), Without<Blocker>>,
    tiles: Query<(&RapierCollider, &Transform), Without<Solid>>,
    mut drawn: ResMut<ShapesDrawn>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    if !switches.shapes {
        return;
    }
    let mut lines = Lines::default();
    for (body, state) in &movers {
        lines.rings(state.center.as_vec3(), Quat::IDENTITY, body.radii, SHAPE);
        for (_, contact) in state.contacts() {
            let (point, normal) = (contact.point.as_vec3(), contact.normal.as_vec3());
            lines.line(point, point + normal * NORMAL, CONTACT);
            for side in [Vec3::X, Vec3::Z] {
                lines.line(point - side * 0.1, point + side * 0.1, CONTACT);
            }
        }
        if let Some(ground) = &state.outcome.ground {
            let (point, normal) = (ground.point.as_vec3(), ground.normal.as_vec3());
            lines.line(point, point + normal * NORMAL, CONTACT);
        }
    }
    for (blocker, place) in &blockers {
        let upright = Transform::from_translation(place.translation);
        lines.cuboid(&upright, blocker.half_size, SHAPE);
    }
    for (collider, place) in &colliders {
        let mesh = collider.0.mesh();
        for triangle in 0..mesh.triangles().len() as u32 {
            let [a, b, c] = mesh
                .corners(triangle)
                .map(|corner| place.translation + place.rotation * corner.as_vec3());
            // Each edge of a closed mesh once.
            for (from, to) in [(a, b), (b, c), (c, a)] {
                if from.to_array() < to.to_array() {
                    lines.line(from, to, SHAPE);
                }
            }
        }
    }
    for (collider, place) in &tiles {
        if let TypedShape::HeightField(field) = collider.raw.as_typed_shape() {
            for triangle in field.triangles() {
                let [a, b, c] = [triangle.a, triangle.b, triangle.c]
                    .map(|corner| place.translation + corner + Vec3::Y * ABOVE);
                lines.line(a, b, TILE);
                lines.line(b, c, TILE);
                lines.line(c, a, TILE);
            }
        }
    }
    drawn
        .0
        .show(lines, &mut meshes, &mut materials, &mut commands);
}

fn clear(switches: Res<Switches>, mut drawn: ResMut<ShapesDrawn>, mut commands: Commands) {
    if !switches.shapes {
        drawn.0.hide(&mut commands);
    }
}
