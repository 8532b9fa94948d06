//! Control and evaluate functions of the ground in Rust: the CPU reference of
//! `shaders/src/ground/functions.wgsl`, for tests, tools and machines without a GPU.

use bevy::math::{UVec2, Vec2, Vec3};
use dolomite_terrain::{GpuTerrainUniform, GroundPoint, Terrain};

use super::patches::GroundPatches;
pub use crate::range::{DEPTH_RANGE, OPAQUE_DEPTH};
use dolomite_tessellation::Levels;
use dolomite_tessellation::layout::StageView;

/// Share of the segments that patches get which are seen through a shadow map alone.
pub const SHADOW_DETAIL: f32 = 0.25;

/// The ground in one view.
#[derive(Clone, Copy, Debug)]
pub struct GroundFunctions<'a> {
    /// The patches.
    pub patches: &'a GroundPatches,
    /// The height function.
    pub terrain: &'a Terrain,
    /// What the view is: positions relative to its anchor.
    pub view: &'a StageView,
    /// From the lowest to the highest ground of all, metres.
    pub relief: f32,
}

/// A vertex of the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundVertex {
    /// Relative to the view's anchor, metres: on the ground, or on the sea above it.
    pub position: Vec3,
    /// Upward normal of the ground, of any length.
    pub normal: Vec3,
    /// How deep the ground lies below the sea, metres, within ± [`DEPTH_RANGE`].
    pub depth: f32,
}

impl GroundFunctions<'_> {
    fn sea(&self) -> f32 {
        self.terrain
            .sea_level()
            .unwrap_or(GpuTerrainUniform::NO_SEA)
    }

    /// From the patches' origin to the view's anchor.
    fn shift(&self) -> Vec3 {
        let [x, y, z] = self.view.anchor;
        Vec3::new(
            self.patches.origin.x as f32 - x,
            -y,
            self.patches.origin.y as f32 - z,
        )
    }

    fn point(&self, patch: u32, k: usize) -> [f32; 4] {
        let mesh = &self.patches.mesh;
        mesh.points()[mesh.indices()[patch as usize * 5 + k] as usize]
    }

    /// Where the surface of a corner is drawn.
    fn drawn_corner(&self, patch: u32, k: usize) -> Vec3 {
        let [x, height, z, _] = self.point(patch, k);
        Vec3::new(x, height.max(self.sea()), z) + self.shift()
    }

    /// Levels of a patch; 0 where it is not seen.
    #[must_use]
    pub fn control(&self, patch: u32) -> Levels {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.drawn_corner(patch, k));
        let [least, greatest, ..] = self.point(patch, 4);
        let up = self.shift().y;
        let low = Vec3::new(a.x, least.max(self.sea()) + up, c.z);
        let high = Vec3::new(c.x, greatest.max(self.sea()) + up, a.z);
        let share = self.seen(low, high);
        if share == 0.0 {
            return Levels::uniform(0.0);
        }
        if greatest < self.sea() - OPAQUE_DEPTH {
            return Levels::uniform(1.0);
        }
        let level = |a, b| (share * self.edge_level(a, b)).max(1e-3);
        let outer = [level(d, a), level(a, b), level(b, c), level(c, d)];
        Levels {
            outer,
            inner: [outer[1].max(outer[3]), outer[0].max(outer[2])],
        }
    }

    /// As `edge_level` in `api.wgsl`.
    fn edge_level(&self, a: Vec3, b: Vec3) -> f32 {
        let view = self.view;
        let middle = (a + b) * 0.5;
        let reach = if view.orthographic == 1.0 {
            1.0
        } else {
            middle.distance(Vec3::from(view.eye)).max(1e-6)
        };
        a.distance(b) * view.pixels_per_radian / (reach * view.pixels_per_edge)
    }

    fn sweep(&self) -> Vec3 {
        let [x, y, z, _] = self.view.sweep;
        let sweep = Vec3::new(x, y, z);
        let reach = sweep.length();
        if reach == 0.0 {
            return Vec3::ZERO;
        }
        let along = sweep / reach;
        along * (self.relief / (-along.y).max(0.05))
    }

    /// 1 when the box meets the frustum, [`SHADOW_DETAIL`] when only the box swept along the light
    /// does, else 0.
    fn seen(&self, low: Vec3, high: Vec3) -> f32 {
        let sweep = self.sweep();
        let mut share = 1.0;
        for &[x, y, z, d] in &self.view.planes {
            let normal = Vec3::new(x, y, z);
            let farthest = Vec3::select(normal.cmpge(Vec3::ZERO), high, low);
            let inside = normal.dot(farthest) + d;
            if inside < 0.0 {
                share = SHADOW_DETAIL;
                if inside + normal.dot(sweep).max(0.0) < 0.0 {
                    return 0.0;
                }
            }
        }
        if share != 1.0 && sweep == Vec3::ZERO {
            0.0
        } else {
            share
        }
    }

    /// The vertex of a patch at (u, v).
    #[must_use]
    pub fn evaluate(&self, patch: u32, at: Vec2) -> GroundVertex {
        let ([ax, _, az, _], [cx, _, cz, _]) = (self.point(patch, 0), self.point(patch, 2));
        let place = Vec2::new(ax, az) + (Vec2::new(cx, cz) - Vec2::new(ax, az)) * at;
        let origin = GroundPoint {
            cell: self.patches.origin,
            frac: UVec2::ZERO,
        };
        let ground = self.terrain.sample(origin.offset(place.as_dvec2()));
        let local = Vec3::new(place.x, ground.value.max(self.sea()), place.y);
        GroundVertex {
            position: local + self.shift(),
            normal: Vec3::new(-ground.gradient.x, 1.0, -ground.gradient.y),
            depth: (self.sea() - ground.value).clamp(-DEPTH_RANGE, DEPTH_RANGE),
        }
    }
}
