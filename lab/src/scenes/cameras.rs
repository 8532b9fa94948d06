//! Cameras over a terrain, ordinary and hostile, from a seed.

use super::camera::Camera;
use bevy::math::{DVec2, DVec3, UVec2};
use dolomite_terrain::Terrain;
use dolomite_testkit::random::Random;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// What a camera is there for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// Eyes 1.7 m above the ground.
    Standing,
    /// 30 to 300 m above the ground, looking ahead.
    Flying,
    /// 2 to 8 cm above the ground, looking along it.
    Grazing,
    /// Above the highest summit, the whole terrain below.
    Above,
    /// The ground close by lies across the near plane.
    NearPlane,
    /// A telescope of 5 degrees.
    Narrow,
    /// 120 degrees.
    Wide,
    /// Straight down from 2 to 100 m.
    Down,
    /// Standing, with a roll of π.
    UpsideDown,
    /// Without perspective, from above, at any angle.
    Orthographic,
}

/// Every kind.
pub const KINDS: [Kind; 10] = [
    Kind::Standing,
    Kind::Flying,
    Kind::Grazing,
    Kind::Above,
    Kind::NearPlane,
    Kind::Narrow,
    Kind::Wide,
    Kind::Down,
    Kind::UpsideDown,
    Kind::Orthographic,
];

/// One camera of each kind over the terrain; same seed, same cameras.
#[must_use]
pub fn over(terrain: &Terrain, seed: u32) -> Vec<Camera> {
    KINDS
        .iter()
        .map(|&kind| camera(terrain, kind, seed))
        .collect()
}

/// A camera of a kind, 1920 × 1080: 60 degrees where the kind does not say otherwise.
#[must_use]
pub fn camera(terrain: &Terrain, kind: Kind, seed: u32) -> Camera {
    let mut random = Random::new(seed.wrapping_mul(31).wrapping_add(kind as u32));
    let xz = on_land(terrain, &mut random);
    camera_at(terrain, kind, xz, &mut random)
}

/// Cameras of a kind that look the same way; then they turn.
pub const BURST: usize = 20;

/// `count` cameras at one place, as many of each kind; [`Kind::Above`] stands over the middle. What is known
/// of the ground here serves all of them, most of all those of a [`BURST`]: they differ by a few degrees, and
/// by a fourth of their height above the ground.
#[must_use]
pub fn around(terrain: &Terrain, count: usize, seed: u32) -> Vec<(Kind, Camera)> {
    let mut random = Random::new(seed);
    let xz = on_land(terrain, &mut random);
    let mut first: Vec<Camera> = Vec::new();
    let mut cameras = Vec::with_capacity(count);
    for number in 0..count {
        let (round, at) = (number / KINDS.len(), number % KINDS.len());
        if at == 0 && round.is_multiple_of(BURST) {
            first = KINDS
                .iter()
                .map(|&kind| camera_at(terrain, kind, xz, &mut random))
                .collect();
        }
        let camera = if round.is_multiple_of(BURST) {
            first[at]
        } else {
            nudged(terrain, first[at], &mut random)
        };
        cameras.push((KINDS[at], camera));
    }
    cameras
}

/// A camera that differs a little: by up to 4 degrees of yaw and 2 of pitch, a tenth of the angle, and a
/// fourth of the height above the ground.
fn nudged(terrain: &Terrain, camera: Camera, random: &mut Random) -> Camera {
    let mut around = |most: f64| most * (2.0 * random.unit() - 1.0);
    let ground = terrain
        .sample_f64(DVec2::new(camera.eye.x, camera.eye.z))
        .height
        .max(terrain.sea_level().map_or(f64::NEG_INFINITY, f64::from));
    let height = (camera.eye.y - ground) * (1.0 + around(0.25));
    Camera {
        eye: DVec3::new(camera.eye.x, ground + height, camera.eye.z),
        yaw: camera.yaw + around(4.0_f64.to_radians()),
        pitch: camera.pitch + around(2.0_f64.to_radians()),
        fov_y: camera.fov_y * (1.0 + around(0.1)),
        orthographic: camera
            .orthographic
            .map(|metres| metres * (1.0 + around(0.1))),
        ..camera
    }
}

/// A place on land, if some is found; the sea is flat and asks for nothing.
fn on_land(terrain: &Terrain, random: &mut Random) -> DVec2 {
    let extent = terrain.extent();
    let sea = terrain.sea_level().map_or(f64::NEG_INFINITY, f64::from);
    let place = |random: &mut Random| {
        let share = DVec2::new(random.unit(), random.unit()) * 0.8 + 0.1;
        extent.min + extent.size() * share
    };
    let mut xz = place(random);
    for _ in 0..64 {
        if terrain.sample_f64(xz).height > sea + 1.0 {
            break;
        }
        xz = place(random);
    }
    xz
}

fn camera_at(terrain: &Terrain, kind: Kind, xz: DVec2, random: &mut Random) -> Camera {
    let extent = terrain.extent();
    let sea = terrain.sea_level().map_or(f64::NEG_INFINITY, f64::from);
    let ground = terrain.sample_f64(xz).height.max(sea);
    let degrees = f64::to_radians;
    let between = |random: &mut Random, low: f64, high: f64| low + (high - low) * random.unit();
    let standing = Camera {
        eye: DVec3::new(xz.x, ground + 1.7, xz.y),
        yaw: between(random, -PI, PI),
        pitch: degrees(between(random, -15.0, 5.0)),
        roll: 0.0,
        fov_y: degrees(60.0),
        size: UVec2::new(1920, 1080),
        near: 0.1,
        orthographic: None,
    };
    let up = |metres: f64| DVec3::new(xz.x, ground + metres, xz.y);
    match kind {
        Kind::Standing => standing,
        Kind::Flying => Camera {
            eye: up(between(random, 30.0, 300.0)),
            pitch: degrees(between(random, -30.0, 0.0)),
            ..standing
        },
        Kind::Grazing => Camera {
            eye: up(between(random, 0.02, 0.08)),
            pitch: degrees(between(random, -1.0, 1.0)),
            near: 0.01,
            ..standing
        },
        Kind::Above => {
            let centre = extent.centre();
            let top = f64::from(terrain.bounds(&extent).max);
            Camera {
                // High enough that the terrain fits into the screen.
                eye: DVec3::new(centre.x, top + extent.size().max_element(), centre.y),
                pitch: degrees(between(random, -90.0, -60.0)),
                ..standing
            }
        }
        Kind::NearPlane => Camera {
            eye: up(between(random, 0.3, 0.8)),
            pitch: degrees(between(random, -50.0, -20.0)),
            near: 1.5,
            ..standing
        },
        Kind::Narrow => Camera {
            eye: up(between(random, 10.0, 100.0)),
            fov_y: degrees(5.0),
            pitch: degrees(between(random, -6.0, 0.0)),
            ..standing
        },
        Kind::Wide => Camera {
            fov_y: degrees(120.0),
            ..standing
        },
        Kind::Down => Camera {
            eye: up(between(random, 2.0, 100.0)),
            pitch: degrees(-90.0),
            ..standing
        },
        Kind::UpsideDown => Camera {
            roll: PI,
            ..standing
        },
        Kind::Orthographic => {
            // 4 km back from the place that it looks at; a slope of 1 stays in front of it.
            let pitch = degrees(between(random, -90.0, -50.0));
            let looking = Camera { pitch, ..standing };
            Camera {
                eye: up(0.0) - looking.view().forward * 4000.0,
                orthographic: Some(between(random, 100.0, 1000.0)),
                ..looking
            }
        }
    }
}

/// Three ordinary cameras, the same for every run, 1920 × 1080 and 60 degrees: standing on the ground
/// a third of the way from the middle to the border, flying 150 m above it, and high above the
/// terrain, a quarter of its size up, looking down at 34 degrees.
#[must_use]
pub fn ordinary(terrain: &Terrain) -> [Camera; 3] {
    let extent = terrain.extent();
    let sea = terrain.sea_level().map_or(f64::NEG_INFINITY, f64::from);
    let at = |x: f64, z: f64| extent.centre() + extent.size() * DVec2::new(x, z);
    let xz = at(-0.091_552_734_375, 0.195_312_5);
    let ground = terrain.sample_f64(xz).height.max(sea);
    let standing = Camera {
        eye: DVec3::new(xz.x, ground + 1.7, xz.y),
        yaw: (-38.0_f64).to_radians(),
        pitch: 0.0,
        roll: 0.0,
        fov_y: 60.0_f64.to_radians(),
        size: UVec2::new(1920, 1080),
        near: 0.1,
        orthographic: None,
    };
    let south = at(0.0, 0.366_210_937_5);
    let height = extent.size().max_element() * 0.244_140_625;
    [
        standing,
        Camera {
            eye: standing.eye + DVec3::Y * 150.0,
            pitch: -0.2,
            ..standing
        },
        Camera {
            eye: DVec3::new(south.x, height, south.y),
            yaw: 0.0,
            pitch: -0.6,
            ..standing
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::places::Places;
    use crate::scenes::terrains;
    use crate::scenes::truth::Truth;

    #[test]
    fn every_camera_is_of_its_kind_and_sees_ground() {
        let terrain = terrains::fbm(1);
        let truth = Truth::new(&terrain);
        for (kind, camera) in KINDS.into_iter().zip(over(&terrain, 4)) {
            let view = camera.view();
            let above = camera.eye.y
                - terrain
                    .sample_f64(DVec2::new(camera.eye.x, camera.eye.z))
                    .height;
            match kind {
                Kind::Standing | Kind::Wide => assert!((above - 1.7).abs() < 1e-9),
                Kind::Grazing => assert!(above < 0.081),
                Kind::UpsideDown => assert!(view.up.y < 0.0),
                Kind::Down => assert!(view.forward.y < -0.999),
                _ => {}
            }
            let places = Places::new(&truth, &view, 1000, 1);
            let seen = places
                .xz
                .iter()
                .any(|&xz| view.sees(DVec3::new(xz.x, truth.height(xz), xz.y)));
            assert!(seen, "{kind:?} sees no ground");
        }
        assert_eq!(over(&terrain, 4), over(&terrain, 4));
        assert_ne!(over(&terrain, 4), over(&terrain, 5));
    }
}
