//! `bevy_egui`'s systems, for as long as something is open.
//!
//! Its plugin would add them to every frame of an app: some thirty in the main world, an exclusive one in the schedule of
//! each 3D view, the faces of shadow maps among them, and four that make maps anew in the render world, whether there is a
//! context or not. So the same systems of the same version stand in schedules of their own here, and in the render world
//! behind a condition. Resources and the shader are made when something is first opened. An app that adds `EguiPlugin`
//! itself has that one's systems, and these never run.

use bevy::asset::Assets;
use bevy::core_pipeline::upscaling::upscaling;
use bevy::core_pipeline::{Core2d, Core2dSystems};
use bevy::ecs::message::{MessageRegistry, Messages};
use bevy::ecs::schedule::{ScheduleLabel, SingleThreadedExecutor};
use bevy::prelude::*;
use bevy::render::extract_resource::ExtractResource;
use bevy::render::render_resource::SpecializedRenderPipelines;
use bevy::render::{Extract, ExtractSchedule, MainWorld, Render, RenderApp, RenderSystems};
use bevy::shader::Shader;
use bevy_egui::input::{
    EguiFileDragAndDropMessage, EguiInputEvent, EguiWantsInput, ModifierKeysState,
    WindowToEguiContextMap, process_ime_system, read_egui_zoom_factor_system,
    write_egui_input_system, write_egui_wants_input_system, write_file_dnd_messages_system,
    write_ime_messages_system, write_keyboard_input_messages_system,
    write_modifiers_keys_state_system, write_mouse_wheel_messages_system,
    write_non_window_pointer_moved_messages_system, write_non_window_touch_messages_system,
    write_pinch_gesture_messages_system, write_pointer_moved_and_button_messages_system,
    write_window_touch_messages_system,
};
use bevy_egui::output::process_output_system;
use bevy_egui::render::systems::{
    EguiPipelines, EguiRenderData, EguiTextureBindGroups, EguiTransforms,
    ExtractedEguiManagedTextures, prepare_egui_render_target_data_system,
    prepare_egui_transforms_system, queue_bind_groups_system, queue_pipelines_system,
};
use bevy_egui::render::{
    EGUI_SHADER_HANDLE, EguiPipeline, EguiRenderSettings, egui_pass,
    extract_egui_camera_view_system, prepare_egui_pass,
};
use bevy_egui::{
    EguiGlobalSettings, EguiManagedTextures, EguiPlugin, EguiUserTextures,
    free_egui_textures_system, run_egui_context_pass_loop_system, update_egui_textures_system,
    update_ui_screen_rect,
};

/// What `bevy_egui` does before the frame, while something is open.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct InspectorInput;

/// What it does behind the frame, while something is open: the panel is drawn, and its picture handed over.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct InspectorOutput;

/// Frames that they run after closing, to notice that the context is gone: messages of removals live for two.
const LINGER: u8 = 3;

/// They run. Counts frames that are left where all is closed.
#[derive(Resource)]
pub(super) struct Runs(u8);

/// The app's own `EguiPlugin` does all that.
#[derive(Resource)]
pub(super) struct Theirs;

/// In the render world: something is open, or was in the last frames.
#[derive(Resource)]
struct Drawn;

/// Adds the schedules, and the conditions of the render world.
pub(super) fn build(app: &mut App) {
    let mut input = Schedule::new(InspectorInput);
    input
        .set_executor(SingleThreadedExecutor::new())
        .add_systems(
            (
                WindowToEguiContextMap::on_egui_context_added_system,
                WindowToEguiContextMap::on_egui_context_removed_system,
                update_ui_screen_rect,
                write_modifiers_keys_state_system,
                read_egui_zoom_factor_system,
                write_pointer_moved_and_button_messages_system,
                write_window_touch_messages_system,
                write_non_window_pointer_moved_messages_system,
                write_non_window_touch_messages_system,
                write_mouse_wheel_messages_system,
                write_pinch_gesture_messages_system,
                write_keyboard_input_messages_system,
                write_ime_messages_system,
                write_file_dnd_messages_system,
                write_egui_input_system,
            )
                .chain(),
        );
    let mut output = Schedule::new(InspectorOutput);
    output
        .set_executor(SingleThreadedExecutor::new())
        .add_systems(
            (
                run_egui_context_pass_loop_system,
                process_output_system,
                write_egui_wants_input_system,
                process_ime_system,
                update_egui_textures_system,
                free_egui_textures_system,
            )
                .chain(),
        );
    app.add_schedule(input).add_schedule(output);
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    let drawn = resource_exists::<Drawn>;
    render_app
        .add_systems(
            ExtractSchedule,
            (
                (extract_egui_camera_view_system, hand_over).run_if(runs),
                put_away.run_if(drawn),
            ),
        )
        .add_systems(
            Render,
            (
                (
                    prepare_egui_transforms_system,
                    prepare_egui_render_target_data_system,
                )
                    .in_set(RenderSystems::Prepare),
                (queue_bind_groups_system, queue_pipelines_system).in_set(RenderSystems::Queue),
            )
                .run_if(drawn),
        )
        .add_systems(
            Core2d,
            (
                prepare_egui_pass,
                egui_pass.after(Core2dSystems::MainPass).before(upscaling),
            )
                .chain()
                .run_if(drawn),
        );
}

/// Whether somebody else's plugin does all that, which is known when all plugins were built.
pub(super) fn finish(app: &mut App) {
    if app.is_plugin_added::<EguiPlugin>() {
        app.insert_resource(Theirs);
    }
}

/// In the frame in which something is opened: makes what the systems need, the first time.
pub(super) fn begin(world: &mut World) {
    if world.contains_resource::<Theirs>() {
        return;
    }
    if !world.contains_resource::<WindowToEguiContextMap>() {
        world.init_resource::<EguiGlobalSettings>();
        world.init_resource::<ModifierKeysState>();
        world.init_resource::<EguiWantsInput>();
        world.init_resource::<WindowToEguiContextMap>();
        world.init_resource::<EguiManagedTextures>();
        world.init_resource::<EguiUserTextures>();
        if !world.contains_resource::<Messages<EguiInputEvent>>() {
            MessageRegistry::register_message::<EguiInputEvent>(world);
            MessageRegistry::register_message::<EguiFileDragAndDropMessage>(world);
        }
        if let (Some(shader), Some(mut shaders)) =
            (shader(), world.get_resource_mut::<Assets<Shader>>())
            // It is an identifier that an asset may have.
            && let Err(error) = shaders.insert(EGUI_SHADER_HANDLE.id(), shader)
        {
            error!("the inspector's panel has no shader: {error}");
        }
    }
    world.insert_resource(Runs(LINGER));
}

/// The shader of `bevy_egui`, which gives it to none but an app.
fn shader() -> Option<Shader> {
    let mut app = App::new();
    app.insert_sub_app(RenderApp, SubApp::new());
    app.init_resource::<Assets<Shader>>();
    app.add_plugins(EguiPlugin::default());
    let mut shaders = app.world_mut().resource_mut::<Assets<Shader>>();
    shaders.remove(EGUI_SHADER_HANDLE.id())
}

/// Before the frame.
pub(super) fn input(world: &mut World, is_open: bool) {
    let Some(mut runs) = world.get_resource_mut::<Runs>() else {
        return;
    };
    if is_open {
        runs.0 = LINGER;
    } else if runs.0 > 0 {
        runs.0 -= 1;
    } else {
        world.remove_resource::<Runs>();
        return;
    }
    world.run_schedule(InspectorInput);
}

/// Behind the frame.
pub(super) fn output(world: &mut World) {
    world.run_schedule(InspectorOutput);
}

fn runs(main: Res<MainWorld>) -> bool {
    main.contains_resource::<Runs>()
}

/// What the render world needs of the main world, beside views.
fn hand_over(
    mut commands: Commands,
    managed: Extract<Res<EguiManagedTextures>>,
    user: Extract<Res<EguiUserTextures>>,
    drawn: Option<Res<Drawn>>,
) {
    if drawn.is_none() {
        commands.insert_resource(EguiRenderSettings {
            bindless_mode_array_size: EguiPlugin::default().bindless_mode_array_size,
        });
        commands.init_resource::<EguiPipeline>();
        commands.init_resource::<SpecializedRenderPipelines<EguiPipeline>>();
        commands.init_resource::<EguiTransforms>();
        commands.init_resource::<EguiRenderData>();
        commands.insert_resource(Drawn);
    }
    commands.insert_resource(ExtractedEguiManagedTextures::extract_resource(&managed));
    commands.insert_resource(EguiUserTextures::extract_resource(&user));
}

/// Nothing is open any more: lets buffers and groups go.
fn put_away(mut commands: Commands, main: Res<MainWorld>) {
    if runs(main) {
        return;
    }
    commands.remove_resource::<EguiRenderData>();
    commands.remove_resource::<EguiTransforms>();
    commands.remove_resource::<EguiTextureBindGroups>();
    commands.remove_resource::<EguiPipelines>();
    commands.remove_resource::<ExtractedEguiManagedTextures>();
    commands.remove_resource::<EguiUserTextures>();
    commands.remove_resource::<Drawn>();
}
