//! Height queries for entities: the true surface at once, the drawn one some frames later.
//!
//! A [`GroundProbe`] on an entity asks for the ground under (or over) it. The **true** surface is the
//! height function in f64; it is answered on the CPU, with or without a renderer. The **drawn** surface
//! is the triangles of a frame; who draws them takes the [question](ProbeBatch::question) of that frame,
//! all places in one flat array, and [fills](ProbeBatch::fill) in what it found when it is back, frames
//! later. Nothing waits for it.
//!
//! Every answer carries the frame that it was asked in ([`ProbeBatch::frame`]); its age is the distance
//! to the present one. The stamp is stored in place of the age so that a probe at rest is not written
//! every frame.
//!
//! | place | true | drawn |
//! |---|---|---|
//! | inside the world | yes | where a triangle is drawn there |
//! | beyond every extent | yes, of the nearest terrain: a height function has no border | no |
//! | not finite | no | no |

mod answer;
mod batch;

pub use answer::GroundProbeSystems;
pub(crate) use answer::build;
pub use batch::{ProbeAnswer, ProbeBatch, ProbeError, ProbePart, ProbeQuestion};

use crate::ground::GroundSample;
use bevy::ecs::prelude::*;
use bevy::ecs::reflect::ReflectComponent;
use bevy::math::DVec2;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use bevy::transform::components::Transform;

/// Asks for the ground under (or over) an entity.
///
/// The true answer is that of the [`Terrain`](crate::Terrain) whose extent contains the place, as
/// [`terrain_at`](crate::terrain_at) chooses it; its frame is the world's, whatever transform that entity
/// has. Hidden terrains answer as well.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
#[require(Transform, batch::Asked)]
#[component(on_remove = batch::release)]
pub struct GroundProbe {
    /// Height and gradient of the true surface at the entity's (x, z); `None` before the first answer,
    /// where the world has no terrain, and at a place that is not finite.
    pub sample: Option<GroundSample>,
    /// Frame in which the place of `sample` was asked for. At rest it stays, and so does the answer; in a
    /// crowd above [`ProbeBatch::per_frame`] it says how long ago the entity was there.
    pub frame: u32,
    /// The drawn surface, if it was answered; `None` where no triangle is.
    pub drawn: Option<DrawnAnswer>,
}

/// What was drawn under a probe.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
pub struct DrawnAnswer {
    /// Height and gradient of the triangle.
    pub sample: GroundSample,
    /// Where the probe was, (x, z), metres.
    pub place: DVec2,
    /// How far the triangle may lie above or below the true surface, metres.
    pub bound: f64,
    /// Frame in which it was drawn.
    pub frame: u32,
}

/// Which surface an answer is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnswerSource {
    /// The height function, in f64.
    True,
    /// A triangle of some frame.
    Drawn,
}

/// An answer that was chosen: [`GroundProbe::answer`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundAnswer {
    /// Height and gradient.
    pub sample: GroundSample,
    /// Of which surface.
    pub source: AnswerSource,
    /// Frames since it was asked for.
    pub age: u32,
}

impl DrawnAnswer {
    /// Frames between the drawing and frame `now`.
    #[must_use]
    pub fn age(&self, now: u32) -> u32 {
        now.wrapping_sub(self.frame)
    }

    /// The triangle's plane at another place, metres: it holds as far as the triangle reaches.
    #[must_use]
    pub fn height_at(&self, xz: DVec2) -> f64 {
        self.sample.height + self.sample.gradient.dot(xz - self.place)
    }
}

impl GroundProbe {
    /// Frames between the question of the true sample and frame `now`.
    #[must_use]
    pub fn age(&self, now: u32) -> u32 {
        now.wrapping_sub(self.frame)
    }

    /// What to stand on at `xz`, where the true surface is `truth`, in frame `now`: the drawn triangle if
    /// it is at most `oldest` frames old and, carried on to `xz`, no farther from the truth than it may
    /// be; else the truth. A triangle that was left behind fails the second test, so that nobody walks
    /// on along a plane in the air.
    #[must_use]
    pub fn answer(&self, xz: DVec2, truth: GroundSample, now: u32, oldest: u32) -> GroundAnswer {
        if let Some(drawn) = self.drawn
            && drawn.age(now) <= oldest
        {
            let height = drawn.height_at(xz);
            if (height - truth.height).abs() <= drawn.bound {
                return GroundAnswer {
                    sample: GroundSample {
                        height,
                        gradient: drawn.sample.gradient,
                    },
                    source: AnswerSource::Drawn,
                    age: drawn.age(now),
                };
            }
        }
        GroundAnswer {
            sample: truth,
            source: AnswerSource::True,
            age: 0,
        }
    }
}

#[cfg(test)]
mod tests;
