//! What an error on the ground is in the picture, at most.
//!
//! Space: metres relative to the view's anchor, axes of the world. For a point P relative to the eye, a
//! vertical displacement δ, and depths w, w′ before and after it, both projected, the distance in the
//! picture is exactly f·δ·|(u × P)ₓᵧ| / (w·w′): u is up, x and y are the camera's axes, f the pixels of
//! a unit tangent (u × P is the same for both points). Over a box each factor is bounded by itself.

use bevy::math::{DQuat, DVec2, DVec3, IVec2, UVec2, Vec3};
use bytemuck::{Pod, Zeroable};

use super::settings::{Metric, TerrainLod};

/// A view as a choice sees it; laid out as `DetailView` in `shaders/src/detail/types.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct DetailView {
    /// Inward half-spaces of the frustum: inside where dot(n, p) + d ≥ 0.
    pub planes: [[f32; 4]; 6],
    /// The eye.
    pub eye: [f32; 3],
    /// Pixels of a unit tangent; of a metre where the camera is orthographic.
    pub scale: f32,
    /// The camera's axes: right, up, forward.
    pub right: [f32; 3],
    /// Nearest depth that is drawn, metres.
    pub near: f32,
    /// See `right`.
    pub up: [f32; 3],
    /// Cosine of the angle between the middle and a corner of the picture.
    pub cos_corner: f32,
    /// See `right`.
    pub forward: [f32; 3],
    /// 1 where the camera is orthographic.
    pub orthographic: f32,
    /// How far shadows reach along the light, metres; 0 without shadows.
    pub sweep: [f32; 3],
    /// Share of the detail for ground that is seen through its shadow alone.
    pub shadow_share: f32,
    /// Whole metres (x, z) of the anchor; its height is 0.
    pub anchor: [i32; 2],
    /// Number of the metric: 0 classic, 1 edge length, 2 error bound.
    pub metric: u32,
    /// 1 / tolerance in pixels; of the classic metric 1 / patch side.
    pub inverse_tolerance: f32,
    /// Of the classic metric: least and greatest segments, 0.6 / reach, 1 / height.
    pub classic: [f32; 4],
}

/// How a view projects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// A pinhole; above 0: the tangent of half the angle between the lower and the upper edge of the
    /// picture.
    Perspective(f64),
    /// Parallel rays; metres between the lower and the upper edge, above 0.
    Orthographic(f64),
}

/// Share by which frusta are wider than asked. Rounded to f32, a plane and a point in the picture miss
/// each other by some 2⁻²² of the point's distance and of the eye's height; distance is at most 3.7
/// times depth with 120 degrees at 16:9. So nothing is lost that is seen in f64.
const WIDER: f64 = 1e-6;

/// What a box is for a view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// Share of the detail: 1 in the frustum, less where only its shadow is, 0 where nothing is.
    pub share: f32,
    /// The most pixels that a vertical metre in the box is in the picture, where it is seen.
    pub pixels_per_metre: f32,
    /// Distance from the eye to the box, metres.
    pub distance: f32,
}

impl DetailView {
    /// A view of the default metric, without shadows. `eye` in metres of the world, of which x and z may
    /// lie anywhere within ±2³¹; `rotation` turns −Z to where it looks and +Y upwards in the picture;
    /// `size` in pixels; nothing nearer than `near` metres of depth is drawn (above 0 for a pinhole).
    #[must_use]
    pub fn new(eye: DVec3, rotation: DQuat, lens: Lens, size: UVec2, near: f64) -> Self {
        let anchor = DVec2::new(eye.x, eye.z).floor();
        let eye = eye - DVec3::new(anchor.x, 0.0, anchor.y);
        let axes = [DVec3::X, DVec3::Y, DVec3::NEG_Z].map(|axis| rotation * axis);
        let [right, up, forward] = axes;
        let size = size.max(UVec2::ONE).as_dvec2();
        let aspect = size.x / size.y;
        let (half, orthographic) = match lens {
            Lens::Perspective(tangent) => (tangent, false),
            Lens::Orthographic(metres) => (metres / 2.0, true),
        };
        // Half the picture: at depth 1, or at any.
        let reach = DVec2::new(half * aspect, half);
        let aside = if orthographic { reach.length() } else { 0.0 };
        // Inside where n · (p − eye) + more ≥ 0.
        let margin = WIDER * (eye.y.abs() + near.abs() + aside + 1.0);
        let plane = |normal: DVec3, more: f64| {
            let length = normal.length();
            let normal = normal / length;
            let away = more / length + margin - normal.dot(eye);
            normal.extend(away).as_vec4().to_array()
        };
        let side = |axis: DVec3, reach: f64| {
            if orthographic {
                plane(axis + forward * WIDER, reach)
            } else {
                plane(axis + forward * (reach * (1.0 + WIDER) + WIDER), 0.0)
            }
        };
        let mut view = Self {
            planes: [
                side(right, reach.x),
                side(-right, reach.x),
                side(up, reach.y),
                side(-up, reach.y),
                plane(forward, -near),
                [0.0, 0.0, 0.0, 1.0],
            ],
            eye: eye.as_vec3().to_array(),
            scale: (size.y / 2.0 / half) as f32,
            right: right.as_vec3().to_array(),
            near: near as f32,
            up: up.as_vec3().to_array(),
            cos_corner: (1.0 + reach.length_squared()).sqrt().recip() as f32,
            forward: forward.as_vec3().to_array(),
            orthographic: if orthographic { 1.0 } else { 0.0 },
            anchor: anchor.as_ivec2().to_array(),
            ..Self::zeroed()
        };
        view.set_metric(&TerrainLod::default());
        view
    }

    /// Numbers of the metric.
    pub fn set_metric(&mut self, detail: &TerrainLod) {
        let detail = detail.clamped();
        self.shadow_share = detail.shadow_share;
        self.classic = [0.0; 4];
        match detail.metric {
            Metric::Classic {
                patch,
                least,
                greatest,
                reach,
                height,
            } => {
                self.metric = 0;
                self.inverse_tolerance = 1.0 / patch;
                self.classic = [least, greatest, 0.6 / reach, 1.0 / height];
            }
            Metric::EdgeLength { pixels } => {
                self.metric = 1;
                self.inverse_tolerance = 1.0 / pixels;
            }
            Metric::ErrorBound { pixels } => {
                self.metric = 2;
                self.inverse_tolerance = 1.0 / pixels;
            }
        }
    }

    /// The anchor.
    #[must_use]
    pub const fn anchor(&self) -> IVec2 {
        IVec2::new(self.anchor[0], self.anchor[1])
    }

    /// How a box is seen.
    #[must_use]
    pub fn sight(&self, low: Vec3, high: Vec3) -> Sight {
        let centre = (low + high) * 0.5 - Vec3::from(self.eye);
        let half = (high - low) * 0.5;
        let distance = (centre.abs() - half).max(Vec3::ZERO).length();
        Sight {
            share: self.share(low, high),
            pixels_per_metre: self.pixels_per_metre(centre, half, distance),
            distance,
        }
    }

    /// Share of the detail of a box: 1 in the frustum, less where only its shadow is, 0 where nothing is.
    #[must_use]
    pub fn share(&self, low: Vec3, high: Vec3) -> f32 {
        let sweep = Vec3::from(self.sweep);
        let mut share = 1.0;
        for &[x, y, z, d] in &self.planes {
            let normal = Vec3::new(x, y, z);
            let farthest = Vec3::select(normal.cmpge(Vec3::ZERO), high, low);
            let inside = normal.dot(farthest) + d;
            if inside < 0.0 {
                share = if sweep == Vec3::ZERO {
                    0.0
                } else {
                    self.shadow_share
                };
                if inside + normal.dot(sweep).max(0.0) < 0.0 {
                    return 0.0;
                }
            }
        }
        share
    }

    /// `centre` relative to the eye.
    fn pixels_per_metre(&self, centre: Vec3, half: Vec3, distance: f32) -> f32 {
        let (right, up) = (Vec3::from(self.right), Vec3::from(self.up));
        if self.orthographic == 1.0 {
            return self.scale * (right.y * right.y + up.y * up.y).sqrt();
        }
        // u × P = (P_z, 0, −P_x), along a camera axis a: P_z·a_x − P_x·a_z.
        let across = |axis: Vec3| {
            (centre.z * axis.x - centre.x * axis.z).abs()
                + half.z * axis.x.abs()
                + half.x * axis.z.abs()
        };
        let (x, y) = (across(right), across(up));
        let forward = Vec3::from(self.forward);
        let least = (centre.dot(forward) - half.dot(forward.abs())).max(self.near);
        // What is seen lies no nearer to the eye's plane than this share of its distance. What it is
        // moved to may be out of view, but not by more than the box is high.
        let seen = least.max(distance * self.cos_corner);
        let moved = least.max(seen - 2.0 * half.y * forward.y.abs());
        let far = (x * x + y * y).sqrt() / (seen * moved);
        // Of what is seen |u × P| ≤ |P| ≤ w / cos_corner.
        self.scale * far.min(1.0 / (self.cos_corner * moved))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use bevy::math::Quat;

    /// A perspective camera at `eye`, turned by `rotation`, with a picture of 1920 × 1080.
    pub(crate) fn perspective(eye: Vec3, rotation: Quat, fov: f32, near: f32) -> DetailView {
        let lens = Lens::Perspective(f64::from(bevy::math::ops::tan(fov / 2.0)));
        let (eye, size) = (eye.as_dvec3(), UVec2::new(1920, 1080));
        DetailView::new(eye, rotation.as_dquat(), lens, size, f64::from(near))
    }

    fn hash(k: u32, salt: u32) -> f32 {
        let mut h = k.wrapping_mul(0x9e37_79b9) ^ salt.wrapping_mul(0x85eb_ca6b);
        h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
        h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
        (h ^ (h >> 16)) as f32 / u32::MAX as f32
    }

    /// Pixels between two points, where both are in front of the near plane.
    fn pixels(view: &DetailView, a: Vec3, b: Vec3) -> f32 {
        let at = |p: Vec3| {
            let p = p - Vec3::from(view.eye);
            let w = p.dot(Vec3::from(view.forward));
            Vec3::new(p.dot(Vec3::from(view.right)), p.dot(Vec3::from(view.up)), w)
        };
        let (a, b) = (at(a), at(b));
        ((a.truncate() / a.z) - (b.truncate() / b.z)).length() * view.scale
    }

    fn inside(view: &DetailView, p: Vec3) -> bool {
        view.planes
            .iter()
            .all(|&[x, y, z, d]| Vec3::new(x, y, z).dot(p) + d >= 0.0)
    }

    #[test]
    fn no_displacement_is_larger_than_the_bound() {
        let mut seen = 0;
        let mut largest: f32 = 0.0;
        for k in 0..40_000_u32 {
            let hash = |salt: u32| hash(k, salt);
            let rotation = Quat::from_euler(
                bevy::math::EulerRot::YXZ,
                hash(1) * std::f32::consts::TAU,
                (hash(2) - 0.5) * 3.1,
                if k % 7 == 0 {
                    std::f32::consts::PI
                } else {
                    0.0
                },
            );
            let fov = 0.1 + 2.0 * hash(3);
            let view = perspective(Vec3::new(3.0, 5.0, -2.0), rotation, fov, 0.1);
            let size = Vec3::new(hash(4), hash(5) * 0.5, hash(6)) * 40.0 * hash(7);
            let low = Vec3::new(hash(8) - 0.5, hash(9) - 0.7, hash(10) - 0.5) * 90.0;
            let sight = view.sight(low, low + size);
            for j in 0..20 {
                let place = low + size * Vec3::new(hash(20 + j), hash(50 + j), hash(80 + j));
                let other = Vec3::new(place.x, low.y + size.y * hash(110 + j), place.z);
                let depth = |p: Vec3| (p - Vec3::from(view.eye)).dot(Vec3::from(view.forward));
                if !(inside(&view, place) && depth(other) >= view.near) {
                    continue;
                }
                seen += 1;
                assert_eq!(sight.share, 1.0);
                let found = pixels(&view, place, other);
                let bound = sight.pixels_per_metre * (place.y - other.y).abs();
                // f32: a thousandth of the bound, and a hundredth of a pixel where w is near 0.
                assert!(found <= bound * 1.001 + 0.01, "{k}: {found} > {bound}");
                if bound > 1.0 {
                    largest = largest.max(found / bound);
                }
            }
        }
        assert!(seen > 10_000 && largest > 0.9, "{seen} {largest}");
    }

    #[test]
    fn what_is_outside_is_not_seen_but_for_its_shadow() {
        let mut view = perspective(Vec3::ZERO, Quat::IDENTITY, 1.0, 0.1);
        let (low, high) = (Vec3::new(-1.0, -1.0, 10.0), Vec3::new(1.0, 1.0, 12.0));
        assert_eq!(view.sight(low, high).share, 0.0);
        view.sweep = [0.0, -1.0, -30.0];
        view.shadow_share = 0.25;
        assert_eq!(view.sight(low, high).share, 0.25);
        view.sweep = [0.0, -1.0, 30.0];
        assert_eq!(view.sight(low, high).share, 0.0);
    }

    /// What an exact camera sees is in the frustum, on its border too, and what it does not see by a
    /// thousandth is not.
    #[test]
    fn frusta_hold_what_is_seen_far_from_the_origin_and_high_up() {
        for k in 0..2000_u32 {
            let unit = |salt: u32| f64::from(hash(k, salt));
            let far = [0.0, 1e6, -3e8][k as usize % 3];
            let eye = DVec3::new(far + unit(1), 9000.0 * unit(2) * unit(2), unit(3) - far);
            let turn = Quat::from_euler(
                bevy::math::EulerRot::YXZ,
                std::f32::consts::TAU * hash(k, 4),
                3.1 * (hash(k, 5) - 0.5),
                std::f32::consts::TAU * hash(k, 6),
            );
            let rotation = turn.as_dquat().normalize();
            let near = 0.01 + unit(7);
            let half = if k % 2 == 0 {
                0.02 + 1.7 * unit(8)
            } else {
                300.0 * unit(8) + 1.0
            };
            let lens = if k % 2 == 0 {
                Lens::Perspective(half)
            } else {
                Lens::Orthographic(2.0 * half)
            };
            let view = DetailView::new(eye, rotation, lens, UVec2::new(1920, 1080), near);
            let anchor = DVec3::new(f64::from(view.anchor[0]), 0.0, f64::from(view.anchor[1]));
            for j in 0..20 {
                // Half of the points on a border, half of these on the near plane.
                let w = if j % 4 == 0 {
                    near
                } else {
                    near * (1.0
                        + 1e4 * {
                            let cube = unit(20 + j) * unit(20 + j) * unit(20 + j);
                            cube * cube
                        })
                };
                let mut at = DVec2::new(unit(50 + j), unit(80 + j)) * 2.0 - 1.0;
                if j % 2 == 0 {
                    at /= at.abs().max_element();
                }
                let reach =
                    DVec2::new(1920.0 / 1080.0, 1.0) * half * if k % 2 == 0 { w } else { 1.0 };
                let place = |at: DVec2, w: f64| {
                    let local = DVec3::new(at.x * reach.x, at.y * reach.y, -w);
                    (eye + rotation * local - anchor).as_vec3()
                };
                let share = |p: Vec3| view.sight(p, p).share;
                assert_eq!(share(place(at, w)), 1.0, "{k} {j} {at} {w}");
                // Where a thousandth of the picture is well above what frusta are wider by.
                if 1e-3 * reach.y > 4.0 * WIDER * (eye.y + w + reach.length() + 1.0) {
                    let out = at / at.abs().max_element() * 1.001;
                    assert_eq!(share(place(out, w)), 0.0, "{k} {j} {out} {w}");
                }
            }
        }
    }

    #[test]
    fn an_orthographic_metre_is_foreshortened() {
        let down = Quat::from_rotation_x(-0.5).as_dquat();
        let lens = Lens::Orthographic(108.0);
        let view = DetailView::new(
            DVec3::new(7.5, 90.0, -3.25),
            down,
            lens,
            UVec2::new(1920, 1080),
            0.1,
        );
        assert_eq!((view.anchor, view.eye), ([7, -4], [0.5, 90.0, 0.75]));
        let sight = view.sight(Vec3::new(-1.0, 0.0, -99.0), Vec3::new(1.0, 3.0, -90.0));
        let expected = 10.0 * bevy::math::ops::cos(0.5);
        assert!(
            (sight.pixels_per_metre - expected).abs() < 1e-5,
            "{sight:?}"
        );
        assert_eq!(sight.share, 1.0);
    }
}
