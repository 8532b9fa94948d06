//! Animations become clips.

use super::{LoadError, accessor};
use crate::clip::{Channel, ClipData, Interpolation, Values};
use gltf::animation::{Interpolation as Between, Property};

/// The channels of an animation that move joints. Weights of blend shapes are not for a skeleton.
pub(super) fn read(
    animation: &gltf::Animation,
    joint_of_node: &[Option<usize>],
    buffers: &[Vec<u8>],
) -> Result<ClipData, LoadError> {
    let mut channels = Vec::new();
    for channel in animation.channels() {
        let (target, sampler) = (channel.target(), channel.sampler());
        let Some(joint) = joint_of_node[target.node().index()] else {
            continue;
        };
        let values = match target.property() {
            Property::Translation => Values::Translation(accessor::floats(
                &sampler.output(),
                buffers,
                "translations",
            )?),
            Property::Rotation => {
                Values::Rotation(accessor::floats(&sampler.output(), buffers, "rotations")?)
            }
            Property::Scale => {
                Values::Scale(accessor::floats(&sampler.output(), buffers, "scales")?)
            }
            Property::MorphTargetWeights => continue,
        };
        let times = accessor::floats::<1>(&sampler.input(), buffers, "key times")?;
        channels.push(Channel {
            joint,
            times: times.into_iter().flatten().collect(),
            interpolation: match sampler.interpolation() {
                Between::Step => Interpolation::Step,
                Between::Linear => Interpolation::Linear,
                Between::CubicSpline => Interpolation::Cubic,
            },
            values,
        });
    }
    Ok(ClipData {
        name: animation.name().unwrap_or_default().to_owned(),
        channels,
    })
}
