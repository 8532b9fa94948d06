//! Who is sampled how often: by size in the picture, and by being in it.

use super::Character;
use bevy::ecs::prelude::*;
use bevy::math::Vec3;
use bevy::reflect::prelude::*;
use bevy::transform::components::Transform;
use bevy::transform::helper::TransformHelper;

/// Sees figures: on a camera, or on whatever figures are to be animated for. It looks along its -z.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq)]
#[require(Transform)]
pub struct CharacterEye {
    /// Height of the picture in pixels over twice the tangent of half its angle: pixels of something one
    /// metre large at one metre.
    pub focal: f32,
    /// Radians from the middle of the picture to its corner; π or more sees all around.
    pub cone: f32,
    /// Smaller than this, pixels, a figure is sampled every second frame.
    pub full: f32,
    /// Smaller than this, pixels, a figure is not sampled.
    pub least: f32,
    /// Metres within which figures out of view are sampled every second frame, for their shadows.
    pub shadows: f32,
}

impl Default for CharacterEye {
    /// A picture of 1080 rows and 60°.
    fn default() -> Self {
        Self {
            focal: 935.3,
            cone: 0.87,
            full: 120.0,
            least: 4.0,
            shadows: 25.0,
        }
    }
}

/// How often a figure is sampled.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Sampling {
    /// Not: it keeps its last pose. Its gait goes on.
    Off,
    /// Every second frame; between, a pose half-way is shown.
    Half,
    /// Every frame.
    #[default]
    Full,
}

/// How often a figure is sampled, and what has become of that.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, PartialEq)]
pub struct CharacterLod {
    /// As the eyes see it.
    pub sampling: Sampling,
    /// Its height in the picture, pixels; the greatest of all eyes. Infinite without eyes.
    pub pixels: f32,
    /// Poses sampled since it was spawned.
    pub samples: u64,
    /// Seconds since the last one.
    pub(super) since: f32,
    /// Whether the next frame shows what was sampled in the last.
    pub(super) owed: bool,
}

pub(super) fn choose(
    eyes: Query<(Entity, &CharacterEye)>,
    places: TransformHelper,
    mut figures: Query<(Entity, &Character, &mut CharacterLod)>,
) {
    let eyes: Vec<(Seer, &CharacterEye)> = eyes
        .iter()
        .filter_map(|(entity, eye)| {
            let place = places.compute_global_transform(entity).ok()?;
            let seer = Seer {
                at: place.translation(),
                ahead: place.forward().into(),
            };
            Some((seer, eye))
        })
        .collect();
    for (entity, character, mut lod) in &mut figures {
        let (sampling, pixels) = match places.compute_global_transform(entity) {
            _ if eyes.is_empty() => (Sampling::Full, f32::INFINITY),
            Ok(place) => {
                let size = character.figure.height * place.scale().y.abs();
                eyes.iter()
                    .map(|(seer, eye)| seer.look(eye, place.translation(), size))
                    .fold((Sampling::Off, 0.0_f32), |a, b| {
                        (a.0.max(b.0), a.1.max(b.1))
                    })
            }
            Err(_) => (Sampling::Off, 0.0),
        };
        if (lod.sampling, lod.pixels) != (sampling, pixels) {
            (lod.sampling, lod.pixels) = (sampling, pixels);
        }
    }
}

/// Where an eye is.
struct Seer {
    at: Vec3,
    ahead: Vec3,
}

impl Seer {
    /// How often a figure of that height is sampled for this eye, and its pixels.
    fn look(&self, eye: &CharacterEye, soles: Vec3, height: f32) -> (Sampling, f32) {
        let way = soles + Vec3::Y * (0.5 * height) - self.at;
        let distance = way.length();
        // Arms and what it holds reach out of its height: a ball about its middle, as wide as it is tall.
        let radius = height;
        let pixels = eye.focal * height / distance.max(1e-3);
        let seen = distance <= radius || {
            let angle = self.ahead.angle_between(way);
            angle - bevy::math::ops::asin((radius / distance).min(1.0)) <= eye.cone
        };
        let sampling = if pixels < eye.least {
            Sampling::Off
        } else if !seen {
            if distance < eye.shadows {
                Sampling::Half
            } else {
                Sampling::Off
            }
        } else if pixels < eye.full {
            Sampling::Half
        } else {
            Sampling::Full
        };
        (sampling, pixels)
    }
}
