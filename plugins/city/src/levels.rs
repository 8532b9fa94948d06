//! Levels of detail of patches: as the literature has them, and such that an error is bounded.
//!
//! **The bound.** A patch whose displacement is h ≤ a is drawn as triangles through points of it. At distance d a
//! pixel is d / r metres, r the pixels of a radian, so with a tolerance of τ pixels e = τ d / r metres are allowed.
//! Surface and triangles both lie between 0 and a: where a ≤ e, any triangles will do. Else triangles whose longest
//! side is l are off by at most l² k / 6, with k the greatest second derivative of h (S. Waldron, *The error in
//! linear interpolation at the vertices of a simplex*, 1998: ½ k R² for an acute triangle, R² ≤ l² / 3; an obtuse one
//! is off by l² k / 8 at most). The stage's triangles join neighbours of two rows: with steps of w along both, they
//! reach over 2 w along and w across, l² ≤ 5 w². So w = √(6 e / (5 k)).
//!
//! Sides of borders take a and k of the whole city, so that both faces of an edge ask for the same level.

use bevy::math::Vec3;
use bevy::reflect::prelude::*;

use crate::map::{DisplacementMap, TEXELS_PER_METRE};
use crate::relief::CityPatch;
use crate::rules::CityRules;
use crate::surface::Surface;

/// Greatest level of the stage.
pub const MOST: f32 = 64.0;

/// Where detail follows from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// Place, metres, in the space of the patches.
    pub at: Vec3,
    /// Pixels of a radian in the middle of the view.
    pub pixels_per_radian: f32,
}

/// Levels of the sides u = 0, v = 0, u = 1, v = 1, and along u and v.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PatchLevels {
    /// Of the sides.
    pub outer: [f32; 4],
    /// Inside.
    pub inner: [f32; 2],
}

/// What levels with a bounded error follow from: all that is the same for the whole city.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorBound {
    /// Pixels.
    pub tolerance: f32,
    /// 5/6 of the greatest second derivative of each surface, 1/m.
    pub bend: [f32; 8],
    /// Greatest displacement of all, metres.
    pub amplitude: f32,
    /// The greatest of `bend`.
    pub border_bend: f32,
    /// Half of the longest side of a patch, metres: how far triangles at a side may reach from it.
    pub slack: f32,
}

impl ErrorBound {
    /// Of a city.
    ///
    /// Two fades at most count at a place, S₁ S₂; the derivative of each is at most 3/(2 b) along its own distance, the
    /// second 6/b², b the band. Across a rectangle the two distances are at right angles, so along (cos a, sin a)
    /// |(S₁ S₂)′| ≤ 3/(√2 b) and |(S₁ S₂)″| ≤ (6 + 2 · (3/2)² · ½)/b² = 8¼/b². On roofs, whose sides lean, both may
    /// point one way: 3/b and (12 + 4½)/b². With slope k₁ and curvature k_m of the map, and m ≤ 1,
    /// |(m S₁ S₂)″| ≤ k_m + 2 k₁ |(S₁ S₂)′| + |(S₁ S₂)″|.
    #[must_use]
    pub fn new(rules: &CityRules, maps: &[DisplacementMap], tolerance: f32) -> Self {
        let band = rules.relief.band;
        let mut bend = [0.0; 8];
        for surface in Surface::ALL {
            let bounds = maps[surface.map()].bounds();
            let curvature = bounds.curvature * TEXELS_PER_METRE * TEXELS_PER_METRE;
            // Along a direction that is neither axis a slope is up to √2 of that along both.
            let slope = bounds.slope * TEXELS_PER_METRE * core::f32::consts::SQRT_2;
            let (first, second) = match surface {
                Surface::Tiles => (3.0, 16.5),
                _ => (1.5 * core::f32::consts::SQRT_2, 8.25),
            };
            let sum = curvature + 2.0 * slope * first / band + second / (band * band);
            bend[surface as usize] = sum * surface.amplitude(rules) * (5.0 / 6.0);
        }
        Self {
            tolerance,
            bend,
            amplitude: Surface::greatest(rules),
            border_bend: bend.into_iter().fold(0.0, f32::max),
            slack: 0.5 * rules.relief.patch,
        }
    }

    /// Level of a length at a distance: displacement up to `amplitude`, bent by `bend`.
    fn level(&self, eye: &Eye, length: f32, distance: f32, amplitude: f32, bend: f32) -> f32 {
        let allowed = self.tolerance * distance.max(0.0) / eye.pixels_per_radian;
        if amplitude <= allowed {
            return 1.0;
        }
        // The stage cuts off beyond its greatest level; 0 metres allowed give infinity.
        (length * (bend / allowed).sqrt()).min(MOST)
    }

    /// Levels of a patch.
    #[must_use]
    pub fn levels(&self, eye: &Eye, patch: &CityPatch) -> PatchLevels {
        let corner = patch.corners.map(|c| Vec3::new(c[0], c[1], c[2]));
        let [c0, c1, c2, c3] = corner;
        let data = &patch.data;
        let bend = self.bend[(data.material() & 7) as usize];
        let own = data.map[2];
        let side = |number: usize, a: Vec3, b: Vec3| {
            let length = a.distance(b);
            let middle = (a + b) * 0.5;
            let distance = middle.distance(eye.at) - 0.5 * length - self.slack - self.amplitude;
            if data.is_border(number) {
                self.level(eye, length, distance, self.amplitude, self.border_bend)
            } else {
                self.level(eye, length, distance, own, bend)
            }
        };
        let outer = [
            side(0, c0, c3),
            side(1, c0, c1),
            side(2, c1, c2),
            side(3, c3, c2),
        ];
        let centre = (c0 + c1 + c2 + c3) * 0.25;
        let radius = corner
            .into_iter()
            .map(|c| c.distance(centre))
            .fold(0.0, f32::max);
        let distance = centre.distance(eye.at) - radius - self.amplitude;
        let wide = c0.distance(c1).max(c3.distance(c2));
        let high = c0.distance(c3).max(c1.distance(c2));
        let inner = [wide, high].map(|length| {
            let level = self.level(eye, length, distance, own, bend);
            // Triangles at a side reach over one row: a third of the patch at most.
            if level > 1.0 { level.max(3.0) } else { level }
        });
        PatchLevels { outer, inner }
    }

    /// Whether a patch is as fine as the bound asks for, and not cut off at the stage's greatest level.
    #[must_use]
    pub fn is_kept(levels: &PatchLevels) -> bool {
        levels
            .outer
            .iter()
            .chain(&levels.inner)
            .all(|level| *level < MOST)
    }
}

/// Levels by distance, as the literature has them.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub struct Classic {
    /// Greatest and least level.
    pub levels: (f32, f32),
    /// Beyond which ground has the least level, metres.
    pub ground: f32,
    /// Between which walls and hedges go from the greatest to the least level, metres.
    pub walls: (f32, f32),
    /// The same of roofs.
    pub roofs: (f32, f32),
}

impl Default for Classic {
    /// The literature states no values; these are ours.
    fn default() -> Self {
        Self {
            levels: (16.0, 1.0),
            ground: 120.0,
            walls: (10.0, 120.0),
            roofs: (10.0, 60.0),
        }
    }
}

impl Classic {
    /// Levels of a patch of the ground: 0.6 of the distance of a side's middle and 0.4 of flatness, which is 1 where
    /// all corners are equally high, as they are here.
    #[must_use]
    pub fn ground_levels(&self, eye: &Eye, patch: &CityPatch) -> PatchLevels {
        let (most, least) = self.levels;
        let level = |a: [f32; 4], b: [f32; 4]| {
            let middle = (Vec3::new(a[0], a[1], a[2]) + Vec3::new(b[0], b[1], b[2])) * 0.5;
            let distance = middle.distance(eye.at);
            if distance > self.ground {
                return least;
            }
            let share = 0.6 * (distance / self.ground) + 0.4;
            most + (least - most) * share
        };
        let [c0, c1, c2, c3] = patch.corners;
        Self::with_inner([level(c0, c3), level(c0, c1), level(c1, c2), level(c3, c2)])
    }

    /// Levels of a face of a wall, roof or hedge: by horizontal distance; then a level a metre, the mean of both
    /// sides of an axis, times the length of each.
    #[must_use]
    pub fn face_levels(&self, eye: &Eye, patch: &CityPatch, roof: bool) -> PatchLevels {
        let (most, least) = self.levels;
        let (near, far) = if roof { self.roofs } else { self.walls };
        let side = |a: [f32; 4], b: [f32; 4]| {
            let (a, b) = (Vec3::new(a[0], a[1], a[2]), Vec3::new(b[0], b[1], b[2]));
            let away = (a + b) * 0.5 - eye.at;
            let distance = (away.x * away.x + away.z * away.z).sqrt();
            let share = ((distance - near) / (far - near)).clamp(0.0, 1.0);
            let length = a.distance(b);
            ((most + (least - most) * share) / length, length)
        };
        let [c0, c1, c2, c3] = patch.corners;
        let [left, low, right, high] = [side(c0, c3), side(c0, c1), side(c1, c2), side(c3, c2)];
        let mean = |a: (f32, f32), b: (f32, f32)| {
            let each = (a.0 + b.0) * 0.5;
            [each * a.1, each * b.1]
        };
        let [l, r] = mean(left, right);
        let [b, t] = mean(low, high);
        Self::with_inner([l, b, r, t])
    }

    /// Levels of any patch.
    #[must_use]
    pub fn levels(&self, eye: &Eye, patch: &CityPatch) -> PatchLevels {
        match patch.data.material() & 7 {
            0..=2 => self.ground_levels(eye, patch),
            surface => self.face_levels(eye, patch, surface == Surface::Tiles as u32),
        }
    }

    fn with_inner(outer: [f32; 4]) -> PatchLevels {
        PatchLevels {
            outer,
            inner: [outer[1].max(outer[3]), outer[0].max(outer[2])],
        }
    }
}

/// How levels are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum CityDetail {
    /// The same for every patch, wherever the eye is.
    Static(f32),
    /// By distance, without a bound.
    Classic(Classic),
    /// So that what is drawn is off by so many pixels at most.
    ErrorBound(f32),
}

impl Default for CityDetail {
    fn default() -> Self {
        Self::ErrorBound(1.0)
    }
}
