//! What figures stand on.

use crate::feet::Footing;
use bevy::ecs::prelude::*;
use bevy::math::DVec2;
use core::fmt;
use dolomite_terrain::{GroundProbe, GroundSample, Terrain, terrain_at};

/// A ground of one's own, in place of a terrain: any function of the place (x, z), metres.
#[derive(Resource)]
pub struct CharacterGround(Box<dyn Fn(DVec2) -> Option<Footing> + Send + Sync>);

impl CharacterGround {
    /// A ground. Where it answers `None`, feet are where the clips have them.
    pub fn new(ground: impl Fn(DVec2) -> Option<Footing> + Send + Sync + 'static) -> Self {
        Self(Box::new(ground))
    }
}

impl fmt::Debug for CharacterGround {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("CharacterGround(..)")
    }
}

impl From<GroundSample> for Footing {
    fn from(sample: GroundSample) -> Self {
        Self {
            height: sample.height,
            gradient: sample.gradient,
        }
    }
}

/// The ground of a frame, for all figures.
#[derive(Clone, Copy)]
pub(super) struct Ground<'a> {
    pub own: Option<&'a CharacterGround>,
    /// In the order in which they are asked.
    pub terrains: &'a [&'a Terrain],
    /// The frame of ground probes.
    pub frame: u32,
}

/// A drawn answer older than this is not stood on: some frames come from the readback, the rest is for a
/// display that waits.
const OLDEST: u32 = 8;

impl Ground<'_> {
    pub fn is_there(&self) -> bool {
        self.own.is_some() || !self.terrains.is_empty()
    }

    /// The ground at a place, of the terrain there: the drawn one where the figure's probe knows it.
    pub fn at(&self, xz: DVec2, probe: Option<&GroundProbe>) -> Option<Footing> {
        if let Some(own) = self.own {
            return (own.0)(xz);
        }
        let truth = terrain_at(self.terrains.iter().copied(), xz)?.sample_f64(xz);
        Some(match probe {
            Some(probe) => probe.answer(xz, truth, self.frame, OLDEST).sample.into(),
            None => truth.into(),
        })
    }
}
