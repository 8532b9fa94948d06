//! The keys of a clip's curves, all together.

use crate::curves::{Layers, TICKS, repeats};
use crate::error::FbxError;
use crate::options::Budget;
use std::collections::BTreeSet;
use ufbx::{
    AnimCurve, AnimValue, ElementType, Extrapolation, ExtrapolationMode, Interpolation, Keyframe,
    Scene,
};

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

/// Of these, those that are angles.
const ANGLES: &[&str] = &["Lcl Rotation", "PreRotation", "PostRotation"];

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
    /// From here on there is a key in every frame.
    pub(super) baked: bool,
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
            baked: false,
        }
    }
}

/// Keys of everything that moves nodes or morph targets, each time once, growing; and the nodes of
/// which an angle changes much from one key to the next.
pub(super) struct Marks {
    pub(super) all: Vec<Mark>,
    pub(super) spinning: BTreeSet<usize>,
    /// Keys that curves have beyond their own by repeating them.
    repeated: usize,
}

/// Keys beyond a curve's own that one clip may have.
const MOST_REPEATED: usize = 1 << 20;

/// The marks of a stack's `layers` that play; `span` is the stack's own, for curves that repeat.
pub(super) fn keys(
    scene: &Scene,
    layers: &Layers,
    span: (f64, f64),
    budget: &Budget,
) -> Result<Marks, FbxError> {
    let mut marks = Marks {
        all: Vec::new(),
        spinning: BTreeSet::new(),
        repeated: 0,
    };
    for layer in &layers.playing {
        for prop in layer.source.anim_props.iter() {
            let name: &str = &prop.prop_name;
            let moves = match prop.element.type_ {
                ElementType::Node => MOVES.contains(&name),
                ElementType::BlendChannel => name == BLENDS,
                _ => false,
            };
            if !moves {
                continue;
            }
            let most = marks.value(&prop.anim_value, ANGLES.contains(&name), span, budget)?;
            if most >= SPIN {
                marks.spinning.insert(prop.element.typed_id as usize);
            }
        }
        // Weights of layers are curves of the layer, in whichever layer they lie.
        if let Some(value) = layer.weight_value {
            marks.value(value, false, span, budget)?;
        }
    }
    // What hangs on other properties moves as these do.
    let nodes = scene.nodes.iter().map(|node| (&node.element, MOVES));
    let channels = scene.blend_channels.iter();
    let channels = channels.map(|channel| (&channel.element, &[BLENDS][..]));
    for (element, names) in nodes.chain(channels) {
        for &name in names {
            for value in layers.hanging(element, name) {
                let most = marks.value(value, ANGLES.contains(&name), span, budget)?;
                if most >= SPIN {
                    marks.spinning.insert(element.typed_id as usize);
                }
            }
        }
    }
    Ok(marks)
}

impl Marks {
    /// Adds the keys of a property's curves; gives the largest [`Mark::spin`].
    fn value(
        &mut self,
        value: &AnimValue,
        turns: bool,
        span: (f64, f64),
        budget: &Budget,
    ) -> Result<f64, FbxError> {
        let curves: Vec<&AnimCurve> = value.curves.iter().flatten().map(AsRef::as_ref).collect();
        let mut most = 0.0_f64;
        for (number, curve) in curves.iter().enumerate() {
            let others: Vec<&[Keyframe]> = curves
                .iter()
                .enumerate()
                .filter(|(other, _)| *other != number)
                .map(|(_, curve)| &*curve.keyframes)
                .collect();
            let own = marks(&curve.keyframes, turns.then_some(&others));
            most = own.iter().fold(most, |most, mark| most.max(mark.spin));
            let (before, after) = repeats(curve, span.0, span.1);
            self.repeat(curve, &own, (before, after), budget)?;
            // Some tens of keys are passed as fast as a pose is worked out.
            budget.must((self.all.len() + own.len()) / 32 + 1, "the keys of a clip")?;
            merge(&mut self.all, own.into_iter());
        }
        Ok(most)
    }

    /// The marks of a curve's repetitions.
    fn repeat(
        &mut self,
        curve: &AnimCurve,
        own: &[Mark],
        (before, after): (f64, f64),
        budget: &Budget,
    ) -> Result<(), FbxError> {
        let count = (before + after) as usize;
        self.repeated = self
            .repeated
            .saturating_add(count.saturating_mul(own.len()));
        if self.repeated > MOST_REPEATED {
            return Err(budget.too_much("the repetitions of a clip's curves"));
        }
        // Whole ticks of the file's clock, as curves are read: a seam stands on the key that it is, not an ulp of f64 beside it.
        let ticks = curve.element.scene.metadata.ktime_second as f64;
        let ticks = if ticks > 0.0 { ticks } else { TICKS };
        let tick = |time: f64| (time * ticks).round();
        let (begin, end) = (tick(curve.min_time), tick(curve.max_time));
        let length = end - begin;
        let mut all: Vec<Mark> = Vec::new();
        let mut once = |how: &Extrapolation, number: f64| {
            let backwards = how.mode == ExtrapolationMode::Mirror && number.rem_euclid(2.0) == 1.0;
            let shift = number * length;
            let mut new: Vec<Mark> = match backwards {
                false => own
                    .iter()
                    .map(|mark| Mark {
                        time: (tick(mark.time) + shift) / ticks,
                        ..*mark
                    })
                    .collect(),
                true => {
                    // What came after a key comes before it now.
                    let turned = own
                        .iter()
                        .rev()
                        .zip(own.iter().rev().skip(1).map(Some).chain([None]));
                    turned
                        .map(|(mark, next)| Mark {
                            time: (end - (tick(mark.time) - begin) + shift) / ticks,
                            before: mark.after,
                            after: mark.before,
                            swing: next.map_or(0.0, |next| next.swing),
                            spin: next.map_or(0.0, |next| next.spin),
                            baked: false,
                        })
                        .collect()
                }
            };
            // Values may jump at seams.
            if how.mode == ExtrapolationMode::Repeat || how.repeat_count > 0 {
                for end in [0, new.len().saturating_sub(1)] {
                    if let Some(mark) = new.get_mut(end) {
                        (mark.before, mark.after) = (true, true);
                    }
                }
            }
            all.append(&mut new);
        };
        for number in 1..=before as usize {
            once(&curve.pre_extrapolation, -(number as f64));
        }
        for number in 1..=after as usize {
            once(&curve.post_extrapolation, number as f64);
        }
        merge(&mut self.all, all.into_iter());
        Ok(())
    }
}

/// The marks of one curve. `others` are the two other angles of a rotation.
fn marks(keys: &[Keyframe], others: Option<&Vec<&[Keyframe]>>) -> Vec<Mark> {
    let change = |keys: &[Keyframe], i: usize| match (keys.get(i), keys.get(i + 1)) {
        (Some(key), Some(next)) => (next.value - key.value).abs(),
        _ => 0.0,
    };
    let at = |(i, key): (usize, &Keyframe)| Mark {
        time: key.time,
        before: i > 0 && keys[i - 1].interpolation == Interpolation::ConstantPrev,
        after: key.interpolation == Interpolation::ConstantNext,
        swing: match (others, keys.get(i + 1)) {
            (Some(_), Some(next)) => swing(key, next),
            _ => 0.0,
        },
        spin: match others {
            Some(others) if !others.iter().any(|other| change(other, i) > SPIN) => change(keys, i),
            _ => 0.0,
        },
        baked: false,
    };
    let keys = keys.iter().enumerate();
    keys.filter(|(_, key)| key.time.is_finite())
        .map(at)
        .collect()
}

/// The most that a curve changes by on its way from one key to the next: along its control points.
fn swing(key: &Keyframe, next: &Keyframe) -> f64 {
    if key.interpolation != Interpolation::Cubic {
        return (next.value - key.value).abs();
    }
    let (out, into) = (f64::from(key.right.dy), f64::from(next.left.dy));
    out.abs() + into.abs() + (next.value - into - key.value - out).abs()
}

/// Curves of a bake have the same times: then this is one walk along both.
fn merge(all: &mut Vec<Mark>, marks: impl Iterator<Item = Mark>) {
    let mut at = 0;
    let mut new: Vec<Mark> = Vec::new();
    for mark in marks {
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
        all.dedup_by(|mark, known| {
            let same = mark.time == known.time;
            if same {
                known.before |= mark.before;
                known.after |= mark.after;
                known.swing = known.swing.max(mark.swing);
                known.spin = known.spin.max(mark.spin);
            }
            same
        });
    }
}
