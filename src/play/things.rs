//! Things of the scene: what the figure meets and what Rapier moves. Without a thing in the scene there is no
//! collision and no world of Rapier's.

use std::sync::Arc;

use bevy::math::{DVec2, DVec3, ops};
use bevy::prelude::*;
use bevy_rapier3d::prelude::{Collider as RapierCollider, Friction, RigidBody};
use dolomite::collision::rapier::{GroundTiles, MeetsMovers, RapierBridgePlugin};
use dolomite::collision::{
    BetweenSteps, Blocker, Collider, CollisionSystems, TreeKind, TreeSettings, TriangleMesh,
    TriangleTree,
};
use dolomite::terrain::{Ground, Terrain};

use crate::scene::CurrentScene;
use crate::scene::reload::ReloadSystems;
use crate::scene::things::Thing;

/// Distance of the samples of the ground below stones, and how many a side of a tile has.
const STEP: f32 = 0.5;
const CELLS: u32 = 16;

/// How long lifts wait where they turn, seconds.
const WAIT: f32 = 2.5;

/// Something that stands or lies on the ground.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[require(Transform, Visibility)]
pub struct Solid(pub Thing);

/// A plate that goes up and down.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct Lift {
    /// Height of its middle at the lowest, metres.
    pub low: f32,
    /// How far it goes, metres.
    pub rise: f32,
    /// Metres a second.
    pub speed: f32,
    /// Since it last waited below, seconds.
    pub age: f32,
}

/// The ground of stones.
#[derive(Component)]
pub(super) struct Bed;

/// The set in which lifts move (schedule `FixedUpdate`).
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LiftSystems;

/// Makes the things of the scene, again when it changes, and moves lifts. Needs no renderer.
pub struct ThingsPlugin;

impl Plugin for ThingsPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(RapierBridgePlugin)
            .add_systems(
                PreUpdate,
                make.run_if(resource_changed::<CurrentScene>)
                    .after(ReloadSystems),
            )
            .add_systems(
                FixedUpdate,
                move_lifts
                    .in_set(LiftSystems)
                    .before(CollisionSystems::Gather),
            );
    }
}

fn make(
    mut commands: Commands,
    scene: Res<CurrentScene>,
    old: Query<Entity, Or<(With<Solid>, With<Bed>)>>,
) {
    for entity in &old {
        commands.entity(entity).despawn();
    }
    if scene.things.is_empty() {
        return;
    }
    match GroundTiles::new(Arc::new(scene.terrain.clone()), STEP, CELLS) {
        Ok(tiles) => {
            commands.spawn((Bed, tiles, Friction::coefficient(0.9)));
        }
        Err(error) => error!("stones have no ground: {error}"),
    }
    for thing in &scene.things {
        spawn(&mut commands, *thing, &scene.terrain);
    }
}

fn spawn(commands: &mut Commands, thing: Thing, terrain: &Terrain) {
    let at = DVec2::from(thing.at());
    let place = |above: f32| {
        let middle = DVec3::new(at.x, terrain.height(at) + f64::from(above), at.y);
        Transform::from_translation(middle.as_vec3())
    };
    let half = |size: (f32, f32, f32)| Vec3::from(size) * 0.5;
    let mut entity = commands.spawn(Solid(thing));
    match thing {
        Thing::Boulder { radius, height, .. } => {
            let Some((vertices, triangles)) = boulder(&thing) else {
                return;
            };
            if let Some(hull) = RapierCollider::convex_hull(&vertices) {
                entity.insert(hull);
            }
            // Its middle lies in the ground.
            let place = place(0.0);
            entity.insert(place);
            match TriangleMesh::new(DVec3::ZERO, vertices, triangles) {
                Ok(mesh) => {
                    let tree = TriangleTree::new(mesh, TreeSettings::default());
                    entity.insert(Collider(Arc::new(tree)));
                }
                Err(error) => {
                    error!("a boulder of {radius} m by {height} m is no obstacle: {error}")
                }
            }
        }
        Thing::Block { size, .. } => {
            let half_size = half(size);
            // A part of it stands in the ground, which is not level.
            entity.insert((
                Blocker { half_size },
                RapierCollider::cuboid(half_size.x, half_size.y, half_size.z),
                place(half_size.y * 0.8),
            ));
        }
        Thing::Lift {
            size, rise, speed, ..
        } => {
            let half = half(size);
            // Its top is so little above the ground that it is walked onto.
            let place = place(0.02 - half.y);
            let settings = TreeSettings {
                kind: TreeKind::List,
                ..TreeSettings::default()
            };
            if let Ok(mesh) = TriangleMesh::cuboid(DVec3::ZERO, half) {
                entity.insert(Collider(Arc::new(TriangleTree::new(mesh, settings))));
            }
            entity.insert((
                BetweenSteps::default(),
                Lift {
                    low: place.translation.y,
                    rise,
                    speed,
                    age: 0.0,
                },
                RigidBody::KinematicPositionBased,
                RapierCollider::cuboid(half.x, half.y, half.z),
                place,
            ));
        }
        Thing::Stone { radius, .. } => {
            entity.insert((
                BetweenSteps::default(),
                RigidBody::Dynamic,
                RapierCollider::ball(radius),
                Friction::coefficient(0.9),
                MeetsMovers,
                place(radius + 0.05),
            ));
        }
    }
}

impl Lift {
    /// From waiting below to waiting above, seconds.
    fn half(&self) -> f32 {
        self.rise / self.speed + WAIT
    }

    /// How high it is above its lowest place: it waits there, goes up, waits, and comes down again.
    fn height(&self) -> f32 {
        let way = self.rise / self.speed;
        let half = self.half();
        let at = self.age % (2.0 * half);
        let up = ((at % half - WAIT) / way).max(0.0);
        self.rise * if at < half { up } else { 1.0 - up }
    }
}

fn move_lifts(time: Res<Time>, mut lifts: Query<(&mut Lift, &mut Transform)>) {
    for (mut lift, mut place) in &mut lifts {
        // Not for ever: a float that grows loses its hundredths.
        lift.age = (lift.age + time.delta_secs()) % (2.0 * lift.half());
        place.translation.y = lift.low + lift.height();
    }
}

/// The surface of a boulder around its middle: an octahedron, divided four times and pushed out to a flat ellipsoid
/// with bumps. `None` for what is no boulder.
pub fn boulder(thing: &Thing) -> Option<(Vec<Vec3>, Vec<[u32; 3]>)> {
    const DIVISIONS: u32 = 8;
    let Thing::Boulder {
        radius,
        height,
        seed,
        ..
    } = *thing
    else {
        return None;
    };
    let phase = seed as f32;
    let bump = |d: Vec3| {
        let wave = |k: f32, along: Vec3, shift: f32| ops::sin(k * d.dot(along) + shift * phase);
        1.0 + 0.05 * wave(5.0, Vec3::new(0.8, 0.5, 0.3), 1.3)
            + 0.04 * wave(8.0, Vec3::new(-0.3, 0.7, 0.6), 2.1)
            + 0.02 * wave(17.0, Vec3::new(0.5, -0.4, 0.8), 0.7)
    };
    let out = |d: Vec3| {
        let d = d.normalize();
        d * Vec3::new(radius, height, radius) * bump(d)
    };
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for face in 0..8_u32 {
        let sign = |bit: u32| if face >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let (x, y, z) = (Vec3::X * sign(0), Vec3::Y * sign(1), Vec3::Z * sign(2));
        let first = vertices.len() as u32;
        let row = |i: u32| first + i * (2 * DIVISIONS + 3 - i) / 2;
        for i in 0..=DIVISIONS {
            for j in 0..=DIVISIONS - i {
                let (a, b) = (i as f32 / DIVISIONS as f32, j as f32 / DIVISIONS as f32);
                vertices.push(out(x * a + y * b + z * (1.0 - a - b)));
            }
        }
        // Seen from outside against the clock: mirrored faces the other way round.
        let turned = sign(0) * sign(1) * sign(2) < 0.0;
        let mut add = |a: u32, b: u32, c: u32| {
            triangles.push(if turned { [a, c, b] } else { [a, b, c] });
        };
        for i in 0..DIVISIONS {
            for j in 0..DIVISIONS - i {
                add(row(i) + j, row(i + 1) + j, row(i) + j + 1);
                if j + 1 < DIVISIONS - i {
                    add(row(i + 1) + j, row(i + 1) + j + 1, row(i) + j + 1);
                }
            }
        }
    }
    Some((vertices, triangles))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lift_waits_goes_and_turns() {
        let at = |age| {
            let lift = Lift {
                low: 0.0,
                rise: 4.0,
                speed: 2.0,
                age,
            };
            lift.height()
        };
        let expected = [
            (0.0, 0.0),
            (2.5, 0.0),
            (3.5, 2.0),
            (4.5, 4.0),
            (7.0, 4.0),
            (8.0, 2.0),
            (9.0, 0.0),
        ];
        for (age, height) in expected {
            assert!((at(age) - height).abs() < 1e-5, "{age}: {}", at(age));
        }
    }

    #[test]
    fn a_boulder_is_as_wide_and_high_as_it_says_and_faces_outwards() {
        let thing = Thing::Boulder {
            at: (0.0, 0.0),
            radius: 1.0,
            height: 0.4,
            seed: 3,
        };
        let (vertices, triangles) = boulder(&thing).unwrap();
        assert_eq!(triangles.len(), 8 * 64);
        for v in &vertices {
            let size = (*v / Vec3::new(1.0, 0.4, 1.0)).length();
            assert!((0.88..=1.12).contains(&size), "{v}");
        }
        for [a, b, c] in triangles {
            let [a, b, c] = [a, b, c].map(|i| vertices[i as usize]);
            assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
        }
        assert!(
            boulder(&Thing::Stone {
                at: (0.0, 0.0),
                radius: 1.0
            })
            .is_none()
        );
    }
}
