//! What collision knows, drawn as lines over the picture: shapes in white, contacts and their normals in red, tiles of
//! the ground in green, each cell as it is cut.

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::NoFrustumCulling;
use bevy::light::{NotShadowCaster, NotShadowReceiver};
use bevy::material::OpaqueRendererMethod;
use bevy::math::ops;
use bevy::mesh::PrimitiveTopology;
use bevy::prelude::*;
use bevy_rapier3d::parry::shape::TypedShape;
use bevy_rapier3d::prelude::Collider as RapierCollider;
use dolomite::collision::{Blocker, CharacterBody, Collider, MoveState};

use crate::play::Switches;
use crate::play::things::Solid;

/// Sides of a ring.
const RING: u32 = 24;

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
            .init_resource::<Drawn>();
    }
}

/// The mesh of all lines, while they are drawn.
#[derive(Resource, Default)]
struct Drawn(Option<(Entity, Handle<Mesh>)>);

/// Ends of lines and their colours.
#[derive(Default)]
struct Lines {
    ends: Vec<Vec3>,
    colours: Vec<Vec4>,
}

impl Lines {
    fn line(&mut self, from: Vec3, to: Vec3, colour: Vec4) {
        self.ends.extend([from, to]);
        self.colours.extend([colour, colour]);
    }

    /// Three rings around a centre, along the axes of a turn.
    fn rings(&mut self, center: Vec3, turn: Quat, radii: Vec3) {
        let (x, y, z) = (
            turn * Vec3::X * radii.x,
            turn * Vec3::Y * radii.y,
            turn * Vec3::Z * radii.z,
        );
        for (one, two) in [(x, y), (y, z), (z, x)] {
            let at = |i: u32| {
                let (sin, cos) = ops::sin_cos(std::f32::consts::TAU * i as f32 / RING as f32);
                center + one * cos + two * sin
            };
            for i in 0..RING {
                self.line(at(i), at(i + 1), SHAPE);
            }
        }
    }

    fn cuboid(&mut self, place: &Transform, half: Vec3) {
        let corner = |i: u32| {
            let side = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
            place.translation + place.rotation * (half * Vec3::new(side(0), side(1), side(2)))
        };
        for i in 0..8_u32 {
            for bit in 0..3 {
                if i >> bit & 1 == 0 {
                    self.line(corner(i), corner(i | 1 << bit), SHAPE);
                }
            }
        }
    }

    fn mesh(self) -> Mesh {
        Mesh::new(PrimitiveTopology::LineList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![Vec3::Y; self.ends.len()])
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, self.ends)
            .with_inserted_attribute(
                Mesh::ATTRIBUTE_COLOR,
                self.colours.iter().map(Vec4::to_array).collect::<Vec<_>>(),
            )
    }
}

fn draw(
    switches: Res<Switches>,
    movers: Query<(&CharacterBody, &MoveState)>,
    blockers: Query<(&Blocker, &Transform)>,
    colliders: Query<(&Collider, &Transform), Without<Blocker>>,
    tiles: Query<(&RapierCollider, &Transform), Without<Solid>>,
    mut drawn: ResMut<Drawn>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    if !switches.shapes {
        return;
    }
    let mut lines = Lines::default();
    for (body, state) in &movers {
        lines.rings(state.center.as_vec3(), Quat::IDENTITY, body.radii);
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
        lines.cuboid(&upright, blocker.half_size);
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
    let mesh = lines.mesh();
    if let Some((_, handle)) = &drawn.0
        && let Some(mut known) = meshes.get_mut(handle)
    {
        *known = mesh;
        return;
    }
    let handle = meshes.add(mesh);
    let entity = commands
        .spawn((
            Mesh3d(handle.clone()),
            MeshMaterial3d(materials.add(StandardMaterial {
                unlit: true,
                // Not into the G-buffer, which has no lines.
                opaque_render_method: OpaqueRendererMethod::Forward,
                ..default()
            })),
            Transform::default(),
            NoFrustumCulling,
            NotShadowCaster,
            NotShadowReceiver,
        ))
        .id();
    drawn.0 = Some((entity, handle));
}

fn clear(switches: Res<Switches>, mut drawn: ResMut<Drawn>, mut commands: Commands) {
    if switches.shapes {
        return;
    }
    if let Some((entity, _)) = drawn.0.take() {
        commands.entity(entity).try_despawn();
    }
}
