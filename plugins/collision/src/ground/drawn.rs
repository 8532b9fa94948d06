//! Movers are drawn on the ground that was drawn.

use super::GroundTiles;
use crate::plugin::{CharacterBody, MoveState};
use bevy::ecs::prelude::*;
use bevy::math::{DVec2, DVec3, Vec3Swizzles as _};
use bevy::reflect::prelude::*;
use bevy::transform::components::Transform;
use dolomite_terrain::{DrawnAnswer, GroundProbe};

/// On a mover: while it stands on ground its `Transform` is raised or lowered so that it touches the triangle that a
/// camera drew below it, as its [`GroundProbe`] says. Its steps are those without: [`MoveState::center`] stays on the
/// samples of the ground.
///
/// It is moved by no more than the error that the camera states for the triangle, what the samples miss at that place,
/// and what the slope of the triangle makes of the mover's round foot. In the air, on anything that is no ground, and
/// where nothing was drawn yet within [`OnDrawnGround::FARTHEST`] it is drawn where it is.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, PartialEq)]
#[require(GroundProbe)]
pub struct OnDrawnGround {
    /// How far above its place it is drawn, metres.
    pub raised: f64,
}

impl OnDrawnGround {
    /// How far an answer may be from where the mover is, metres: a triangle's plane holds as far as the triangle reaches,
    /// and answers are some frames old.
    pub const FARTHEST: f64 = 1.0;
}

/// Draws movers where the drawn ground is.
pub(super) fn raise(
    mut movers: Query<(
        &CharacterBody,
        &GroundProbe,
        &mut OnDrawnGround,
        &mut MoveState,
        &mut Transform,
    )>,
    grounds: Query<&GroundTiles>,
) {
    for (body, probe, mut on, mut state, mut place) in &mut movers {
        let ground = state.stands_on.and_then(|entity| grounds.get(entity).ok());
        let raised = ground
            .zip(probe.drawn)
            .and_then(|(ground, drawn)| offset(ground, &drawn, state.center, body.radii.as_dvec3()))
            .unwrap_or(0.0);
        if on.raised != raised {
            on.raised = raised;
        }
        let drawn = (state.center + DVec3::Y * raised).as_vec3();
        // Who was moved by another hand, or not moved for an error, is left where it is.
        if state.is_placed(&place) && place.translation != drawn {
            place.translation = drawn;
            let center = state.center;
            state.put(center, drawn);
        }
    }
}

/// How far the centre of an upright ellipsoid is above the plane below it that it stands on: that of a plane with a
/// gradient, at the ellipsoid's own (x, z).
fn stands_above(radii: DVec3, gradient: DVec2) -> f64 {
    let along = radii.xz() * gradient;
    (radii.y * radii.y + along.length_squared()).sqrt()
}

/// How far a mover is drawn above its centre; `None` where the answer is none for this place.
fn offset(ground: &GroundTiles, drawn: &DrawnAnswer, center: DVec3, radii: DVec3) -> Option<f64> {
    let xz = center.xz();
    let near = drawn.place.distance(xz) <= OnDrawnGround::FARTHEST;
    let surface = ground.surface(xz).filter(|_| near)?;
    let truth = ground.ground().sample(xz);
    let foot = stands_above(radii, drawn.sample.gradient);
    let raised = drawn.height_at(xz) + foot - center.y;
    let round = (foot - stands_above(radii, truth.gradient)).abs();
    let most = drawn.bound + (surface - truth.height).abs() + round + ROUNDED;
    (raised.is_finite() && most.is_finite()).then(|| raised.clamp(-most, most))
}

/// Answers and samples are rounded: of f32 at a height of some kilometres, metres.
const ROUNDED: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::ops;
    use dolomite_terrain::{Ground, GroundSample};
    use std::sync::Arc;

    struct Plane(DVec2);

    impl Ground for Plane {
        fn sample(&self, xz: DVec2) -> GroundSample {
            GroundSample {
                height: self.0.dot(xz),
                gradient: self.0,
            }
        }
    }

    fn answer(height: f64, gradient: DVec2, bound: f64) -> DrawnAnswer {
        DrawnAnswer {
            sample: GroundSample { height, gradient },
            place: DVec2::ZERO,
            bound,
            frame: 0,
        }
    }

    /// The nearest point of the ellipsoid to the plane, from the definition: the least height of its points over it.
    #[test]
    fn an_ellipsoid_touches_the_plane_that_it_is_said_to_stand_on() {
        let radii = DVec3::new(0.3, 0.9, 0.5);
        let gradient = DVec2::new(0.7, -0.4);
        let height = stands_above(radii, gradient);
        let mut least = f64::INFINITY;
        for i in 0..400 {
            for j in 0..400 {
                let [a, b] = [i as f32 * 0.0157, j as f32 * 0.007_85];
                let of = |angle: f32| [ops::cos(angle), ops::sin(angle)].map(f64::from);
                let ([cos_a, sin_a], [cos_b, sin_b]) = (of(a), of(b));
                let on = radii * DVec3::new(cos_a * sin_b, -cos_b, sin_a * sin_b);
                least = least.min(height + on.y - gradient.dot(on.xz()));
            }
        }
        // Points of f32 angles, some 0.02 apart.
        assert!((0.0..1e-4).contains(&(least + 1e-6)), "{least}");
    }

    #[test]
    fn movers_are_drawn_on_the_triangle_within_the_stated_error() {
        let radii = DVec3::new(0.3, 0.9, 0.3);
        let slope = DVec2::new(0.2, 0.1);
        let ground = GroundTiles::new(Arc::new(Plane(slope)), 0.5, 16).unwrap();
        let center = DVec3::Y * stands_above(radii, slope);
        let raised = |answer: &DrawnAnswer| offset(&ground, answer, center, radii);
        // The triangle lies 3 cm above, and the camera says that it may be 5.
        let at = raised(&answer(0.03, slope, 0.05)).unwrap();
        assert!((at - 0.03).abs() < 1e-12, "{at}");
        // Another slope: what it touches is the triangle.
        let other = DVec2::new(0.3, 0.0);
        let at = raised(&answer(-0.01, other, 0.05)).unwrap();
        let foot = center.y + at - stands_above(radii, other);
        assert!((foot + 0.01).abs() < 1e-12, "{foot}");
        // An answer that is not of this ground moves it by what is stated and no farther.
        let at = raised(&answer(4.0, slope, 0.05)).unwrap();
        assert!((0.05..0.052).contains(&at), "{at}");
        // One from elsewhere, or that is no number, is none.
        let elsewhere = DrawnAnswer {
            place: DVec2::new(0.0, 1.5),
            ..answer(0.03, slope, 0.05)
        };
        assert_eq!(raised(&elsewhere), None);
        assert_eq!(raised(&answer(f64::NAN, slope, 0.05)), None);
    }
}
