//! Displacement along the normals of flat faces, and how it fades to nothing at their borders.
//!
//! A face is a rectangle or a symmetric trapezoid: W₀ wide at its foot, W₁ at its top, H high. A patch is a part of
//! it. Place (s, t) on the face, both 0 to 1, lies at x = ½ W₀ + (s − ½) W(t), y = t H, metres in its plane. With
//! m from the map and S(d) = smoothstep(d / band) of the distance d to each side that is a border,
//!
//! > h(x, y) = amplitude · m(x, y) · ∏ S(d)
//!
//! On a border d is exactly 0, by how patches state their place: no tolerance in uv. S and its slope are 0 there, so
//! h and its slope are, and both faces of an edge meet on the straight line between its ends.

use bevy::math::{DVec3, Vec3};
use bytemuck::{Pod, Zeroable};

use crate::map::{DisplacementMap, Sample, TEXELS_PER_METRE};

/// Where a patch lies on its face, and what displaces it: four control points of the stage, as `city/relief.wgsl`
/// reads them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PatchData {
    /// Share of the width before it, its own, behind it: exactly 0 where it lies at that border; W₀ in metres.
    pub across: [f32; 4],
    /// The same of the height; H.
    pub up: [f32; 4],
    /// W₁; borders by bits (u = 0, v = 0, u = 1, v = 1); amplitude in metres; material: surface, lot and colour.
    pub face: [f32; 4],
    /// Where the face begins in the map, texels; greatest displacement of the patch, metres; its map.
    pub map: [f32; 4],
}

/// Four corners (u, v) = (0,0), (1,0), (1,1), (0,1) with a mark that parts what must not share vertices, and the
/// data of a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CityPatch {
    /// Positions in metres, and the mark.
    pub corners: [[f32; 4]; 4],
    /// Its data.
    pub data: PatchData,
}

/// smoothstep(d / band) and its derivative by d.
fn fade(d: f32, band: f32) -> (f32, f32) {
    let t = (d / band).clamp(0.0, 1.0);
    (t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t) / band)
}

impl PatchData {
    /// Number of the patch's surface and the other bits of its material.
    #[must_use]
    pub const fn material(&self) -> u32 {
        self.face[3] as u32
    }

    /// Whether a side (u = 0, v = 0, u = 1, v = 1) lies on a border.
    #[must_use]
    pub const fn is_border(&self, side: usize) -> bool {
        let [first, _, behind, _] = if side.is_multiple_of(2) {
            self.across
        } else {
            self.up
        };
        let at_end = if side < 2 {
            first == 0.0
        } else {
            behind == 0.0
        };
        at_end && (self.face[1] as u32) & (1 << side) != 0
    }

    /// Displacement and its slopes in the plane of the face, metres, at (u, v) of the patch; in the operations of
    /// the shader.
    #[must_use]
    pub fn relief(&self, map: &DisplacementMap, band: f32, u: f32, v: f32) -> Sample {
        let [s0, ds, behind_s, w0] = self.across;
        let [t0, dt, behind_t, high] = self.up;
        let [w1, borders, amplitude, _] = self.face;
        let s = s0 + u * ds;
        let t = t0 + v * dt;
        let wide = w0 + (w1 - w0) * t;
        // How fast each side leans in.
        let lean = 0.5 * (w1 - w0) / high;
        let x = 0.5 * w0 + (s - 0.5) * wide;
        let y = t * high;
        let behind = [behind_s + (1.0 - u) * ds, behind_t + (1.0 - v) * dt];
        let bits = borders as u32;
        // Distance to each side, and its derivatives by x and y.
        let sides = [
            (s * wide, 1.0, lean),
            (y, 0.0, 1.0),
            (behind[0] * wide, -1.0, lean),
            (behind[1] * high, 0.0, -1.0),
        ];
        let (mut share, mut share_x, mut share_y) = (1.0, 0.0, 0.0);
        for (side, (distance, by_x, by_y)) in sides.into_iter().enumerate() {
            if bits & (1 << side) != 0 {
                let (value, slope) = fade(distance, band);
                share_x = share_x * value + share * (slope * by_x);
                share_y = share_y * value + share * (slope * by_y);
                share *= value;
            }
        }
        let sample = map.sample(
            self.map[0] + x * TEXELS_PER_METRE,
            self.map[1] + y * TEXELS_PER_METRE,
        );
        let [mx, my] = sample.slope.map(|slope| slope * TEXELS_PER_METRE);
        Sample {
            height: amplitude * (sample.height * share),
            slope: [
                amplitude * (mx * share + sample.height * share_x),
                amplitude * (my * share + sample.height * share_y),
            ],
        }
    }

    /// Displacement in f64: the reference, by the map's own f64 reference and by distances to lines.
    #[must_use]
    pub fn exact(&self, map: &DisplacementMap, band: f64, u: f64, v: f64) -> f64 {
        let [s0, ds, _, w0] = self.across.map(f64::from);
        let [t0, dt, _, high] = self.up.map(f64::from);
        let [w1, borders, amplitude, _] = self.face.map(f64::from);
        let (s, t) = (s0 + u * ds, t0 + v * dt);
        let wide = w0 + (w1 - w0) * t;
        let (x, y) = (0.5 * w0 + (s - 0.5) * wide, t * high);
        let left = 0.5 * (w0 - wide);
        let right = 0.5 * (w0 + wide);
        let distances = [x - left, y, right - x, high - y];
        let share: f64 = (0..4)
            .filter(|side| borders as u32 & (1 << side) != 0)
            .map(|side| {
                let t = (distances[side] / band).clamp(0.0, 1.0);
                t * t * (3.0 - 2.0 * t)
            })
            .product();
        let texels = f64::from(TEXELS_PER_METRE);
        let [phase_x, phase_y, ..] = self.map.map(f64::from);
        amplitude * share * map.exact(phase_x + x * texels, phase_y + y * texels)[0]
    }
}

/// Whether `a` comes before `b`: the order in which the ends of a side are taken from both faces.
fn is_first(a: [f32; 4], b: [f32; 4]) -> bool {
    if a[0] != b[0] {
        a[0] < b[0]
    } else if a[1] != b[1] {
        a[1] < b[1]
    } else {
        a[2] < b[2]
    }
}

fn between(a: Vec3, b: Vec3, t: f32) -> Vec3 {
    // Exact at both ends.
    a * (1.0 - t) + b * t
}

impl CityPatch {
    /// The point of the flat face at (u, v). On a side it depends on the two ends of the side alone, taken in one
    /// order, so that the faces on both sides of an edge get the same bits.
    #[must_use]
    pub fn base(&self, u: f32, v: f32) -> Vec3 {
        let [c0, c1, c2, c3] = self.corners;
        let side = if u == 0.0 {
            Some((c0, c3, v))
        } else if u == 1.0 {
            Some((c1, c2, v))
        } else if v == 0.0 {
            Some((c0, c1, u))
        } else if v == 1.0 {
            Some((c3, c2, u))
        } else {
            None
        };
        let place = |c: [f32; 4]| Vec3::new(c[0], c[1], c[2]);
        match side {
            Some((a, b, t)) if is_first(a, b) => between(place(a), place(b), t),
            Some((a, b, t)) => between(place(b), place(a), 1.0 - t),
            None => between(
                between(place(c0), place(c3), v),
                between(place(c1), place(c2), v),
                u,
            ),
        }
    }

    /// Unit vectors of the face: along its foot, up in its plane, and outwards.
    #[must_use]
    pub fn frame(&self) -> [Vec3; 3] {
        let place = |k: usize| Vec3::from_slice(&self.corners[k][..3]);
        let along = (place(1) - place(0)).normalize();
        let out = along.cross(place(3) - place(0)).normalize();
        [along, out.cross(along), out]
    }

    /// Position and normal (not of length 1) of the displaced face at (u, v).
    #[must_use]
    pub fn evaluate(&self, map: &DisplacementMap, band: f32, u: f32, v: f32) -> (Vec3, Vec3) {
        let [along, up, out] = self.frame();
        let relief = self.data.relief(map, band, u, v);
        let [dx, dy] = relief.slope;
        (
            self.base(u, v) + out * relief.height,
            out - along * dx - up * dy,
        )
    }

    /// Position of the displaced face in f64: the reference.
    #[must_use]
    pub fn exact(&self, map: &DisplacementMap, band: f64, u: f64, v: f64) -> DVec3 {
        let [c0, c1, c2, c3] = self
            .corners
            .map(|c| DVec3::new(f64::from(c[0]), f64::from(c[1]), f64::from(c[2])));
        let base =
            c0 * (1.0 - u) * (1.0 - v) + c1 * u * (1.0 - v) + c2 * u * v + c3 * (1.0 - u) * v;
        let out = (c1 - c0).cross(c3 - c0).normalize();
        base + out * self.data.exact(map, band, u, v)
    }
}
