//! Frames with and without ambient occlusion, rays, and times.

use bevy::app::App;
use bevy::ecs::entity::Entity;
use bevy::pbr::ScreenSpaceAmbientOcclusion;
use bevy::render::renderer::RenderAdapterInfo;
use dolomite_deferred::occlusion::Settings;
use dolomite_deferred::{
    AmbientOcclusion, DeferredLighting, DeferredPlugin, OcclusionQuality, OcclusionResolution,
};
use dolomite_light_oracle::occlusion::Occlusion;
use dolomite_light_oracle::{Recipe, generate, per_pixel};
use dolomite_testkit::cores::processor_time;
use dolomite_testkit::light::occlusion::{Seen, in_ambient_light, shares};
use dolomite_testkit::light::{self, GBufferPlugin};
use std::collections::HashMap;
use std::time::Instant;

use crate::study::Options;

/// Of each pixel's truth.
pub const RAYS: u32 = 4096;

/// Scenes, where no `--count` says another number.
const SCENES: usize = 8;

/// Every quality.
pub const QUALITIES: [OcclusionQuality; 4] = [
    OcclusionQuality::Low,
    OcclusionQuality::Medium,
    OcclusionQuality::High,
    OcclusionQuality::Ultra,
];

/// Whose occlusion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    /// Ours.
    Ours(OcclusionQuality, OcclusionResolution),
    /// Bevy's, at its greatest number of samples; its radius is its own.
    Bevy,
    /// Ours on the CPU with more samples than a frame has time for.
    Limit,
    /// No occlusion: every pixel has all of the light.
    None,
}

impl Method {
    /// As the report has it.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Ours(quality, OcclusionResolution::Full) => format!("{quality:?}").to_lowercase(),
            Self::Ours(quality, OcclusionResolution::Half) => {
                format!("{quality:?} half").to_lowercase()
            }
            Self::Bevy => "bevy".into(),
            Self::Limit => "limit".into(),
            Self::None => "none".into(),
        }
    }
}

/// Of all pixels of all scenes.
#[derive(Debug, Clone, Copy)]
pub struct Error {
    /// Root mean square.
    pub rms: f64,
    /// Mean; above 0 it is too light.
    pub bias: f64,
    /// Of the absolute.
    pub p99: f64,
    /// Of the absolute.
    pub max: f64,
}

/// What was found.
pub struct Measured {
    errors: HashMap<(Method, usize), Error>,
    ms: HashMap<Method, f64>,
    /// How many.
    pub scenes: usize,
    /// What it ran on.
    pub device: String,
}

impl Measured {
    /// In the order of the report.
    pub fn methods(&self) -> impl Iterator<Item = Method> {
        all_of_ours().chain([Method::Bevy, Method::Limit, Method::None])
    }

    /// Of a method at a radius.
    #[must_use]
    pub fn error(&self, method: Method, radius: usize) -> Option<Error> {
        self.errors.get(&(method, radius)).copied()
    }

    /// Of one frame.
    #[must_use]
    pub fn ms(&self, method: Method) -> Option<f64> {
        self.ms.get(&method).copied()
    }
}

fn all_of_ours() -> impl Iterator<Item = Method> {
    [OcclusionResolution::Full, OcclusionResolution::Half]
        .into_iter()
        .flat_map(|resolution| QUALITIES.map(|quality| Method::Ours(quality, resolution)))
}

fn set(app: &mut App, camera: Entity, method: Method, radius: f32) {
    let mut camera = app.world_mut().entity_mut(camera);
    camera.remove::<(AmbientOcclusion, ScreenSpaceAmbientOcclusion)>();
    match method {
        Method::Ours(quality, resolution) => {
            camera.insert(AmbientOcclusion {
                radius,
                quality,
                resolution,
            });
        }
        Method::Bevy => {
            camera.insert(ScreenSpaceAmbientOcclusion {
                quality_level: bevy::pbr::ScreenSpaceAmbientOcclusionQualityLevel::Ultra,
                ..Default::default()
            });
        }
        Method::Limit | Method::None => {}
    }
}

fn error_of(mut errors: Vec<f64>) -> Option<Error> {
    let count = errors.len() as f64;
    let bias = errors.iter().sum::<f64>() / count;
    let rms = (errors.iter().map(|x| x * x).sum::<f64>() / count).sqrt();
    for error in &mut errors {
        *error = error.abs();
    }
    errors.sort_by(f64::total_cmp);
    Some(Error {
        rms,
        bias,
        p99: errors[errors.len() * 99 / 100],
        max: *errors.last()?,
    })
}

/// All of it; `None` without a device.
pub fn measure(options: &Options, radii: &[f32]) -> Option<Measured> {
    let mut app = light::app_with(|app| {
        app.add_plugins((DeferredPlugin, GBufferPlugin));
    })?;
    let info = app.world().resource::<RenderAdapterInfo>();
    let device = format!("{} ({} {})", info.name, info.driver, info.driver_info);
    let mut errors: HashMap<(Method, usize), Vec<f64>> = HashMap::new();
    let mut ms = HashMap::new();
    let scenes = options.count.unwrap_or(SCENES).max(1);
    for index in 0..scenes {
        eprintln!("scene {} of {scenes}", index + 1);
        let [width, height] = options.size;
        let scene = in_ambient_light(&generate(&Recipe {
            seed: u64::from(options.seed) + index as u64,
            width,
            height,
            ..Recipe::default()
        }));
        let spawned = light::spawn(&mut app, &scene, DeferredLighting::default());
        let without = light::picture(&mut app, spawned.camera, 4);
        let seen = Seen::new(&light::pixels(&app), &scene.camera);
        for (k, radius) in radii.iter().enumerate() {
            let truth = per_pixel::occlusions(
                &scene,
                &Occlusion {
                    rays: RAYS,
                    distance: f64::from(*radius),
                    ..Occlusion::default()
                },
            );
            let mut add = |method: Method, found: &[Option<f64>]| {
                let off = found
                    .iter()
                    .zip(&truth)
                    .filter_map(|(a, b)| Some((*a)? - (*b)?));
                errors.entry((method, k)).or_default().extend(off);
            };
            let limit = Settings {
                radius: *radius,
                slices: 24,
                steps: 24,
                thickness: *radius,
                most_pixels: width as f32,
            };
            let limit = seen.screen().shares(&limit, false);
            add(
                Method::Limit,
                &limit
                    .iter()
                    .map(|x| Some(f64::from(*x)))
                    .collect::<Vec<_>>(),
            );
            add(Method::None, &vec![Some(1.0); truth.len()]);
            for method in all_of_ours().chain([Method::Bevy]) {
                // Bevy's has one radius, which is the last one.
                if method == Method::Bevy && k + 1 < radii.len() {
                    continue;
                }
                set(&mut app, spawned.camera, method, *radius);
                let with = light::picture(&mut app, spawned.camera, 4);
                add(method, &shares(&with, &without));
            }
        }
        if index == 0 {
            ms = times(&mut app, spawned.camera, options.repeats);
        }
        app.world_mut().despawn(spawned.camera);
        for other in spawned.others {
            app.world_mut().despawn(other);
        }
    }
    let errors = errors.into_iter();
    Some(Measured {
        errors: errors
            .filter_map(|(key, errors)| Some((key, error_of(errors)?)))
            .collect(),
        ms,
        scenes,
        device,
    })
}

/// Medians over frames in turns, less a frame without occlusion, at half a metre.
fn times(app: &mut App, camera: Entity, repeats: usize) -> HashMap<Method, f64> {
    let info = app.world().resource::<RenderAdapterInfo>();
    let software = info.device_type == wgpu::DeviceType::Cpu;
    let methods: Vec<Method> = all_of_ours().chain([Method::Bevy, Method::None]).collect();
    let mut taken: HashMap<Method, Vec<f64>> = HashMap::new();
    for _ in 0..repeats.max(1) {
        for method in &methods {
            set(app, camera, *method, 0.5);
            light::frames(app, 3);
            let start = Instant::now();
            let before = processor_time(start);
            light::frames(app, 1);
            // Where the adapter is a program, the processor's time: what else the machine does counts little then.
            let time = if software {
                processor_time(start) - before
            } else {
                start.elapsed()
            };
            let all = taken.entry(*method).or_default();
            all.push(time.as_secs_f64() * 1e3);
        }
    }
    let median = |mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    };
    let all: HashMap<Method, f64> = taken.into_iter().map(|(m, t)| (m, median(t))).collect();
    let base = all.get(&Method::None).copied().unwrap_or(0.0);
    all.into_iter()
        .filter(|(method, _)| *method != Method::None)
        .map(|(method, ms)| (method, ms - base))
        .collect()
}
