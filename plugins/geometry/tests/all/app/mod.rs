//! An app that renders without a window, and pictures of what its cameras see.

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

/// Adds Bevy's plugins without a window; a pipeline is there in the frame that first needs it.
pub fn bevys(app: &mut App) {
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
    app.add_plugins(plugins)
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO))
        .insert_resource(ClearColor(Color::BLACK));
}

/// An app to which `add` adds plugins, Bevy's among them; `None`, after a line that says so, without Vulkan; in
/// CI that fails.
pub fn app(add: impl FnOnce(&mut App)) -> Option<App> {
    dolomite_testkit::gpu::for_test()?;
    let mut app = App::new();
    add(&mut app);
    app.finish();
    app.cleanup();
    Some(app)
}

/// A target of cameras.
pub fn target(app: &mut App, [width, height]: [u32; 2]) -> Handle<Image> {
    let image = Image::new_target_texture(width, height, TextureFormat::Rgba8UnormSrgb, None);
    app.world_mut().resource_mut::<Assets<Image>>().add(image)
}

/// Gives all cameras the target.
pub fn retarget(app: &mut App, target: &Handle<Image>) {
    let world = app.world_mut();
    let mut cameras = world.query_filtered::<Entity, With<Camera>>();
    for camera in cameras.iter(world).collect::<Vec<_>>() {
        let target = RenderTarget::Image(target.clone().into());
        world.entity_mut(camera).insert(target);
    }
}

/// Some frames.
pub fn frames(app: &mut App, count: usize) {
    for _ in 0..count {
        app.update();
        assert_eq!(app.should_exit(), None, "rendering stopped");
        // Shader files come from a thread of their own.
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[derive(Resource, Default)]
struct Captured(Option<Image>);

/// What the cameras of a target see.
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

/// How many pixels of columns `from` to `to` are as `is` says of their linear colour.
pub fn count(image: &Image, from: u32, to: u32, is: impl Fn(LinearRgba) -> bool) -> usize {
    let pixels = (0..image.height()).flat_map(|y| (from..to).map(move |x| (x, y)));
    let seen = pixels.filter(|(x, y)| image.get_color_at(*x, *y).is_ok_and(|c| is(c.to_linear())));
    seen.count()
}

/// Writes a picture of a README, where `DOLOMITE_PICTURES` is set.
pub fn keep(image: Image, path: &str) {
    if std::env::var_os("DOLOMITE_PICTURES").is_some() {
        let picture = image.try_into_dynamic().expect("an 8-bit picture");
        picture.into_rgb8().save(path).expect("written");
    }
}
