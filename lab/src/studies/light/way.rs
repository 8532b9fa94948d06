//! One way of lighting in an app: its frame, and its time.

use std::time::Instant;

use bevy::prelude::*;
use bevy::render::renderer::RenderAdapterInfo;
use dolomite_deferred::{DeferredLighting, DeferredStats, Way};
use dolomite_testkit::cores::processor_time;
use dolomite_testkit::light::{self, Spawned, Unlit};

/// Who lights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lit {
    /// Bevy's own pass.
    Bevy,
    /// Ours.
    Ours(Way),
    /// Nobody.
    Nobody,
}

/// All that are compared.
pub const LITS: [Lit; 5] = [
    Lit::Ours(Way::BruteForce),
    Lit::Ours(Way::Tiled),
    Lit::Ours(Way::Volumes),
    Lit::Ours(Way::Auto),
    Lit::Bevy,
];

impl Lit {
    /// As the report has it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bevy => "bevy",
            Self::Nobody => "nobody",
            Self::Ours(Way::BruteForce) => "brute force",
            Self::Ours(Way::Tiled) => "tiled",
            Self::Ours(Way::Volumes) => "volumes",
            Self::Ours(Way::Auto) => "auto",
        }
    }

    /// Of ours.
    #[must_use]
    pub const fn way(self) -> Option<Way> {
        match self {
            Self::Ours(way) => Some(way),
            Self::Bevy | Self::Nobody => None,
        }
    }
}

/// A frame.
pub struct Measured {
    /// Who lit it.
    pub lit: Lit,
    /// Linear radiance, rows from the top.
    pub pixels: Vec<[f32; 4]>,
    /// Passes of ours; 1 of Bevy's.
    pub passes: u32,
    /// Bytes of ours.
    pub bytes: u64,
}

fn set(app: &mut App, camera: Entity, lit: Lit) {
    app.insert_resource(Unlit(lit == Lit::Nobody));
    let mut camera = app.world_mut().entity_mut(camera);
    match lit.way() {
        Some(way) => camera.insert(DeferredLighting { way }),
        None => camera.remove::<DeferredLighting>(),
    };
}

/// What the camera sees.
pub fn frame(app: &mut App, camera: Entity, lit: Lit) -> Measured {
    set(app, camera, lit);
    let picture = light::picture(app, camera, 4);
    let views = app.world().resource::<DeferredStats>().views();
    let (passes, bytes) = views
        .first()
        .map_or((1, 0), |view| (view.passes, view.bytes));
    Measured {
        lit,
        pixels: picture.pixels,
        passes,
        bytes,
    }
}

/// Medians, milliseconds.
pub struct Times {
    /// Of lighting, in the order of [`LITS`].
    lit: Vec<f64>,
    /// Of a frame that nobody lights.
    pub unlit: f64,
    /// What it ran on.
    pub device: String,
}

impl Times {
    /// Of lighting a frame: whole frames less one that nobody lights.
    #[must_use]
    pub fn of(&self, lit: Lit) -> f64 {
        let at = LITS.iter().position(|other| *other == lit);
        at.and_then(|at| self.lit.get(at))
            .copied()
            .unwrap_or(f64::NAN)
    }
}

/// The ways take turns, so that what else the machine does meets all of them.
pub fn times(app: &mut App, camera: Entity, repeats: usize) -> Times {
    let all: Vec<Lit> = LITS.iter().copied().chain([Lit::Nobody]).collect();
    let medians = turns(app, camera, &all, repeats);
    let unlit = medians.last().copied().unwrap_or(f64::NAN);
    let info = app.world().resource::<RenderAdapterInfo>();
    Times {
        lit: medians[..LITS.len()].iter().map(|ms| ms - unlit).collect(),
        unlit,
        device: format!("{} ({} {})", info.name, info.driver, info.driver_info),
    }
}

/// Medians of the time of a frame by each, milliseconds. Where the adapter is a program on the processor it is the
/// processor's time of all threads, so that what else the machine does counts little.
pub fn turns(app: &mut App, camera: Entity, all: &[Lit], repeats: usize) -> Vec<f64> {
    let info = app.world().resource::<RenderAdapterInfo>();
    let software = info.device_type == wgpu::DeviceType::Cpu;
    let mut taken = vec![Vec::new(); all.len()];
    for _ in 0..repeats.max(1) {
        for (lit, taken) in all.iter().zip(&mut taken) {
            set(app, camera, *lit);
            // What is made for a way is made in these; its pipelines are there in the third frame.
            light::frames(app, 3);
            let start = Instant::now();
            let before = processor_time(start);
            light::frames(app, 1);
            let time = if software {
                processor_time(start) - before
            } else {
                start.elapsed()
            };
            taken.push(time.as_secs_f64() * 1e3);
        }
    }
    taken
        .iter_mut()
        .map(|times| {
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        })
        .collect()
}

/// The largest relative difference of two frames; below `floor` it counts as that.
#[must_use]
pub fn apart(a: &[[f32; 4]], b: &[[f32; 4]], floor: f32) -> f32 {
    let channels = a.iter().zip(b).flat_map(|(a, b)| a.iter().zip(b).take(3));
    channels
        .map(|(a, b)| (a - b).abs() / a.abs().max(b.abs()).max(floor))
        .fold(0.0, f32::max)
}

/// Takes a scene away.
pub fn despawn(app: &mut App, spawned: Spawned) {
    for entity in spawned.others.into_iter().chain([spawned.camera]) {
        app.world_mut().despawn(entity);
    }
}
