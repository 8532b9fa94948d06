//! Counters that the GPU writes, fetched without waiting, and their way to the main world.

use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::prelude::*;
use bevy::render::render_resource::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoder, MapMode,
};
use bevy::render::renderer::RenderDevice;
use bytemuck::Pod;

use super::prepare::TerrainViews;
use crate::stats::TessellationStats;

/// Paths of the diagnostics, in the order of [`values`].
const PATHS: [&str; 6] = [
    "dolomite/tessellation/triangles",
    "dolomite/tessellation/vertices",
    "dolomite/tessellation/patches_drawn",
    "dolomite/tessellation/patches_culled",
    "dolomite/tessellation/dispatches",
    "dolomite/tessellation/bytes",
];

fn values(stats: &TessellationStats) -> [f64; 6] {
    [
        f64::from(stats.triangles),
        f64::from(stats.vertices),
        f64::from(stats.patches_drawn),
        f64::from(stats.patches_culled),
        f64::from(stats.dispatches),
        stats.bytes as f64,
    ]
}

/// Registers the diagnostics.
pub fn register(app: &mut App) {
    for path in PATHS {
        app.register_diagnostic(Diagnostic::new(DiagnosticPath::const_new(path)));
    }
}

/// The newest counters, shared by both worlds.
#[derive(Resource, Clone, Default)]
pub struct SharedStats(Arc<Mutex<Shared>>);

#[derive(Default)]
struct Shared {
    newest: TessellationStats,
    /// Dispatches of the frame being recorded.
    dispatches: u32,
}

impl SharedStats {
    fn with<T>(&self, f: impl FnOnce(&mut Shared) -> T) -> T {
        // The counters are plain numbers: a panic elsewhere cannot leave them half-written.
        f(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Adds to this frame's dispatches.
    pub fn count_dispatches(&self, count: u32) {
        self.with(|shared| shared.dispatches += count);
    }
}

/// Main world: takes the newest counters over and publishes them.
pub fn publish(
    shared: Res<SharedStats>,
    mut stats: ResMut<TessellationStats>,
    mut diagnostics: Diagnostics,
) {
    let newest = shared.with(|shared| shared.newest);
    stats.set_if_neq(newest);
    for (path, value) in PATHS.into_iter().zip(values(&newest)) {
        diagnostics.add_measurement(&DiagnosticPath::const_new(path), || value);
    }
}

const IDLE: u8 = 0;
const COPIED: u8 = 1;
const MAPPING: u8 = 2;
const READY: u8 = 3;
const FAILED: u8 = 4;

/// One view's counters on their way back from the GPU.
pub struct Counters<T> {
    staging: Buffer,
    state: Arc<AtomicU8>,
    wanted: bool,
    /// What arrived last.
    pub newest: T,
}

impl<T: Pod> Counters<T> {
    pub fn new(device: &RenderDevice) -> Self {
        let staging = device.create_buffer(&BufferDescriptor {
            label: Some("terrain_counters"),
            size: size_of::<T>() as u64,
            usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self {
            staging,
            state: Arc::default(),
            wanted: false,
            newest: T::zeroed(),
        }
    }

    /// Asks for a copy of the counters as soon as the staging buffer is free.
    pub fn want(&mut self) {
        self.wanted = true;
    }

    /// Whether a copy is wanted and possible.
    pub fn is_waiting(&self) -> bool {
        self.wanted && self.state.load(Ordering::Acquire) == IDLE
    }

    /// Records the copy.
    pub fn copy(&mut self, encoder: &mut CommandEncoder, result: &Buffer) {
        encoder.copy_buffer_to_buffer(result, 0, &self.staging, 0, Some(self.staging.size()));
        self.wanted = false;
        self.state.store(COPIED, Ordering::Release);
    }

    /// After the submit: starts the mapping, or reads what has arrived.
    pub fn advance(&mut self) {
        match self.state.load(Ordering::Acquire) {
            COPIED => {
                self.state.store(MAPPING, Ordering::Release);
                let state = self.state.clone();
                self.staging
                    .slice(..)
                    .map_async(MapMode::Read, move |mapped| {
                        state.store(
                            if mapped.is_ok() { READY } else { FAILED },
                            Ordering::Release,
                        );
                    });
            }
            READY => {
                let bytes = self.staging.slice(..).get_mapped_range();
                self.newest = bytemuck::pod_read_unaligned(&bytes);
                drop(bytes);
                self.staging.unmap();
                self.state.store(IDLE, Ordering::Release);
            }
            FAILED => self.state.store(IDLE, Ordering::Release),
            _ => {}
        }
    }
}

/// Render world, after the submit: sums the counters of all views.
pub fn collect(mut views: ResMut<TerrainViews>, shared: Res<SharedStats>) {
    let mut sum = TessellationStats::default();
    for state in views.0.values_mut() {
        state.counters.advance();
        let newest = state.counters.newest;
        sum.triangles += newest.triangles;
        sum.vertices += newest.vertices;
        sum.patches_drawn += newest.drawn;
        sum.patches_culled += newest.culled;
        sum.lowered = sum.lowered.max(newest.lowered);
    }
    sum.bytes = u64::from(sum.vertices) * 16 + u64::from(sum.triangles) * 12;
    shared.with(|shared| {
        sum.dispatches = std::mem::take(&mut shared.dispatches);
        shared.newest = sum;
    });
}
