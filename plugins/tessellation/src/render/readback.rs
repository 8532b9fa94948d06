//! Counters that the GPU writes, fetched without waiting.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use bevy::render::render_resource::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoder, MapMode,
};
use bevy::render::renderer::RenderDevice;
use bytemuck::Pod;

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
            label: Some("stage_counters"),
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

    /// Takes counters that are known already.
    pub fn set(&mut self, newest: T) {
        self.newest = newest;
        self.wanted = false;
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
