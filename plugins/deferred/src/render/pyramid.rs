//! The depth pyramid of a view, and which of its lights lie behind what is drawn.

use bevy::math::UVec2;
use bevy::render::render_resource::{
    BindGroup, BindGroupEntries, BindGroupEntry, BindingResource, Buffer, BufferDescriptor,
    BufferInitDescriptor, BufferUsages, CommandEncoder, ComputePassDescriptor, ComputePipeline,
    IntoBinding, PipelineCache, TextureView,
};
use bevy::render::renderer::RenderDevice;

use super::pipeline::{build_layout, look_layout};
use crate::pyramid::{level, levels, texels};

/// Levels that a pass makes.
const LEVELS: u32 = 4;

/// Lights in view from which on they are tested: for fewer the pyramid costs more than it saves.
pub const MANY: u32 = 256;

/// Buffers of a view.
pub struct ViewPyramid {
    size: UVec2,
    corner: UVec2,
    /// All levels.
    texels: Buffer,
    /// A bit a light.
    pub shown: Buffer,
    /// What each pass makes, and its workgroups.
    tasks: Vec<(Buffer, UVec2)>,
}

impl ViewPyramid {
    /// Of a view of `size` pixels at `corner` of its target, for so many lights.
    pub fn new(device: &RenderDevice, size: UVec2, corner: UVec2, lights: u32) -> Self {
        let make = |label, size: u64| {
            device.create_buffer(&BufferDescriptor {
                label: Some(label),
                size,
                usage: BufferUsages::STORAGE,
                mapped_at_creation: false,
            })
        };
        let (mut below, mut made, mut source) = (size, 0, corner);
        let mut tasks = Vec::new();
        while made < levels(size) {
            let next = level(size, made + 1);
            let count = LEVELS.min(levels(size) - made);
            let task = [
                below.x, below.y, source.x, source.y, next.first, count, 0, 0,
            ];
            let buffer = device.create_buffer_with_data(&BufferInitDescriptor {
                label: Some("dolomite_deferred_pyramid_task"),
                contents: bytemuck::cast_slice(&task),
                usage: BufferUsages::UNIFORM,
            });
            let groups = UVec2::new(next.size.x.div_ceil(8), next.size.y.div_ceil(8));
            tasks.push((buffer, groups));
            made += count;
            let last = level(size, made);
            (below, source) = (last.size, UVec2::new(last.first, 0));
        }
        Self {
            size,
            corner,
            texels: make("dolomite_deferred_pyramid", 4 * u64::from(texels(size))),
            shown: make("dolomite_deferred_shown", words(lights)),
            tasks,
        }
    }

    /// Whether it is good for such a view.
    pub fn fits(&self, size: UVec2, corner: UVec2, lights: u32) -> bool {
        let needed = words(lights);
        self.size == size
            && self.corner == corner
            && self.shown.size() >= needed
            && self.shown.size() <= 4 * needed
    }

    /// All levels.
    pub const fn texels(&self) -> &Buffer {
        &self.texels
    }

    /// Bytes of its buffers.
    pub fn bytes(&self) -> u64 {
        self.texels.size() + self.shown.size() + 32 * self.tasks.len() as u64
    }
}

/// Bytes of a bit a light.
fn words(lights: u32) -> u64 {
    (4 * u64::from(lights.div_ceil(32)))
        .next_power_of_two()
        .max(16)
}

/// What is recorded for a view.
pub struct Recording<'a> {
    /// Its buffers.
    pub pyramid: &'a ViewPyramid,
    /// From depth, from a level, and of the lights.
    pub pipelines: [&'a ComputePipeline; 3],
    /// Level 0.
    pub depths: &'a TextureView,
    /// The view, the lighting, its lights and its list.
    pub seen: [BindingResource<'a>; 4],
    /// Of the view's uniform.
    pub offset: u32,
    /// How many are looked at.
    pub lights: u32,
}

/// Makes all levels, then looks at the lights.
pub fn record(
    recording: Recording<'_>,
    device: &RenderDevice,
    cache: &PipelineCache,
    encoder: &mut CommandEncoder,
) {
    let Recording {
        pyramid,
        pipelines,
        depths,
        seen,
        offset,
        lights,
    } = recording;
    let groups: Vec<BindGroup> = pyramid
        .tasks
        .iter()
        .enumerate()
        .map(|(index, (task, _))| {
            let mut entries = vec![
                BindGroupEntry {
                    binding: 0,
                    resource: task.as_entire_binding(),
                },
                BindGroupEntry {
                    binding: 1,
                    resource: pyramid.texels.as_entire_binding(),
                },
            ];
            if index == 0 {
                entries.push(BindGroupEntry {
                    binding: 2,
                    resource: depths.into_binding(),
                });
            }
            let layout = cache.get_bind_group_layout(&build_layout(index == 0));
            device.create_bind_group("dolomite_deferred_pyramid", &layout, &entries)
        })
        .collect();
    let [view, lighting, rows, list] = seen;
    let look = device.create_bind_group(
        "dolomite_deferred_shown",
        &cache.get_bind_group_layout(&look_layout()),
        &BindGroupEntries::sequential((
            view,
            lighting,
            rows,
            list,
            pyramid.texels.as_entire_binding(),
            pyramid.shown.as_entire_binding(),
        )),
    );
    let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
        label: Some("dolomite_deferred_pyramid"),
        timestamp_writes: None,
    });
    for (index, (group, (_, groups))) in groups.iter().zip(&pyramid.tasks).enumerate() {
        pass.set_pipeline(pipelines[usize::from(index > 0)]);
        pass.set_bind_group(0, group, &[]);
        pass.dispatch_workgroups(groups.x, groups.y, 1);
    }
    pass.set_pipeline(pipelines[2]);
    pass.set_bind_group(0, &look, &[offset]);
    pass.dispatch_workgroups(lights.div_ceil(32).div_ceil(64), 1, 1);
}
