//! Clips as files have them: channels, and what is refused.

use thiserror::Error;

/// How values between two keys come about, as in glTF.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// The earlier key's value.
    Step,
    /// A straight line; of rotations the shorter slerp.
    #[default]
    Linear,
    /// A cubic spline with tangents at both ends, per second. Values come in threes: incoming tangent,
    /// value, outgoing tangent. Rotations are normalised afterwards.
    Cubic,
}

/// What a channel moves. For each key one value, or three for [`Interpolation::Cubic`].
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Metres.
    Translation(Vec<[f32; 3]>),
    /// Quaternions x, y, z, w; need not be of unit length.
    Rotation(Vec<[f32; 4]>),
    /// Factors.
    Scale(Vec<[f32; 3]>),
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Self::Translation(values) | Self::Scale(values) => values.len(),
            Self::Rotation(values) => values.len(),
        }
    }

    fn kind(&self) -> &'static str {
        match self {
            Self::Translation(_) => "translation",
            Self::Rotation(_) => "rotation",
            Self::Scale(_) => "scale",
        }
    }

    fn is_finite(&self) -> bool {
        match self {
            Self::Translation(values) | Self::Scale(values) => {
                values.iter().flatten().all(|number| number.is_finite())
            }
            Self::Rotation(values) => values.iter().flatten().all(|number| number.is_finite()),
        }
    }
}

/// Keys of one property of one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Joint of the skeleton.
    pub joint: usize,
    /// Seconds, increasing strictly.
    pub times: Vec<f32>,
    /// Between keys.
    pub interpolation: Interpolation,
    /// At keys.
    pub values: Values,
}

/// A clip as a file has it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClipData {
    /// Its name; may be empty.
    pub name: String,
    /// Its channels, at most one for each property of a joint.
    pub channels: Vec<Channel>,
}

/// Why channels are not a clip.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ClipError {
    /// A joint that the skeleton has not.
    #[error("clip {clip}: a channel moves joint {joint}, the skeleton has {joints}")]
    NoJoint {
        /// The clip's name.
        clip: String,
        /// What the channel named.
        joint: usize,
        /// How many there are.
        joints: usize,
    },
    /// A channel is wrong.
    #[error("clip {clip}: the {kind} of joint {joint} {what}")]
    Channel {
        /// The clip's name.
        clip: String,
        /// The joint.
        joint: usize,
        /// Translation, rotation or scale.
        kind: &'static str,
        /// What is wrong, and what is needed.
        what: ChannelFault,
    },
    /// More keys than the layout's 32-bit places reach.
    #[error("clip {clip}: it has more than 4 GiB of keys; split it")]
    TooLong {
        /// The clip's name.
        clip: String,
    },
}

/// What is wrong with a channel.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum ChannelFault {
    /// No keys.
    #[error("has no keys; leave the channel out")]
    Empty,
    /// Values do not fit times.
    #[error("has {values} values for {times} keys; it needs one a key, or three if cubic")]
    Count {
        /// Values.
        values: usize,
        /// Keys.
        times: usize,
    },
    /// A time is not finite, or not later than the one before.
    #[error("has key {0} at a time that is not finite or not later than the key before")]
    Time(usize),
    /// A value is not finite.
    #[error("has a value that is not finite")]
    NotFinite,
    /// A rotation of length zero.
    #[error("has a rotation of length zero")]
    ZeroRotation,
    /// Two channels for the same property.
    #[error("is moved by two channels; keep one")]
    Twice,
}

impl Channel {
    /// What is wrong with it by itself.
    pub(super) fn fault(&self) -> Option<ChannelFault> {
        if self.times.is_empty() {
            return Some(ChannelFault::Empty);
        }
        if self.values.len() != self.times.len() * super::parts(self.interpolation) {
            return Some(ChannelFault::Count {
                values: self.values.len(),
                times: self.times.len(),
            });
        }
        let mut before = f32::NEG_INFINITY;
        for (key, time) in self.times.iter().enumerate() {
            if !time.is_finite() || *time <= before {
                return Some(ChannelFault::Time(key));
            }
            before = *time;
        }
        if !self.values.is_finite() {
            return Some(ChannelFault::NotFinite);
        }
        let cubic = self.interpolation == Interpolation::Cubic;
        if let Values::Rotation(values) = &self.values {
            let keys = values
                .iter()
                .skip(usize::from(cubic))
                .step_by(if cubic { 3 } else { 1 });
            let square =
                |q: &[f32; 4]| q.iter().map(|x| f64::from(*x) * f64::from(*x)).sum::<f64>();
            if keys.into_iter().any(|key| square(key) < 1e-24) {
                return Some(ChannelFault::ZeroRotation);
            }
        }
        None
    }

    pub(super) fn kind(&self) -> &'static str {
        self.values.kind()
    }
}
