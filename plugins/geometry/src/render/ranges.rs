//! What of a producer's primitives each shadow view draws: ranges whose bounds meet it.
//!
//! A cascade near the camera sees a small part of what the camera sees, and what it does not see would
//! still cost a vertex and a triangle each. Producers whose parts have bounds are drawn in ranges: a pass of
//! theirs reads [`ShadowRanges::views`] and writes [`ShadowRanges::arguments`].

use bevy::math::{DMat4, DVec4};
use bevy::render::render_resource::{Buffer, BufferDescriptor, BufferUsages};
use bevy::render::renderer::{RenderDevice, RenderQueue};

/// Ranges of a producer's primitives that a shadow view draws at most, as `GROUPS` in the producer's pass.
pub const RANGES: u32 = 64;
/// Half-spaces of a shadow view, as `PLANES` in the producer's pass.
pub const PLANES: usize = 5;
/// Bytes of the arguments of a draw.
pub const RANGE_ARGUMENTS: u64 = 20;
/// Shadow views that there is room for at first.
const FIRST_VIEWS: usize = 4;

type Planes = [[f32; 4]; PLANES];

/// The ranges of one producer in the shadow views of one view.
pub struct ShadowRanges {
    /// Half-spaces of the shadow views, [`PLANES`] vec4 each.
    pub views: Buffer,
    /// Arguments of the draws: of each shadow view [`RANGES`] times index count, instances (1), first index,
    /// base vertex, first instance.
    pub arguments: Buffer,
    planes: Vec<Planes>,
    /// Whether shadow views or primitives changed since the ranges were made. Cleared by the producer.
    pub due: bool,
}

impl ShadowRanges {
    pub(super) fn new(device: &RenderDevice) -> Self {
        let [views, arguments] = buffers(device, FIRST_VIEWS);
        Self {
            views,
            arguments,
            planes: Vec::new(),
            due: true,
        }
    }

    /// Takes over this frame's shadow views, relative to the anchor.
    pub(super) fn update(&mut self, device: &RenderDevice, queue: &RenderQueue, clips: &[DMat4]) {
        let same = self.planes.len() == clips.len()
            && self
                .planes
                .iter()
                .zip(clips)
                .all(|(known, clip)| *known == half_spaces(*clip));
        if same {
            return;
        }
        self.planes.clear();
        self.planes
            .extend(clips.iter().map(|clip| half_spaces(*clip)));
        self.due = true;
        let room = self.views.size() as usize / size_of::<Planes>();
        if room < clips.len() {
            [self.views, self.arguments] = buffers(device, clips.len().next_power_of_two());
        }
        queue.write_buffer(&self.views, 0, bytemuck::cast_slice(&self.planes));
    }

    /// How many shadow views there are.
    #[must_use]
    pub fn count(&self) -> u32 {
        self.planes.len() as u32
    }

    /// Bytes of the buffers.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.views.size() + self.arguments.size()
    }

    /// Places of the arguments of the draws into shadow view `k`, of so many parts in ranges of equal
    /// numbers of parts.
    pub fn draws(&self, k: u32, parts: u32) -> impl Iterator<Item = u64> + use<> {
        let size = parts.div_ceil(RANGES).max(1);
        (0..parts.div_ceil(size)).map(move |range| u64::from(k * RANGES + range) * RANGE_ARGUMENTS)
    }
}

fn buffers(device: &RenderDevice, views: usize) -> [Buffer; 2] {
    let buffer = |label, size, usage| {
        device.create_buffer(&BufferDescriptor {
            label: Some(label),
            size,
            usage: usage | BufferUsages::STORAGE,
            mapped_at_creation: false,
        })
    };
    [
        buffer(
            "geometry_shadow_views",
            (views * size_of::<Planes>()) as u64,
            BufferUsages::COPY_DST,
        ),
        buffer(
            "geometry_shadow_ranges",
            views as u64 * u64::from(RANGES) * RANGE_ARGUMENTS,
            BufferUsages::INDIRECT,
        ),
    ]
}

/// Inward half-spaces of a clip space (Gribb and Hartmann, 2001), all but the near one: what stands
/// before it casts its shadow too.
#[must_use]
pub fn half_spaces(clip: DMat4) -> [[f32; 4]; PLANES] {
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
    fn every_part_is_in_a_range() {
        for parts in [1, 2, 63, 64, 65, 700, 100_000_u32] {
            let size = parts.div_ceil(RANGES).max(1);
            let ranges = parts.div_ceil(size);
            assert!(ranges <= RANGES && ranges * size >= parts);
        }
    }
}
