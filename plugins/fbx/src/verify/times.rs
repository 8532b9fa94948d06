//! When a clip is looked at, and what that comes to.

use super::actors::Actors;
use super::search::{Look, Peaks};
use crate::clips::{Shells, Source, Stretch, in_parts, threads};
use crate::curves::Reading;
use crate::error::FbxError;
use crate::model::Clip;

/// An angle is looked at once for so many degrees: four times a quarter turn.
const TURN: f64 = 22.5;

/// Looks between two keys of the file, where what lies there counts.
const LOOKS: usize = 3;

/// Looks at a clip, at least, where what lies within frames is little: so that few such gaps get more.
const MANY: usize = 2000;

/// Looks within a frame at most, unless something turns much there.
const LOOKS_WITHIN: usize = 4;

/// What a search may have missed of a peak, as a share of it.
const MISSED: f64 = 1.01;

/// What a check found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Checked {
    /// The largest distance, metres, at any time.
    pub(crate) error: f64,
    /// The same without what lies within frames.
    pub(crate) keyed_error: f64,
    /// Times that were looked at.
    pub(crate) times: usize,
}

/// Holds `clip` against the curves of the file.
pub(crate) fn check(source: &Source, shells: &Shells, clip: &Clip) -> Result<Checked, FbxError> {
    let take = source.take;
    let moving = shells.moved_by(take.moving.iter().copied());
    let keys = key_times(clip);
    let stretches: Vec<Stretch> = take.plan.gaps().collect();
    let gaps = stretches.len() + keys.len();
    let within = (MANY / gaps.max(1)).clamp(1, LOOKS_WITHIN);
    let poses = (stretches.len() + keys.len()) * take.moving.len().max(1);
    let parts = in_parts(stretches.len(), threads(poses, source.options), |range| {
        let mut actors = Actors::of(source, shells, clip, &moving, Reading::Usual);
        let mut peaks = Peaks::default();
        for number in range {
            if source.budget.is_late() {
                break;
            }
            look(
                &stretches[number],
                number,
                &keys,
                clip.begin,
                within,
                &mut actors,
                &mut peaks,
            );
        }
        peaks
    });
    source.budget.in_time("the check")?;
    let mut peaks = Peaks::default();
    parts.into_iter().for_each(|part| peaks.join(part));
    let mut actors = Actors::of(source, shells, clip, &moving, Reading::Usual);
    let end = take.plan.end.max(take.plan.begin);
    peaks.add(Look {
        error: actors.apart(end),
        time: end,
        begin: end,
        end,
        within: false,
    });
    Ok(found(&mut actors, peaks))
}

/// The keys' times of all channels, growing, each once.
fn key_times(clip: &Clip) -> Vec<f32> {
    let mut keys: Vec<f32> = Vec::new();
    let mut last: &[f32] = &[];
    for channel in &clip.channels {
        // Many channels share their times.
        if channel.times != last {
            keys.extend(&channel.times);
            last = &channel.times;
        }
    }
    keys.sort_by(f32::total_cmp);
    keys.dedup();
    keys
}

/// Looks at a stretch between two keys of the file, `number` in the clip; `within` times between two keys where
/// it lies within a frame.
fn look(
    stretch: &Stretch,
    number: usize,
    keys: &[f32],
    begin: f64,
    within: usize,
    actors: &mut Actors,
    peaks: &mut Peaks,
) {
    if !stretch.jumps {
        peaks.add(Look {
            error: actors.apart(stretch.begin),
            time: stretch.begin,
            begin: stretch.begin,
            end: stretch.begin,
            within: false,
        });
    }
    let first = keys.partition_point(|&key| begin + f64::from(key) <= stretch.begin);
    let inner = keys[first..]
        .iter()
        .map(|&key| begin + f64::from(key))
        .take_while(|&key| key < stretch.end);
    let count = 1 + inner.clone().count();
    let least = match stretch.within {
        true => within,
        false => LOOKS.div_ceil(count),
    };
    let length = stretch.end - stretch.begin;
    let mut from = stretch.begin;
    for (gap, to) in inner.chain([stretch.end]).enumerate() {
        // Times that f32 hardly tells apart are the two sides of a jump.
        let step = ((to - begin).abs() * 2.5e-7).max(1.5e-7);
        if to - from > 2.0 * step {
            let turned = stretch.swing * (to - from) / length;
            let looks = ((turned / TURN).ceil() as usize).max(least);
            for i in 0..looks {
                let share = (i as f64 + dice(number, gap, i)) / looks as f64;
                let time = (from + (to - from) * share).clamp(from + step, to - step);
                // Half of the way that the next look stands for.
                let at = |i: f64| from + (to - from) * (i / looks as f64);
                peaks.add(Look {
                    error: actors.apart(time),
                    time,
                    begin: at(i as f64 - 0.5).max(from + step),
                    end: at(i as f64 + 1.5).min(to - step),
                    within: stretch.within,
                });
            }
        }
        from = to;
    }
}

/// A pseudo-random share, 0.1 to 0.9, the same in every run.
pub(crate) fn dice(stretch: usize, gap: usize, look: usize) -> f64 {
    let mut x = (stretch as u64)
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .wrapping_add((gap as u64).wrapping_mul(0xbf58_476d_1ce4_e5b9))
        .wrapping_add(look as u64);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^= x >> 31;
    0.1 + 0.8 * (x >> 11) as f64 / (1_u64 << 53) as f64
}

/// Times at which readings of the same layers are held against each other.
const READINGS: usize = 65;

/// For each layer that can be read in two ways: its name, which they are, and how far what they show is
/// apart at most, metres at the shells.
pub(crate) fn doubts(source: &Source, shells: &Shells, clip: &Clip) -> Vec<(String, Reading, f64)> {
    let take = source.take;
    let layers = take.layers(Reading::Usual);
    let mut out = Vec::new();
    for (reading, layer) in layers.doubts() {
        let moving = shells.moved_by(take.moving.iter().copied());
        let mut usual = Actors::of(source, shells, clip, &moving, Reading::Usual);
        let mut other = Actors::of(source, shells, clip, &moving, reading);
        let length = take.plan.end - take.plan.begin;
        let apart = (0..READINGS)
            .map(|i| take.plan.begin + length * i as f64 / (READINGS - 1) as f64)
            .map(|time| usual.otherwise(&mut other, time))
            .fold(0.0, f64::max);
        out.push((layer.element.name.to_string(), reading, apart));
    }
    out
}

/// Searches around the peaks, and holds their vertices against their shells.
fn found(actors: &mut Actors, mut peaks: Peaks) -> Checked {
    peaks.search(actors);
    let mut factor = MISSED;
    for list in [&peaks.keyed, &peaks.within] {
        let worst = list.iter().max_by(|a, b| a.error.total_cmp(&b.error));
        if let Some(worst) = worst.filter(|look| look.error > 1e-12) {
            let (shells, vertices) = actors.both(worst.time);
            if vertices > shells && shells > 1e-12 {
                factor = factor.max(MISSED * vertices / shells);
            }
        }
    }
    let largest = |list: &[Look]| list.iter().map(|look| look.error).fold(0.0, f64::max);
    let keyed = largest(&peaks.keyed);
    Checked {
        error: factor * keyed.max(largest(&peaks.within)),
        keyed_error: factor * keyed,
        times: peaks.times,
    }
}
