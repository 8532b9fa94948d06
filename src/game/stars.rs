//! The stars in the sky: one entity of six thousand octahedra, which the tessellation stage draws on
//! a dome about the camera. By day there is none.

use std::sync::Arc;

use bevy::math::Vec4;
use bevy::prelude::*;
use bevy::render::render_resource::{AsBindGroup, ShaderType};
use dolomite::tessellation::render::{PatchKind, PatchPlugin, PatchPool, PatchShader};
use dolomite::tessellation::{PatchLayout, PatchMesh, Patches};

use super::camera::{CameraSystems, FreeCamera};
use super::scattering::zenith_depth;
use super::sky::{SeenSky, SkySystems};
use super::star_catalogue::{self, COLOURS, STARS};

/// Radius of the dome, metres: behind all ground, before the far plane at 100 km.
pub const DOME: f32 = 90_000.0;

/// Illuminance of a star of magnitude 0 outside the air, lux.
const MAGNITUDE_0: f32 = 2.54e-6;

/// How much brighter stars are shown than they are. A full moon leaves a tenth of them to the eye;
/// this gives back those of the fifth magnitude.
const SHOWN: f32 = 3.0;

/// Share of a star's colour that is shown: the rest is white, as the eye has it.
const COLOURED: f32 = 0.7;

/// What follows the camera: its place seen from there, metres.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct Dome(pub Vec3);

/// The kind of patches that stars are.
#[derive(Resource, AsBindGroup, Clone, Default)]
pub struct Star {
    #[uniform(0)]
    light: StarLight,
    #[texture(1, dimension = "cube")]
    #[sampler(2)]
    sky: Option<Handle<Image>>,
}

/// Laid out as `StarLight` in `star.wgsl`.
#[derive(ShaderType, Clone, Copy, Default)]
struct StarLight {
    /// Exposed illuminance of a star of magnitude 0, for each class of colour.
    colours: [Vec4; COLOURS as usize],
    /// Optical depth of the air above; w: exposed luminance of 1 in the map of the sky.
    depth: Vec4,
}

impl PatchKind for Star {
    const LAYOUT: PatchLayout = PatchLayout::TRIANGLE;
    const CUSTOM_MATERIAL: bool = true;
    const SHADOWS: bool = false;

    fn shader() -> PatchShader {
        PatchShader::File("shaders/star.wgsl")
    }

    /// Every octahedron of the dome, unrefined.
    fn pool(&self) -> PatchPool {
        PatchPool {
            vertices: 6 * STARS,
            primitives: 8 * STARS,
        }
    }
}

/// The mesh, once it was needed.
#[derive(Resource)]
struct StarMesh(Arc<PatchMesh>);

/// Stars where and while they are seen, and the dome about the camera.
pub struct StarPlugin;

impl Plugin for StarPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(PatchPlugin(Star::default())).add_systems(
            Update,
            (
                shine
                    .run_if(resource_exists_and_changed::<SeenSky>)
                    .after(SkySystems),
                follow.after(CameraSystems),
            ),
        );
    }
}

/// Spawns or removes the stars, and gives them their light.
fn shine(
    mut commands: Commands,
    sky: Res<SeenSky>,
    mut kind: ResMut<Star>,
    mesh: Option<Res<StarMesh>>,
    stars: Query<Entity, With<Patches<Star>>>,
    cameras: Query<&Transform, (With<FreeCamera>, Without<Dome>)>,
) {
    let share = sky.heavens.stars;
    if share == 0.0 {
        for entity in &stars {
            commands.entity(entity).despawn();
        }
        return;
    }
    let light = MAGNITUDE_0 * SHOWN * share * sky.exposure;
    let mut colours = [Vec4::ZERO; COLOURS as usize];
    for (class, colour) in (0..).zip(&mut colours) {
        let shown = Vec3::ONE.lerp(star_catalogue::colour(class), COLOURED);
        *colour = (shown * light).extend(0.0);
    }
    *kind = Star {
        light: StarLight {
            colours,
            depth: zenith_depth().extend(sky.exposure * sky.scale),
        },
        sky: Some(sky.map.clone()),
    };
    if !stars.is_empty() {
        return;
    }
    let mesh = match mesh {
        Some(mesh) => mesh.0.clone(),
        None => match star_catalogue::mesh(&star_catalogue::catalogue()) {
            Ok(mesh) => {
                let mesh = Arc::new(mesh);
                commands.insert_resource(StarMesh(mesh.clone()));
                mesh
            }
            Err(fault) => {
                error!("there are no stars: {fault}");
                return;
            }
        },
    };
    let patches = Patches::<Star>::new(mesh);
    commands.spawn(dome(&cameras, Vec3::ZERO, DOME, Quat::IDENTITY, patches));
}

/// Patches at `offset` metres from the camera, `scale` metres large, turned by `rotation`.
pub fn dome<K: PatchKind>(
    cameras: &Query<&Transform, (With<FreeCamera>, Without<Dome>)>,
    offset: Vec3,
    scale: f32,
    rotation: Quat,
    patches: Patches<K>,
) -> impl Bundle + use<K> {
    let eye = cameras.iter().next();
    let eye = eye.map_or(Vec3::ZERO, |eye| eye.translation);
    (
        Dome(offset),
        patches,
        Transform {
            translation: eye + offset,
            rotation,
            scale: Vec3::splat(scale),
        },
    )
}

/// Moves the dome with the camera; a camera that rests changes nothing.
fn follow(
    cameras: Query<&Transform, (With<FreeCamera>, Without<Dome>)>,
    mut domes: Query<(&Dome, &mut Transform)>,
) {
    let Some(eye) = cameras.iter().next() else {
        return;
    };
    for (dome, mut place) in &mut domes {
        let translation = eye.translation + dome.0;
        if place.translation != translation {
            place.translation = translation;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::game::moon::{Moon, MoonPlugin};
    use crate::game::night::Heavens;
    use bevy::math::ops;

    fn sky(elevation: f32) -> SeenSky {
        let (sin, cos) = ops::sin_cos(elevation.to_radians());
        SeenSky {
            heavens: Heavens::new(Vec3::new(cos, sin, 0.0), true),
            exposure: 1.0,
            map: Handle::default(),
            scale: 1.0,
        }
    }

    fn count(app: &mut App) -> [usize; 2] {
        app.update();
        app.update();
        let world = app.world_mut();
        let stars = world.query::<&Patches<Star>>().iter(world).count();
        [stars, world.query::<&Patches<Moon>>().iter(world).count()]
    }

    #[test]
    fn by_day_there_is_neither_star_nor_moon_and_no_mesh_of_them() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, StarPlugin, MoonPlugin));
        assert_eq!(count(&mut app), [0, 0], "no sky yet");
        app.insert_resource(sky(24.0));
        assert_eq!(count(&mut app), [0, 0], "day");
        assert!(!app.world().contains_resource::<StarMesh>());
        app.insert_resource(sky(-1.0));
        assert_eq!(count(&mut app), [0, 1], "the moon rises as the sun sets");
        app.insert_resource(sky(-30.0));
        assert_eq!(count(&mut app), [1, 1], "night");
        app.insert_resource(sky(-40.0));
        assert_eq!(count(&mut app), [1, 1], "later that night");
        app.insert_resource(sky(2.0));
        assert_eq!(count(&mut app), [0, 0], "morning");
    }

    #[test]
    fn the_dome_follows_the_camera_and_rests_with_it() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, StarPlugin, MoonPlugin));
        app.insert_resource(sky(-30.0));
        let eye = FreeCamera {
            pose: crate::scene::Pose {
                position: bevy::math::DVec3::ZERO,
                yaw: 0.0,
                pitch: 0.0,
            },
            velocity: Vec3::ZERO,
            fov: 55.0,
            followed: None,
        };
        let eye = app.world_mut().spawn(eye).id();
        assert_eq!(count(&mut app), [1, 1]);
        let at = Vec3::new(300.0, 20.0, -7.0);
        if let Some(mut place) = app.world_mut().get_mut::<Transform>(eye) {
            place.translation = at;
        }
        app.update();
        let tick = app.world_mut().change_tick();
        app.update();
        let world = app.world_mut();
        let now = world.read_change_tick();
        let mut domes = world.query::<(&Dome, Ref<Transform>)>();
        for (dome, place) in domes.iter(world) {
            assert_eq!(place.translation, at + dome.0);
            assert!(!place.last_changed().is_newer_than(tick, now), "{dome:?}");
        }
        assert_eq!(domes.iter(world).count(), 2);
    }
}
