//! Patrols on splines.
//!
//! A closed way through points is a uniform Catmull-Rom spline (E. Catmull, R. Rom, A class of local interpolating
//! splines, 1974): it passes each point, with a continuous direction. Metres along it are looked up in a table of
//! chords, so that who patrols goes at an even speed.

use crate::clock::LogicClock;
use crate::need::Asleep;
use crate::values::Logic;
use bevy::ecs::prelude::*;
use bevy::math::{Quat, Vec3, ops};
use bevy::reflect::prelude::*;
use bevy::transform::components::Transform;
use std::sync::Arc;
use thiserror::Error;

/// Chords of a piece between two points: the length of a piece of a circle is then within a thousandth.
const CHORDS: usize = 16;

/// A way that cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum RouteError {
    /// At least two points.
    #[error("a route needs two points or more, not {0}")]
    Points(usize),
    /// Not a place.
    #[error("point {0} of a route is not finite")]
    NotFinite(usize),
    /// All points are one.
    #[error("a route of no length")]
    NoLength,
}

/// A closed way through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    points: Vec<Vec3>,
    /// Metres at the end of each chord.
    lengths: Vec<f32>,
}

impl Route {
    /// Through points, and back to the first.
    ///
    /// # Errors
    /// [`RouteError`].
    pub fn new(points: Vec<Vec3>) -> Result<Self, RouteError> {
        if points.len() < 2 {
            return Err(RouteError::Points(points.len()));
        }
        if let Some(at) = points.iter().position(|point| !point.is_finite()) {
            return Err(RouteError::NotFinite(at));
        }
        let mut route = Self {
            points,
            lengths: Vec::new(),
        };
        let mut length = 0.0;
        let mut last = route.at_piece(0, 0.0);
        for piece in 0..route.points.len() {
            for chord in 1..=CHORDS {
                let next = route.at_piece(piece, chord as f32 / CHORDS as f32);
                length += next.distance(last);
                last = next;
                route.lengths.push(length);
            }
        }
        match length > 0.0 && length.is_finite() {
            true => Ok(route),
            false => Err(RouteError::NoLength),
        }
    }

    /// Metres once around.
    #[must_use]
    pub fn length(&self) -> f32 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    fn at_piece(&self, piece: usize, t: f32) -> Vec3 {
        let count = self.points.len();
        let point = |offset: usize| self.points[(piece + count + offset - 1) % count];
        let (a, b, c, d) = (point(0), point(1), point(2), point(3));
        let (t2, t3) = (t * t, t * t * t);
        0.5 * (2.0 * b
            + (c - a) * t
            + (2.0 * a - 5.0 * b + 4.0 * c - d) * t2
            + (3.0 * b - a - 3.0 * c + d) * t3)
    }

    /// The place so many metres along, around and around; a number that is not finite is the first point.
    #[must_use]
    pub fn at(&self, metres: f32) -> Vec3 {
        let along = metres.rem_euclid(self.length());
        if !along.is_finite() {
            return self.points[0];
        }
        let chord = self.lengths.partition_point(|&end| end < along);
        let chord = chord.min(self.lengths.len() - 1);
        let start = if chord == 0 {
            0.0
        } else {
            self.lengths[chord - 1]
        };
        let span = self.lengths[chord] - start;
        let part = if span > 0.0 {
            (along - start) / span
        } else {
            0.0
        };
        let t = ((chord % CHORDS) as f32 + part) / CHORDS as f32;
        self.at_piece(chord / CHORDS, t)
    }
}

/// Moves its entity along a route, looking where it goes.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Clone)]
#[reflect(from_reflect = false)]
#[require(Logic, Transform)]
pub struct Patrol {
    /// The way.
    #[reflect(ignore)]
    pub route: Arc<Route>,
    /// Metres a second; below 0 it goes the other way around. What is not finite stands.
    pub speed: f32,
    /// Metres along.
    pub along: f32,
    /// Whether it stands, as one does who heard something.
    pub halted: bool,
}

impl Patrol {
    /// From the first point on.
    #[must_use]
    pub const fn new(route: Arc<Route>, speed: f32) -> Self {
        Self {
            route,
            speed,
            along: 0.0,
            halted: false,
        }
    }
}

pub(super) fn patrol(
    clock: Res<LogicClock>,
    mut patrols: Query<(&mut Patrol, &mut Transform), Without<Asleep>>,
) {
    for (mut patrol, mut transform) in &mut patrols {
        if patrol.halted || !patrol.speed.is_finite() || patrol.speed == 0.0 {
            continue;
        }
        let along = patrol.along + patrol.speed * clock.delta;
        patrol.along = along.rem_euclid(patrol.route.length());
        let place = patrol.route.at(patrol.along);
        // A hand's breadth ahead.
        let ahead = patrol
            .route
            .at(patrol.along + 0.1_f32.copysign(patrol.speed))
            - place;
        transform.translation = place;
        if ahead.x != 0.0 || ahead.z != 0.0 {
            transform.rotation = Quat::from_rotation_y(ops::atan2(-ahead.x, -ahead.z));
        }
    }
}
