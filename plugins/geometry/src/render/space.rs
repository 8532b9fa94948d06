//! What producers and draws are told of a view: in f64 until it is relative to the anchor.

use bevy::math::{DMat4, DVec3, DVec4};
use bevy::prelude::*;
use bevy::render::view::ExtractedView;

use super::camera::Matrices;
use super::extract::{ExtractedGeometryCamera, GeometryScene};

/// What a producer's numbers of a view depend on ([`Producer::numbers`](super::Producer::numbers)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// World position that positions in the pools are counted from, whole metres.
    pub anchor: DVec3,
    /// World position of the camera, metres.
    pub camera: DVec3,
    /// Seconds, wrapped at an hour.
    pub time: f32,
}

/// A view in a frame. Positions and planes are relative to the anchor, axes of the world, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewFrame {
    /// World position that positions in the pools are counted from, whole metres near the camera.
    pub anchor: DVec3,
    /// World position of the camera.
    pub position: DVec3,
    /// Inward half-spaces of the frustum, without the jitter of temporal anti-aliasing.
    pub planes: [[f32; 4]; 6],
    /// How far shadows reach along the light ([`GeometryScene::sun`]); 0 without shadows.
    pub sweep: Vec3,
    /// The point that detail follows.
    pub eye: Vec3,
    /// Size of a radian in the middle of the picture, pixels; of a metre, if orthographic.
    pub pixels_per_radian: f32,
    /// Wanted length of an edge, pixels.
    pub pixels_per_edge: f32,
    /// Whether distance does not matter.
    pub orthographic: bool,
    /// [`camera_number`](super::camera_number).
    pub number: f32,
    /// From the anchor to clip space, without jitter.
    pub steady_clip: Mat4,
    /// Width and height of the viewport, pixels.
    pub size: Vec2,
    /// Seconds, wrapped at an hour, of this frame and the last.
    pub time: [f32; 2],
}

impl ViewFrame {
    /// Of a camera's view, relative to `anchor`.
    #[must_use]
    pub fn new(
        view: &ExtractedView,
        matrices: &Matrices,
        anchor: DVec3,
        camera: &ExtractedGeometryCamera,
        scene: &GeometryScene,
    ) -> Self {
        let clip = matrices.steady_clip_from_world * DMat4::from_translation(anchor);
        let rows = clip.transpose();
        let (x, y, z, w) = (rows.x_axis, rows.y_axis, rows.z_axis, rows.w_axis);
        // Inside: -w <= x <= w, -w <= y <= w, 0 <= z <= w (Gribb and Hartmann, 2001).
        let planes = [w + x, w - x, w + y, w - y, w - z, z].map(|plane: DVec4| {
            let length = plane.truncate().length();
            let unit = if length > 0.0 { plane / length } else { plane };
            unit.as_vec4().to_array()
        });
        let settings = &camera.settings;
        let focus = settings
            .focus
            .filter(|focus| focus.is_finite())
            .unwrap_or(matrices.position);
        let reach = settings.shadow_reach.max(0.0);
        Self {
            anchor,
            position: matrices.position,
            planes,
            sweep: scene.sun.map_or(Vec3::ZERO, |sun| sun * reach),
            eye: (focus - anchor).as_vec3(),
            // Perspective: half the picture's height in pixels over the tangent of half the field of
            // view. Orthographic: pixels a metre, the same formula.
            pixels_per_radian: 0.5 * view.viewport.w as f32 * view.clip_from_view.y_axis.y,
            pixels_per_edge: settings.pixels_per_edge.clamp(1.0, 1000.0),
            orthographic: view.clip_from_view.w_axis.w == 1.0,
            number: camera.number,
            steady_clip: Mat4::from_cols_array_2d(&from_anchor(
                matrices.steady_clip_from_world,
                anchor,
            )),
            size: view.viewport.zw().as_vec2(),
            time: scene.time,
        }
    }

    /// What numbers of the view depend on.
    #[must_use]
    pub const fn viewpoint(&self) -> Viewpoint {
        Viewpoint {
            anchor: self.anchor,
            camera: self.position,
            time: self.time[0],
        }
    }
}

/// A matrix from the world as one from the anchor.
pub(super) fn from_anchor(clip_from_world: DMat4, anchor: DVec3) -> [[f32; 4]; 4] {
    (clip_from_world * DMat4::from_translation(anchor))
        .as_mat4()
        .to_cols_array_2d()
}
