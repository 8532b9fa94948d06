//! What the scene looks like: the camera's pipeline, the ground's material.
//!
//! | file | concern |
//! |---|---|
//! | [`textures`] | the ground's texture arrays |
//! | [`person`], [`hero`] | persons from their files; what the figure looks like |
//! | [`things`], [`shapes`] | what things look like; what collision knows, as lines |
//! | [`senses`], [`lines`] | what logic senses, as lines; lines as a mesh |
//! | [`panel`], [`passes`] | figures over the picture; times of render passes |
//! | [`start`], [`progress`] | the start screen; what has been made of the first picture |
//! | [`quality`] | bloom, anti-aliasing and shadows as they were chosen |
//! | [`scaled`] | the scene in a resolution of its own |
//! | [`bloom`] | bloom in views of any shape |
//! | [`renderer`] | who lights the picture |
//! | [`lamps`], [`torch`] | lamps of the scene; the one in the figure's hand |
//! | [`city`] | the city of the scene |
//! | [`vegetation`] | what grows |
//! | [`level`] | what a level looks like, and its menus |
//! | [`unlit`] | a view without its lighting, for the bench |
//! | [`daylight`] | the place of the sun; colours by day and by night |

pub mod bloom;
pub mod brush;
pub mod city;
pub mod daylight;
pub mod hero;
pub mod lamps;
pub mod level;
pub mod lines;
pub mod panel;
pub mod passes;
pub mod person;
pub mod progress;
pub mod quality;
pub mod renderer;
pub mod scaled;
pub mod senses;
pub mod shapes;
pub mod start;
pub mod textures;
pub mod things;
pub mod torch;
pub mod unlit;
pub mod vegetation;

use bevy::camera::{Hdr, RenderTarget};
use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::pbr::DefaultOpaqueRendererMethod;
use bevy::prelude::*;
use bevy::render::view::{ColorGrading, ColorGradingGlobal, ColorGradingSection};
use dolomite::ground::detail::budget::{Budget, FrameTime, frame_time};
use dolomite::ground::detail::{Metric, TerrainLod};
use dolomite::ground::{GroundTextures, PatchDetail, TerrainView};
use dolomite::terrain::Ground;
use dolomite::tessellation::GeometryCamera;
use dolomite::vegetation::VegetationView;

use crate::play::camera::{CameraSystems, FreeCamera};
use crate::play::figure::Figure;
use crate::play::{DetailFocus, Landscape, Switches};
use crate::scene::CurrentScene;
use crate::settings::Settings;
use crate::settings::quality::Quality;
use bloom::BloomFitPlugin;
use brush::BrushPlugin;
use city::CityScenePlugin;
use daylight::{DaylightPlugin, SATURATION};
use hero::HeroPlugin;
use lamps::LampsPlugin;
use quality::QualityPlugin;
use renderer::RendererPlugin;
use scaled::{Scaled, ScaledPlugin};
use senses::SensesPlugin;
use shapes::ShapesPlugin;
use start::Starting;
use things::ThingViewPlugin;
use torch::TorchPlugin;
use vegetation::PlantPlugin;

/// Distances that the camera sees, metres. Depth is infinite; `far` bounds culling only.
const NEAR: f32 = 0.15;
const FAR: f32 = 100_000.0;

/// Where the camera draws to when there is no window.
#[derive(Resource, Clone)]
pub struct OffscreenTarget(pub Handle<Image>);

/// The camera that panels are drawn over.
#[derive(Component)]
pub struct UiCamera;

/// Makes the scene visible: gives cameras and ground what they are drawn with, and spawns panels. Runs
/// once: at the start, or after the first frames of the [`start`] screen.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Dress;

/// The order of [`Dress`].
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DressSystems {
    /// Cameras and ground.
    Scene,
    /// What is drawn over a camera's picture.
    Panels,
}

/// Runs [`Dress`] at the start.
pub struct DressPlugin;

impl Plugin for DressPlugin {
    fn build(&self, app: &mut App) {
        init_dress(app);
        app.add_systems(Startup, |world: &mut World| world.run_schedule(Dress));
    }
}

fn init_dress(app: &mut App) {
    app.init_schedule(Dress)
        .configure_sets(Dress, (DressSystems::Scene, DressSystems::Panels).chain());
}

/// The two texture arrays of the ground.
#[derive(Resource, Clone)]
pub struct SceneTextures(pub GroundTextures);

impl SceneTextures {
    /// Takes what [`textures::read_ground`] read.
    pub fn new([albedo_height, normal_roughness]: [Image; 2], images: &mut Assets<Image>) -> Self {
        Self(GroundTextures {
            albedo_height: images.add(albedo_height),
            normal_roughness: images.add(normal_roughness),
        })
    }
}

/// Draws what the simulation holds. Expects, when [`Dress`] runs, the resource [`SceneTextures`], and
/// [`OffscreenTarget`] where there is no window.
pub struct ViewPlugin;

impl Plugin for ViewPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(DefaultOpaqueRendererMethod::deferred())
            .insert_resource(ClearColor(Color::BLACK))
            .add_plugins((
                DaylightPlugin,
                HeroPlugin,
                BloomFitPlugin,
                QualityPlugin,
                ScaledPlugin,
                ThingViewPlugin,
                SensesPlugin,
                ShapesPlugin,
                RendererPlugin,
                LampsPlugin,
                TorchPlugin,
                CityScenePlugin,
                PlantPlugin,
                BrushPlugin,
            ))
            .add_systems(
                Dress,
                (dress_camera, dress_landscape).in_set(DressSystems::Scene),
            )
            .add_systems(
                Update,
                (
                    follow_switches.after(CameraSystems),
                    dress_landscape
                        .run_if(resource_exists::<SceneTextures>)
                        .run_if(resource_changed::<CurrentScene>),
                ),
            );
    }
}

/// Ground that is nowhere farther than so many pixels from the true one.
fn bounded(pixels: f32) -> TerrainLod {
    TerrainLod {
        metric: Metric::ErrorBound { pixels },
        ..default()
    }
}

fn dress_camera(
    mut commands: Commands,
    target: Option<Res<OffscreenTarget>>,
    settings: Res<Settings>,
    scene: Res<CurrentScene>,
    starting: Option<Res<Starting>>,
    chosen: Res<Quality>,
    cameras: Query<(Entity, &FreeCamera)>,
) {
    for (entity, camera) in &cameras {
        let mut entity = commands.entity(entity);
        entity.insert((
            Camera3d::default(),
            Projection::Perspective(PerspectiveProjection {
                fov: camera.fov.to_radians(),
                near: NEAR,
                far: FAR,
                ..default()
            }),
            Hdr,
            // The G-buffer has one sample; edges are smoothed afterwards.
            Msaa::Off,
            (DepthPrepass, DeferredPrepass),
            Tonemapping::AgX,
            ColorGrading {
                global: ColorGradingGlobal {
                    post_saturation: SATURATION,
                    ..default()
                },
                midtones: ColorGradingSection {
                    contrast: 1.12,
                    ..default()
                },
                ..default()
            },
            Scaled,
            (TerrainView, VegetationView),
            bounded(settings.max_error.unwrap_or(1.0)),
            GeometryCamera {
                pixels_per_edge: settings.pixels_per_edge,
                ..default()
            },
            daylight::sky(&scene, starting.is_some()),
            UiCamera,
        ));
        quality::effects(&mut entity, &chosen);
        if let Some(target) = &target {
            entity.insert(RenderTarget::Image(target.0.clone().into()));
        }
    }
}

/// Gives the landscape its material, and again when the scene was loaded anew.
fn dress_landscape(
    mut commands: Commands,
    textures: Res<SceneTextures>,
    scene: Res<CurrentScene>,
    landscapes: Query<Entity, With<Landscape>>,
) {
    for entity in &landscapes {
        let material = scene.material.clone();
        let material = material.unwrap_or_else(|| scene.bands.into());
        commands
            .entity(entity)
            .insert((material, textures.0.clone(), scene.sea));
    }
}

/// Hands switches and settings to the tessellation. The view is written only when it differs, so
/// that a still camera stays unchanged and costs no dispatch.
fn follow_switches(
    switches: Res<Switches>,
    settings: Res<Settings>,
    scene: Res<CurrentScene>,
    figures: Query<&Figure>,
    mut views: Query<(
        Entity,
        &mut GeometryCamera,
        &mut TerrainLod,
        Option<&mut PatchDetail>,
        Option<&Budget>,
    )>,
    mut commands: Commands,
) {
    let focus = match switches.focus {
        DetailFocus::Camera => None,
        DetailFocus::Figure => figures.iter().next().map(|figure| {
            let place = figure.now.place;
            bevy::math::DVec3::new(place.x, scene.terrain.height(place), place.y)
        }),
    };
    for (entity, mut camera, mut detail, patches, budget) in &mut views {
        // A budget moves the metric itself.
        if let (None, Some(pixels)) = (settings.budget, settings.max_error) {
            detail.set_if_neq(bounded(pixels));
        }
        let by_patches = settings.budget.is_none() && settings.max_error.is_none();
        let wanted = by_patches.then(|| PatchDetail {
            finest_patch: settings.finest_patch,
            ..default()
        });
        let asked = settings.budget.map(|milliseconds| Budget {
            milliseconds,
            ..default()
        });
        if asked.as_ref() != budget {
            let mut camera = commands.entity(entity);
            match asked {
                Some(asked) => camera.insert((asked, frame_time())),
                None => camera.remove::<(Budget, FrameTime)>(),
            };
        }
        match (patches, wanted) {
            (Some(mut patches), Some(wanted)) => {
                patches.set_if_neq(wanted);
            }
            (None, Some(wanted)) => {
                commands.entity(entity).insert(wanted);
            }
            (Some(_), None) => {
                commands.entity(entity).remove::<PatchDetail>();
            }
            (None, None) => {}
        }
        let next = GeometryCamera {
            pixels_per_edge: settings.pixels_per_edge,
            focus,
            fill: switches.fill,
            lines: switches.lines,
            ..camera.clone()
        };
        camera.set_if_neq(next);
    }
}
