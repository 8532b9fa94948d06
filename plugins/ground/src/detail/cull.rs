//! Triangles of which a view shows nothing: those beyond one of its borders, and those that face away.
//! The CPU reference of `shaders/src/detail/cull.wgsl`.
//!
//! Nothing else depends on it: which vertices there are and where they stand is chosen as before, so that
//! the bound and the closed mesh are untouched. It decides as the draw does, by clip space and by the order
//! of corners in the picture: what the draw's cull mode would drop is dropped before. Seen from below the
//! ground that is all of it, as before.
//!
//! **Margins.** The draw's own arithmetic may differ in the last bits, a picture may be moved by a part of a
//! pixel (temporal anti-aliasing), and corners are snapped to a grid: Vulkan promises 1/16 pixel, so that a
//! corner is off by 1/32 a side. A triangle lies beyond a border if all corners lie beyond a line one pixel
//! outside of it, or beyond the near or the far plane by more than rounding. It faces away if its corners
//! still go round the other way after each was moved by e = 0.1 pixels and what rounding adds: moved
//! corners change twice the area by at most e · (sum of its sides) + 4 e².

use bevy::math::{Mat4, Vec2, Vec3, Vec4, Vec4Swizzles as _};

/// Rounding of f32, some times: of a sum of four products, and of what made them.
const ROUNDING: f32 = 1e-6;
/// Pixels by which a corner may be drawn off its place: twice the half step of the coarsest grid.
const SNAP: f32 = 0.1;

/// What a camera draws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CullView {
    /// From places in the stage (relative to its anchor, height too) to clip space.
    pub clip: Mat4,
    /// Half the size, pixels.
    pub half_size: Vec2,
    /// Whether triangles that face away are not drawn.
    pub one_sided: bool,
}

/// Where a corner is drawn; and in bits which borders it lies beyond.
#[derive(Clone, Copy, Debug)]
struct Drawn {
    clip: Vec4,
    beyond: u32,
}

impl CullView {
    fn drawn(&self, place: Vec3) -> Drawn {
        let clip = self.clip * place.extend(1.0);
        let size = (clip.abs() + Vec4::splat(clip.w.abs())) * ROUNDING;
        let border = (Vec2::ONE + self.half_size.recip()) * clip.w;
        let least = border + clip.xy() + size.xy();
        let greatest = border - clip.xy() + size.xy();
        let outside = [
            least.x < 0.0,
            least.y < 0.0,
            greatest.x < 0.0,
            greatest.y < 0.0,
            clip.z - clip.w > size.z,
            clip.z < -size.z,
        ];
        let bits = (0..).zip(outside);
        let beyond = bits.fold(0, |all, (bit, is)| all | u32::from(is) << bit);
        Drawn { clip, beyond }
    }

    /// Whether the view shows nothing of a triangle.
    #[must_use]
    pub fn hides(&self, triangle: [Vec3; 3]) -> bool {
        let corners = triangle.map(|corner| self.drawn(corner));
        if corners.iter().fold(u32::MAX, |all, at| all & at.beyond) != 0 {
            return true;
        }
        if !self.one_sided || corners.iter().any(|at| at.clip.w <= 0.0) {
            return false;
        }
        let [a, b, c] = corners.map(|at| at.clip.xy() / at.clip.w * self.half_size);
        let (ab, ac) = (b - a, c - a);
        let around = ab.length() + ac.length() + (c - b).length();
        let reach = a.abs().max(b.abs()).max(c.abs());
        let off = SNAP + ROUNDING * (reach.x + reach.y);
        // Twice the area, upwards positive: counter-clockwise is the front. No comparison with what is not a
        // number holds: such a triangle is kept.
        ab.perp_dot(ac) < -off * (around + 4.0 * off)
    }

    /// Puts what is not hidden first; how many these are. `places` of the vertices are relative to the stage's anchor.
    pub fn sort(&self, triangles: &mut Vec<[u32; 3]>, places: &[Vec3]) -> usize {
        let hidden =
            |triangle: &[u32; 3]| self.hides(triangle.map(|corner| places[corner as usize]));
        let (others, mut first): (Vec<_>, Vec<_>) = triangles.drain(..).partition(hidden);
        let count = first.len();
        first.extend(others);
        *triangles = first;
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::Quat;

    fn hash(k: u32, salt: u32) -> f32 {
        let mut h = k.wrapping_mul(0x9e37_79b9) ^ salt.wrapping_mul(0x85eb_ca6b);
        h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
        h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
        (h ^ (h >> 16)) as f32 / u32::MAX as f32
    }

    /// Cameras of both kinds at the origin, some upside down and mirrored.
    fn picture(k: u32) -> CullView {
        let turn = Quat::from_euler(
            bevy::math::EulerRot::YXZ,
            std::f32::consts::TAU * hash(k, 1),
            3.1 * (hash(k, 2) - 0.5),
            if k.is_multiple_of(5) {
                std::f32::consts::PI
            } else {
                0.3 * hash(k, 3)
            },
        );
        let half_size = Vec2::new(320.0, 180.0);
        let aspect = half_size.x / half_size.y;
        let lens = if k.is_multiple_of(3) {
            // Reversed, as Bevy's.
            Mat4::orthographic_rh(-20.0 * aspect, 20.0 * aspect, -20.0, 20.0, 400.0, 0.1)
        } else {
            Mat4::perspective_infinite_reverse_rh(0.1 + 2.0 * hash(k, 4), aspect, 0.1)
        };
        let mirror = if k.is_multiple_of(7) {
            Vec3::new(-1.0, 1.0, 1.0)
        } else {
            Vec3::ONE
        };
        CullView {
            clip: Mat4::from_scale(mirror) * lens * Mat4::from_quat(turn).inverse(),
            half_size,
            one_sided: true,
        }
    }

    /// Triangles of all sizes around the origin, among them ones behind it and through it.
    fn triangle(k: u32, j: u32) -> [Vec3; 3] {
        let at = |salt: u32| {
            Vec3::new(
                hash(k, salt) - 0.5,
                hash(k, salt + 1) - 0.5,
                hash(k, salt + 2) - 0.5,
            )
        };
        let middle = at(100 * j + 10) * 120.0;
        let size = bevy::math::ops::exp2(9.0 * hash(k, 100 * j + 13) - 5.0);
        [0, 3, 6].map(|salt| middle + at(100 * j + 20 + salt) * size)
    }

    #[test]
    fn what_is_hidden_covers_no_pixel_however_its_corners_are_snapped() {
        let (mut hidden, mut all) = (0, 0);
        for k in 0..400_u32 {
            let picture = picture(k);
            for j in 0..60 {
                let corners = triangle(k, j);
                all += 1;
                if !picture.hides(corners) {
                    continue;
                }
                hidden += 1;
                // In f64: places inside the triangle that the picture holds are seen from behind.
                let clip = picture.clip.as_dmat4();
                let [a, b, c] = corners.map(|p| clip * p.as_dvec3().extend(1.0));
                for s in 0..=12_u32 {
                    for t in 0..=12 - s {
                        let (s, t) = (f64::from(s) / 12.0, f64::from(t) / 12.0);
                        let p = a + (b - a) * s + (c - a) * t;
                        let held = p.w > 0.0
                            && p.x.abs() <= p.w
                            && p.y.abs() <= p.w
                            && (0.0..=p.w).contains(&p.z);
                        // Sign of the area in the picture, of corners that may lie behind the eye (M. Olano,
                        // T. Greer 1997).
                        let rows = bevy::math::DMat3::from_cols(
                            bevy::math::DVec3::new(a.x, a.y, a.w),
                            bevy::math::DVec3::new(b.x, b.y, b.w),
                            bevy::math::DVec3::new(c.x, c.y, c.w),
                        );
                        assert!(!held || rows.determinant() < 0.0, "{k} {j} {p}");
                    }
                }
            }
        }
        // Half of what is in the picture faces away, and most is beyond a border.
        assert!(hidden > all / 2 && hidden < all, "{hidden} of {all}");
    }

    #[test]
    fn most_of_what_can_be_hidden_is() {
        let (mut away, mut found) = (0, 0);
        for k in 0..400_u32 {
            let picture = picture(k);
            for j in 0..60 {
                let corners = triangle(k, j);
                let [a, b, c] = corners.map(|p| picture.drawn(p));
                if [a, b, c].iter().any(|at| at.beyond != 0) {
                    continue;
                }
                let [a, b, c] = [a, b, c].map(|at| at.clip.xy() / at.clip.w * picture.half_size);
                // Of ten square pixels and more.
                if (b - a).perp_dot(c - a) < -20.0 {
                    away += 1;
                    found += usize::from(picture.hides(corners));
                }
            }
        }
        assert!(away > 300 && found * 10 > away * 9, "{found} of {away}");
    }

    #[test]
    fn two_sided_draws_keep_what_faces_away_and_nothing_hides_what_is_no_number() {
        let one = CullView {
            clip: Mat4::orthographic_rh(-1.0, 1.0, -1.0, 1.0, 10.0, 0.0),
            half_size: Vec2::splat(100.0),
            one_sided: true,
        };
        let [a, b, c] = [
            Vec3::new(0.0, 0.0, -1.0),
            Vec3::new(0.5, 0.0, -1.0),
            Vec3::new(0.0, 0.5, -1.0),
        ];
        assert!(!one.hides([a, b, c]) && one.hides([a, c, b]));
        let two = CullView {
            one_sided: false,
            ..one
        };
        assert!(!two.hides([a, c, b]));
        assert!(!one.hides([a, Vec3::NAN, b]));
        let far = [a, b, c].map(|p| p + Vec3::X * 3.0);
        assert!(one.hides(far) && two.hides(far));
        let mut triangles = vec![[0, 2, 1], [0, 1, 2], [3, 4, 5]];
        let places: Vec<Vec3> = [a, b, c].into_iter().chain(far).collect();
        assert_eq!(one.sort(&mut triangles, &places), 1);
        assert_eq!(triangles, [[0, 1, 2], [0, 2, 1], [3, 4, 5]]);
    }
}
