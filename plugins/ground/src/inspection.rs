//! Numbers of the drawn ground in each pixel, for pictures of them: the functions of `shaders/src/ground/inspect.wgsl`,
//! in Rust.

use bevy::math::{DVec3, Mat4, Vec2, Vec3, Vec3Swizzles as _, Vec4Swizzles as _};
use bevy::prelude::*;
use bytemuck::{Pod, Zeroable};

use crate::detail::{DetailLattice, Metric};

/// What is found out of the ground in each pixel of a camera that has a [`TerrainView`](crate::TerrainView), into a texture
/// of its own. The picture of the camera stays as it is.
///
/// While a camera has it, the triangles that it sees of its ground are drawn once more: 12 bytes a pixel, and with
/// [`Self::Error`] the height function in each pixel. Ground of patches ([`PatchDetail`](crate::PatchDetail)) is not in it.
/// Without one there is no pass, no pipeline, no texture and no buffer.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Component, Default, Clone, PartialEq, Hash)]
pub enum GroundInspection {
    /// How often a root square of the ground was bisected until its triangle came out, −1 where no ground is. Half of it,
    /// rounded down, is the level of the triangle's cell: 0 for a root.
    #[default]
    Level,
    /// How far the drawn ground is from the true one, pixels: of a point and the true one above or below it, their
    /// distance in the picture. −1 where no ground is. Beside it the tolerance, pixels: that of
    /// [`Metric::ErrorBound`], else 1.
    Error,
    /// How many triangles of the ground were shaded: those that lay before all that were drawn earlier in the pixel.
    Overdraw,
}

/// What the shader knows, byte for byte.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[expect(
    missing_docs,
    reason = "each field is documented once, in inspect.wgsl"
)]
pub struct InspectionParams {
    pub clip: [[f32; 4]; 4],
    pub anchor: [i32; 2],
    pub anchor_height: f32,
    pub tolerance: f32,
    pub half_size: [f32; 2],
    pub root_area: f32,
    pub pad: f32,
    pub first_end: [f32; 2],
    pub last_begin: [f32; 2],
    pub first_stretch: [f32; 2],
    pub last_stretch: [f32; 2],
}

impl InspectionParams {
    /// Of a view of `size` pixels whose places are relative to `anchor`, and the lattice of its ground.
    #[must_use]
    pub fn new(
        lattice: &DetailLattice,
        anchor: DVec3,
        clip: Mat4,
        size: Vec2,
        metric: Metric,
    ) -> Self {
        let border = lattice.border;
        let steps = lattice.roots << (lattice.depth + 1);
        let line = |at: [i64; 2]| (lattice.signed_point(at).to_dvec2() - anchor.xz()).as_vec2();
        let width = i64::from(border.width);
        let stretch = |own: [u64; 2]| match border.width {
            0 => [1.0; 2],
            _ => [0, 1].map(|axis| (lattice.step[axis] as f64 / own[axis] as f64) as f32),
        };
        Self {
            clip: clip.to_cols_array_2d(),
            anchor: [anchor.x as i32, anchor.z as i32],
            anchor_height: anchor.y as f32,
            tolerance: match metric {
                Metric::ErrorBound { pixels } => pixels,
                Metric::EdgeLength { .. } | Metric::Classic { .. } => 1.0,
            },
            half_size: (0.5 * size).to_array(),
            root_area: lattice.sides(lattice.root_half()).element_product() as f32,
            pad: 0.0,
            first_end: line([width; 2]).to_array(),
            last_begin: line([i64::from(steps.x) - width, i64::from(steps.y) - width]).to_array(),
            first_stretch: stretch(border.first),
            last_stretch: stretch(border.last),
        }
    }

    /// A place as it would be if the outermost columns and rows were as wide as the others.
    fn evened(&self, place: Vec2) -> Vec2 {
        let axis = |k: usize| {
            let (at, first, last) = (place[k], self.first_end[k], self.last_begin[k]);
            if at < first {
                first + (at - first) * self.first_stretch[k]
            } else if at > last {
                last + (at - last) * self.last_stretch[k]
            } else {
                at
            }
        };
        Vec2::new(axis(0), axis(1))
    }

    /// How often a root was bisected until this triangle came out: a bisection halves the area, and a root square is two
    /// triangles. Corners are places along the ground relative to the anchor, metres; not in one line.
    #[must_use]
    pub fn bisections(&self, corners: [Vec2; 3]) -> u32 {
        let [a, b, c] = corners.map(|corner| self.evened(corner));
        let area = (b - a).perp_dot(c - a).abs();
        bevy::math::ops::log2(self.root_area / area)
            .round()
            .max(0.0) as u32
    }

    /// Pixels between a point relative to the anchor and the one `up` metres above it, in the picture.
    #[must_use]
    pub fn pixels(&self, point: Vec3, up: f32) -> f32 {
        let clip = Mat4::from_cols_array_2d(&self.clip);
        let (from, a_metre) = (clip * point.extend(1.0), clip.y_axis);
        // The difference of both projections, without taking one from the other: that would leave their rounding.
        let w = (from.w + up * a_metre.w).max(LEAST_W);
        let moved = (a_metre.xy() - from.xy() / from.w.max(LEAST_W) * a_metre.w) * (up / w);
        (moved * Vec2::from(self.half_size)).length()
    }
}

/// Depth below which nothing is drawn, metres: what would be divided by less.
const LEAST_W: f32 = 1e-6;

const _: () = assert!(size_of::<InspectionParams>() == 128);

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::{DVec2, UVec2};
    use dolomite_terrain::GroundRect;

    const SIZE: Vec2 = Vec2::new(640.0, 360.0);

    fn params(lattice: &DetailLattice, anchor: DVec3) -> InspectionParams {
        let clip = Mat4::perspective_infinite_reverse_rh(1.0, SIZE.x / SIZE.y, 0.1);
        InspectionParams::new(lattice, anchor, clip, SIZE, Metric::default())
    }

    /// Of all triangles that a root is bisected into, to some depth: the number of bisections that made them.
    fn check(lattice: &DetailLattice, root: UVec2, anchor: DVec3) {
        let params = params(lattice, anchor);
        let side = 2 * lattice.root_half();
        let corner = |x: u32, z: u32| (root + UVec2::new(x, z)) * side;
        let [nw, ne, se, sw] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
        // The ends of the longest edge first; the middle of it becomes the apex of both halves.
        let mut triangles = vec![([nw, se, ne], 0), ([se, nw, sw], 0)];
        while let Some(([a, b, apex], bisections)) = triangles.pop() {
            let place = |at: UVec2| {
                let from_anchor = lattice.point(at).to_dvec2() - DVec2::new(anchor.x, anchor.z);
                from_anchor.as_vec2()
            };
            let found = params.bisections([place(a), place(b), place(apex)]);
            assert_eq!(found, bisections, "{a} {b} {apex}");
            let middle = (a + b) / 2;
            if (a + b) % 2 == UVec2::ZERO && bisections < 14 {
                // One way down is enough, and another at its beginning.
                triangles.push(([a, apex, middle], bisections + 1));
                if bisections < 4 {
                    triangles.push(([apex, b, middle], bisections + 1));
                }
            }
        }
    }

    #[test]
    fn a_triangle_tells_how_often_a_root_was_bisected() {
        let extent = GroundRect::square(DVec2::new(5e5, -3e5), 4096.0);
        let lattice = DetailLattice::new(extent, 0.5);
        check(&lattice, UVec2::ZERO, DVec3::new(5e5, 30.0, -3e5));
        // Roots that are no squares.
        let extent = GroundRect::new(DVec2::ZERO, DVec2::new(300.0, 520.0));
        let lattice = DetailLattice::new(extent, 0.5);
        assert_eq!(lattice.roots, UVec2::new(1, 2));
        check(&lattice, UVec2::new(0, 1), DVec3::new(100.0, 0.0, 100.0));
    }

    #[test]
    fn columns_of_another_width_count_as_the_others() {
        // 256 samples every 4 m, the first 3 m from the border.
        let extent = GroundRect::new(DVec2::ZERO, DVec2::splat(1024.0 + 2.0));
        let lattice = DetailLattice::aligned(extent, DVec2::splat(3.0), DVec2::splat(4.0), 0.5)
            .expect("fits");
        assert_ne!(lattice.border.width, 0);
        assert_ne!(lattice.border.first, lattice.step);
        let last = lattice.roots - UVec2::ONE;
        for root in [UVec2::ZERO, last] {
            check(&lattice, root, DVec3::new(20.0, 0.0, 1000.0));
        }
    }

    #[test]
    fn pixels_are_those_between_both_projections() {
        let lattice = DetailLattice::new(GroundRect::square(DVec2::ZERO, 64.0), 1.0);
        let params = params(&lattice, DVec3::ZERO);
        let clip = Mat4::from_cols_array_2d(&params.clip).as_dmat4();
        let project = |point: Vec3| {
            let at = clip * point.as_dvec3().extend(1.0);
            at.xy() / at.w * (0.5 * SIZE).as_dvec2()
        };
        for point in [
            Vec3::new(0.0, 0.0, -10.0),
            Vec3::new(3.0, -2.0, -5.0),
            Vec3::new(-400.0, -30.0, -900.0),
        ] {
            for up in [0.25_f32, -1.0, 7.0] {
                let expected = project(point).distance(project(point + Vec3::Y * up));
                let found = f64::from(params.pixels(point, up));
                assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
            }
        }
        // Behind the eye there is no picture: far more than any tolerance, and a number.
        assert!(params.pixels(Vec3::new(1.0, 1.0, -1e-7), 1.0) > 1e6);
    }
}
