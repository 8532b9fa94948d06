//! Our movers.

use super::messages::ProgramError;
use super::method::{RADIUS, Walkers, timed};
use bevy::math::DVec3;
use dolomite_collision::{Body, MoveOutcome, MoveSettings, Mover, Scratch, World, advance};

/// Balls that our movers are.
pub struct Movers<'a> {
    world: World<'a>,
    /// Of all of them.
    pub settings: MoveSettings,
    /// Each where it is.
    pub movers: Vec<Mover>,
    scratch: Scratch,
    outcome: MoveOutcome,
}

impl<'a> Movers<'a> {
    /// At these places, in a world of these bodies.
    pub fn new(bodies: &'a [Body<'a>], places: &[DVec3]) -> Self {
        let mover = |&place| Mover::new(place, DVec3::splat(RADIUS));
        Self {
            world: World::new(bodies),
            settings: MoveSettings::default(),
            movers: places.iter().map(mover).collect(),
            scratch: Scratch::default(),
            outcome: MoveOutcome::default(),
        }
    }

    /// One step of one ball, and whether it stands then.
    pub fn advance(&mut self, ball: usize, wish: DVec3) -> bool {
        let mover = &mut self.movers[ball];
        let (scratch, outcome) = (&mut self.scratch, &mut self.outcome);
        advance(&self.world, mover, wish, &self.settings, scratch, outcome);
        outcome.grounded
    }
}

impl Walkers for Movers<'_> {
    fn step(&mut self, wishes: &[DVec3], stands: &mut [bool]) -> Result<f64, ProgramError> {
        Ok(timed(wishes, stands, |ball, wish| self.advance(ball, wish)))
    }

    fn center(&self, ball: usize) -> DVec3 {
        self.movers[ball].center
    }
}
