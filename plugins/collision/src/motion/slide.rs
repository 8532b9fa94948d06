//! An ellipsoid that moves until something is in its way, and then along it.

use super::planes::allowed;
use super::world::{Touch, World};
use super::{MoveContact, MoveSettings};
use crate::sweep::UnitSpace;
use bevy::math::DVec3;

/// What movers keep from surfaces, in parts of their radii: what a slide along a plane ends in must not be taken for
/// a way into its neighbours, and rounding in unit space is some 1e-15 of the way. 1e-6 of 1 m is a micrometre.
pub const GAP: f64 = 1e-6;

/// A way of less than this, in parts of the radii, is none: what is touched within it is touched at once.
const STILL: f64 = 1e-5;

/// Most advances of a move, if nothing else is set.
pub const ITERATIONS: u32 = 3;

/// Most surfaces that are taken at once at one place.
const AT_ONCE: usize = 8;

/// A slide.
#[derive(Debug, Default)]
pub struct Slide {
    /// What was touched, in order.
    pub contacts: Vec<MoveContact>,
    /// Advances: at most [`MoveSettings::iterations`].
    pub iterations: u32,
    /// Sweeps that were made.
    pub casts: u32,
    /// Normals of what was touched.
    normals: Vec<DVec3>,
}

impl Slide {
    /// Starts anew, keeping memory.
    pub fn clear(&mut self) {
        self.contacts.clear();
        self.normals.clear();
        self.iterations = 0;
        self.casts = 0;
    }

    /// Moves by `wish` and along what is in the way; gives where the centre ends.
    ///
    /// One iteration is one advance along one direction. What is touched where it ends, and would stop the next
    /// advance at once, is gathered before that: a crease and a corner are one iteration, and not three. `walls`
    /// says that slopes that are too steep are walls to what moves into them.
    pub fn run(
        &mut self,
        world: &World,
        space: &mut UnitSpace,
        wish: DVec3,
        settings: &MoveSettings,
        walls: bool,
    ) {
        let mut rest = wish;
        self.normals.clear();
        let mut advances = 0;
        while advances < settings.iterations {
            let mut moved = false;
            for _ in 0..AT_ONCE {
                let way = allowed(rest, &self.normals);
                let length = (space.to_unit * way).length();
                if length < 1e-12 {
                    self.iterations += u32::from(moved || advances == 0);
                    return;
                }
                self.casts += 1;
                let Some(touch) = world.sweep(space, way) else {
                    space.center += way;
                    self.iterations += 1;
                    return;
                };
                let time = stop(&touch, space, way);
                self.add(&touch, space, way, settings, walls);
                // A short advance is taken, but what comes next belongs to the same place.
                space.center += way * time;
                rest *= 1.0 - time;
                if time * length > STILL {
                    moved = true;
                    break;
                }
            }
            advances += 1;
            self.iterations += 1;
            if !moved {
                return;
            }
        }
    }

    fn add(
        &mut self,
        touch: &Touch,
        space: &UnitSpace,
        way: DVec3,
        settings: &MoveSettings,
        walls: bool,
    ) {
        self.contacts.push(contact(touch, space, way));
        self.normals.push(touch.normal);
        let steepness = touch.normal.dot(settings.up);
        if walls && steepness > 0.0 && !settings.is_walkable(touch) {
            // Not up it; down it as before.
            let wall = touch.normal - settings.up * steepness;
            self.normals.extend(wall.try_normalize());
        }
    }
}

/// When to stop before a touch: so early that the gap is kept. The distance is convex in time, so that going back by
/// gap / rate leaves the gap at least.
fn stop(touch: &Touch, space: &UnitSpace, way: DVec3) -> f64 {
    let rate = -(space.to_unit * way).dot(touch.unit.normal);
    if rate > 0.0 {
        (touch.unit.time - GAP / rate).max(0.0)
    } else {
        touch.unit.time
    }
}

/// As it is handed out.
pub fn contact(touch: &Touch, space: &UnitSpace, way: DVec3) -> MoveContact {
    // The nearest point of the sphere is against the normal, at the moment of the touch.
    let from_center = space.axes * -touch.unit.normal;
    MoveContact {
        body: touch.body,
        triangle: touch.triangle,
        feature: touch.unit.feature,
        point: space.center + way * touch.unit.time + from_center,
        normal: touch.normal,
        face: touch.face,
        time: touch.unit.time,
        depth: (space.axes * touch.unit.normal).length() * touch.unit.depth,
    }
}
