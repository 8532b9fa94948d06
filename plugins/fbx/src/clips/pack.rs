//! Values with fewer bits, for keys whose bytes are compressed.
//!
//! The codec ([`crate::codec`]) pays for what changes from key to key, byte by byte. A key of few bits beside
//! another costs little, so that often a key on every frame with few bits is less than few keys with all
//! of theirs. Both are tried. Each channel has a step that its values are whole multiples of; from the roots to
//! the tips rotations make good what those above them were rounded by, as in [`super::spend`]; steps grow as
//! long as the error at the skin, measured by playing what a decoder gives back, keeps to the bound: all together in a
//! quick search, one by one in a thorough one.
//!
//! Where the bound leaves hardly any room to round, keys of few bits on every frame may be more than few keys with all of
//! their bits. So the keys of a plain file are held beside the others, as they are: in their own form, which may be shorter
//! than what values are rounded to here.

use super::choose::Choice;
use super::play::Player;
use super::steps::{rotation, round, vector};
use super::work::Work;
use crate::codec::{exponent_below, power};
use crate::model::{Channel, Interpolation, Property};
use crate::options::{Budget, Effort, Options};
use crate::write::animation::numbers;
use crate::write::buffer::Numbers;
use crate::write::compress::size;
use glam::DQuat;
use std::collections::BTreeMap;

/// Times as they are.
const TIMES_AS_THEY_ARE: i32 = -40;

/// Steps of times that are tried, as powers of two of a second.
const TIME_STEPS: std::ops::RangeInclusive<i32> = -20..=-6;

/// A half to the power of no, one and two thirds.
const THIRDS: [f64; 3] = [1.0, 0.793_700_525_984_1, 0.629_960_524_947_4];

/// How coarse steps are tried to be, in thirds of a power of two below the bound, the coarsest first.
const COARSE: std::ops::Range<i32> = -4..42;

/// Shares of the bound that the first steps of a channel come to which was left as it is.
const FIRST_STEPS: [f64; 3] = [1.0 / 64.0, 1.0 / 16.0, 1.0 / 4.0];

/// Channels and the steps of their values, as powers of two.
#[derive(Clone)]
struct Draft {
    choices: Vec<Choice>,
    /// `None` leaves a channel as it is, in its own form.
    steps: Vec<Option<i32>>,
    time: i32,
    /// Rotations make good what those above them were rounded by.
    aimed: bool,
}

/// Keys for the codec.
pub(super) struct Packed {
    /// Metres.
    pub(super) error: f64,
    pub(super) choices: Vec<Choice>,
    /// Coded bytes of what moves.
    pub(super) bytes: usize,
    /// They are those that a plain file has.
    pub(super) same: bool,
}

/// Sets of keys to begin with, and the least that came out.
struct Packing<'a> {
    work: &'a Work<'a>,
    options: &'a Options<'a>,
    /// Metres.
    bound: f64,
    purse: &'a Budget,
    /// Number of the track of each node that has one.
    tracks: BTreeMap<usize, usize>,
}

/// Something that keeps to the bound.
struct Good {
    bytes: usize,
    error: f64,
    draft: Draft,
    made: Vec<Choice>,
}

/// Keys in the fewest coded bytes that keep to `bound` metres; each of `sparse` is a set of keys to begin with, the first
/// that of a plain file, with its error. `None` where nothing does.
pub(super) fn pack(
    work: &Work,
    sparse: &[Vec<Choice>],
    plain_error: f64,
    bound: f64,
    options: &Options,
    purse: &Budget,
) -> Option<Packed> {
    let tracks = work.samples.tracks.iter().enumerate();
    let packing = Packing {
        work,
        options,
        bound,
        purse,
        tracks: tracks.map(|(number, track)| (track.node, number)).collect(),
    };
    let plain = sparse.first().filter(|_| plain_error <= bound);
    let plain = plain.map(|plain| packing.as_it_is(plain, plain_error));
    let baked = sparse.first().map(|first| packing.baked(first));
    let starts = sparse.iter().cloned().chain(baked.clone());
    let mut all: Vec<Good> = starts
        .filter_map(|choices| packing.start(choices))
        .collect();
    all.sort_by_key(|good| good.bytes);
    all.truncate(2);
    if let Some(plain) = plain
        && all.first().is_none_or(|first| plain.bytes <= first.bytes)
    {
        all.insert(0, plain);
    }
    let mut best: Option<Good> = None;
    for mut good in all {
        packing.coarsen_times(&mut good);
        if options.effort == Effort::Thorough {
            packing.coarsen(&mut good);
            packing.exchange(&mut good, sparse.iter().chain(&baked));
            packing.coarsen(&mut good);
        }
        if best.as_ref().is_none_or(|best| good.bytes < best.bytes) {
            best = Some(good);
        }
    }
    best.map(|best| {
        let own = sparse.iter().flatten().map(|choice| &choice.channel);
        let made = best.made.iter().map(|choice| &choice.channel);
        Packed {
            error: best.error,
            bytes: best.bytes,
            same: made.zip(own).all(|(a, b)| a == b),
            choices: best.made,
        }
    })
}

impl Packing<'_> {
    /// Linear keys on all samples that keys may stand on, for what moves but in steps.
    fn baked(&self, choices: &[Choice]) -> Vec<Choice> {
        let stops = &self.work.samples.stops;
        let one = |choice: &Choice| {
            let channel = &choice.channel;
            let moves = channel.times.len() > 1 && channel.interpolation != Interpolation::Step;
            let track = self.tracks.get(&channel.node).filter(|_| moves);
            let Some(columns) = track.map(|&track| &self.work.columns[track]) else {
                return choice.clone();
            };
            let values: Vec<f64> = match channel.property {
                Property::Translation => {
                    let each = stops.iter().map(|&i| columns.translations[i].to_array());
                    each.flatten().collect()
                }
                Property::Rotation => {
                    let each = stops.iter().map(|&i| columns.rotations[i].to_array());
                    each.flatten().collect()
                }
                Property::Scale => {
                    let each = stops.iter().map(|&i| columns.scales[i].to_array());
                    each.flatten().collect()
                }
                Property::Weights => return choice.clone(),
            };
            Choice {
                at_rest: choice.at_rest,
                channel: Channel {
                    interpolation: Interpolation::Linear,
                    times: stops.iter().map(|&i| self.work.times[i] as f32).collect(),
                    values: values.into_iter().map(|x| x as f32).collect(),
                    short: false,
                    ..channel.clone()
                },
            }
        };
        choices.iter().map(one).collect()
    }

    /// Keys without any rounding, of which the error is known.
    fn as_it_is(&self, choices: &[Choice], error: f64) -> Good {
        Good {
            bytes: bytes(choices),
            error,
            draft: Draft {
                choices: choices.to_vec(),
                steps: vec![None; choices.len()],
                time: TIMES_AS_THEY_ARE,
                aimed: false,
            },
            made: choices.to_vec(),
        }
    }

    /// The coarsest steps, all in the same proportion to what they come to at the skin, that keep to the bound.
    fn start(&self, choices: Vec<Choice>) -> Option<Good> {
        let fit = |thirds: i32, aimed: bool| {
            let share = power(-thirds.div_euclid(3)) * THIRDS[thirds.rem_euclid(3) as usize];
            Draft {
                steps: choices
                    .iter()
                    .map(|choice| Some(self.step(choice, share)))
                    .collect(),
                time: TIMES_AS_THEY_ARE,
                aimed,
                choices: choices.clone(),
            }
        };
        let mut all = COARSE;
        let aimed = all.find_map(|thirds| self.good(fit(thirds, true)));
        // Few keys that aim at where the file's curves are at their own times may be farther off between these. Without that
        // the finest steps leave them about as they were chosen, within their share of the bound.
        aimed.or_else(|| {
            let (mut coarse, mut fine) = (COARSE.start - 1, COARSE.end - 1);
            let mut best = self.good(fit(fine, false))?;
            while fine - coarse > 1 {
                let middle = (coarse + fine).div_euclid(2);
                match self.good(fit(middle, false)) {
                    Some(good) => (best, fine) = (good, middle),
                    None => coarse = middle,
                }
            }
            Some(best)
        })
    }

    /// The power of two below what may be off in a channel's own unit.
    fn step(&self, choice: &Choice, share: f64) -> i32 {
        let lever = self.work.leverage[choice.channel.node];
        let lever = match choice.channel.property {
            Property::Translation => lever.translation,
            Property::Rotation => lever.rotation,
            Property::Scale => lever.scale,
            Property::Weights => self.work.reach(choice.channel.node),
        };
        exponent_below(share * self.bound / lever.max(1e-9)).clamp(-30, 20)
    }

    /// A draft that keeps to the bound; `None` where it does not, or where no more can be paid for.
    fn good(&self, draft: Draft) -> Option<Good> {
        // Rounded and played, it costs about as much as the poses of its samples twice.
        let poses = self.work.times.len() * self.work.moved.len().max(1);
        if !self.purse.pays(2 * poses) {
            return None;
        }
        let made = self.made(&draft);
        let error = self.work.error(&made, self.options);
        (error <= self.bound).then(|| Good {
            bytes: bytes(&made),
            error,
            draft,
            made,
        })
    }

    /// Lets times have fewer bits.
    fn coarsen_times(&self, good: &mut Good) {
        for time in TIME_STEPS {
            let draft = Draft {
                time,
                ..good.draft.clone()
            };
            match self.good(draft) {
                Some(next) if next.bytes < good.bytes => *good = next,
                Some(_) => {}
                None => break,
            }
        }
    }

    /// Lets steps grow one by one as long as that makes the whole smaller.
    fn coarsen(&self, good: &mut Good) {
        let mut open: Vec<bool> = vec![true; good.draft.steps.len()];
        while open.iter().any(|open| *open) {
            for (number, open) in open.iter_mut().enumerate() {
                if !*open {
                    *open = false;
                    continue;
                }
                let mut found = None;
                // A step may have to grow twice before a byte becomes smaller.
                for (more, share) in (1..).zip(FIRST_STEPS) {
                    let mut draft = good.draft.clone();
                    draft.steps[number] = Some(match draft.steps[number] {
                        Some(step) => step + more,
                        None => self.step(&draft.choices[number], share),
                    });
                    let Some(next) = self.good(draft) else { break };
                    if next.bytes < good.bytes {
                        found = Some(next);
                        break;
                    }
                }
                match found {
                    Some(next) => *good = next,
                    None => *open = false,
                }
            }
        }
    }

    /// Takes single channels from other sets of keys where that is smaller.
    fn exchange<'b>(&self, good: &mut Good, others: impl Iterator<Item = &'b Vec<Choice>>) {
        for other in others {
            for (number, choice) in other.iter().enumerate() {
                if choice.channel == good.draft.choices[number].channel {
                    continue;
                }
                let mut draft = good.draft.clone();
                draft.choices[number] = choice.clone();
                if let Some(next) = self.good(draft)
                    && next.bytes < good.bytes
                {
                    *good = next;
                }
            }
        }
    }

    /// Channels as they come back from the codec.
    fn made(&self, draft: &Draft) -> Vec<Choice> {
        let mut out = draft.choices.clone();
        for choice in out.iter_mut().filter(|_| draft.time > TIMES_AS_THEY_ARE) {
            let times = &mut choice.channel.times;
            let rounded: Vec<f32> = times.iter().map(|&t| round(t.into(), draft.time)).collect();
            // Times grow strictly, whatever the step.
            if rounded.windows(2).all(|pair| pair[0] < pair[1]) {
                *times = rounded;
            }
        }
        let rotations: BTreeMap<usize, usize> = (0..out.len())
            .filter(|&number| out[number].channel.property == Property::Rotation)
            .map(|number| (out[number].channel.node, number))
            .collect();
        for (number, choice) in out.iter_mut().enumerate() {
            let channel = &mut choice.channel;
            match (draft.steps[number], channel.property) {
                (None, _) => {}
                (Some(step), Property::Rotation) if !draft.aimed => {
                    rotation(channel, step, |_, q| q)
                }
                (Some(_), Property::Rotation) => {}
                (Some(step), _) => vector(channel, step),
            }
        }
        if draft.aimed {
            self.rotations(draft, &rotations, &mut out);
        }
        out
    }

    /// Rounds rotations from the roots to the tips.
    fn rotations(&self, draft: &Draft, of: &BTreeMap<usize, usize>, out: &mut [Choice]) {
        let (work, count) = (self.work, self.work.times.len());
        // What the world's rotation of a node is off by, at each sample, where it moves or one above it does.
        let mut before: BTreeMap<usize, Vec<DQuat>> = BTreeMap::new();
        let mut after: BTreeMap<usize, Vec<DQuat>> = BTreeMap::new();
        for &node in work.shells.in_order() {
            let above = work
                .shells
                .parent(node)
                .filter(|above| before.contains_key(above));
            let track = self.tracks.get(&node);
            if track.is_none() && above.is_none() {
                continue;
            }
            let rest = work.rest[node].rotation;
            let wanted = |i: usize| track.map_or(rest, |&track| work.columns[track].rotations[i]);
            let world = |all: &BTreeMap<usize, Vec<DQuat>>, i: usize| {
                above.map_or(DQuat::IDENTITY, |above| all[&above][i])
            };
            let mut played: Vec<DQuat> = (0..count).map(wanted).collect();
            if let Some(&number) = of.get(&node) {
                let choice = &draft.choices[number].channel;
                let channel = &mut out[number].channel;
                let aim = |key: usize, q: DQuat| {
                    let time = f64::from(choice.times[key]);
                    let i = work.times.partition_point(|&t| t < time).min(count - 1);
                    // One value for all times cannot make good what changes with them.
                    match choice.times.len() > 1 {
                        true => world(&after, i).conjugate() * world(&before, i) * q,
                        false => q,
                    }
                };
                if let Some(step) = draft.steps[number] {
                    rotation(channel, step, aim);
                }
                let mut player = Player::new(channel);
                for (i, played) in played.iter_mut().enumerate() {
                    let mut q = [0.0; 4];
                    player.at(work.times[i], &mut q);
                    *played = DQuat::from_array(q);
                }
            }
            let was = (0..count).map(|i| world(&before, i) * wanted(i)).collect();
            let is = (0..count).map(|i| world(&after, i) * played[i]).collect();
            before.insert(node, was);
            after.insert(node, is);
        }
    }
}

/// Coded bytes of what moves.
fn bytes(choices: &[Choice]) -> usize {
    let moving = || choices.iter().filter(|choice| !choice.at_rest);
    let mut known = std::collections::BTreeSet::new();
    let mut all: Vec<Numbers> = Vec::new();
    for choice in moving() {
        let times = &choice.channel.times;
        if known.insert(times.iter().map(|t| t.to_bits()).collect::<Vec<_>>()) {
            let times: Vec<[f32; 1]> = times.iter().map(|&t| [t]).collect();
            all.push(Numbers::floats(&times));
        }
        all.push(numbers(&choice.channel));
    }
    size(all.iter())
}
