//! What the figure looks like: the person of `assets/hero`, read from their FBX file.
//!
//! The file is loaded beside the game, as any asset of Bevy's is; joints and clips come from the .glb
//! that [`FbxPlugin`](dolomite::fbx::FbxPlugin) made of it, and the meshes hang on the scene of the same
//! file. Where it is missing or broken, the log says why, and a capsule stands in.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use bevy::asset::LoadState;
use bevy::math::ops;
use bevy::prelude::*;
use dolomite::character::gait::{GaitData, GaitError};
use dolomite::character::{
    Character, CharacterEye, CharacterJoints, CharacterState, Figure as Person, LoadError, Rig,
};
use dolomite::fbx::FbxConversion;
use thiserror::Error;

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

/// Why the person is not there.
#[derive(Debug, Error)]
pub enum HeroError {
    /// The model was not loaded.
    #[error("{MODEL}: {0}")]
    Model(String),
    /// It has no figure in it.
    #[error("{MODEL}: {0}; it needs a skin and clips: assets/hero/README.md says how it is made")]
    Rig(#[from] LoadError),
    /// The meaning of its clips cannot be read.
    #[error("{}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Its clips are not those that are spoken of.
    #[error("{}: {source}", .path.display())]
    Gaits {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: GaitError,
    },
}

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
pub struct Coming {
    gltf: Handle<Gltf>,
    made: Handle<FbxConversion>,
}

/// The person, once they are there: others may look like them.
#[derive(Resource, Clone)]
pub struct Hero {
    /// Joints and clips.
    pub person: Arc<Person>,
    /// Meshes.
    pub scene: Option<Handle<bevy::world_serialization::WorldAsset>>,
}

/// Whether every figure looks as it will: nothing is being loaded, and all joints have been found.
pub fn is_there(world: &mut World) -> bool {
    let mut unbound = world.query_filtered::<(), (With<Character>, Without<CharacterJoints>)>();
    !world.contains_resource::<Coming>() && unbound.iter(world).next().is_none()
}

fn call(mut commands: Commands, assets: Res<AssetServer>) {
    commands.insert_resource(Coming {
        gltf: assets.load(MODEL),
        made: assets.load(format!("{MODEL}#{}", FbxConversion::LABEL)),
    });
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
    let person = match (
        assets.load_state(&coming.gltf),
        assets.load_state(&coming.made),
    ) {
        (LoadState::Failed(error), _) | (_, LoadState::Failed(error)) => {
            Err(HeroError::Model(error.to_string()))
        }
        // With textures and meshes: the person appears whole.
        _ if !assets.is_loaded_with_dependencies(&coming.gltf) => return,
        _ => match (gltfs.get(&coming.gltf), conversions.get(&coming.made)) {
            (Some(gltf), Some(made)) => {
                person(&made.glb, &folder.0).map(|person| (person, gltf.scenes.first().cloned()))
            }
            _ => return,
        },
    };
    commands.remove_resource::<Coming>();
    match person {
        Ok((person, scene)) => {
            let person = Arc::new(person);
            commands.insert_resource(Hero {
                person: person.clone(),
                scene: scene.clone(),
            });
            for figure in &figures {
                let mut figure = commands.entity(figure);
                figure.insert(Character {
                    figure: person.clone(),
                });
                if let Some(scene) = &scene {
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

/// Joints and clips of a .glb, with the meaning that the file in `assets` gives them.
fn person(glb: &[u8], assets: &Path) -> Result<Person, HeroError> {
    let rig = Rig::from_bytes(glb, |_| Err(std::io::ErrorKind::NotFound.into()))?;
    let path = assets.join(GAITS);
    let text = std::fs::read_to_string(&path).map_err(|source| HeroError::Read {
        path: path.clone(),
        source,
    })?;
    GaitData::from_ron(&text)
        .and_then(|gaits| Person::new(rig, &gaits))
        .map_err(|source| HeroError::Gaits { path, source })
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
