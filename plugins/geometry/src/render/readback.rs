//! Counters that the GPU writes, fetched without waiting.

use bevy::render::render_resource::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoder, MapMode,
};
use bevy::render::renderer::RenderDevice;
use bytemuck::Pod;

use crate::ring::{Ring, Staging};

/// A staging buffer of a [`Ring`].
pub struct Mapped(Buffer);

impl Mapped {
    /// One of so many bytes.
    #[must_use]
    pub fn new(device: &RenderDevice, label: &str, size: u64) -> Self {
        Self(device.create_buffer(&BufferDescriptor {
            label: Some(label),
            size,
            usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        }))
    }

    /// What is copied into.
    #[must_use]
    pub const fn buffer(&self) -> &Buffer {
        &self.0
    }
}

impl Staging for Mapped {
    fn bytes(&self) -> u64 {
        self.0.size()
    }

    fn map(&self, bytes: u64, done: Box<dyn FnOnce(bool) + Send>) {
        let slice = self.0.slice(..bytes);
        slice.map_async(MapMode::Read, move |mapped| done(mapped.is_ok()));
    }

    fn take(&self, bytes: u64, read: &mut dyn FnMut(&[u8])) {
        read(&self.0.slice(..bytes).get_mapped_range());
        self.0.unmap();
    }
}

/// A record at the beginning of a buffer, on its way back from the GPU.
pub struct Counters<T> {
    ring: Ring<Mapped, ()>,
    wanted: bool,
    /// What arrived last.
    pub newest: T,
}

impl<T: Pod> Default for Counters<T> {
    fn default() -> Self {
        Self {
            ring: Ring::default(),
            wanted: false,
            newest: T::zeroed(),
        }
    }
}

impl<T: Pod> Counters<T> {
    const BYTES: u64 = size_of::<T>() as u64;

    /// Takes counters that are known already; those under way are older.
    pub fn set(&mut self, newest: T) {
        self.newest = newest;
        self.wanted = false;
        self.ring.forget();
    }

    /// Asks for a copy of the counters as soon as a staging buffer is free.
    pub fn want(&mut self) {
        self.wanted = true;
    }

    /// Whether a copy is wanted.
    #[must_use]
    pub const fn is_wanted(&self) -> bool {
        self.wanted
    }

    /// Whether [`Self::newest`] is of what was made last: nothing is wanted and nothing is under way.
    #[must_use]
    pub fn is_current(&self) -> bool {
        !self.wanted && !self.ring.under_way()
    }

    /// Records the copy, where one is wanted and a buffer is free.
    pub fn copy(&mut self, device: &RenderDevice, encoder: &mut CommandEncoder, from: &Buffer) {
        let make = || Mapped::new(device, "geometry_counters", Self::BYTES);
        if !(self.wanted && self.ring.begin(Self::BYTES, (), make)) {
            return;
        }
        if let Some((staging, bytes, ())) = self.ring.begun() {
            encoder.copy_buffer_to_buffer(from, 0, staging.buffer(), 0, Some(bytes));
        }
        self.ring.copied();
        self.wanted = false;
    }

    /// After the submit: starts mappings, and takes what has arrived.
    pub fn advance(&mut self) {
        let newest = &mut self.newest;
        self.ring
            .take_arrived(|(), bytes| *newest = bytemuck::pod_read_unaligned(bytes));
        self.ring.map();
    }

    /// Bytes of the staging buffers.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.ring.buffers() as u64 * Self::BYTES
    }
}
