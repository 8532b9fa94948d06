//! What the figure looks like: the person of `assets/hero`, read from their FBX file.
//!
//! Where the file is missing or broken, the log says why, and a capsule stands in.

use bevy::math::ops;
use bevy::prelude::*;
use dolomite::character::{Character, CharacterEye, CharacterJoints, CharacterState};
use dolomite::fbx::FbxConversion;

use super::person::{Loading, PersonFiles};
use crate::input::PlayerInput;
use crate::play::figure::Figure;
use crate::settings::paths::AssetsDir;

/// Model and clips, below the assets folder.
pub const MODEL: &str = "hero/hero.fbx";

/// What the clips mean, below the assets folder.
pub const GAITS: &str = "hero/gaits.ron";

/// Number of the wave among the one-shots of [`GAITS`].
const WAVE: usize = 0;

/// Radius of the capsule that stands in, metres.
const RADIUS: f32 = 0.28;

/// Height of the capsule, metres: that of a grown person.
const HEIGHT: f32 = 1.8;

/// Makes figures look like the person.
pub struct HeroPlugin;

impl Plugin for HeroPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Startup, call).add_systems(
            Update,
            (
                arrive.run_if(resource_exists::<Coming>),
                wave.run_if(|input: Res<PlayerInput>| input.wave),
                watch,
            ),
        );
    }
}

/// The person is being loaded.
#[derive(Resource)]
pub struct Coming(Loading);

/// Whether every figure looks as it will: nothing is being loaded, and all joints have been found.
pub fn is_there(world: &mut World) -> bool {
    let mut unbound = world.query_filtered::<(), (With<Character>, Without<CharacterJoints>)>();
    !world.contains_resource::<Coming>() && unbound.iter(world).next().is_none()
}

fn call(mut commands: Commands, assets: Res<AssetServer>) {
    let files = PersonFiles {
        model: MODEL,
        gaits: GAITS,
    };
    commands.insert_resource(Coming(Loading::new(files, &assets)));
}

fn arrive(
    mut commands: Commands,
    coming: Res<Coming>,
    assets: Res<AssetServer>,
    gltfs: Res<Assets<Gltf>>,
    conversions: Res<Assets<FbxConversion>>,
    folder: Res<AssetsDir>,
    figures: Query<Entity, With<Figure>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let Some(person) = coming.0.poll(&assets, &gltfs, &conversions, &folder.0) else {
        return;
    };
    commands.remove_resource::<Coming>();
    match person {
        Ok(person) => {
            for figure in &figures {
                let mut figure = commands.entity(figure);
                figure.insert(Character {
                    figure: person.figure.clone(),
                });
                if let Some(scene) = &person.scene {
                    figure.with_child(WorldAssetRoot(scene.clone()));
                }
            }
        }
        Err(error) => {
            error!("the person is not there, a capsule stands in: {error}");
            let body = meshes.add(Capsule3d::new(RADIUS, HEIGHT - 2.0 * RADIUS));
            let jacket = materials.add(StandardMaterial {
                base_color: Color::srgb(0.80, 0.16, 0.07),
                perceptual_roughness: 0.75,
                ..default()
            });
            for figure in &figures {
                commands.entity(figure).with_child((
                    Mesh3d(body.clone()),
                    MeshMaterial3d(jacket.clone()),
                    Transform::from_xyz(0.0, HEIGHT / 2.0, 0.0),
                ));
            }
        }
    }
}

fn wave(mut figures: Query<&mut CharacterState, With<Figure>>) {
    for mut state in &mut figures {
        state.play(WAVE);
    }
}

/// Tells the person how large they are in the picture, so that nobody is animated whom nobody sees.
fn watch(
    mut commands: Commands,
    cameras: Query<(Entity, &Camera, &Projection, Option<&CharacterEye>), With<Camera3d>>,
) {
    for (entity, camera, projection, eye) in &cameras {
        let (Projection::Perspective(lens), Some(size)) =
            (projection, camera.physical_viewport_size())
        else {
            continue;
        };
        let slope = ops::tan(0.5 * lens.fov);
        let aspect = size.x as f32 / (size.y as f32).max(1.0);
        let next = CharacterEye {
            focal: size.y as f32 / (2.0 * slope),
            cone: ops::atan(slope * (1.0 + aspect * aspect).sqrt()),
            ..default()
        };
        if eye != Some(&next) {
            commands.entity(entity).insert(next);
        }
    }
}
