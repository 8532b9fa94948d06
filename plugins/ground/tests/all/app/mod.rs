//! An app that renders without a window, and pictures of what its cameras see.

#[cfg(feature = "render")]
pub mod seen;

use std::time::Duration;

use bevy::camera::RenderTarget;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::TextureFormat;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::time::TimeUpdateStrategy;
use bevy::window::{ExitCondition, WindowPlugin};
use bevy::winit::WinitPlugin;
use dolomite_geometry::GeometryStats;
use dolomite_ground::GroundPlugin;
use dolomite_ground::detail::MakingBudget;

/// Bevy's plugins and the ground's; `None`, after a line that says so, without Vulkan; in CI that fails.
pub fn app() -> Option<App> {
    dolomite_testkit::gpu::for_test()?;
    let mut app = App::new();
    let plugins = DefaultPlugins
        .build()
        .set(WindowPlugin {
            primary_window: None,
            exit_condition: ExitCondition::DontExit,
            ..default()
        })
        .set(RenderPlugin {
            synchronous_pipeline_compilation: true,
            ..default()
        })
        .disable::<LogPlugin>()
        .disable::<WinitPlugin>()
        .disable::<PipelinedRenderingPlugin>();
    let relief_side = 64;
    app.add_plugins((plugins, GroundPlugin { relief_side }))
        // All that a view asks for is made in the frame that asks.
        .insert_resource(MakingBudget {
            blocks: Some(u32::MAX),
        })
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO))
        .insert_resource(ClearColor(Color::BLACK));
    app.finish();
    app.cleanup();
    Some(app)
}

/// A target of a camera.
pub fn target(app: &mut App, width: u32, height: u32) -> Handle<Image> {
    let image = Image::new_target_texture(width, height, TextureFormat::Rgba8UnormSrgb, None);
    app.world_mut().resource_mut::<Assets<Image>>().add(image)
}

/// A camera that draws there.
pub fn camera(app: &mut App, target: &Handle<Image>, components: impl Bundle) -> Entity {
    let target = RenderTarget::Image(target.clone().into());
    let camera = (Camera3d::default(), Msaa::Off, target, components);
    app.world_mut().spawn(camera).id()
}

/// Some frames.
pub fn frames(app: &mut App, count: usize) {
    for _ in 0..count {
        app.update();
        assert_eq!(app.should_exit(), None, "rendering stopped");
    }
}

/// Bytes of buffers that all views share, and of each view.
pub fn bytes(app: &App) -> (u64, Vec<u64>) {
    let pools = &app.world().resource::<GeometryStats>().pools;
    let of = |shared: bool| {
        let pools = pools.iter();
        pools.filter(move |pool| pool.camera.is_none() == shared)
    };
    (
        of(true).map(|pool| pool.allocated).sum(),
        of(false).map(|pool| pool.allocated).collect(),
    )
}

#[derive(Resource, Default)]
struct Captured(Option<Image>);

/// What the camera of a target sees.
pub fn picture(app: &mut App, target: &Handle<Image>) -> Image {
    app.init_resource::<Captured>();
    app.world_mut()
        .spawn(Screenshot::image(target.clone()))
        .observe(
            |shot: On<ScreenshotCaptured>, mut captured: ResMut<Captured>| {
                captured.0 = Some(shot.image.clone());
            },
        );
    for _ in 0..200 {
        app.update();
        if let Some(image) = app.world_mut().resource_mut::<Captured>().0.take() {
            return image;
        }
    }
    panic!("no picture came back");
}
