//! The keys of a clip's curves, all together.

use crate::error::FbxError;
use crate::options::Budget;
use std::collections::BTreeSet;
use ufbx::{AnimStack, ElementType, Interpolation, Scene};

/// Names of properties that move a node.
pub(crate) const MOVES: &[&str] = &[
    "Lcl Translation",
    "Lcl Rotation",
    "Lcl Scaling",
    "PreRotation",
    "PostRotation",
    "RotationOffset",
    "RotationPivot",
    "ScalingOffset",
    "ScalingPivot",
    "RotationOrder",
    "RotationActive",
    "RotationSpaceForLimitOnly",
];

/// Name of the property that is the weight of a blend channel.
pub(crate) const BLENDS: &str = "DeformPercent";

/// A key of any curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mark {
    /// On the file's clock, seconds.
    pub(super) time: f64,
    /// Values may jump just before, or just after.
    pub(super) before: bool,
    pub(super) after: bool,
    /// The most that a rotation's angle changes from here to the next key, degrees.
    pub(super) swing: f64,
    /// The same where one angle alone changes much: a wheel turns, and no path of angles is told
    /// again in others.
    pub(super) spin: f64,
}

/// An angle that changes by so many degrees within a frame changes much. Bakers that tell the same
/// rotation in three other angles change at least two of them by as much.
pub(super) const SPIN: f64 = 60.0;

impl Mark {
    pub(super) fn at(time: f64) -> Self {
        Self {
            time,
            before: false,
            after: false,
            swing: 0.0,
            spin: 0.0,
        }
    }
}

/// Keys of everything that moves nodes or morph targets, each time once, growing; and the nodes of
/// which an angle changes much from one key to the next.
pub(super) fn keys(
    scene: &Scene,
    stack: &AnimStack,
    budget: &Budget,
) -> Result<(Vec<Mark>, BTreeSet<usize>), FbxError> {
    let mut all: Vec<Mark> = Vec::new();
    let mut spinning = BTreeSet::new();
    for layer in &stack.layers {
        budget.in_time("clips")?;
        for prop in layer.anim_props.iter() {
            let name: &str = &prop.prop_name;
            let moves = match prop.element.type_ {
                ElementType::Node => MOVES.contains(&name),
                ElementType::BlendChannel => name == BLENDS,
                ElementType::AnimLayer => true,
                _ => false,
            };
            if !moves {
                continue;
            }
            let turns = name == "Lcl Rotation";
            let curves: Vec<&[ufbx::Keyframe]> = prop
                .anim_value
                .curves
                .iter()
                .flatten()
                .map(|curve| &*curve.keyframes)
                .collect();
            for (number, keys) in curves.iter().enumerate() {
                let others = curves
                    .iter()
                    .enumerate()
                    .filter(|(other, _)| *other != number);
                let others: Vec<&[ufbx::Keyframe]> = others.map(|(_, keys)| *keys).collect();
                if merge(&mut all, keys, turns.then_some(&others)) >= SPIN {
                    spinning.insert(prop.element.typed_id as usize);
                }
            }
        }
    }
    // Weights of layers are curves of the layer, in whichever layer they lie.
    for value in &scene.anim_values {
        let of_layer = value
            .element
            .connections_src
            .iter()
            .any(|c| c.dst.type_ == ElementType::AnimLayer && c.dst_prop.length > 0);
        if of_layer {
            for curve in value.curves.iter().flatten() {
                merge(&mut all, &curve.keyframes, None);
            }
        }
    }
    Ok((all, spinning))
}

/// Curves of a bake have the same times: then this is one walk along both. `others` are the two other
/// angles of a rotation. Gives the largest [`Mark::spin`].
fn merge(
    all: &mut Vec<Mark>,
    keys: &[ufbx::Keyframe],
    others: Option<&Vec<&[ufbx::Keyframe]>>,
) -> f64 {
    let mut most = 0.0_f64;
    let change = |keys: &[ufbx::Keyframe], i: usize| match (keys.get(i), keys.get(i + 1)) {
        (Some(key), Some(next)) => (next.value - key.value).abs(),
        _ => 0.0,
    };
    let mut at = 0;
    let mut new: Vec<Mark> = Vec::new();
    for (i, key) in keys
        .iter()
        .enumerate()
        .filter(|(_, key)| key.time.is_finite())
    {
        let mark = Mark {
            time: key.time,
            before: i > 0 && keys[i - 1].interpolation == Interpolation::ConstantPrev,
            after: key.interpolation == Interpolation::ConstantNext,
            swing: if others.is_some() {
                change(keys, i)
            } else {
                0.0
            },
            spin: match others {
                Some(others) if !others.iter().any(|other| change(other, i) > SPIN) => {
                    change(keys, i)
                }
                _ => 0.0,
            },
        };
        most = most.max(mark.spin);
        while at < all.len() && all[at].time < mark.time {
            at += 1;
        }
        match all.get_mut(at) {
            Some(known) if known.time == mark.time => {
                known.before |= mark.before;
                known.after |= mark.after;
                known.swing = known.swing.max(mark.swing);
                known.spin = known.spin.max(mark.spin);
            }
            _ => new.push(mark),
        }
    }
    if !new.is_empty() {
        all.append(&mut new);
        all.sort_by(|a, b| a.time.total_cmp(&b.time));
    }
    most
}
