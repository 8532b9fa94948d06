//! The fixed paths of the bench: where the camera is at a moment of virtual time.

use bevy::math::{DVec2, DVec3, ops};
use dolomite::terrain::Ground;

use crate::scene::{LoadedScene, Pose};

/// A path. All are functions of the scene and of virtual time alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Path {
    /// From the start of the process to the first picture and to the settled one, at the scene's start.
    Start,
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

/// Height of the eyes of the walking figure, metres.
const EYES: f64 = 1.7;

/// Height of [`Path::Fly`] above the ground, metres.
const ALTITUDE: f64 = 60.0;

impl Path {
    /// The name, as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Still => "still",
            Self::Orbit => "orbit",
            Self::Fly => "fly",
            Self::Walk => "walk",
        }
    }

    /// The camera at `seconds` after the start.
    pub fn pose(self, scene: &LoadedScene, seconds: f32) -> Pose {
        if let (Some(own), Self::Orbit) = (&scene.own, self) {
            // As it is defined: not lifted above the ground.
            return own.orbit(seconds);
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
            Self::Still | Self::Start => scene.camera,
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
