//! Clips.

use super::buffer::{Buffer, Numbers, Use};
use crate::model::{Channel, Clip, Interpolation, Property};
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::animation::{
    Animation, Channel as JsonChannel, Property as JsonProperty, Sampler, Target,
};
use gltf_json::validation::Checked;
use gltf_json::{Index, Root};

/// A clip; where it began on the file's clock is kept beside it.
pub(crate) fn animation(root: &mut Root, buffer: &mut Buffer, clip: &Clip) -> Animation {
    let mut samplers = Vec::new();
    let mut channels = Vec::new();
    for channel in &clip.channels {
        let times: Vec<[f32; 1]> = channel.times.iter().map(|&t| [t]).collect();
        let input = buffer.accessor(root, &Numbers::bounded(&times), Use::Keys);
        let output = buffer.accessor(root, &numbers(channel), Use::Keys);
        samplers.push(Sampler {
            extensions: None,
            extras: None,
            input,
            interpolation: Checked::Valid(match channel.interpolation {
                Interpolation::Step => gltf_json::animation::Interpolation::Step,
                Interpolation::Linear => gltf_json::animation::Interpolation::Linear,
                Interpolation::Cubic => gltf_json::animation::Interpolation::CubicSpline,
            }),
            output,
        });
        channels.push(JsonChannel {
            sampler: Index::new(samplers.len() as u32 - 1),
            target: Target {
                extensions: None,
                extras: None,
                node: Index::new(channel.node as u32),
                path: Checked::Valid(match channel.property {
                    Property::Translation => JsonProperty::Translation,
                    Property::Rotation => JsonProperty::Rotation,
                    Property::Scale => JsonProperty::Scale,
                    Property::Weights => JsonProperty::MorphTargetWeights,
                }),
            },
            extensions: None,
            extras: None,
        });
    }
    let extras = serde_json::json!({ "begin": clip.begin, "duration": clip.duration });
    Animation {
        extensions: None,
        extras: serde_json::value::to_raw_value(&extras).ok(),
        channels,
        name: super::names::name(&clip.name),
        samplers,
    }
}

/// Values as they are written.
pub(crate) fn numbers(channel: &Channel) -> Numbers {
    let width = match channel.property {
        Property::Translation | Property::Scale => 3,
        Property::Rotation => 4,
        Property::Weights => 1,
    };
    let short = |x: &f32| ((x * 32767.0).round() as i16).to_le_bytes();
    Numbers {
        bytes: match channel.short {
            true => channel.values.iter().flat_map(short).collect(),
            false => channel
                .values
                .iter()
                .flat_map(|x| x.to_le_bytes())
                .collect(),
        },
        component: if channel.short {
            ComponentType::I16
        } else {
            ComponentType::F32
        },
        shape: match width {
            1 => Type::Scalar,
            3 => Type::Vec3,
            _ => Type::Vec4,
        },
        count: channel.values.len() / width,
        normalised: channel.short,
        period: channel.values.len() / channel.times.len().max(1),
        bounds: None,
    }
}
