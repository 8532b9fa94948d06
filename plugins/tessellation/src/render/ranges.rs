//! What of a tessellation each shadow view draws: groups of consecutive patches whose bounds meet it.
//!
//! A cascade near the camera sees a small part of what the camera sees, and what it does not see would
//! still cost a vertex and a triangle each. Kinds that have a bounds function are drawn in ranges.

use std::num::NonZero;

use bevy::math::{DMat4, DVec4};
use bevy::render::render_resource::binding_types::{
    storage_buffer_read_only_sized, storage_buffer_sized, uniform_buffer_sized,
};
use bevy::render::render_resource::{
    BindGroup, BindGroupEntries, BindGroupLayoutDescriptor, BindGroupLayoutEntries, Buffer,
    BufferDescriptor, BufferUsages, PipelineCache, ShaderStages,
};
use bevy::render::renderer::{RenderDevice, RenderQueue};

use super::prepare::{KindBuffers, SHADOW_SLOTS};
use crate::layout::StageParams;

/// Groups of patches of a kind, as in `shadow_ranges.wgsl`.
const GROUPS: u32 = 64;
/// Half-spaces of a shadow view, as in `shadow_ranges.wgsl`.
const PLANES: usize = 5;
/// Bytes of the arguments of a draw.
const ARGUMENTS: u64 = 20;

type Planes = [[[f32; 4]; PLANES]; SHADOW_SLOTS as usize];

/// The ranges of one kind in the shadow views of one view.
pub struct ShadowRanges {
    views: Buffer,
    /// Arguments of the draws.
    pub arguments: Buffer,
    planes: Planes,
    /// How many shadow views there are.
    pub count: u32,
    /// Whether shadow views changed since the ranges were made.
    pub due: bool,
    pub group: Option<BindGroup>,
}

impl ShadowRanges {
    pub fn new(device: &RenderDevice) -> Self {
        let buffer = |label, size, usage| {
            device.create_buffer(&BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        Self {
            views: buffer(
                "stage_shadow_views",
                size_of::<Planes>() as u64,
                BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            ),
            arguments: buffer(
                "stage_shadow_ranges",
                SHADOW_SLOTS * u64::from(GROUPS) * ARGUMENTS,
                BufferUsages::STORAGE | BufferUsages::INDIRECT,
            ),
            planes: [[[0.0; 4]; PLANES]; SHADOW_SLOTS as usize],
            count: 0,
            due: true,
            group: None,
        }
    }

    /// Takes over this frame's shadow views.
    pub fn update(&mut self, queue: &RenderQueue, clips: &[DMat4]) {
        let mut planes = [[[0.0; 4]; PLANES]; SHADOW_SLOTS as usize];
        for (planes, clip) in planes.iter_mut().zip(clips) {
            *planes = half_spaces(*clip);
        }
        if self.planes != planes || self.count != clips.len() as u32 {
            self.planes = planes;
            self.count = clips.len() as u32;
            self.due = true;
            queue.write_buffer(&self.views, 0, bytemuck::bytes_of(&planes));
        }
    }

    /// Makes the bind group if it is missing.
    pub fn bind(
        &mut self,
        device: &RenderDevice,
        cache: &PipelineCache,
        layout: &BindGroupLayoutDescriptor,
        buffers: &KindBuffers,
        [uniform, work]: [&Buffer; 2],
    ) {
        self.group.get_or_insert_with(|| {
            device.create_bind_group(
                "stage_shadow_ranges",
                &cache.get_bind_group_layout(layout),
                &BindGroupEntries::sequential((
                    uniform.as_entire_binding(),
                    buffers.tables.as_entire_binding(),
                    buffers.data.as_entire_binding(),
                    work.as_entire_binding(),
                    self.arguments.as_entire_binding(),
                    self.views.as_entire_binding(),
                )),
            )
        });
    }

    /// Places of the arguments of the draws into shadow view `k`, for so many patches.
    pub fn draws(&self, k: u32, patches: u32) -> impl Iterator<Item = u64> + use<> {
        let size = patches.div_ceil(GROUPS).max(1);
        (0..patches.div_ceil(size)).map(move |group| u64::from(k * GROUPS + group) * ARGUMENTS)
    }
}

/// Layout of the pass.
pub fn layout() -> BindGroupLayoutDescriptor {
    let read = || storage_buffer_read_only_sized(false, None);
    BindGroupLayoutDescriptor::new(
        "stage_shadow_ranges",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::COMPUTE,
            (
                uniform_buffer_sized(false, NonZero::new(size_of::<StageParams>() as u64)),
                read(),
                read(),
                read(),
                storage_buffer_sized(false, None),
                uniform_buffer_sized(false, NonZero::new(size_of::<Planes>() as u64)),
            ),
        ),
    )
}

/// Inward half-spaces of a clip space (Gribb and Hartmann, 2001), all but the near one: what stands
/// before it casts its shadow too.
fn half_spaces(clip: DMat4) -> [[f32; 4]; PLANES] {
    let rows = clip.transpose();
    let (x, y, z, w) = (rows.x_axis, rows.y_axis, rows.z_axis, rows.w_axis);
    [w + x, w - x, w + y, w - y, z].map(|plane: DVec4| {
        let length = plane.truncate().length();
        let unit = if length > 0.0 { plane / length } else { plane };
        unit.as_vec4().to_array()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::DVec3;

    #[test]
    fn half_spaces_hold_what_the_view_holds_and_what_is_before_it() {
        // Looks down −z from the origin: x and y within ±10, depth 1 to 50, reversed.
        let clip = DMat4::orthographic_rh(-10.0, 10.0, -10.0, 10.0, 50.0, 1.0);
        let planes = half_spaces(clip);
        let inside = |point: DVec3| {
            planes.iter().all(|[a, b, c, d]| {
                point.dot(DVec3::new(f64::from(*a), f64::from(*b), f64::from(*c))) + f64::from(*d)
                    >= 0.0
            })
        };
        assert!(inside(DVec3::new(9.0, -9.0, -20.0)));
        assert!(inside(DVec3::new(0.0, 0.0, 30.0)), "towards the light");
        for outside in [
            DVec3::new(11.0, 0.0, -20.0),
            DVec3::new(0.0, -11.0, -20.0),
            DVec3::new(0.0, 0.0, -51.0),
        ] {
            assert!(!inside(outside), "{outside}");
        }
    }

    #[test]
    fn every_patch_is_in_a_group() {
        for patches in [1, 2, 63, 64, 65, 700, 100_000_u32] {
            let size = patches.div_ceil(GROUPS).max(1);
            let groups = patches.div_ceil(size);
            assert!(groups <= GROUPS && groups * size >= patches);
        }
    }
}
