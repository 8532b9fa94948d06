//! Where the material is looked at: the kinds of place that it is made for.

#![expect(
    clippy::disallowed_methods,
    reason = "f64 angles of cameras: the last bit of where one looks decides nothing"
)]

use crate::scenes::camera::Camera;
use crate::scenes::terrains;
use bevy::math::{DVec2, DVec3, UVec2};
use dolomite_ground::{GroundMaterial, MaterialBands, Sea};
use dolomite_terrain::Terrain;
use dolomite_testkit::random::Random;

/// A ground with its materials.
pub struct Place {
    /// As it is named in tables.
    pub name: &'static str,
    /// The ground.
    pub terrain: Terrain,
    /// What lies on it.
    pub material: GroundMaterial,
    /// Its water.
    pub sea: Option<Sea>,
}

/// What is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The ground at one's feet, a few metres away.
    Feet,
    /// Slopes between 20 and 400 m away.
    Middle,
    /// The whole ground, kilometres away.
    Far,
    /// Rock too steep to stand on.
    Steep,
    /// The water line.
    Shore,
    /// As [`Kind::Middle`], by the light of the moon.
    Night,
}

/// All of them.
pub const KINDS: [Kind; 6] = [
    Kind::Feet,
    Kind::Middle,
    Kind::Far,
    Kind::Steep,
    Kind::Shore,
    Kind::Night,
];

/// The grounds of a seed: an island massif in the manner of the game's scene `mountain`, and the real elevation of its
/// scene `jacksboro`, each with the bands of that scene.
#[must_use]
pub fn places(seed: u32) -> [Place; 2] {
    let bands = |sand_top, tree_line, snow_line, rock_slope| MaterialBands {
        sand_top,
        tree_line,
        snow_line,
        rock_slope,
        blend: 180.0,
        ..MaterialBands::default()
    };
    [
        Place {
            name: "mountain",
            terrain: terrains::mountain(seed),
            material: bands(5.0, 560.0, 960.0, 0.75).into(),
            sea: Some(Sea::default()),
        },
        Place {
            name: "jacksboro",
            terrain: terrains::dem(seed),
            material: bands(0.0, 2500.0, 4000.0, 0.8).into(),
            sea: None,
        },
    ]
}

impl Place {
    /// The camera of a kind of view: the first of some hundreds of random places that suits it best. `None` where
    /// there is nothing of the kind: no shore without a sea.
    #[must_use]
    pub fn camera(&self, kind: Kind, size: UVec2, seed: u32) -> Option<Camera> {
        if kind == Kind::Shore && self.sea.is_none() {
            return None;
        }
        let mut random = Random::new(seed.wrapping_mul(97).wrapping_add(kind as u32));
        let extent = self.terrain.extent();
        let sea = self.terrain.sea_level().filter(|_| self.sea.is_some());
        let sea = sea.map_or(f64::NEG_INFINITY, f64::from);
        let mut best: Option<(f64, DVec2)> = None;
        for _ in 0..600 {
            // Not at the border, where there is nothing to look at.
            let unit = DVec2::new(random.unit(), random.unit());
            let xz = extent.min + extent.size() * (0.15 + 0.7 * unit);
            let here = self.terrain.sample_f64(xz);
            let above = here.height - sea;
            let slope = here.gradient.length();
            // How badly it suits.
            let off = match kind {
                Kind::Steep => (slope - 1.6).abs(),
                Kind::Shore => (above - 1.0).abs() + 2.0 * slope,
                Kind::Feet => (slope - 0.35).abs() + f64::from(above < 8.0),
                _ => (slope - 0.3).abs() + f64::from(above < 8.0),
            };
            if best.is_none_or(|(least, _)| off < least) {
                best = Some((off, xz));
            }
        }
        let (_, at) = best?;
        let here = self.terrain.sample_f64(at);
        let ground = |xz: DVec2| self.terrain.sample_f64(xz).height.max(sea);
        let down = -here.gradient.normalize_or(DVec2::X);
        // Metres back down the slope, above the ground, and above the place that is looked at.
        let (back, up, target_up) = match kind {
            Kind::Feet => (2.2, 1.7, 0.0),
            Kind::Middle | Kind::Night => (30.0, 12.0, 14.0),
            Kind::Far => (3000.0, 500.0, 250.0),
            Kind::Steep => (60.0, 25.0, 0.0),
            Kind::Shore => (9.0, 2.5, 0.0),
        };
        let stands = at + down * back;
        let eye = ground(stands).max(here.height) + up;
        let target = DVec3::new(at.x, here.height + target_up, at.y);
        Some(looking(DVec3::new(stands.x, eye, stands.y), target, size))
    }
}

/// A pinhole of 60 degrees.
fn looking(eye: DVec3, target: DVec3, size: UVec2) -> Camera {
    let to = target - eye;
    Camera {
        eye,
        yaw: (-to.x).atan2(-to.z),
        pitch: to.y.atan2(to.x.hypot(to.z)),
        roll: 0.0,
        fov_y: 60_f64.to_radians(),
        size,
        near: 0.1,
        orthographic: None,
    }
}
