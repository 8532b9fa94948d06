//! What a figure's clips mean: written beside the model, in RON.

use super::phase::Warp;
use crate::blend::Mask;
use crate::load::Rig;
use crate::skeleton::Skeleton;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A figure's gaits, as its file has them. All names are those of clips and joints of the model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GaitData {
    /// Standing.
    pub idle: String,
    /// Walks and runs, the slowest first.
    pub strides: Vec<ClipMotion>,
    /// Turning on the spot, to the left.
    pub turn_left: Option<ClipMotion>,
    /// Turning on the spot, to the right.
    pub turn_right: Option<ClipMotion>,
    /// Taking off; once.
    pub jump: Option<String>,
    /// In the air; repeats.
    pub fall: Option<String>,
    /// Landing; once.
    pub land: Option<String>,
    /// Clips that are laid over the others when asked for.
    pub one_shots: Vec<OneShotData>,
    /// Joints that lean, from the lowest.
    pub spine: Vec<String>,
    /// The joint that carries both legs.
    pub pelvis: String,
    /// Left leg, right leg.
    pub legs: Option<[LegData; 2]>,
}

/// A clip that steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ClipMotion {
    /// Its name.
    pub clip: String,
    /// Metres a second that the ground goes by as the clip is.
    pub speed: f32,
    /// Radians a second that the figure turns as the clip is, positive.
    pub turn_rate: f32,
    /// Phases of the clip, from 0 to 1, at which the left foot lands and is lifted. It is in the air from
    /// the second to the first; a number above 1 is meant in the next turn.
    pub left: (f32, f32),
    /// The right foot's.
    pub right: (f32, f32),
}

/// A clip that is laid over the others.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct OneShotData {
    /// Its name.
    pub clip: String,
    /// The joint below which it is seen, such as the upper body; all joints if there is none.
    pub from: Option<String>,
}

/// Joints of a leg.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LegData {
    /// Thigh: its origin is the hip.
    pub hip: String,
    /// Shank: its origin is the knee.
    pub knee: String,
    /// Foot: its origin is the ankle.
    pub ankle: String,
    /// Toes: its origin is the ball.
    pub ball: String,
    /// Metres from the ankle back to the end of the heel.
    pub heel: f32,
}

/// Why gaits do not fit a model.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum GaitError {
    /// Not RON, or not of this form.
    #[error("gaits: {0}")]
    Syntax(String),
    /// A clip that the model has not.
    #[error("gaits: {of}: the model has no clip {clip:?}; it has {has}")]
    NoClip {
        /// What it is for.
        of: String,
        /// What was asked for.
        clip: String,
        /// What there is.
        has: String,
    },
    /// A joint that the model has not.
    #[error("gaits: {of}: the model has no joint {joint:?}")]
    NoJoint {
        /// What it is for.
        of: &'static str,
        /// What was asked for.
        joint: String,
    },
    /// A leg whose joints do not hang from each other.
    #[error("gaits: leg {0}: hip, knee, ankle and ball have to hang from each other in this order")]
    Leg(usize),
    /// A stride's numbers.
    #[error("gaits: clip {clip:?}: {what}")]
    Motion {
        /// Which.
        clip: String,
        /// What is wrong, and what is needed.
        what: &'static str,
    },
}

/// A figure's gaits, with clips and joints found.
#[derive(Clone, Debug)]
pub struct Gait {
    /// Clip of standing.
    pub idle: usize,
    /// Walks and runs, the slowest first.
    pub strides: Vec<MoveClip>,
    /// Turning on the spot: left, right.
    pub turns: [Option<MoveClip>; 2],
    /// Clips of taking off, being in the air, landing.
    pub air: [Option<usize>; 3],
    /// Clips laid over the others, with their joints.
    pub one_shots: Vec<(usize, Option<Mask>)>,
    /// Joints that lean, from the lowest.
    pub spine: Vec<usize>,
    /// The joint that carries both legs.
    pub pelvis: usize,
    /// Left leg, right leg.
    pub legs: Option<[LegJoints; 2]>,
}

/// A clip that steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoveClip {
    /// Which.
    pub clip: usize,
    /// Seconds of one turn.
    pub duration: f32,
    /// Metres, or radians of turning, in one turn of the clip.
    pub reach: f32,
    /// Metres a second, or radians a second.
    pub rate: f32,
    /// From the common phase to the clip's.
    pub warp: Warp,
    /// For how much of the common phase each foot stands, from its landing on.
    pub stance: [f32; 2],
}

/// Joints of a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegJoints {
    /// Thigh.
    pub hip: usize,
    /// Shank.
    pub knee: usize,
    /// Foot.
    pub ankle: usize,
    /// Toes.
    pub ball: usize,
    /// Metres from the ankle back to the end of the heel.
    pub heel: f32,
}

impl GaitData {
    /// Reads RON.
    ///
    /// # Errors
    /// [`GaitError::Syntax`], with line and column.
    pub fn from_ron(text: &str) -> Result<Self, GaitError> {
        ron::from_str(text).map_err(|error| GaitError::Syntax(error.to_string()))
    }

    /// Finds clips and joints in a model.
    ///
    /// # Errors
    /// [`GaitError`]: what is not there, or does not fit.
    pub fn resolve(&self, rig: &Rig) -> Result<Gait, GaitError> {
        let clip = |of: &str, name: &str| find_clip(rig, of, name);
        let some =
            |of: &str, name: &Option<String>| name.as_ref().map(|name| clip(of, name)).transpose();
        let turn = |data: &Option<ClipMotion>| {
            data.as_ref()
                .map(|data| move_clip(rig, data, data.turn_rate))
                .transpose()
        };
        let joint = |of, name: &str| find_joint(&rig.skeleton, of, name);
        let strides = self
            .strides
            .iter()
            .map(|data| move_clip(rig, data, data.speed))
            .collect::<Result<Vec<_>, _>>()?;
        if let Some(pair) = strides.windows(2).find(|pair| pair[0].rate >= pair[1].rate) {
            return Err(GaitError::Motion {
                clip: rig.clips[pair[1].clip].name().to_owned(),
                what: "strides have to stand in the order of their speeds, the slowest first",
            });
        }
        let one_shots = self.one_shots.iter().map(|data| {
            let from = data
                .from
                .as_ref()
                .map(|name| joint("one_shots", name))
                .transpose()?;
            let mask = from.map(|top| Mask::branch(&rig.skeleton, top));
            Ok((clip("one_shots", &data.clip)?, mask))
        });
        let spine = self.spine.iter().map(|name| joint("spine", name));
        Ok(Gait {
            idle: clip("idle", &self.idle)?,
            strides,
            turns: [turn(&self.turn_left)?, turn(&self.turn_right)?],
            air: [
                some("jump", &self.jump)?,
                some("fall", &self.fall)?,
                some("land", &self.land)?,
            ],
            one_shots: one_shots.collect::<Result<_, _>>()?,
            spine: spine.collect::<Result<_, _>>()?,
            pelvis: joint("pelvis", &self.pelvis)?,
            legs: match &self.legs {
                Some([left, right]) => Some([leg(rig, left, 0)?, leg(rig, right, 1)?]),
                None => None,
            },
        })
    }
}

fn find_clip(rig: &Rig, of: &str, name: &str) -> Result<usize, GaitError> {
    let found = rig.clips.iter().position(|clip| clip.name() == name);
    found.ok_or_else(|| GaitError::NoClip {
        of: of.to_owned(),
        clip: name.to_owned(),
        has: rig
            .clips
            .iter()
            .map(|clip| clip.name())
            .collect::<Vec<_>>()
            .join(", "),
    })
}

fn find_joint(skeleton: &Skeleton, of: &'static str, name: &str) -> Result<usize, GaitError> {
    skeleton.find(name).ok_or_else(|| GaitError::NoJoint {
        of,
        joint: name.to_owned(),
    })
}

fn move_clip(rig: &Rig, data: &ClipMotion, rate: f32) -> Result<MoveClip, GaitError> {
    let clip = find_clip(rig, "strides and turns", &data.clip)?;
    let refuse = |what| GaitError::Motion {
        clip: data.clip.clone(),
        what,
    };
    let duration = rig.clips[clip].duration();
    if !(rate > 0.0 && rate.is_finite()) {
        return Err(refuse(
            "it needs a positive speed, or turn_rate for turning",
        ));
    }
    if duration <= 0.0 {
        return Err(refuse("it lasts no time"));
    }
    let phases = [data.left.0, data.left.1, data.right.0, data.right.1];
    if !phases.iter().all(|phase| (0.0..=2.0).contains(phase)) {
        return Err(refuse("phases of feet have to lie between 0 and 2"));
    }
    let warp = Warp::new(data.left.0, data.right.0).ok_or_else(|| {
        refuse("the feet have to land at least a fifth of the clip after each other")
    })?;
    let stance = |up: f32, landing: f32| {
        (warp.invert(up) - landing)
            .rem_euclid(1.0)
            .clamp(0.05, 0.95)
    };
    Ok(MoveClip {
        clip,
        duration,
        reach: rate * duration,
        rate,
        warp,
        stance: [stance(data.left.1, 0.0), stance(data.right.1, 0.5)],
    })
}

fn leg(rig: &Rig, data: &LegData, side: usize) -> Result<LegJoints, GaitError> {
    let find = |name: &str| find_joint(&rig.skeleton, "legs", name);
    let leg = LegJoints {
        hip: find(&data.hip)?,
        knee: find(&data.knee)?,
        ankle: find(&data.ankle)?,
        ball: find(&data.ball)?,
        heel: data.heel,
    };
    let chain = [leg.hip, leg.knee, leg.ankle, leg.ball];
    let hangs = |pair: &[usize]| rig.skeleton.parent(pair[1]) == Some(pair[0]);
    if !chain.windows(2).all(hangs) || !data.heel.is_finite() {
        return Err(GaitError::Leg(side));
    }
    Ok(leg)
}
