//! Where a pixel's surface is, and what the pixel spans of it, by its depth alone: the CPU reference of
//! `shaders/src/geometry/once.wgsl`, by which what draws kept of surfaces is shaded once a pixel.

use bevy::math::{Mat4, Vec2, Vec3, Vec4};

/// Least cosine between a surface's normal and the way to the eye that counts; below it a pixel spans what it would at that
/// angle.
pub const LEAST_COSINE: f32 = 0.05;

/// The planes of places that are drawn in a column and in a row of the picture and at a depth, and the one whose distance
/// is w of clip space: a place p is on a plane where the product of plane and (p, 1) is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rows {
    /// Of the column.
    pub column: Vec4,
    /// Of the row.
    pub row: Vec4,
    /// Of the depth.
    pub depth: Vec4,
    /// Of w.
    pub w: Vec4,
}

impl Rows {
    /// Of a place in the picture, −1 to 1, y up, at a reversed depth, 0 to 1.
    #[must_use]
    pub fn new(clip_from_anchor: Mat4, at: Vec2, depth: f32) -> Self {
        let rows = clip_from_anchor.transpose();
        Self {
            column: rows.x_axis - at.x * rows.w_axis,
            row: rows.y_axis - at.y * rows.w_axis,
            depth: rows.z_axis - depth * rows.w_axis,
            w: rows.w_axis,
        }
    }

    /// Where the three planes meet (Cramer's rule), metres from the anchor. Not finite at depth 0 of a perspective without
    /// a far end.
    #[must_use]
    pub fn place(&self) -> Vec3 {
        let [column, row, depth] = [self.column, self.row, self.depth].map(Vec4::truncate);
        let across = row.cross(depth);
        let sum = self.column.w * across
            + self.row.w * depth.cross(column)
            + self.depth.w * column.cross(row);
        -sum / column.dot(across)
    }

    /// What a pixel spans along the rows and down the columns of a picture of `size` pixels, metres on the surface with this
    /// normal through a place: the derivatives of the place along the surface, with the row or the column held.
    #[must_use]
    pub fn footprint(&self, place: Vec3, normal: Vec3, size: Vec2) -> [Vec3; 2] {
        let (column, row) = (self.column.truncate(), self.row.truncate());
        let way = column.cross(row);
        let facing = normal.dot(way);
        let least = LEAST_COSINE * way.length();
        let facing = if facing >= 0.0 {
            facing.max(least)
        } else {
            facing.min(-least)
        };
        let scale = self.w.dot(place.extend(1.0)) * 2.0 / facing;
        [
            row.cross(normal) * (scale / size.x),
            column.cross(normal) * (scale / size.y),
        ]
    }
}

#[cfg(test)]
mod tests {
    use bevy::math::{DMat4, DVec2, DVec3, DVec4, Quat};

    use super::*;

    const SIZE: Vec2 = Vec2::new(640.0, 360.0);

    /// Views that look from (30, 12, −7), 4 km from the anchor, and from the anchor: with perspective and without.
    fn views() -> Vec<(DMat4, DVec3)> {
        let turn = Quat::from_euler(bevy::math::EulerRot::YXZ, 0.7, -0.3, 0.1);
        let eyes = [
            DVec3::new(30.0, 12.0, -7.0),
            DVec3::new(2300.0, 900.0, -3200.0),
            DVec3::ZERO,
        ];
        let lenses = [
            DMat4::from_cols_array_2d(&std::array::from_fn(|c| {
                Mat4::perspective_infinite_reverse_rh(1.0, SIZE.x / SIZE.y, 0.1).to_cols_array_2d()
                    [c]
                    .map(f64::from)
            })),
            DMat4::orthographic_rh(-40.0, 40.0, -22.5, 22.5, 2000.0, 0.1),
        ];
        let view = |eye: DVec3| DMat4::from_rotation_translation(turn.as_dquat(), eye).inverse();
        eyes.iter()
            .flat_map(|eye| lenses.map(|lens| (lens * view(*eye), *eye)))
            .collect()
    }

    fn drawn(clip: &DMat4, place: DVec3) -> (DVec2, f64, f64) {
        let at: DVec4 = *clip * place.extend(1.0);
        (at.truncate().truncate() / at.w, at.z / at.w, at.w)
    }

    /// Places in the picture of a view, at distances from 1 m to 1.9 km.
    fn places(clip: &DMat4) -> Vec<DVec3> {
        let inverse = clip.inverse();
        let rows = clip.transpose();
        let mut places = Vec::new();
        for distance in [1.0, 20.0, 300.0, 1900.0] {
            for (x, y) in [(0.0, 0.0), (-0.9, 0.4), (0.7, -0.95)] {
                // The depth at that distance along the view's own way.
                let middle = inverse * DVec4::new(0.0, 0.0, 1.0, 1.0);
                let middle = middle.truncate() / middle.w;
                let ahead = inverse * DVec4::new(0.0, 0.0, 0.5, 1.0);
                let way = (ahead.truncate() / ahead.w - middle).normalize();
                let depth = drawn(clip, middle + way * distance).1;
                let place = inverse * DVec4::new(x, y, depth, 1.0);
                places.push(place.truncate() / place.w);
            }
        }
        assert!(rows.is_finite());
        places
    }

    #[test]
    fn places_come_back_from_their_depth() {
        for (clip, eye) in views() {
            for place in places(&clip) {
                let (at, depth, _) = drawn(&clip, place);
                let rows = Rows::new(clip.as_mat4(), at.as_vec2(), depth as f32);
                let error = rows.place().as_dvec3().distance(place);
                // Rounding of places from the anchor, of the eye's own place in the planes, and of depth and lens by
                // the distance: a few steps of f32 each, more by the width of the picture.
                let scale = eye.length() + place.distance(eye) + 1.0;
                // Without perspective depth has even steps, of as many metres near as far.
                let step = at.extend(depth * (1.0 + f64::from(f32::EPSILON)));
                let beyond = clip.inverse() * step.extend(1.0);
                let step = place.distance(beyond.truncate() / beyond.w);
                let allowed = 16.0 * f64::from(f32::EPSILON) * scale + step;
                assert!(error < allowed, "{error} of {allowed} at {place}");
            }
        }
    }

    #[test]
    fn footprints_are_what_a_pixel_more_sees_of_the_plane() {
        for (clip, _) in views() {
            for place in places(&clip) {
                let (at, depth, _) = drawn(&clip, place);
                let rows = Rows::new(clip.as_mat4(), at.as_vec2(), depth as f32);
                for normal in [Vec3::Y, Vec3::new(0.5, 0.7, -0.4).normalize()] {
                    let way = rows.column.truncate().cross(rows.row.truncate());
                    if normal.dot(way).abs() < 0.1 * way.length() {
                        continue;
                    }
                    let footprint = rows.footprint(place.as_vec3(), normal, SIZE);
                    for (span, held, step) in [
                        (footprint[0], DVec2::Y, DVec2::new(2.0 / 640.0, 0.0)),
                        (footprint[1], DVec2::X, DVec2::new(0.0, -2.0 / 360.0)),
                    ] {
                        assert!(span.dot(normal).abs() < 1e-5 * span.length());
                        // A thousandth of it, so that it is the derivative.
                        let moved = drawn(&clip, place + span.as_dvec3() * 1e-3).0 - at;
                        assert!(moved.dot(held).abs() < 1e-3 * moved.length(), "{span}");
                        let share = moved.length() / (1e-3 * step.length());
                        assert!((share - 1.0).abs() < 1e-2, "{share} at {place}");
                        assert!(moved.dot(step) > 0.0, "{span} at {place}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_surface_that_is_seen_from_its_edge_spans_no_more_than_at_the_least_angle() {
        let clip = Mat4::perspective_infinite_reverse_rh(1.0, SIZE.x / SIZE.y, 0.1);
        let rows = Rows::new(clip, Vec2::ZERO, 0.01);
        let place = rows.place();
        let [dx, _] = rows.footprint(place, Vec3::X, SIZE);
        let [flat, _] = rows.footprint(place, Vec3::Z, SIZE);
        assert!(dx.is_finite() && dx.length() < 1.01 * flat.length() / LEAST_COSINE);
    }
}
