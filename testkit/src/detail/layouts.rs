//! Layouts of what the passes bind, and groups of buffers.

use crate::gpu::Gpu;
use dolomite_ground::detail::layout::Second;
use wgpu::{
    BindGroup, BindGroupLayout, BindGroupLayoutEntry, BindingType, BufferBindingType, ShaderStages,
};

pub(super) const UNIFORM: BufferBindingType = BufferBindingType::Uniform;
pub(super) const READ: BufferBindingType = BufferBindingType::Storage { read_only: true };
pub(super) const WRITE: BufferBindingType = BufferBindingType::Storage { read_only: false };

fn layout(gpu: &Gpu, types: &[(BufferBindingType, bool)]) -> BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(types)
        .map(
            |(binding, &(ty, has_dynamic_offset))| BindGroupLayoutEntry {
                binding,
                visibility: ShaderStages::COMPUTE,
                ty: BindingType::Buffer {
                    ty,
                    has_dynamic_offset,
                    min_binding_size: None,
                },
                count: None,
            },
        )
        .collect();
    let descriptor = wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &entries,
    };
    gpu.device().create_bind_group_layout(&descriptor)
}

pub(super) fn group(
    gpu: &Gpu,
    layout: &BindGroupLayout,
    resources: &[wgpu::BindingResource],
) -> BindGroup {
    let entries: Vec<_> = (0..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry {
            binding,
            resource: resource.clone(),
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
    pub ground: BindGroupLayout,
    pub arguments: BindGroupLayout,
    pub vertices: BindGroupLayout,
    pub triangles: BindGroupLayout,
    pub head: BindGroupLayout,
}

impl Layouts {
    pub fn new(gpu: &Gpu) -> Self {
        let write = (WRITE, false);
        let read = (READ, false);
        let uniform = [(UNIFORM, false), (UNIFORM, true)];
        Self {
            shared: layout(gpu, &[&uniform[..], &[write; 5]].concat()),
            ground: layout(gpu, &[read, read, uniform[0]]),
            arguments: layout(gpu, &[write; 3]),
            vertices: layout(gpu, &[read, write, write]),
            triangles: layout(gpu, &[read, write]),
            head: layout(gpu, &[write; 3]),
        }
    }

    pub fn of(&self, second: Second) -> Option<&BindGroupLayout> {
        match second {
            Second::Nothing => None,
            Second::Ground => Some(&self.ground),
            Second::Arguments => Some(&self.arguments),
            Second::Vertices => Some(&self.vertices),
            Second::Triangles => Some(&self.triangles),
            Second::Head => Some(&self.head),
        }
    }
}
