//! An app that renders without a window, and the radiance that its camera sees in f32.

use std::time::Duration;

use bevy::camera::RenderTarget;
use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::core_pipeline::tonemapping::{DebandDither, Tonemapping};
use bevy::log::LogPlugin;
use bevy::pbr::DefaultOpaqueRendererMethod;
use bevy::prelude::*;
use bevy::render::gpu_readback::{Readback, ReadbackComplete};
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::{
    CachedPipelineState, PipelineCache, PollType, TextureFormat, TextureUsages,
};
use bevy::render::renderer::RenderDevice;
use bevy::render::{RenderApp, RenderPlugin};
use bevy::time::TimeUpdateStrategy;
use bevy::window::{ExitCondition, WindowPlugin};
use bevy::winit::WinitPlugin;
use dolomite_deferred::{DeferredLighting, DeferredPlugin, Way};

/// Every way.
pub const WAYS: [Way; 3] = [Way::BruteForce, Way::Tiled, Way::Volumes];

/// Bevy's plugins without a window, and ours; everything is deferred. `None`, after a line that says so, without
/// Vulkan; in CI that fails.
pub fn app(with_plugin: bool) -> Option<App> {
    app_with(|app| {
        if with_plugin {
            app.add_plugins(DeferredPlugin);
        }
    })
}

/// The same with what `add` adds.
pub fn app_with(add: impl FnOnce(&mut App)) -> Option<App> {
    let renderer = RenderPlugin {
        synchronous_pipeline_compilation: true,
        ..default()
    };
    app_by(renderer, add)
}

/// The same by a renderer of its own: one that compiles while frames are drawn, or has less than the adapter gives.
pub fn app_by(renderer: RenderPlugin, add: impl FnOnce(&mut App)) -> Option<App> {
    crate::gpu::for_test()?;
    let mut app = App::new();
    let plugins = DefaultPlugins
        .build()
        .set(WindowPlugin {
            primary_window: None,
            exit_condition: ExitCondition::DontExit,
            ..default()
        })
        .set(renderer)
        .disable::<LogPlugin>()
        .disable::<WinitPlugin>()
        .disable::<PipelinedRenderingPlugin>();
    app.add_plugins(plugins)
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO))
        .insert_resource(DefaultOpaqueRendererMethod::deferred())
        .insert_resource(GlobalAmbientLight::NONE)
        .insert_resource(ClearColor(Color::BLACK));
    add(&mut app);
    app.finish();
    app.cleanup();
    Some(app)
}

/// What a camera sees, rows from the top.
pub struct Picture {
    /// Pixels in a row.
    pub width: u32,
    /// Linear radiance.
    pub pixels: Vec<[f32; 4]>,
}

impl Picture {
    /// Pixels that are no number, or infinite.
    pub fn nonsense(&self) -> usize {
        let bad = |pixel: &&[f32; 4]| pixel.iter().any(|channel| !channel.is_finite());
        self.pixels.iter().filter(bad).count()
    }

    /// The largest difference of two channels, relative to the larger one; differences below `floor` count as
    /// those of `floor`.
    pub fn relative_difference(&self, other: &Self, floor: f32) -> f32 {
        assert_eq!(self.pixels.len(), other.pixels.len());
        let mut worst = 0.0_f32;
        for (a, b) in self.pixels.iter().zip(&other.pixels) {
            for (a, b) in a.iter().zip(b).take(3) {
                worst = worst.max((a - b).abs() / a.abs().max(b.abs()).max(floor));
            }
        }
        worst
    }

    /// The greatest channel.
    pub fn brightest(&self) -> f32 {
        let all = self.pixels.iter().flat_map(|pixel| &pixel[..3]);
        all.copied().fold(0.0, f32::max)
    }

    /// Pixels of any light.
    pub fn lit(&self) -> usize {
        let lit = |pixel: &&[f32; 4]| pixel[..3].iter().any(|channel| *channel > 0.0);
        self.pixels.iter().filter(lit).count()
    }
}

/// The target of a camera.
#[derive(Component, Clone)]
pub struct Target(Handle<Image>, UVec2);

/// A camera that draws to a target of 32-bit floats, without tone mapping; exposure does not change a value.
pub fn camera(app: &mut App, size: [u32; 2], at: Transform, components: impl Bundle) -> Entity {
    let mut image = Image::new_target_texture(size[0], size[1], TextureFormat::Rgba32Float, None);
    image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
    let camera = (
        Camera3d::default(),
        Msaa::Off,
        (DepthPrepass, DeferredPrepass),
        // Even no tone mapping at all dithers by default.
        (Tonemapping::None, DebandDither::Disabled),
        bevy::camera::Exposure {
            // 2^-EV100 / 1.2 is 1.
            ev100: -bevy::math::ops::log2(1.2),
        },
        RenderTarget::Image(image.clone().into()),
        Target(image, size.into()),
        at,
    );
    let entity = app.world_mut().spawn(camera).id();
    app.world_mut().entity_mut(entity).insert(components);
    entity
}

/// Some frames.
pub fn frames(app: &mut App, count: usize) {
    for _ in 0..count {
        app.update();
        assert_eq!(app.should_exit(), None, "rendering stopped");
        let device = app.world().resource::<RenderDevice>();
        device.poll(PollType::wait_indefinitely()).expect("drawn");
        let Some(render) = app.get_sub_app(RenderApp) else {
            continue;
        };
        for pipeline in render.world().resource::<PipelineCache>().pipelines() {
            // Files of shaders come from a thread of their own; all else is a mistake.
            if let CachedPipelineState::Err(error) = &pipeline.state {
                let error = error.to_string();
                let waits = ["not yet available", "could not be loaded"];
                assert!(waits.iter().any(|wait| error.contains(wait)), "{error}");
            }
        }
    }
}

#[derive(Resource, Default)]
struct Read(Option<Vec<u8>>);

/// What the camera sees now, after `wait` frames for what changed.
pub fn picture(app: &mut App, camera: Entity, wait: usize) -> Picture {
    frames(app, wait);
    app.insert_resource(Read(None));
    let target = app.world().get::<Target>(camera).expect("ours").clone();
    let reader = app
        .world_mut()
        .spawn(Readback::texture(target.0))
        .observe(|read: On<ReadbackComplete>, mut all: ResMut<Read>| {
            all.0 = Some(read.data.clone());
        })
        .id();
    for _ in 0..20 {
        frames(app, 1);
        if let Some(bytes) = app.world_mut().resource_mut::<Read>().0.take() {
            app.world_mut().despawn(reader);
            let [width, height] = target.1.to_array();
            let row = (width as usize * 16).next_multiple_of(256);
            let row = if height == 1 {
                width as usize * 16
            } else {
                row
            };
            let mut pixels = Vec::new();
            for y in 0..height as usize {
                let line = &bytes[y * row..][..width as usize * 16];
                pixels.extend(bytemuck::pod_collect_to_vec::<u8, [f32; 4]>(line));
            }
            return Picture { width, pixels };
        }
    }
    panic!("no picture came back")
}

/// The same with the camera lit by `way`, or by Bevy.
pub fn lit_by(app: &mut App, camera: Entity, way: Option<Way>) -> Picture {
    match way {
        Some(way) => app
            .world_mut()
            .entity_mut(camera)
            .insert(DeferredLighting { way }),
        None => app
            .world_mut()
            .entity_mut(camera)
            .remove::<DeferredLighting>(),
    };
    picture(app, camera, 4)
}

/// Writes a picture for a person, where `DOLOMITE_PICTURES` is set: linear, gamma 2.2, cut off at `white`.
pub fn keep(picture: &Picture, white: f32, name: &str) {
    let Some(folder) = std::env::var_os("DOLOMITE_PICTURES") else {
        return;
    };
    let height = picture.pixels.len() as u32 / picture.width;
    let image = image::RgbImage::from_fn(picture.width, height, |x, y| {
        let pixel = picture.pixels[(y * picture.width + x) as usize];
        let byte =
            |c: f32| (bevy::math::ops::powf((c / white).clamp(0.0, 1.0), 1.0 / 2.2) * 255.0) as u8;
        image::Rgb([byte(pixel[0]), byte(pixel[1]), byte(pixel[2])])
    });
    let path = std::path::Path::new(&folder).join(format!("{name}.png"));
    image.save(path).expect("written");
}
