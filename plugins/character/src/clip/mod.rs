//! Clips: keys of joints over time, laid out to be sampled eight joints at a time.
//!
//! Each of translation, rotation and scale has a block for every eight joints. A block is
//!
//! | kind | when | holds |
//! |---|---|---|
//! | at rest | no lane has keys | nothing: the skeleton's rest pose |
//! | constant | all keys of each lane are equal | one value a lane |
//! | uniform | all moving lanes have the same key times and interpolation | key after key, number after number, lane after lane: two keys that follow each other lie side by side |
//! | mixed | anything else | a list of lanes, each with its axis and its keys |
//!
//! Keys lie in the order in which they are played. A lane that rests in a block that moves is written out
//! as constant keys.

mod axis;
mod build;
mod channel;
pub mod oracle;
mod sample;

pub use channel::{Channel, ChannelFault, ClipData, ClipError, Interpolation, Values};
pub use sample::Sampler;

use crate::pose::{LANES, Lane};
use axis::Axis;

/// An animation of a skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    name: String,
    duration: f32,
    joints: usize,
    axes: Vec<Axis>,
    translations: Track<3>,
    rotations: Track<4>,
    scales: Track<3>,
}

/// All joints' translations, rotations or scales: `N` numbers each.
#[derive(Clone, Debug, Default, PartialEq)]
struct Track<const N: usize> {
    blocks: Vec<Block<N>>,
    /// Keys of all blocks.
    keys: Vec<f32>,
    /// Lanes of mixed blocks.
    lanes: Vec<LaneKeys>,
}

/// Eight joints of a track.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Block<const N: usize> {
    /// The same at all times.
    Constant([Lane; N]),
    /// Every lane has these key times; `at` is the first key's place in `keys`.
    Uniform {
        axis: u32,
        interpolation: Interpolation,
        at: u32,
    },
    /// `lanes[at..at + 8]`.
    Mixed { at: u32 },
}

/// One lane of a mixed block.
#[derive(Clone, Copy, Debug, PartialEq)]
struct LaneKeys {
    /// [`AT_REST`]: one value, at all times.
    axis: u32,
    interpolation: Interpolation,
    at: u32,
}

/// The axis of a lane that does not move.
const AT_REST: u32 = u32::MAX;

impl Clip {
    /// Its name; may be empty.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Time of the last key, seconds; 0 for a clip of one pose.
    #[must_use]
    pub const fn duration(&self) -> f32 {
        self.duration
    }

    /// Joints of the skeleton that it was made for.
    #[must_use]
    pub const fn joints(&self) -> usize {
        self.joints
    }

    /// Bytes that keys and tables take.
    #[must_use]
    pub fn bytes(&self) -> usize {
        fn track<const N: usize>(track: &Track<N>) -> usize {
            size_of_val(&track.blocks[..])
                + size_of_val(&track.keys[..])
                + size_of_val(&track.lanes[..])
        }
        let axes: usize = self
            .axes
            .iter()
            .map(|axis| axis.times().len() * 8 + 4)
            .sum();
        axes + track(&self.translations) + track(&self.rotations) + track(&self.scales)
    }

    /// A time within the clip: `time` modulo the duration. For clips that repeat.
    #[must_use]
    pub fn looped(&self, time: f32) -> f32 {
        if self.duration > 0.0 && time.is_finite() {
            let wrapped = time % self.duration;
            if wrapped < 0.0 {
                (wrapped + self.duration).min(self.duration)
            } else {
                wrapped
            }
        } else {
            0.0
        }
    }
}

/// Numbers of a key: 1 for step and linear, 3 for cubic (tangent, value, tangent).
const fn parts(interpolation: Interpolation) -> usize {
    match interpolation {
        Interpolation::Step | Interpolation::Linear => 1,
        Interpolation::Cubic => 3,
    }
}

/// Floats of a key of a uniform block.
const fn stride<const N: usize>(interpolation: Interpolation) -> usize {
    parts(interpolation) * N * LANES
}
