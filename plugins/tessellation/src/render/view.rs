//! What control functions and draws are told of a view: in f64 until it is relative to the anchor.

use bevy::math::{DMat4, DVec3, DVec4};
use bevy::prelude::*;
use bevy::render::view::ExtractedView;

use super::camera::Camera;
use super::extract::ExtractedStageCamera;
use crate::layout::StageView;

/// What [`PatchKind::view_numbers`](super::PatchKind::view_numbers) is told of a view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// World position that stage space is counted from, whole metres.
    pub anchor: DVec3,
    /// World position of the camera, metres.
    pub camera: DVec3,
    /// Seconds, wrapped at an hour.
    pub time: f32,
}

/// Where positions of the stage are counted from.
pub struct StageSpace {
    /// World space, whole metres near the camera.
    pub anchor: DVec3,
}

impl StageSpace {
    /// The space of a camera at `position`.
    pub fn new(position: DVec3) -> Self {
        Self {
            anchor: position.floor(),
        }
    }

    /// What kinds are told of a view.
    pub fn viewpoint(&self, camera: &Camera, time: f32) -> Viewpoint {
        Viewpoint {
            anchor: self.anchor,
            camera: camera.position,
            time,
        }
    }

    /// From stage space to clip space.
    pub fn clip_from_stage(&self, clip_from_world: DMat4) -> [[f32; 4]; 4] {
        (clip_from_world * DMat4::from_translation(self.anchor))
            .as_mat4()
            .to_cols_array_2d()
    }
}

/// The view as control functions see it. `time` is that of this frame and the last.
pub fn stage_view(
    view: &ExtractedView,
    camera: &Camera,
    space: &StageSpace,
    stage: &ExtractedStageCamera,
    sun: Option<Vec3>,
    time: [f32; 2],
) -> StageView {
    let clip = camera.steady_clip_from_world * DMat4::from_translation(space.anchor);
    let rows = clip.transpose();
    let (x, y, z, w) = (rows.x_axis, rows.y_axis, rows.z_axis, rows.w_axis);
    // Inside: -w <= x <= w, -w <= y <= w, 0 <= z <= w (Gribb and Hartmann, 2001).
    let planes = [w + x, w - x, w + y, w - y, w - z, z].map(|plane: DVec4| {
        let length = plane.truncate().length();
        let unit = if length > 0.0 { plane / length } else { plane };
        unit.as_vec4().to_array()
    });
    let settings = &stage.settings;
    let focus = settings
        .focus
        .filter(|focus| focus.is_finite())
        .unwrap_or(camera.position);
    let orthographic = view.clip_from_view.w_axis.w == 1.0;
    let reach = settings.shadow_reach.max(0.0);
    StageView {
        planes,
        sweep: sun
            .map_or(Vec3::ZERO, |sun| sun * reach)
            .extend(0.0)
            .to_array(),
        eye: (focus - space.anchor).as_vec3().to_array(),
        // Perspective: half the picture's height in pixels over the tangent of half the field of
        // view. Orthographic: pixels a metre, the same formula.
        pixels_per_radian: 0.5 * view.viewport.w as f32 * view.clip_from_view.y_axis.y,
        anchor: space.anchor.as_vec3().to_array(),
        pixels_per_edge: settings.pixels_per_edge.clamp(1.0, 1000.0),
        time: time[0],
        previous_time: time[1],
        orthographic: f32::from(u8::from(orthographic)),
        camera: stage.number,
    }
}
