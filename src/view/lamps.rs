//! The lamps of a scene: a light, its glass and its post each.

use bevy::light::NotShadowCaster;
use bevy::prelude::*;

use super::{Dress, DressSystems, SceneTextures};
use crate::scene::CurrentScene;
use crate::scene::lamps::{Lamp, Lamps};

/// Radius of the glass, metres.
const GLASS: f32 = 0.11;

/// Radius of the post, metres.
const POST: f32 = 0.035;

/// How bright the glass is in the picture, where 1 is white.
const GLOW: f32 = 7.0;

/// Puts up the lamps of the scene, and others when it is loaded anew.
pub struct LampsPlugin;

impl Plugin for LampsPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Dress, put_up.in_set(DressSystems::Scene))
            .add_systems(
                Update,
                put_up
                    .run_if(resource_exists::<SceneTextures>)
                    .run_if(resource_changed::<CurrentScene>),
            );
    }
}

/// A part of a lamp, and the lamps that it is one of.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
struct LampPart;

/// What was put up, so that a change of anything else leaves it standing.
#[derive(Resource, Clone, PartialEq)]
struct PutUp(Option<Lamps>, Vec<Lamp>);

fn put_up(
    mut commands: Commands,
    scene: Res<CurrentScene>,
    standing: Option<Res<PutUp>>,
    old: Query<Entity, With<LampPart>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let lamps = scene.lamps;
    let places = lamps.map_or_else(Vec::new, |lamps| lamps.on(&scene.terrain));
    let next = PutUp(lamps, places);
    if standing.is_some_and(|standing| *standing == next) {
        return;
    }
    for part in &old {
        commands.entity(part).despawn();
    }
    if let Some(lamps) = lamps {
        let glass = meshes.add(Sphere::new(GLASS).mesh().uv(12, 8));
        let post = meshes.add(Cylinder::new(POST, lamps.height).mesh().resolution(6));
        let iron = materials.add(StandardMaterial {
            base_color: Color::linear_rgb(0.03, 0.03, 0.035),
            metallic: 0.6,
            perceptual_roughness: 0.55,
            ..default()
        });
        // Glass of few colours, so that lamps are drawn together.
        let steps = 6_u16;
        let glasses: Vec<_> = (0..steps)
            .map(|step| {
                let colour = Lamp::colour(f32::from(step) / f32::from(steps - 1)) * GLOW;
                materials.add(StandardMaterial {
                    base_color: Color::BLACK,
                    emissive: LinearRgba::rgb(colour.x, colour.y, colour.z),
                    ..default()
                })
            })
            .collect();
        for lamp in &next.1 {
            let foot = lamp.foot.as_vec3();
            let step = (lamp.pale * f32::from(steps - 1)).round() as usize;
            let colour = Lamp::colour(lamp.pale);
            commands.spawn((
                LampPart,
                PointLight {
                    color: Color::linear_rgb(colour.x, colour.y, colour.z),
                    intensity: lamps.lumens,
                    range: lamps.range,
                    radius: GLASS,
                    ..default()
                },
                Mesh3d(glass.clone()),
                MeshMaterial3d(glasses[step.min(glasses.len() - 1)].clone()),
                // Its own light comes out of it.
                NotShadowCaster,
                Transform::from_translation(foot + Vec3::Y * lamps.height),
            ));
            commands.spawn((
                LampPart,
                Mesh3d(post.clone()),
                MeshMaterial3d(iron.clone()),
                Transform::from_translation(foot + Vec3::Y * (0.5 * lamps.height - GLASS)),
            ));
        }
    }
    commands.insert_resource(next);
}
