//! Buffers of a ground and of a view, and layouts of what the passes bind.

use crate::gpu::Gpu;
use bytemuck::{bytes_of, cast_slice};
use dolomite_ground::blocks::layout::{
    ARGUMENT_BYTES, Beginning, BlockNumbers, COUNT_WORDS, HEAD_BYTES, LOOKED_BYTES, RECORD_WORDS,
    SAMPLE_BYTES, SEEN_BYTES, STOCK_HEAD_BYTES, Second, list_words, made_at,
};
use dolomite_ground::detail::layout::DetailParams;
use dolomite_terrain::Terrain;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    BindGroup, BindGroupLayout, BindGroupLayoutEntry, BindingType, Buffer, BufferBindingType,
    BufferUsages, ShaderStages,
};

const UNIFORM: BufferBindingType = BufferBindingType::Uniform;
const READ: BufferBindingType = BufferBindingType::Storage { read_only: true };
const WRITE: BufferBindingType = BufferBindingType::Storage { read_only: false };

pub(super) fn layout(gpu: &Gpu, types: &[(u32, BufferBindingType)]) -> BindGroupLayout {
    let entries: Vec<_> = types
        .iter()
        .map(|&(binding, ty)| BindGroupLayoutEntry {
            binding,
            visibility: ShaderStages::COMPUTE,
            ty: BindingType::Buffer {
                ty,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        })
        .collect();
    let descriptor = wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &entries,
    };
    gpu.device().create_bind_group_layout(&descriptor)
}

pub(super) fn group(gpu: &Gpu, layout: &BindGroupLayout, buffers: &[(u32, &Buffer)]) -> BindGroup {
    let entries: Vec<_> = buffers
        .iter()
        .map(|&(binding, buffer)| wgpu::BindGroupEntry {
            binding,
            resource: buffer.as_entire_binding(),
        })
        .collect();
    gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &entries,
    })
}

/// Of what all passes share, and of each [`Second`].
pub(super) struct Layouts {
    pub shared: BindGroupLayout,
    pub looked: BindGroupLayout,
    pub arguments: BindGroupLayout,
    pub triangles: BindGroupLayout,
    pub ground: BindGroupLayout,
    pub head: BindGroupLayout,
}

impl Layouts {
    pub fn new(gpu: &Gpu) -> Self {
        let write = |bindings: &[u32]| bindings.iter().map(|&k| (k, WRITE)).collect::<Vec<_>>();
        let uniforms = [(0, UNIFORM), (1, UNIFORM)];
        Self {
            shared: layout(gpu, &[&uniforms[..], &write(&[2, 3, 4, 5, 6])].concat()),
            looked: layout(gpu, &write(&[0])),
            arguments: layout(gpu, &write(&[0, 1, 2])),
            triangles: layout(gpu, &write(&[0, 1])),
            ground: layout(gpu, &[(0, READ), (1, READ), (2, UNIFORM), (3, WRITE)]),
            head: layout(gpu, &write(&[0, 2])),
        }
    }

    pub const fn of(&self, second: Second) -> Option<&BindGroupLayout> {
        match second {
            Second::Nothing => None,
            Second::Looked => Some(&self.looked),
            Second::Arguments => Some(&self.arguments),
            Second::Triangles => Some(&self.triangles),
            Second::Ground => Some(&self.ground),
            Second::Head => Some(&self.head),
        }
    }
}

/// What the height function reads: layers, data, uniform.
pub(super) fn data_of(gpu: &Gpu, terrain: &Terrain) -> [Buffer; 3] {
    let filled = |contents: &[u8], usage| {
        gpu.device().create_buffer_init(&BufferInitDescriptor {
            label: None,
            contents,
            usage: usage | BufferUsages::COPY_DST,
        })
    };
    let mut given = terrain.gpu();
    if given.data.is_empty() {
        given.data.push(0);
    }
    [
        filled(cast_slice(&given.layers), BufferUsages::STORAGE),
        filled(cast_slice(&given.data), BufferUsages::STORAGE),
        filled(bytes_of(&given.uniform), BufferUsages::UNIFORM),
    ]
}

/// What stays from choice to choice.
pub(super) struct Buffers {
    pub params: Buffer,
    pub numbers: Buffer,
    pub records: Buffer,
    pub heads: Buffer,
    pub seen: Buffer,
    pub counts: Buffer,
    pub lists: Buffer,
    pub stock: Buffer,
    pub looked: Buffer,
    pub arguments: Buffer,
    pub samples: Buffer,
    /// Layers, data, uniform.
    pub terrain: [Buffer; 3],
}

impl Buffers {
    pub fn new(gpu: &Gpu, terrain: &Terrain, beginning: &Beginning, slots: u32) -> Self {
        let device = gpu.device();
        let empty = |size: u64| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size,
                usage: BufferUsages::STORAGE
                    | BufferUsages::COPY_DST
                    | BufferUsages::COPY_SRC
                    | BufferUsages::INDIRECT,
                mapped_at_creation: false,
            })
        };
        let uniform = |size: usize| {
            device.create_buffer_init(&BufferInitDescriptor {
                label: None,
                contents: &vec![0; size],
                usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            })
        };
        let room = u64::from(slots);
        let buffers = Self {
            params: uniform(size_of::<DetailParams>()),
            numbers: uniform(size_of::<BlockNumbers>()),
            records: empty(4 * RECORD_WORDS as u64 * room),
            heads: empty(HEAD_BYTES * room),
            seen: empty(SEEN_BYTES * room),
            counts: empty(4 * COUNT_WORDS as u64),
            lists: empty(4 * list_words(slots)),
            stock: empty(STOCK_HEAD_BYTES + 4 * room),
            looked: empty(LOOKED_BYTES),
            arguments: empty(ARGUMENT_BYTES),
            samples: empty(SAMPLE_BYTES),
            terrain: data_of(gpu, terrain),
        };
        let queue = gpu.queue();
        queue.write_buffer(&buffers.heads, 0, cast_slice(&beginning.heads));
        queue.write_buffer(&buffers.stock, 0, cast_slice(&beginning.stock()));
        queue.write_buffer(
            &buffers.lists,
            4 * made_at(slots),
            cast_slice(&beginning.made),
        );
        buffers
    }

    pub fn shared(&self) -> [(u32, &Buffer); 7] {
        [
            (0, &self.params),
            (1, &self.numbers),
            (2, &self.records),
            (3, &self.heads),
            (4, &self.seen),
            (5, &self.counts),
            (6, &self.lists),
        ]
    }
}
