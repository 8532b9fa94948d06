//! A whole clip: in parts where memory asks for it, and again where the check finds too much.

use super::choose::Kinds;
use super::grid::{Plan, before};
use super::metric::Shells;
use super::reduce::{Reduced, leverage, reduce};
use super::refine::{Source, refine};
use super::sample::Samples;
use crate::error::FbxError;
use crate::model::{Channel, Interpolation, Property};
use crate::options::{Compression, Options};
use crate::verify::{Checked, check};
use std::ops::Range;

/// Times that a clip is made again, with samples where its check found too much.
const AGAIN: usize = 3;

/// Another try that does not come nearer by this factor is the last.
const NEARER: f64 = 0.7;

/// Passes over the parts of a clip until all have the same kinds of keys.
const PASSES: usize = 4;

/// The share of the samples that memory allows with which a part of a clip begins: the rest is for those
/// that are added where it bends.
const PART: f64 = 1.0 / 8.0;

/// Keys for a clip that keep to `bound` metres, by a check at times of its own; or else as near as can be,
/// and the report says how near. `samples` are those of the whole clip, where it is whole.
pub(crate) fn clip(
    source: &Source,
    samples: Option<Samples>,
    shells: &Shells,
    bound: f64,
) -> Result<Reduced, FbxError> {
    let mut target = bound;
    let mut made = first(source, &source.take.plan, samples, shells, bound)?;
    let held = |made: &Reduced| check(source, shells, &made.clip, (made.report.error, bound));
    let mut best = held(&made);
    let mut plan = source.take.plan.clone();
    // What a plain file would have at least: it may not have to be made again.
    let (plain, mut same) = (made.bytes.plain, made.bytes.same);
    for attempt in 0..AGAIN {
        if best.keyed_error <= bound || !best.keyed_error.is_finite() || made.clip.duration <= 0.0 {
            break;
        }
        if best.loose > 0.0 && (attempt > 0 || best.peaks.is_empty()) {
            // Nothing is known to be too far off, and keys at other places would not make it better known.
            break;
        }
        plan = plan.with(&best.peaks);
        if attempt > 0 || best.peaks.is_empty() {
            target = (target * 0.9 * bound / best.keyed_error).clamp(0.3 * target, 0.9 * target);
        }
        if source.budget.left() < plan.samples() as u64 * source.take.columns() as u64 {
            // What there is stands, with its error.
            break;
        }
        let again = first(source, &plan, None, shells, target)?;
        let checked = held(&again);
        same &= again.bytes.same;
        let is_nearer = checked.keyed_error < NEARER * best.keyed_error;
        let is_better = checked.keyed_error < best.keyed_error;
        best.peaks.clone_from(&checked.peaks);
        if is_better {
            (made, best) = (again, checked);
        }
        if attempt > 0 && !is_nearer {
            break;
        }
    }
    say(&mut made, &best);
    made.bytes.plain = plain;
    made.bytes.same = same;
    Ok(made)
}

fn say(made: &mut Reduced, checked: &Checked) {
    made.report.error = checked.error;
    made.report.keyed_error = checked.keyed_error;
    made.report.samples = checked.times;
    made.report.unseen = checked.loose;
}

/// In one piece where memory allows it.
fn first(
    source: &Source,
    plan: &Plan,
    samples: Option<Samples>,
    shells: &Shells,
    bound: f64,
) -> Result<Reduced, FbxError> {
    let fits = plan.samples() <= source.take.most as f64;
    if (samples.is_some() || fits)
        && let Some(made) = whole_clip(source, plan, samples, shells, bound)?
    {
        return Ok(made);
    }
    in_parts(source, plan.clone(), shells, bound, PART)
}

/// `None` where memory does not allow it.
fn whole_clip(
    source: &Source,
    plan: &Plan,
    samples: Option<Samples>,
    shells: &Shells,
    bound: f64,
) -> Result<Option<Reduced>, FbxError> {
    let mut samples = match samples {
        Some(samples) => samples,
        None => source.sample(plan, 0..plan.len())?,
    };
    let leverage = leverage(&samples, source.model, shells);
    if !refine(&mut samples, source, &leverage, bound) {
        return Ok(None);
    }
    Ok(Some(reduce(&samples, source, shells, leverage, bound, &[])))
}

/// One part of the clip after the other, each with so large a share of the samples that memory allows.
fn in_parts(
    source: &Source,
    mut plan: Plan,
    shells: &Shells,
    bound: f64,
    share: f64,
) -> Result<Reduced, FbxError> {
    let room = (source.take.most as f64 * share).max(8.0);
    plan.cut(room);
    let windows = plan.windows(room);
    let mut kinds = Vec::new();
    for _ in 0..PASSES {
        if let Some(out) = pass(source, &plan, &windows, shells, bound, &mut kinds)? {
            return Ok(out);
        }
    }
    kinds.fill(Kinds::OnlyCubic);
    let out = pass(source, &plan, &windows, shells, bound, &mut kinds)?;
    out.ok_or_else(|| source.budget.too_much("the poses of a clip"))
}

/// All parts with channels of `kinds`, which the first part sets where none are; `None` where a part needs
/// another kind: then `kinds` has it.
fn pass(
    source: &Source,
    plan: &Plan,
    windows: &[Range<usize>],
    shells: &Shells,
    bound: f64,
    kinds: &mut Vec<Kinds>,
) -> Result<Option<Reduced>, FbxError> {
    let mut out: Option<Reduced> = None;
    let (mut bytes, mut all_fit) = (0, true);
    for window in windows {
        let mut samples = source.sample(plan, window.clone())?;
        let leverage = leverage(&samples, source.model, shells);
        // What memory does not allow to be looked at, the check finds.
        refine(&mut samples, source, &leverage, bound);
        if kinds.is_empty() {
            // Parts are not searched for the codec: their keys are those of a plain file.
            let options = Options {
                compress: Compression::None,
                ..*source.options
            };
            let plain = Source {
                options: &options,
                ..*source
            };
            *kinds = reduce(&samples, &plain, shells, leverage.clone(), bound, &[]).kinds();
        }
        let part = reduce(&samples, source, shells, leverage, bound, kinds);
        for (kind, needed) in kinds.iter_mut().zip(part.kinds()) {
            all_fit &= *kind == needed;
            *kind = needed;
        }
        bytes += part.clip.channels.iter().map(size).sum::<usize>();
        source.budget.afford(2 * bytes, "the keys of a clip")?;
        match &mut out {
            _ if !all_fit => {}
            None => out = Some(part),
            Some(out) => out.append(part),
        }
    }
    Ok(out.filter(|_| all_fit))
}

fn size(channel: &Channel) -> usize {
    (channel.times.len() + channel.values.len()) * size_of::<f32>()
}

impl Reduced {
    /// Puts the next part behind.
    fn append(&mut self, next: Self) {
        let channels = self.clip.channels.iter_mut().zip(next.clip.channels);
        for (channel, next) in channels {
            append(channel, next);
        }
        let rests = self.at_rest.iter_mut().zip(next.at_rest);
        for (rest, next) in rests {
            *rest &= next;
        }
        self.clip.duration = next.clip.duration;
        self.bytes.plain += next.bytes.plain;
        self.bytes.chosen += next.bytes.chosen;
        self.bytes.same &= next.bytes.same;
        let (report, next) = (&mut self.report, next.report);
        report.seconds = next.seconds;
        report.error = report.error.max(next.error);
        report.baked += next.baked;
    }
}

/// Both have the key between them; where they have it otherwise, it becomes two.
fn append(channel: &mut Channel, next: Channel) {
    let values = match channel.interpolation {
        Interpolation::Cubic => 3,
        _ => 1,
    };
    let width = channel.values.len() / channel.times.len().max(1);
    let one = width / values;
    let last = channel.times.len().saturating_sub(1);
    let mut next = next;
    if channel.property == Property::Rotation && is_turned_over(channel, &next, values) {
        next.values.iter_mut().for_each(|x| *x = -*x);
    }
    if let (Some(&end), Some(&begin)) = (channel.times.last(), next.times.first())
        && end >= begin
        && width > 0
    {
        let middle = (values / 2) * one..(values / 2) * one + one;
        let ours = &channel.values[last * width..][middle.clone()];
        let is_same = *ours == next.values[middle];
        let earlier = before(begin);
        let fits = last
            .checked_sub(1)
            .is_none_or(|i| channel.times[i] < earlier);
        match is_same || !fits || earlier <= 0.0 {
            true => {
                // The key of the next part, but with the tangent that comes into it.
                let into = channel.values[last * width..last * width + one].to_vec();
                channel.times.truncate(last);
                channel.values.truncate(last * width);
                let at = channel.values.len();
                channel.times.extend(&next.times);
                channel.values.extend(&next.values);
                if values == 3 {
                    channel.values[at..at + one].copy_from_slice(&into);
                }
                channel.short &= next.short;
                return;
            }
            false => channel.times[last] = earlier,
        }
    }
    channel.times.extend(&next.times);
    channel.values.extend(&next.values);
    channel.short &= next.short;
}

/// A rotation's four numbers at the seam are the negative ones: the same rotation, but a cubic would go
/// from one to the other through nothing.
fn is_turned_over(channel: &Channel, next: &Channel, values: usize) -> bool {
    let skip = (values / 2) * 4;
    let ours = channel.values.rchunks(4 * values).next();
    let theirs = next.values.get(skip..skip + 4);
    let (Some(ours), Some(theirs)) = (ours.and_then(|key| key.get(skip..skip + 4)), theirs) else {
        return false;
    };
    ours.iter().zip(theirs).map(|(a, b)| a * b).sum::<f32>() < 0.0
}
