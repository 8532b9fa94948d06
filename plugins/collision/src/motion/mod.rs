//! Movers: upright ellipsoids that slide, climb steps, stand on slopes and ride on what moves.
//!
//! Conventions: metres, f64; a wish is the way of one step, so that times do not matter here. A mover keeps
//! [`GAP`] of its radii from surfaces. Surfaces have two sides, and nothing is known of what is inside of a mesh: a
//! mover within a closed one that touches no triangle moves freely.
//!
//! One step of a mover, in this order:
//!
//! 1. what it stood on carries it, as far as others let it;
//! 2. what runs into it pushes it along the normal;
//! 3. what it still overlaps it is moved out of, the deepest first;
//! 4. it slides by its wish: plane, crease, corner, in at most three advances ([`MoveSettings::iterations`]); where a step is in the way,
//!    it goes up, on, and down, if that leads farther;
//! 5. if it stood before and does not rise, it is set down on ground within reach.

mod planes;
mod slide;
mod step;
mod world;

pub use planes::allowed;
pub use slide::{GAP, ITERATIONS};
pub use step::{Scratch, advance, advance_all};
pub use world::{Body, Pose, Touch, World};

use crate::geometry::Feature;
use crate::sweep::{FARTHEST, UnitSpace};
use bevy::math::DVec3;
use thiserror::Error;

/// Something that moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mover {
    /// Its centre.
    pub center: DVec3,
    /// Its radii along the coordinate axes.
    pub radii: DVec3,
    /// The body that it stands on, by its number in the [`World`]: it carries it.
    pub stands_on: Option<u32>,
}

impl Mover {
    /// In the air.
    #[must_use]
    pub const fn new(center: DVec3, radii: DVec3) -> Self {
        Self {
            center,
            radii,
            stands_on: None,
        }
    }
}

/// Most of [`MoveSettings::step_height`] and [`MoveSettings::snap`] together, in radii along up. A mover is raised so
/// far and set down again, and its place up there is rounded by 1e-16 of that: a hundredth of the [`GAP`] that it keeps.
pub const HIGHEST: f64 = 1e8;

/// How movers move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoveSettings {
    /// Away from the ground, of length 1.
    pub up: DVec3,
    /// The cosine of the steepest slope that is stood on, 0 to 1; steeper ones are walls to who moves into them.
    pub walkable: f64,
    /// The highest step that is climbed, metres; 0 for none. With `snap` at most [`HIGHEST`] radii.
    pub step_height: f64,
    /// How far below a mover that stood ground still holds it, metres; 0 for no farther than it touches.
    pub snap: f64,
    /// Most advances of a slide, from 1 on: what is left of the wish after them is dropped.
    pub iterations: u32,
}

impl Default for MoveSettings {
    /// For a figure of 1.8 m: slopes to 50°, steps to 0.35 m, ground within 0.3 m below.
    fn default() -> Self {
        Self {
            up: DVec3::Y,
            // cos 50°
            walkable: 0.642_787_609_686_539_3,
            step_height: 0.35,
            snap: 0.3,
            iterations: ITERATIONS,
        }
    }
}

impl MoveSettings {
    /// Whether what was touched is stood on: by the plane of the contact, or by the triangle itself, since the edge
    /// of a step touches a round foot from the side.
    #[must_use]
    pub fn is_walkable(&self, touch: &Touch) -> bool {
        let level = touch.normal.dot(self.up);
        level >= self.walkable || (level > 0.0 && touch.face.dot(self.up) >= self.walkable)
    }

    /// Whether a mover can be moved by them.
    fn check(&self, space: &UnitSpace) -> Result<(), MoveError> {
        // Comparisons that no number that is none passes.
        if !((self.up.length_squared() - 1.0).abs() < 1e-6 && self.iterations > 0) {
            return Err(MoveError::Settings(self.up));
        }
        let heights = [self.step_height, self.snap];
        let along = (space.to_unit * self.up).length();
        let right = (0.0..=1.0).contains(&self.walkable)
            && heights.iter().all(|height| *height >= 0.0)
            && heights.iter().sum::<f64>() * along <= HIGHEST;
        if right {
            Ok(())
        } else {
            Err(MoveError::Range {
                walkable: self.walkable,
                step_height: self.step_height,
                snap: self.snap,
            })
        }
    }
}

/// What a mover touched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoveContact {
    /// Which body.
    pub body: u32,
    /// Which triangle of it.
    pub triangle: u32,
    /// What part of that.
    pub feature: Feature,
    /// Where.
    pub point: DVec3,
    /// Of the plane between both, away from the surface, of length 1.
    pub normal: DVec3,
    /// The triangle's own normal on the same side; zero of one without area.
    pub face: DVec3,
    /// When, as a part of the advance in which it was touched.
    pub time: f64,
    /// How deep the mover lay in it, metres.
    pub depth: f64,
}

/// A mover that cannot be moved.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum MoveError {
    /// Not a place, or no ellipsoid.
    #[error(
        "a mover at {center} with radii {radii} is none: all have to be finite, radii above 0, and the centre within {FARTHEST:e} radii of the origin"
    )]
    Mover {
        /// Its centre.
        center: DVec3,
        /// Its radii.
        radii: DVec3,
    },
    /// Not a way.
    #[error("a wish of {0} m is not finite, or longer than {FARTHEST:e} radii")]
    Wish(DVec3),
    /// Settings without meaning.
    #[error("settings with up {0}: that is not of length 1, or no advance is allowed")]
    Settings(DVec3),
    /// Settings that are out of their range.
    #[error(
        "settings with walkable {walkable}, which has to be 0 to 1, step_height {step_height} m and snap {snap} m, which have to be 0 or more and together at most {HIGHEST:e} radii"
    )]
    Range {
        /// [`MoveSettings::walkable`].
        walkable: f64,
        /// [`MoveSettings::step_height`].
        step_height: f64,
        /// [`MoveSettings::snap`].
        snap: f64,
    },
}

/// What became of a step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MoveOutcome {
    /// Why it did not move at all.
    pub error: Option<MoveError>,
    /// Whether it stands on ground that is not too steep.
    pub grounded: bool,
    /// Whether it could not be moved out of what it overlaps, or not be pushed as far as it had to be.
    pub crushed: bool,
    /// The ground that it stands on.
    pub ground: Option<MoveContact>,
    /// What it touched, in order.
    pub contacts: Vec<MoveContact>,
    /// Advances of its slide, at most [`MoveSettings::iterations`].
    pub iterations: u32,
    /// Sweeps and queries that it took, all in all.
    pub casts: u32,
}
