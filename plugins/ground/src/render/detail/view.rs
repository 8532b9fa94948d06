//! A view of Bevy's as the choice sees it, and what it draws.

use bevy::math::{DVec3, Vec2, Vec3};
use bevy::render::view::ExtractedView;
use bytemuck::Zeroable;
use dolomite_geometry::render::ViewFrame;

use crate::detail::{CullView, DetailView, TerrainLod};

/// What the view draws.
pub(in crate::render) fn picture(frame: &ViewFrame, one_sided: bool) -> CullView {
    CullView {
        clip: frame.steady_clip,
        half_size: frame.size.max(Vec2::ONE) * 0.5,
        one_sided,
    }
}

/// The view as the choice sees it: heights are absolute, x and z relative to the anchor.
pub(in crate::render) fn detail_view(
    view: &ExtractedView,
    frame: &ViewFrame,
    relief: f32,
    detail: &TerrainLod,
) -> DetailView {
    let anchor = frame.anchor;
    let mut out = DetailView::zeroed();
    out.planes = frame.planes.map(|[x, y, z, d]| {
        let raised = f64::from(d) - f64::from(y) * anchor.y;
        [x, y, z, raised as f32]
    });
    let turn = view.world_from_view.affine().matrix3;
    let eye = view.world_from_view.translation().as_dvec3() - DVec3::new(anchor.x, 0.0, anchor.z);
    out.eye = eye.as_vec3().to_array();
    let axis = |axis: Vec3| axis.normalize_or_zero().to_array();
    out.right = axis(turn.x_axis.into());
    out.up = axis(turn.y_axis.into());
    out.forward = axis(-Vec3::from(turn.z_axis));
    let clip = &view.clip_from_view;
    out.scale = 0.5 * view.viewport.w as f32 * clip.y_axis.y;
    out.orthographic = f32::from(u8::from(frame.orthographic));
    // Of Bevy's perspective, infinite and reversed: z of clip space is the near distance.
    out.near = if clip.w_axis.z > 0.0 {
        clip.w_axis.z
    } else {
        0.1
    };
    let (x, y) = (1.0 / clip.x_axis.x, 1.0 / clip.y_axis.y);
    out.cos_corner = 1.0 / (1.0 + x * x + y * y).sqrt();
    if let Some(along) = frame.sweep.try_normalize() {
        // 0.05: below 3 degrees of sun the shadows of everything reach everywhere.
        out.sweep = (along * (relief / (-along.y).max(0.05))).to_array();
    }
    out.anchor = [anchor.x as i32, anchor.z as i32];
    out.set_metric(detail);
    out
}
