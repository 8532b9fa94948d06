//! Animated figures: clips sampled and blended, gaits, feet on the ground, crowds.

pub mod blend;
pub mod clip;
pub mod crowd;
pub mod feet;
mod figure;
pub mod gait;
pub mod load;
mod model;
mod plugin;
mod pose;
#[cfg(feature = "render")]
pub mod render;
mod simd;
mod skeleton;

pub use blend::{Blender, Fade, Layer, Mask, make_additive};
pub use clip::{Channel, ChannelFault, Clip, ClipData, ClipError, Interpolation, Sampler, Values};
pub use figure::{Figure, FigureState, Input, Workspace};
pub use load::{LoadError, Rig, Skin, SkinnedMesh};
pub use plugin::{
    Character, CharacterCounters, CharacterEye, CharacterGround, CharacterJoints, CharacterLod,
    CharacterMotion, CharacterPlugin, CharacterPose, CharacterState, CharacterSystems,
    MotionFromTransform, Sampling,
};
pub use pose::{JointTransform, Joints8, LANES, Lane, Pose};
pub use skeleton::{Joint, Skeleton, SkeletonError};
