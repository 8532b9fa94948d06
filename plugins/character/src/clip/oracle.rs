//! The truth in f64, from the channels themselves: what sampling, blending and model matrices are
//! measured against. Other formulas than theirs where there are any: slerp by `acos` and `sin`, keys
//! found by a walk, matrices multiplied out row by column.

use super::channel::{Channel, ClipData, Interpolation, Values};
use crate::skeleton::Skeleton;

/// A local transform in f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform64 {
    /// Metres.
    pub translation: [f64; 3],
    /// x, y, z, w; a unit quaternion.
    pub rotation: [f64; 4],
    /// Factors.
    pub scale: [f64; 3],
}

/// The first three rows of a matrix: row by row, the last column the translation.
pub type Matrix64 = [[f64; 4]; 3];

/// Local transforms of all joints of `data` at `time`.
///
/// # Panics
/// If a channel is one that [`Clip::new`](super::Clip::new) refuses.
#[must_use]
pub fn sample(skeleton: &Skeleton, data: &ClipData, time: f64) -> Vec<Transform64> {
    let mut pose: Vec<Transform64> = (0..skeleton.len())
        .map(|joint| {
            let rest = skeleton.rest().get(joint);
            Transform64 {
                translation: rest.translation.to_array().map(f64::from),
                rotation: unit(rest.rotation.to_array().map(f64::from)),
                scale: rest.scale.to_array().map(f64::from),
            }
        })
        .collect();
    for channel in &data.channels {
        let joint = &mut pose[channel.joint];
        match &channel.values {
            Values::Translation(values) => joint.translation = at(channel, values, time, line),
            Values::Scale(values) => joint.scale = at(channel, values, time, line),
            Values::Rotation(values) => joint.rotation = unit(at(channel, values, time, arc)),
        }
    }
    pose
}

fn at<const N: usize>(
    channel: &Channel,
    values: &[[f32; N]],
    time: f64,
    between: fn([f64; N], [f64; N], f64) -> [f64; N],
) -> [f64; N] {
    let wide = |index: usize| values[index].map(f64::from);
    let cubic = channel.interpolation == Interpolation::Cubic;
    let value = |key: usize| wide(if cubic { 3 * key + 1 } else { key });
    let times: Vec<f64> = channel.times.iter().map(|time| f64::from(*time)).collect();
    let last = times.len() - 1;
    if time <= times[0] {
        return value(0);
    }
    if time >= times[last] {
        return value(last);
    }
    let key = times.iter().rposition(|begin| *begin <= time).unwrap_or(0);
    let dt = times[key + 1] - times[key];
    let u = (time - times[key]) / dt;
    match channel.interpolation {
        Interpolation::Step => value(key),
        Interpolation::Linear => between(value(key), value(key + 1), u),
        Interpolation::Cubic => {
            let (out, arrive) = (wide(3 * key + 2), wide(3 * key + 3));
            let (a, b) = (value(key), value(key + 1));
            let (u2, u3) = (u * u, u * u * u);
            core::array::from_fn(|i| {
                (2.0 * u3 - 3.0 * u2 + 1.0) * a[i]
                    + dt * (u3 - 2.0 * u2 + u) * out[i]
                    + (3.0 * u2 - 2.0 * u3) * b[i]
                    + dt * (u3 - u2) * arrive[i]
            })
        }
    }
}

fn line(a: [f64; 3], b: [f64; 3], u: f64) -> [f64; 3] {
    core::array::from_fn(|i| a[i] + (b[i] - a[i]) * u)
}

/// The shorter slerp.
#[expect(
    clippy::disallowed_methods,
    reason = "an f64 oracle; only tests and studies use it"
)]
fn arc(a: [f64; 4], b: [f64; 4], u: f64) -> [f64; 4] {
    let (a, mut b) = (unit(a), unit(b));
    let mut cosine = dot(a, b);
    if cosine < 0.0 {
        b = b.map(|x| -x);
        cosine = -cosine;
    }
    let angle = cosine.min(1.0).acos();
    if angle < 1e-7 {
        return core::array::from_fn(|i| a[i] + (b[i] - a[i]) * u);
    }
    let (to_a, to_b) = (((1.0 - u) * angle).sin(), (u * angle).sin());
    core::array::from_fn(|i| (a[i] * to_a + b[i] * to_b) / angle.sin())
}

fn dot(a: [f64; 4], b: [f64; 4]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn unit(q: [f64; 4]) -> [f64; 4] {
    let length = dot(q, q).sqrt();
    q.map(|x| x / length)
}

/// The angle between two rotations, radians: twice the angle of the quaternions, from the chord, so that
/// small ones keep their digits.
#[must_use]
#[expect(
    clippy::disallowed_methods,
    reason = "an f64 oracle; only tests and studies use it"
)]
pub fn angle(a: [f64; 4], b: [f64; 4]) -> f64 {
    let (a, b) = (unit(a), unit(b));
    let sign = if dot(a, b) < 0.0 { -1.0 } else { 1.0 };
    let chord: f64 = a
        .iter()
        .zip(b)
        .map(|(a, b)| (a - sign * b) * (a - sign * b))
        .sum();
    4.0 * (chord.sqrt() / 2.0).min(1.0).asin()
}

/// The blend of several poses: for each joint the direction nearest to all, in the mean that
/// [`blend`](crate::blend) is defined by.
///
/// # Panics
/// If there is no pose, or their lengths differ.
#[must_use]
pub fn blend(poses: &[(Vec<Transform64>, f64)]) -> Vec<Transform64> {
    let mut order: Vec<usize> = (0..poses.len()).collect();
    order.sort_by(|a, b| poses[*b].1.total_cmp(&poses[*a].1));
    let total: f64 = poses.iter().map(|(_, weight)| weight).sum();
    (0..poses[0].0.len())
        .map(|joint| {
            let mut sum = Transform64 {
                translation: [0.0; 3],
                rotation: [0.0; 4],
                scale: [0.0; 3],
            };
            for index in &order {
                let (pose, weight) = &poses[*index];
                let (weight, pose) = (weight / total, pose[joint]);
                let sign = if dot(sum.rotation, pose.rotation) < 0.0 {
                    -weight
                } else {
                    weight
                };
                for i in 0..3 {
                    sum.translation[i] += weight * pose.translation[i];
                    sum.scale[i] += weight * pose.scale[i];
                }
                for i in 0..4 {
                    sum.rotation[i] += sign * pose.rotation[i];
                }
            }
            sum.rotation = unit(sum.rotation);
            sum
        })
        .collect()
}

/// Matrices in the model's frame.
#[must_use]
pub fn local_to_model(skeleton: &Skeleton, pose: &[Transform64]) -> Vec<Matrix64> {
    let mut model: Vec<Matrix64> = Vec::with_capacity(pose.len());
    for (joint, local) in pose.iter().enumerate() {
        let local = matrix(local);
        model.push(match skeleton.parent(joint) {
            Some(parent) => multiply(&model[parent], &local),
            None => local,
        });
    }
    model
}

fn matrix(transform: &Transform64) -> Matrix64 {
    let [x, y, z, w] = transform.rotation;
    let rotation = [
        [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - z * w),
            2.0 * (x * z + y * w),
        ],
        [
            2.0 * (x * y + z * w),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - x * w),
        ],
        [
            2.0 * (x * z - y * w),
            2.0 * (y * z + x * w),
            1.0 - 2.0 * (x * x + y * y),
        ],
    ];
    core::array::from_fn(|row| {
        let [a, b, c] = rotation[row];
        let [sx, sy, sz] = transform.scale;
        [a * sx, b * sy, c * sz, transform.translation[row]]
    })
}

/// a · b, both with a last row (0, 0, 0, 1).
#[must_use]
pub fn multiply(a: &Matrix64, b: &Matrix64) -> Matrix64 {
    core::array::from_fn(|row| {
        core::array::from_fn(|column| {
            let sum: f64 = (0..3).map(|k| a[row][k] * b[k][column]).sum();
            if column == 3 { sum + a[row][3] } else { sum }
        })
    })
}
