//! A view's matrices in f64: positions are relative to the anchor before they become f32.

use bevy::math::{DAffine3, DMat4, DVec3, Vec4Swizzles as _};
use bevy::render::camera::TemporalJitter;
use bevy::render::view::ExtractedView;

/// A view's matrices in f64.
pub struct Matrices {
    /// World space, metres.
    pub position: DVec3,
    /// As drawn, jitter and all.
    pub clip_from_world: DMat4,
    /// Without the sub-pixel jitter of temporal anti-aliasing: what selection and culling use.
    pub steady_clip_from_world: DMat4,
}

impl Matrices {
    /// Of a view, and the jitter of temporal anti-aliasing, if it has one.
    #[must_use]
    pub fn new(view: &ExtractedView, jitter: Option<&TemporalJitter>) -> Self {
        let affine = view.world_from_view.affine();
        let world_from_view = DAffine3::from_mat3_translation(
            affine.matrix3.as_dmat3(),
            affine.translation.as_dvec3(),
        );
        let view_from_world = DMat4::from(world_from_view.inverse());
        let steady = view.clip_from_view.as_dmat4() * view_from_world;
        let mut clip_from_view = view.clip_from_view;
        if let Some(jitter) = jitter {
            jitter.jitter_projection(&mut clip_from_view, view.viewport.zw().as_vec2());
        }
        let given = view
            .clip_from_world
            .filter(|_| jitter.is_none())
            .map(|clip| clip.as_dmat4());
        Self {
            position: world_from_view.translation,
            clip_from_world: given.unwrap_or(clip_from_view.as_dmat4() * view_from_world),
            steady_clip_from_world: given.unwrap_or(steady),
        }
    }
}
