//! Which lights a view can see.
//!
//! A light is kept if the sphere of its range touches the five half-spaces of the view; the far plane is left out,
//! for Bevy's projections draw beyond it. Nothing that lights a pixel is dropped: the planes lie outwards by more
//! than the rounding of the test.

use bevy::math::{Mat4, Vec3, Vec4};

use crate::light::LightRow;

/// The half-spaces of a view, in the world but from the camera; (normal, distance), normals of length 1 inwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sides {
    camera: Vec3,
    planes: [Vec4; 5],
}

impl Sides {
    /// Of a view: its matrix without the translation, the camera's place, and the projection. Planes of a matrix
    /// that has none are left out, so that nothing is dropped.
    #[must_use]
    pub fn new(clip_from_view: Mat4, world_from_view: Mat4) -> Self {
        let mut turned = world_from_view;
        turned.w_axis = Vec4::W;
        let clip = clip_from_view * turned.inverse();
        let w = clip.row(3);
        let (x, y, z) = (clip.row(0), clip.row(1), clip.row(2));
        // Depth is reversed: nearer than the near plane is z > w.
        let planes = [w + x, w - x, w + y, w - y, w - z].map(|plane| {
            let length = plane.truncate().length();
            if length > 1e-20 && plane.is_finite() {
                plane / length
            } else {
                Vec4::ZERO
            }
        });
        Self {
            camera: world_from_view.w_axis.truncate(),
            planes,
        }
    }

    /// Whether some of the sphere may be seen.
    #[must_use]
    pub fn touch(&self, position: Vec3, range: f32) -> bool {
        let offset = position - self.camera;
        // The sums below round by some 1e-7 of the distance.
        let reach = range * 1.001 + 1e-6 * offset.length();
        self.planes
            .iter()
            .all(|plane| plane.truncate().dot(offset) + plane.w >= -reach)
    }
}

/// What a view sees of all lights: four runs of rows, each in the order of all lights.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Listed {
    /// Indices of rows.
    pub indices: Vec<u32>,
    /// Where the runs end: points and spots that cast no shadows, points and spots that do.
    pub ends: [u32; 4],
    /// Kept for its memory.
    runs: [Vec<u32>; 3],
}

impl Listed {
    /// Fills the list anew, keeping its memory; without `sides` nothing is left out for its place. `may` says for
    /// each row whether the view may see it at all.
    pub fn fill(&mut self, rows: &[LightRow], sides: Option<&Sides>, may: impl Fn(usize) -> bool) {
        self.indices.clear();
        for (index, row) in rows.iter().enumerate() {
            let seen = row.shines()
                && may(index)
                && sides.is_none_or(|sides| sides.touch(row.position.into(), row.range));
            if !seen {
                continue;
            }
            let run = match (row.casts(), row.is_point()) {
                (false, true) => &mut self.indices,
                (false, false) => &mut self.runs[0],
                (true, true) => &mut self.runs[1],
                (true, false) => &mut self.runs[2],
            };
            run.push(index as u32);
        }
        self.ends[0] = self.indices.len() as u32;
        for (run, end) in self.runs.iter_mut().zip(&mut self.ends[1..]) {
            self.indices.append(run);
            *end = self.indices.len() as u32;
        }
    }

    /// How many cast no shadows; those come first.
    #[must_use]
    pub const fn open(&self) -> u32 {
        self.ends[1]
    }

    /// Rows of each run: points and spots without shadows, points and spots with.
    #[must_use]
    pub fn runs(&self) -> [std::ops::Range<u32>; 4] {
        let [a, b, c, d] = self.ends;
        [0..a, a..b, b..c, c..d]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::{CASTS, CONTACT, SPOT};
    use bevy::math::Quat;

    fn view(rotation: Quat, place: Vec3) -> Sides {
        let projection = Mat4::perspective_infinite_reverse_rh(1.0, 1.5, 0.1);
        Sides::new(projection, Mat4::from_rotation_translation(rotation, place))
    }

    #[test]
    fn what_is_before_the_camera_is_kept_and_what_is_behind_dropped() {
        for place in [Vec3::ZERO, Vec3::new(1e6, -3e5, 2e6)] {
            for turn in [
                Quat::IDENTITY,
                Quat::from_rotation_y(2.0),
                Quat::from_rotation_x(-1.2),
            ] {
                let sides = view(turn, place);
                let at = |x, y, z| place + turn * Vec3::new(x, y, z);
                assert!(sides.touch(at(0.0, 0.0, -10.0), 1.0));
                assert!(
                    sides.touch(at(0.0, 0.0, -1e7), 1.0),
                    "there is no far plane"
                );
                assert!(
                    sides.touch(at(0.0, 0.0, 5.0), 6.0),
                    "it reaches around the camera"
                );
                assert!(!sides.touch(at(0.0, 0.0, 8.0), 2.0));
                // tan(0.5) is 0.546, so the top edge is 5.46 m up.
                assert!(sides.touch(at(0.0, 6.0, -10.0), 1.0));
                assert!(!sides.touch(at(0.0, 9.0, -10.0), 1.0));
                assert!(!sides.touch(at(14.0, 0.0, -10.0), 1.0));
            }
        }
    }

    #[test]
    fn a_matrix_of_nonsense_drops_nothing() {
        let sides = Sides::new(Mat4::from_cols_array(&[f32::NAN; 16]), Mat4::IDENTITY);
        assert!(sides.touch(Vec3::new(0.0, 0.0, 100.0), 1.0));
    }

    #[test]
    fn runs_keep_the_order_of_all_lights() {
        let row = |z: f32, kind: u32| LightRow {
            position: [0.0, 0.0, z],
            range: 1.0,
            color: [1.0; 3],
            kind,
            ..LightRow::default()
        };
        let rows = [
            row(-5.0, CASTS | SPOT),
            row(5.0, 0),
            row(-6.0, 0),
            row(-7.0, SPOT),
            row(-8.0, CONTACT),
            row(-9.0, 0),
        ];
        let sides = view(Quat::IDENTITY, Vec3::ZERO);
        let mut listed = Listed::default();
        listed.fill(&rows, Some(&sides), |_| true);
        assert_eq!(listed.indices, [2, 5, 3, 4, 0]);
        assert_eq!(listed.runs(), [0..2, 2..3, 3..4, 4..5]);
        listed.fill(&rows, None, |index| index != 0);
        assert_eq!(listed.indices, [1, 2, 5, 3, 4]);
        assert_eq!((listed.ends, listed.open()), ([3, 4, 5, 5], 4));
    }
}
