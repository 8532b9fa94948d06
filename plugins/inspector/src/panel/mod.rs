//! What is drawn: a window with tabs, and the console, by `bevy_egui`.
//!
//! They have a camera of their own, which draws nothing but them over the others, so that no camera of the app is
//! touched. It is there while something is open; `bevy_egui`'s systems run as long.
//!
//! | file | concern |
//! |---|---|
//! | `run` | `bevy_egui`'s systems, while something is open |
//! | `shell` | windows and tabs |
//! | [`state`] | what they remember, and what widgets ask for |
//! | `values` | a value by reflection as widgets |
//! | `settings`, `entities`, `measures`, `frame` | a tab each |
//! | `plot`, `chart` | a history as a line; charts of the running scene |
//! | `console` | the console |
//! | `clip` | text for other programs |

mod chart;
mod clip;
mod console;
mod entities;
mod frame;
mod measures;
mod plot;
mod run;
mod settings;
mod shell;
pub mod state;
mod values;

use bevy::camera::visibility::RenderLayers;
use bevy::camera::{CameraOutputMode, ClearColorConfig, RenderTarget};
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::BlendState;
use bevy_egui::{EguiManagedTextures, EguiPlugin, EguiSchedule};

/// For windows of an app's own in [`InspectorPass`].
pub use bevy_egui::{EguiContext, egui};
pub use run::{InspectorInput, InspectorOutput};

use crate::{Inspector, InspectorWants};
use state::Shell;

/// Behind every other camera.
const ORDER: isize = 10_000;

/// Where the inspector is drawn: the primary window, or an image of a test.
#[derive(Resource, Clone, Debug, Default)]
pub struct InspectorTarget(pub RenderTarget);

/// The camera that draws it, while it is open.
#[derive(Component)]
pub struct InspectorCamera;

/// The schedule in which it is drawn. An app adds windows of its own to it, which are then open as long as the inspector.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct InspectorPass;

/// The plugin was added to an app without a renderer.
#[derive(Resource)]
struct Blind;

pub(crate) fn build(app: &mut App) {
    if app.get_sub_app(RenderApp).is_none() {
        app.insert_resource(Blind);
        return;
    }
    if app.is_plugin_added::<EguiPlugin>() {
        app.insert_resource(run::Theirs);
    } else {
        run::build(app);
    }
    app.init_resource::<InspectorTarget>()
        .init_resource::<Shell>()
        .init_schedule(InspectorPass)
        .add_systems(InspectorPass, shell::show)
        .add_systems(
            PreUpdate,
            open_or_close
                .run_if(resource_changed::<Inspector>.or_else(resource_exists::<run::Runs>))
                .after(crate::InspectorSystems),
        )
        .add_systems(PostUpdate, run::output.run_if(resource_exists::<run::Runs>));
}

pub(crate) fn finish(app: &mut App) {
    run::finish(app);
    if app.world().contains_resource::<Blind>() && app.get_sub_app(RenderApp).is_some() {
        warn!("the inspector has no panel: add InspectorPlugin after Bevy's DefaultPlugins");
    }
}

fn open_or_close(world: &mut World, cameras: &mut QueryState<Entity, With<InspectorCamera>>) {
    let is_open = world.resource::<Inspector>().is_open();
    let camera = cameras.iter(world).next();
    match (is_open, camera) {
        (true, None) => open(world),
        (false, Some(camera)) => close(world, camera),
        _ => {}
    }
    run::input(world, is_open);
}

fn open(world: &mut World) {
    run::begin(world);
    let target = world.resource::<InspectorTarget>().0.clone();
    world.spawn((
        InspectorCamera,
        Name::new("inspector"),
        Camera2d,
        Camera {
            order: ORDER,
            clear_color: ClearColorConfig::Custom(Color::NONE),
            output_mode: CameraOutputMode::Write {
                blend_state: Some(BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                clear_color: ClearColorConfig::None,
            },
            ..default()
        },
        Msaa::Off,
        RenderLayers::none(),
        target,
        EguiContext::default(),
        EguiSchedule::new(InspectorPass),
    ));
}

fn close(world: &mut World, camera: Entity) {
    world.despawn(camera);
    if let Some(mut textures) = world.get_resource_mut::<EguiManagedTextures>() {
        textures.retain(|(context, _), _| *context != camera);
    }
    let mut wants = world.resource_mut::<InspectorWants>();
    wants.set_if_neq(InspectorWants::default());
}
