//! What the passes and the draws of a view are told, from its camera: matrices in f64 until they
//! are relative to the anchor.

use bevy::math::{DAffine3, DMat4, DVec2, DVec3, DVec4};
use bevy::prelude::*;
use bevy::render::camera::TemporalJitter;
use bevy::render::view::ExtractedView;
use dolomite_terrain::GpuTerrainUniform;

use super::extract::{ExtractedTerrainView, TerrainData};
use super::layout::{DrawParams, FAR_TILES};
use super::relief::RELIEF_SIDE;
use crate::layout::ViewParams;

/// A view's matrices in f64.
pub struct Camera {
    /// World space, metres.
    pub position: DVec3,
    /// As drawn, jitter and all.
    pub clip_from_world: DMat4,
    /// Without the sub-pixel jitter of temporal anti-aliasing: what selection and culling use.
    pub steady_clip_from_world: DMat4,
}

impl Camera {
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

pub fn from_anchor(clip_from_world: DMat4, anchor: DVec2) -> [[f32; 4]; 4] {
    let shift = DMat4::from_translation(DVec3::new(anchor.x, 0.0, anchor.y));
    (clip_from_world * shift).as_mat4().to_cols_array_2d()
}

/// Everything that the tessellation of a view depends on, beside the terrain and the patches.
pub fn view_params(
    view: &ExtractedView,
    camera: &Camera,
    settings: &ExtractedTerrainView,
    terrain: &TerrainData,
    sun: Option<Vec3>,
) -> ViewParams {
    let anchor = camera.position.xz().floor();
    let clip = DMat4::from_cols_array_2d(
        &from_anchor(camera.steady_clip_from_world, anchor).map(|column| column.map(f64::from)),
    );
    let rows = clip.transpose();
    let (x, y, z, w) = (rows.x_axis, rows.y_axis, rows.z_axis, rows.w_axis);
    // Inside: -w <= x <= w, -w <= y <= w, 0 <= z <= w (Gribb and Hartmann, 2001).
    let planes = [w + x, w - x, w + y, w - y, w - z, z].map(|plane: DVec4| {
        let length = plane.truncate().length();
        (if length > 0.0 { plane / length } else { plane })
            .as_vec4()
            .to_array()
    });
    // Half the height of the picture in pixels over the tangent of half the field of view.
    let focal = 0.5 * view.viewport.w as f32 * view.clip_from_view.y_axis.y;
    let orthographic = view.clip_from_view.w_axis.w == 1.0;
    let [low, high] = terrain.heights;
    let sweep = sun.map_or(Vec3::ZERO, |sun| {
        // 0.05: below 3 degrees of sun the shadows of everything reach everywhere.
        sun * ((high - low).max(0.0) / (-sun.y).max(0.05))
    });
    let eye = (settings.focus - DVec3::new(anchor.x, 0.0, anchor.y)).as_vec3();
    let anchor = anchor
        .clamp(DVec2::splat(-2e9), DVec2::splat(2e9))
        .as_ivec2();
    ViewParams {
        planes,
        sweep: sweep.extend(0.0).to_array(),
        eye: eye.to_array(),
        // An orthographic picture has the same detail at any distance: as seen from a height of
        // one picture.
        segments_per_radian: if orthographic {
            view.viewport.w as f32
        } else {
            focal
        } / settings.settings.pixels_per_edge,
        anchor: anchor.to_array(),
        corner_count: settings.cover.corners.len() as u32,
        edge_count: settings.cover.edges.len() as u32,
        patch_count: settings.cover.patches.len() as u32,
        max_vertices: settings.settings.max_vertices,
        max_triangles: settings.settings.max_triangles,
        sea_level: terrain.sea_level.unwrap_or(GpuTerrainUniform::NO_SEA),
    }
}

pub fn draw_params(
    terrain: &TerrainData,
    camera: &Camera,
    anchor: DVec2,
    view: &ExtractedView,
    time: f32,
) -> DrawParams {
    let tile = f64::from(terrain.material.tile).clamp(0.01, 10_000.0);
    let offset = |tile: f64| {
        (anchor / tile - (anchor / tile).floor())
            .as_vec2()
            .to_array()
    };
    let bands = terrain.material.bands;
    let relief = terrain.relief.as_ref();
    let relief_scale = relief.map_or(0.0, |relief| {
        1.0 / (f64::from(relief.texel) * f64::from(RELIEF_SIDE))
    });
    DrawParams {
        clip_from_anchor: from_anchor(camera.clip_from_world, anchor),
        previous_clip_from_anchor: [[0.0; 4]; 4],
        camera: (camera.position - DVec3::new(anchor.x, 0.0, anchor.y))
            .as_vec3()
            .to_array(),
        time,
        anchor: anchor.as_vec2().to_array(),
        near_offset: offset(tile),
        far_offset: offset(tile * FAR_TILES),
        viewport: view.viewport.zw().as_vec2().to_array(),
        sea_level: terrain.sea_level.unwrap_or(GpuTerrainUniform::NO_SEA),
        tile: tile as f32,
        sand_top: bands.sand_top,
        tree_line: bands.tree_line,
        snow_line: bands.snow_line,
        blend: bands.blend.max(0.01),
        rock_slope: bands.rock_slope,
        snow_slope: bands.snow_slope,
        flags: 0,
        relief_texel: relief.map_or(0.0, |relief| relief.texel),
        relief_offset: ((anchor - terrain.extent_min) * relief_scale)
            .as_vec2()
            .to_array(),
        relief_scale: [relief_scale as f32; 2],
        pad: [0.0; 2],
    }
}
