//! An app that draws into an image without a window, and what is in the image.

use std::time::Duration;

use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::error_handler::RenderErrorHandler;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::{PipelineCache, PipelineDescriptor, PollType, TextureFormat};
use bevy::render::renderer::RenderDevice;
use bevy::render::settings::{Backends, WgpuSettings};
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::render::{RenderApp, RenderPlugin};
use bevy::tasks::block_on;
use bevy::time::TimeUpdateStrategy;
use bevy::window::{ExitCondition, WindowPlugin};
use bevy::winit::WinitPlugin;

pub const WIDTH: u32 = 640;
pub const HEIGHT: u32 = 400;

#[derive(Resource, Default)]
struct Captured {
    image: Option<Image>,
    count: u32,
}

/// What is drawn into.
#[derive(Resource)]
pub struct Target(pub Handle<Image>);

fn adapter_is_there() -> bool {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::VULKAN;
    let instance = wgpu::Instance::new(descriptor);
    let Err(error) = block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
    else {
        return true;
    };
    assert!(
        std::env::var_os("CI").is_none(),
        "CI must not skip GPU tests: {error}"
    );
    eprintln!("skipped, no Vulkan device: {error}");
    false
}

/// Bevy's plugins, without the inspector, and a [`Target`]. The caller finishes it. `None` without a device.
pub fn app() -> Option<App> {
    if !adapter_is_there() {
        return None;
    }
    let mut app = App::new();
    let settings = WgpuSettings {
        backends: Some(Backends::VULKAN),
        ..default()
    };
    app.add_plugins(
        DefaultPlugins
            .build()
            .set(WindowPlugin {
                primary_window: None,
                exit_condition: ExitCondition::DontExit,
                ..default()
            })
            .set(RenderPlugin {
                render_creation: settings.into(),
                synchronous_pipeline_compilation: true,
                ..default()
            })
            .disable::<LogPlugin>()
            .disable::<WinitPlugin>()
            .disable::<PipelinedRenderingPlugin>(),
    )
    .insert_resource(RenderErrorHandler(|error, _, _| {
        panic!("{}", error.description)
    }))
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(
        16,
    )))
    .init_resource::<Captured>();
    let image = Image::new_target_texture(WIDTH, HEIGHT, TextureFormat::Rgba8UnormSrgb, None);
    let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
    app.insert_resource(Target(image));
    Some(app)
}

/// Draws frames, each to its end.
pub fn frames(app: &mut App, count: u32) {
    for _ in 0..count {
        app.update();
        assert_eq!(app.should_exit(), None, "rendering stopped");
        let device = app.world().resource::<RenderDevice>();
        device.poll(PollType::wait_indefinitely()).expect("drawn");
    }
}

/// The pixels of the next frame. With `DOLOMITE_PICTURES` pictures are kept in that folder.
pub fn picture(app: &mut App) -> Vec<[u8; 4]> {
    let target = app.world().resource::<Target>().0.clone();
    app.world_mut().spawn(Screenshot::image(target)).observe(
        |shot: On<ScreenshotCaptured>, mut captured: ResMut<Captured>| {
            captured.image = Some(shot.image.clone());
            captured.count += 1;
        },
    );
    for _ in 0..60 {
        frames(app, 1);
        let mut captured = app.world_mut().resource_mut::<Captured>();
        let Some(image) = captured.image.take() else {
            continue;
        };
        let bytes = image.data.expect("it was read back");
        if let Some(folder) = std::env::var_os("DOLOMITE_PICTURES") {
            let test = std::thread::current()
                .name()
                .unwrap_or_default()
                .replace("::", "-");
            let name = format!("inspector-{test}-{}.ppm", captured.count);
            let mut file = format!("P6 {WIDTH} {HEIGHT} 255\n").into_bytes();
            file.extend(bytes.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]));
            std::fs::write(std::path::Path::new(&folder).join(name), file)
                .expect("the folder can be written");
        }
        let pixels = bytes.chunks_exact(4);
        return pixels.map(|p| [p[0], p[1], p[2], p[3]]).collect();
    }
    panic!("no picture");
}

/// How many render pipelines there are of a label.
pub fn pipelines(app: &App, label: &str) -> usize {
    let cache = app.sub_app(RenderApp).world().resource::<PipelineCache>();
    cache
        .pipelines()
        .filter(|pipeline| match &pipeline.descriptor {
            PipelineDescriptor::RenderPipelineDescriptor(descriptor) => {
                descriptor.label.as_deref() == Some(label)
            }
            PipelineDescriptor::ComputePipelineDescriptor(_) => false,
        })
        .count()
}

/// How many pixels two pictures have that differ.
pub fn differing(a: &[[u8; 4]], b: &[[u8; 4]]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}
