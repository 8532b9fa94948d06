//! From channels to blocks.

use super::axis::Axis;
use super::channel::{Channel, ChannelFault, ClipData, ClipError, Interpolation, Values};
use super::{AT_REST, Block, Clip, LaneKeys, Track, parts};
use crate::pose::{JointTransform, LANES, Lane};
use crate::skeleton::Skeleton;
use std::collections::HashMap;

/// One joint's part of a track while it is packed.
enum Source<const N: usize> {
    Still([f32; N]),
    Moving {
        axis: u32,
        interpolation: Interpolation,
        /// Key after key; cubic: tangent, value, tangent.
        keys: Vec<[f32; N]>,
    },
}

impl Clip {
    /// Lays a clip out for `skeleton`. What no channel moves stays in the rest pose.
    ///
    /// # Errors
    /// [`ClipError`]: names clip, joint and fault.
    pub fn new(skeleton: &Skeleton, data: &ClipData) -> Result<Self, ClipError> {
        check(skeleton, data)?;
        let joints = skeleton.len();
        let mut translations: Vec<Source<3>> = Vec::with_capacity(joints);
        let mut rotations: Vec<Source<4>> = Vec::with_capacity(joints);
        let mut scales: Vec<Source<3>> = Vec::with_capacity(joints);
        for joint in 0..joints {
            let rest: JointTransform = skeleton.rest().get(joint);
            translations.push(Source::Still(rest.translation.to_array()));
            rotations.push(Source::Still(rest.rotation.to_array()));
            scales.push(Source::Still(rest.scale.to_array()));
        }
        let mut axes = Axes::default();
        for channel in &data.channels {
            let joint = channel.joint;
            match &channel.values {
                Values::Translation(values) => {
                    translations[joint] = source(&mut axes, channel, values.clone());
                }
                Values::Scale(values) => {
                    scales[joint] = source(&mut axes, channel, values.clone());
                }
                Values::Rotation(values) => {
                    let keys = rotation_keys(values, channel.interpolation);
                    rotations[joint] = source(&mut axes, channel, keys);
                }
            }
        }
        let last = |channel: &Channel| channel.times.last().copied().unwrap_or(0.0);
        let clip = Self {
            name: data.name.clone(),
            duration: data.channels.iter().map(last).fold(0.0, f32::max),
            joints,
            translations: pack(&translations, [0.0; 3]),
            rotations: pack(&rotations, [0.0, 0.0, 0.0, 1.0]),
            scales: pack(&scales, [1.0; 3]),
            axes: axes.list,
        };
        if clip.bytes() / 4 > u32::MAX as usize {
            return Err(ClipError::TooLong { clip: clip.name });
        }
        Ok(clip)
    }
}

fn check(skeleton: &Skeleton, data: &ClipData) -> Result<(), ClipError> {
    let mut seen = HashMap::new();
    for channel in &data.channels {
        if channel.joint >= skeleton.len() {
            return Err(ClipError::NoJoint {
                clip: data.name.clone(),
                joint: channel.joint,
                joints: skeleton.len(),
            });
        }
        let twice = seen.insert((channel.joint, channel.kind()), ()).is_some();
        let fault = channel.fault().or(twice.then_some(ChannelFault::Twice));
        if let Some(what) = fault {
            return Err(ClipError::Channel {
                clip: data.name.clone(),
                joint: channel.joint,
                kind: channel.kind(),
                what,
            });
        }
    }
    Ok(())
}

/// Axes found so far, by the bits of their times.
#[derive(Default)]
struct Axes {
    list: Vec<Axis>,
    known: HashMap<Vec<u32>, u32>,
}

impl Axes {
    fn index(&mut self, times: &[f32]) -> u32 {
        let bits = times.iter().map(|time| time.to_bits()).collect();
        *self.known.entry(bits).or_insert_with(|| {
            self.list.push(Axis::new(times));
            self.list.len() as u32 - 1
        })
    }
}

/// Unit quaternions; of linear keys each on the side of the one before, so that the shorter arc is the
/// one without a change of sign. Keys and tangents of splines are left as they are: the spline is
/// normalised at its end.
fn rotation_keys(values: &[[f32; 4]], interpolation: Interpolation) -> Vec<[f32; 4]> {
    if interpolation == Interpolation::Cubic {
        return values.to_vec();
    }
    let mut before = [0.0; 4];
    values
        .iter()
        .map(|value| {
            let wide = value.map(f64::from);
            let length = wide.iter().map(|x| x * x).sum::<f64>().sqrt();
            let along: f64 = wide.iter().zip(before).map(|(a, b)| a * b).sum();
            let sign = if along < 0.0 { -1.0 } else { 1.0 };
            before = wide.map(|x| x * sign / length);
            before.map(|x| x as f32)
        })
        .collect()
}

fn source<const N: usize>(axes: &mut Axes, channel: &Channel, keys: Vec<[f32; N]>) -> Source<N> {
    let cubic = channel.interpolation == Interpolation::Cubic;
    let still = if cubic {
        let zero = |tangent: &[f32; N]| tangent.iter().all(|x| *x == 0.0);
        keys.chunks(3)
            .all(|key| key[1] == keys[1] && zero(&key[0]) && zero(&key[2]))
    } else {
        keys.iter().all(|key| *key == keys[0])
    };
    if still || channel.times.len() == 1 {
        return Source::Still(still_value(keys[usize::from(cubic)]));
    }
    Source::Moving {
        axis: axes.index(&channel.times),
        interpolation: channel.interpolation,
        keys,
    }
}

/// A spline's resting rotation was not normalised above.
fn still_value<const N: usize>(value: [f32; N]) -> [f32; N] {
    if N != 4 {
        return value;
    }
    let wide = value.map(f64::from);
    let length = wide.iter().map(|x| x * x).sum::<f64>().sqrt();
    wide.map(|x| (x / length) as f32)
}

fn pack<const N: usize>(joints: &[Source<N>], identity: [f32; N]) -> Track<N> {
    let mut track = Track::default();
    for eight in joints.chunks(LANES) {
        let block = pack_block(&mut track, eight, identity);
        track.blocks.push(block);
    }
    track
}

fn pack_block<const N: usize>(
    track: &mut Track<N>,
    eight: &[Source<N>],
    identity: [f32; N],
) -> Block<N> {
    let mut moving = eight.iter().filter_map(|source| match source {
        Source::Still(_) => None,
        Source::Moving {
            axis,
            interpolation,
            keys,
        } => Some((*axis, *interpolation, keys.len())),
    });
    let Some(kind) = moving.next() else {
        let mut value = [[0.0; LANES]; N];
        for lane in 0..LANES {
            set_lane(
                &mut value,
                lane,
                match eight.get(lane) {
                    Some(Source::Still(still)) => *still,
                    _ => identity,
                },
            );
        }
        return Block::Constant(value);
    };
    if moving.all(|other| other == kind) {
        let (axis, interpolation, keys) = kind;
        let at = track.keys.len() as u32;
        for key in 0..keys {
            let mut value: [Lane; N] = [[0.0; LANES]; N];
            for lane in 0..LANES {
                let part = key % parts(interpolation);
                set_lane(
                    &mut value,
                    lane,
                    match eight.get(lane) {
                        Some(Source::Moving { keys, .. }) => keys[key],
                        // A tangent of what rests is zero.
                        _ if parts(interpolation) == 3 && part != 1 => [0.0; N],
                        Some(Source::Still(still)) => *still,
                        None => identity,
                    },
                );
            }
            track.keys.extend(value.iter().flatten());
        }
        return Block::Uniform {
            axis,
            interpolation,
            at,
        };
    }
    let at = track.lanes.len() as u32;
    for lane in 0..LANES {
        let keys_at = track.keys.len() as u32;
        let (axis, interpolation) = match eight.get(lane) {
            Some(Source::Moving {
                axis,
                interpolation,
                keys,
            }) => {
                track.keys.extend(keys.iter().flatten());
                (*axis, *interpolation)
            }
            Some(Source::Still(still)) => {
                track.keys.extend(still);
                (AT_REST, Interpolation::Step)
            }
            None => {
                track.keys.extend(identity);
                (AT_REST, Interpolation::Step)
            }
        };
        track.lanes.push(LaneKeys {
            axis,
            interpolation,
            at: keys_at,
        });
    }
    Block::Mixed { at }
}

fn set_lane<const N: usize>(value: &mut [Lane; N], lane: usize, numbers: [f32; N]) {
    for (lanes, number) in value.iter_mut().zip(numbers) {
        lanes[lane] = number;
    }
}
