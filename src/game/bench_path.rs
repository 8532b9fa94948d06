//! The fixed paths of the bench: where the camera is at a moment of virtual time.

use bevy::math::{DVec2, DVec3, ops};
use dolomite_terrain::Ground;

use super::camera::Pose;
use super::scenes::LoadedScene;

/// A path. All are functions of the scene and of virtual time alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Path {
    /// Stands at the scene's start: what is computed once must not be computed again.
    Still,
    /// Circles the middle of the scene, looking at it: once in 40 seconds.
    Orbit,
    /// Crosses the scene at 150 m/s, 60 m above the ground.
    Fly,
    /// Walks north from the figure's start at 1.5 m/s, at the height of the eyes.
    Walk,
}

/// Seconds of one circle of [`Path::Orbit`].
const CIRCLE: f32 = 40.0;

/// Seconds of one circle of the classic scene's path: 120 frames.
const CLASSIC_CIRCLE: f64 = 2.0;

/// The path of the classic scene: 200 m from the axis, 70 m high, looking along the circle and down
/// by a quarter. In f64 but for the angles, rounded once.
pub fn classic_orbit(seconds: f32) -> Pose {
    let angle = std::f64::consts::TAU * f64::from(seconds) / CLASSIC_CIRCLE;
    let (sin, cos) = ops::sin_cos(angle as f32);
    let (sin, cos) = (f64::from(sin), f64::from(cos));
    let eye = DVec3::new(200.0 * cos, 70.0, 200.0 * sin);
    Pose::looking_at(eye, eye + DVec3::new(-sin, -0.25, cos))
}

/// Height of the eyes of the walking figure, metres.
const EYES: f64 = 1.7;

/// Height of [`Path::Fly`] above the ground, metres.
const ALTITUDE: f64 = 60.0;

impl Path {
    /// The name, as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Still => "still",
            Self::Orbit => "orbit",
            Self::Fly => "fly",
            Self::Walk => "walk",
        }
    }

    /// The camera at `seconds` after the start.
    pub fn pose(self, scene: &LoadedScene, seconds: f32) -> Pose {
        if scene.classic.is_some() && self == Self::Orbit {
            // As it is defined: not lifted above the ground.
            return classic_orbit(seconds);
        }
        let terrain = &scene.terrain;
        let surface = |place: DVec2| {
            terrain
                .height(place)
                .max(terrain.sea_level().map_or(f64::NEG_INFINITY, f64::from))
        };
        let extent = terrain.extent();
        let size = (extent.max - extent.min).min_element();
        let middle = (extent.min + extent.max) * 0.5;
        match self {
            Self::Still => scene.camera,
            Self::Orbit => {
                let (sin, cos) = ops::sin_cos(std::f32::consts::TAU * seconds / CIRCLE);
                let round = DVec2::new(f64::from(sin), f64::from(cos));
                let place = middle + round * (size * 0.33);
                let eye = surface(middle).max(surface(place)) + size * 0.04;
                Pose::looking_at(
                    DVec3::new(place.x, eye, place.y),
                    DVec3::new(middle.x, surface(middle), middle.y),
                )
            }
            Self::Fly => {
                // From edge to edge and back, for as long as it takes.
                let length = size * 0.9;
                let gone = (f64::from(seconds) * 150.0).rem_euclid(2.0 * length);
                let (along, heading) = if gone < length {
                    (gone, -1.0)
                } else {
                    (2.0 * length - gone, 1.0)
                };
                let place = middle + DVec2::new(0.0, length * 0.5 - along);
                let ahead = place + DVec2::new(0.0, 100.0 * heading);
                // The mean of a few places ahead: an aircraft does not follow every rock.
                let mean = (0..5)
                    .map(|k| surface(place + DVec2::new(0.0, 50.0 * f64::from(k) * heading)))
                    .sum::<f64>()
                    / 5.0;
                Pose::looking_at(
                    DVec3::new(place.x, mean + ALTITUDE, place.y),
                    DVec3::new(ahead.x, mean + ALTITUDE - 20.0, ahead.y),
                )
            }
            Self::Walk => {
                let place = (scene.figure - DVec2::new(0.0, f64::from(seconds) * 1.5))
                    .clamp(extent.min, extent.max);
                let ahead = place - DVec2::new(0.0, 10.0);
                Pose::looking_at(
                    DVec3::new(place.x, surface(place) + EYES, place.y),
                    DVec3::new(ahead.x, surface(ahead) + EYES, ahead.y),
                )
            }
        }
        .above(terrain, terrain.sea_level())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_classic_path_is_as_defined() {
        for (frame, eye, ahead) in [
            (0, [200.0, 70.0, 0.0], [0.0, -0.25, 1.0]),
            (30, [0.0, 70.0, 200.0], [-1.0, -0.25, 0.0]),
            (90, [0.0, 70.0, -200.0], [1.0, -0.25, 0.0]),
            (120, [200.0, 70.0, 0.0], [0.0, -0.25, 1.0]),
        ] {
            let pose = classic_orbit(frame as f32 / 60.0);
            // Sine and cosine of f32 angles up to 2 pi: 5e-7 of 200 m.
            assert!(
                pose.position.distance(DVec3::from(eye)) < 2e-4,
                "{frame}: {pose:?}"
            );
            let looks = pose.rotation() * bevy::math::Vec3::NEG_Z;
            let wanted = bevy::math::Vec3::from(ahead).normalize();
            assert!(looks.distance(wanted) < 1e-5, "{frame}: {looks}");
        }
    }
}
