//! Which faces of a point light's shadow map see a ball.

use bevy::camera::primitives::{Aabb, CUBE_MAP_FACES};
use bevy::math::{Affine3A, Vec3, Vec3A};

/// All six.
pub const ALL: u8 = 0b11_1111;

/// A ball in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Metres.
    pub center: Vec3,
    /// Metres; infinite where it is not known.
    pub radius: f32,
}

impl Ball {
    /// Everything.
    pub const EVERYWHERE: Self = Self {
        center: Vec3::ZERO,
        radius: f32::INFINITY,
    };

    /// Around a box in the space of a mesh.
    pub fn around(aabb: &Aabb, world_from_mesh: &Affine3A) -> Self {
        let e = aabb.half_extents;
        // The longest diagonal, sheared or not: half of the corners, the others are opposite.
        let corners = [
            e,
            e * Vec3A::new(-1.0, 1.0, 1.0),
            e * Vec3A::new(1.0, -1.0, 1.0),
            e * Vec3A::new(1.0, 1.0, -1.0),
        ];
        let radius = corners
            .map(|corner| world_from_mesh.transform_vector3a(corner).length())
            .into_iter()
            .fold(0.0, f32::max);
        Self {
            center: world_from_mesh.transform_point3a(aabb.center).into(),
            radius,
        }
    }
}

/// A bit for each face, in Bevy's order, that may see some of a ball within the light's range. Never misses one: sides
/// lie outwards by more than the sums round, and what is no number is seen by all.
pub fn that_see(light: Vec3, range: f32, ball: &Ball) -> u8 {
    let away = ball.center - light;
    let radius = ball.radius * 1.0001 + 1e-6 * (away.length() + light.length());
    if away.length() > range + radius {
        return 0;
    }
    let sees = |axis: Vec3| {
        let along = away.dot(axis);
        let others = away - along * axis;
        // The four sides of a face lie at 45°; their normals have the length √2.
        let slack = std::f32::consts::SQRT_2 * radius;
        let beside = others.abs().max_element() > along + slack;
        !beside
    };
    (0..6)
        .filter(|face| sees(CUBE_MAP_FACES[*face].target))
        .fold(0, |bits, face| bits | 1 << face)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_on_an_axis_is_seen_by_its_face_and_a_near_one_by_all() {
        for (k, face) in CUBE_MAP_FACES.iter().enumerate() {
            let ball = |distance: f32, radius: f32| Ball {
                center: Vec3::ONE + distance * face.target,
                radius,
            };
            assert_eq!(that_see(Vec3::ONE, 10.0, &ball(5.0, 0.5)), 1 << k);
            assert_eq!(that_see(Vec3::ONE, 10.0, &ball(11.0, 0.5)), 0);
            assert_ne!(that_see(Vec3::ONE, 10.0, &ball(11.0, 1.5)), 0);
            assert_eq!(that_see(Vec3::ONE, 10.0, &ball(0.5, 1.0)), ALL);
        }
        assert_eq!(that_see(Vec3::ZERO, 1.0, &Ball::EVERYWHERE), ALL);
        let nowhere = Ball {
            center: Vec3::NAN,
            radius: 1.0,
        };
        assert_eq!(that_see(Vec3::ZERO, 1.0, &nowhere), ALL);
    }

    #[test]
    fn a_face_that_sees_a_point_of_a_ball_sees_the_ball() {
        let mut state = 7_u32;
        let mut unit = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        for _ in 0..20_000 {
            let mut vector = || Vec3::new(unit(), unit(), unit()) * 2.0 - 1.0;
            let (center, way) = (vector() * 8.0, vector());
            let radius = 3.0 * unit();
            let point = center + way.normalize_or_zero() * radius * unit();
            let seen = that_see(Vec3::ZERO, 100.0, &Ball { center, radius });
            for (k, face) in CUBE_MAP_FACES.iter().enumerate() {
                let along = point.dot(face.target);
                let within = (point - along * face.target).abs().max_element() <= along;
                assert!(!within || seen & (1 << k) != 0, "{center} {radius} {point}");
            }
        }
    }

    #[test]
    fn the_ball_of_a_box_holds_its_corners() {
        let aabb = Aabb::from_min_max(Vec3::new(-1.0, 0.0, -2.0), Vec3::new(3.0, 1.0, 2.0));
        let shear = Affine3A::from_mat3_translation(
            bevy::math::Mat3::from_cols(Vec3::X, Vec3::new(0.9, 1.0, 0.0), Vec3::Z),
            Vec3::new(5.0, 6.0, 7.0),
        );
        let ball = Ball::around(&aabb, &shear);
        for k in 0..8_u32 {
            let sign = |bit: u32| if k & bit == 0 { -1.0 } else { 1.0 };
            let corner = aabb.center + aabb.half_extents * Vec3A::new(sign(1), sign(2), sign(4));
            let place: Vec3 = shear.transform_point3a(corner).into();
            assert!(place.distance(ball.center) <= ball.radius * 1.0001);
        }
    }
}
