//! The times at which a clip is looked at.

use super::keys::{Mark, SPIN, keys};
use crate::curves::Layers;
use crate::error::FbxError;
use crate::options::{Budget, Options};
use std::collections::BTreeSet;
use std::ops::Range;
use ufbx::{AnimStack, Scene};

/// Between two keys a sample is taken for every so many degrees that an angle changes by. FBX turns
/// three angles apart from each other, on paths that no rotation takes by itself.
const SWING: f64 = 6.0;

/// Up to so many pieces: two full turns.
const SWINGS: f64 = 120.0;

/// The same where an angle turns on and on: what bends between two samples is looked for later.
const LONG_SWING: f64 = 15.0;

/// Keys in every frame are that if so many frames follow each other.
const FRAMES_ON_END: usize = 3;

/// The share of a frame's time that a key in every frame may come early.
const SHORTEST_FRAME: f64 = 0.45;

/// Pieces of a time between two keys at first, because of its length alone; halvings come to a thousand
/// times as many where it bends.
const MOST_BY_TIME: f64 = 32.0;

/// Times of samples, growing.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Grid {
    /// On the file's clock, seconds.
    pub(crate) times: Vec<f64>,
    /// Seconds from the clip's start as glTF holds them, strictly growing.
    pub(crate) labels: Vec<f32>,
    /// Values may jump between this sample and the next.
    pub(crate) jumps: Vec<bool>,
    /// The sample stands on a key of the file, where curves may bend, or at an end.
    pub(crate) keys: Vec<bool>,
    /// What lies between this sample and the next counts: they are keys no frame apart.
    pub(crate) whole: Vec<bool>,
    /// The gap after this sample lies within a frame: it counts for nodes alone that spin.
    pub(crate) within: Vec<bool>,
}

/// How finely a clip is looked at.
#[derive(Debug, Clone, Copy)]
struct Rate {
    /// Samples a second.
    samples: f64,
    /// Seconds of a frame; what lies within one does not count.
    frame: f64,
}

impl Rate {
    fn of(scene: &Scene, options: &Options) -> Self {
        let frames = scene.settings.frames_per_second;
        let frames = if frames.is_finite() {
            frames.clamp(1.0, 1000.0)
        } else {
            30.0
        };
        Self {
            samples: options.sample_rate,
            frame: if options.within_frames {
                0.0
            } else {
                1.0 / frames
            },
        }
    }

    /// Two keys are no more than a frame apart.
    fn is_within(self, pair: &[Mark]) -> bool {
        pair[0].baked && pair[1].time - pair[0].time <= self.frame * 1.001
    }

    /// Says of marks whether a key in every frame goes on from them: at least so many frames on end. Keys
    /// that are nearer than that, or alone, mean what lies between them.
    fn find_bakes(self, marks: &mut [Mark]) {
        let is_frame = |pair: &[Mark]| {
            let length = pair[1].time - pair[0].time;
            length >= self.frame * SHORTEST_FRAME && length <= self.frame * 1.001
        };
        let frames: Vec<bool> = marks.windows(2).map(is_frame).collect();
        let mut at = 0;
        while at < frames.len() {
            let run = frames[at..].iter().take_while(|&&frame| frame).count();
            marks[at..at + run]
                .iter_mut()
                .for_each(|mark| mark.baked = run >= FRAMES_ON_END);
            at += run.max(1);
        }
    }

    /// Into how many pieces the time between two keys is cut.
    fn pieces(self, pair: &[Mark]) -> f64 {
        let length = pair[1].time - pair[0].time;
        if self.is_within(pair) && pair[0].spin < SPIN {
            return 1.0;
        }
        // A hair less than whole numbers, which frames of 1/30 s would else miss by rounding.
        let by_time = (length * self.samples - 1e-6).ceil().min(MOST_BY_TIME);
        let by_angle = (pair[0].swing / SWING).ceil().min(SWINGS);
        let on_and_on = (pair[0].swing / LONG_SWING).ceil();
        by_time.max(by_angle).max(on_and_on).max(2.0)
    }
}

impl Grid {
    pub(crate) fn len(&self) -> usize {
        self.labels.len()
    }

    /// The grid through some of a plan's marks.
    pub(crate) fn of(plan: &Plan, window: Range<usize>) -> Self {
        Self::through(&plan.marks[window], &plan.more, plan.begin, plan.rate)
    }

    fn through(marks: &[Mark], more: &[f64], begin: f64, rate: Rate) -> Self {
        let mut grid = Self::default();
        for (i, mark) in marks.iter().enumerate() {
            let label = (mark.time - begin) as f32;
            // Beside a jump glTF's time is on the side that the file's is on, as near to it as f32 has one: a
            // clip must not get shorter by it.
            let (floor, ceiling) = match f64::from(label) > mark.time - begin {
                true => (label.next_down().max(0.0), label),
                false if f64::from(label) < mark.time - begin => (label, label.next_up()),
                false => (label, label),
            };
            let seen = |label: f32| begin + f64::from(label);
            if i > 0 && mark.before {
                let last = before(floor);
                if seen(last) > marks[i - 1].time {
                    grid.push(seen(last), last, true, true);
                }
            }
            match (mark.before && i > 0, mark.after && i + 1 < marks.len()) {
                // Where no value jumps, samples are taken at the times that glTF can say.
                (false, false) => grid.push(seen(label), label, false, true),
                (true, false) => grid.push(mark.time, floor, false, true),
                (_, true) => grid.push(mark.time, ceiling, true, true),
            }
            let Some(next) = marks.get(i + 1) else { break };
            if mark.after {
                let first = after(ceiling);
                if seen(first) < next.time {
                    grid.push(seen(first), first, false, true);
                }
            }
            let count = rate.pieces(&[*mark, *next]) as usize;
            let first = grid.len() - 1;
            if count == 1 && !mark.after {
                grid.whole[first] = false;
            }
            let piece = |piece| mark.time + (next.time - mark.time) * (piece as f64 / count as f64);
            let after = more.partition_point(|&time| time <= mark.time);
            let until = more.partition_point(|&time| time < next.time).max(after);
            let mut times: Vec<f64> = (1..count).map(piece).collect();
            if until > after {
                times.extend(&more[after..until]);
                times.sort_by(f64::total_cmp);
            }
            for time in times {
                let label = (time - begin) as f32;
                if seen(label) > mark.time && seen(label) < next.time {
                    grid.push(seen(label), label, false, false);
                }
            }
            if rate.is_within(&[*mark, *next]) {
                grid.within[first..].fill(true);
            }
        }
        grid
    }

    /// Times that glTF cannot tell apart are taken once.
    pub(crate) fn push(&mut self, time: f64, label: f32, jump: bool, key: bool) {
        match self.labels.last() {
            Some(&last) if label <= last => {
                let same = self.labels.len() - 1;
                self.jumps[same] |= jump;
                self.keys[same] |= key;
            }
            _ => {
                self.times.push(time);
                self.labels.push(label);
                self.jumps.push(jump);
                self.keys.push(key);
                self.whole.push(true);
                self.within.push(false);
            }
        }
    }

    /// Says of the last sample whether the gap after it lies within a frame.
    pub(crate) fn set_within(&mut self, within: bool) {
        if let Some(last) = self.within.last_mut() {
            *last = within;
        }
    }

    /// Up to four samples that predict the middle of a gap: its two ends first, then others that no
    /// key lies before. They are at least half a gap apart from each other, for polynomials through
    /// samples that crowd together go astray elsewhere.
    pub(crate) fn stencil(&self, gap: usize) -> Vec<usize> {
        let length = self.times[gap + 1] - self.times[gap];
        let mut before = self.outwards(gap, length, false);
        let mut after = self.outwards(gap + 1, length, true);
        let mut out = vec![gap, gap + 1];
        match (before.next(), after.next()) {
            (Some(a), Some(b)) => out.extend([a, b]),
            // At the end of a stretch the stencil leans inwards.
            (Some(a), None) => out.extend([Some(a), before.next()].into_iter().flatten()),
            (None, Some(b)) => out.extend([Some(b), after.next()].into_iter().flatten()),
            (None, None) => {}
        }
        out
    }

    /// Samples from `start` to one side, at least half of `length` apart, up to the next key.
    fn outwards(&self, start: usize, length: f64, forwards: bool) -> impl Iterator<Item = usize> {
        let mut at = start;
        let mut last = self.times[start];
        std::iter::from_fn(move || {
            loop {
                if self.keys[at] {
                    return None;
                }
                at = match forwards {
                    true => Some(at + 1).filter(|&at| at < self.len())?,
                    false => at.checked_sub(1)?,
                };
                if (self.times[at] - last).abs() >= 0.49 * length {
                    last = self.times[at];
                    return Some(at);
                }
            }
        })
    }
}

/// The marks of a whole clip, and how finely it is looked at between them.
#[derive(Clone)]
pub(crate) struct Plan {
    marks: Vec<Mark>,
    rate: Rate,
    /// Times between marks at which it is looked at too, growing.
    more: Vec<f64>,
    /// On the file's clock, seconds.
    pub(crate) begin: f64,
    pub(crate) end: f64,
    /// Nodes that spin.
    pub(crate) spinning: BTreeSet<usize>,
}

impl Plan {
    /// Every key of the stack's curves, both sides of each step, and between keys that are more than a
    /// frame apart at least the middle and so many samples a second as `asked` says.
    pub(crate) fn of(
        scene: &Scene,
        stack: &AnimStack,
        layers: &Layers,
        asked: &Options,
        budget: &Budget,
    ) -> Result<Self, FbxError> {
        let rate = Rate::of(scene, asked);
        let keys = keys(scene, layers, (stack.time_begin, stack.time_end), budget)?;
        let (spinning, keys) = (keys.spinning, keys.all);
        let (begin, end) = range(stack, &keys);
        let mut marks = vec![Mark::at(begin)];
        marks.extend(
            keys.iter()
                .copied()
                .filter(|k| k.time > begin && k.time < end),
        );
        if end > begin {
            marks.push(Mark::at(end));
        }
        for mark in keys.iter().filter(|k| k.time == begin || k.time == end) {
            let same = if mark.time == begin {
                0
            } else {
                marks.len() - 1
            };
            marks[same].before |= mark.before;
            marks[same].after |= mark.after;
            marks[same].swing = marks[same].swing.max(mark.swing);
            marks[same].spin = marks[same].spin.max(mark.spin);
        }
        // A clip that starts between two keys swings as they do.
        if let Some(last) = keys.iter().rfind(|k| k.time < begin) {
            marks[0].swing = marks[0].swing.max(last.swing);
            marks[0].spin = marks[0].spin.max(last.spin);
        }
        rate.find_bakes(&mut marks);
        Ok(Self {
            marks,
            rate,
            more: Vec::new(),
            begin,
            end,
            spinning,
        })
    }

    /// How many marks there are.
    pub(crate) fn len(&self) -> usize {
        self.marks.len()
    }

    /// The same with samples at `times` too, which grow.
    pub(crate) fn with(mut self, times: &[f64]) -> Self {
        self.more.extend(times);
        self.more.sort_by(f64::total_cmp);
        self.more.dedup();
        self
    }

    /// Samples of the grid through all marks.
    pub(crate) fn samples(&self) -> f64 {
        let pieces = self.marks.windows(2).map(|pair| self.rate.pieces(pair));
        pieces.sum::<f64>() + self.more.len() as f64
    }

    /// Ranges of marks of which each has up to so many samples, unless it is no longer than two marks.
    pub(crate) fn windows(&self, samples: f64) -> Vec<Range<usize>> {
        let mut out = Vec::new();
        let (mut from, mut sum) = (0, 0.0);
        for at in 1..self.marks.len() {
            let pieces = self.rate.pieces(&self.marks[at - 1..=at]);
            if sum + pieces > samples && at > from + 1 {
                out.push(from..at);
                (from, sum) = (at - 1, 0.0);
            }
            sum += pieces;
        }
        out.push(from..self.marks.len());
        out
    }

    /// Cuts times between marks that have more than so many samples.
    pub(crate) fn cut(&mut self, samples: f64) {
        let mut out = Vec::with_capacity(self.marks.len());
        for (i, mark) in self.marks.iter().enumerate() {
            out.push(*mark);
            let Some(next) = self.marks.get(i + 1) else {
                break;
            };
            let pieces = self.rate.pieces(&[*mark, *next]);
            let parts = (pieces / samples).ceil().clamp(1.0, 1e6) as usize;
            let part = |of: usize| of as f64 / parts as f64;
            if parts > 1 {
                let last = out.len() - 1;
                out[last].swing = mark.swing * part(1);
            }
            for at in 1..parts {
                out.push(Mark {
                    time: mark.time + (next.time - mark.time) * part(at),
                    swing: mark.swing * part(1),
                    spin: mark.spin,
                    ..Mark::at(0.0)
                });
            }
        }
        self.marks = out;
    }

    /// Each gap between two marks: where it begins and ends on the file's clock, whether values jump there, and whether it
    /// lies within a frame.
    pub(crate) fn gaps(&self) -> impl Iterator<Item = Stretch> {
        self.marks.windows(2).map(|pair| Stretch {
            begin: pair[0].time,
            end: pair[1].time,
            jumps: pair[0].before || pair[0].after,
            jumps_after: pair[1].before || pair[1].after,
            within: self.rate.is_within(pair),
        })
    }
}

/// The time between two marks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stretch {
    /// On the file's clock, seconds.
    pub(crate) begin: f64,
    pub(crate) end: f64,
    /// Values may jump at its begin, or at its end.
    pub(crate) jumps: bool,
    pub(crate) jumps_after: bool,
    /// No longer than a frame, in a file that has keys in every one.
    pub(crate) within: bool,
}

/// Seconds between the two sides of a jump, at least: f32 could say far less near 0, which neither players
/// nor the file's clock tell apart.
const SIDES: f32 = 1e-7;

/// The time just before `x`.
pub(crate) fn before(x: f32) -> f32 {
    x.next_down().min(x - SIDES).max(0.0)
}

/// The time just after `x`.
pub(crate) fn after(x: f32) -> f32 {
    x.max(0.0).next_up().max(x + SIDES)
}

/// The stack's own range, or that of its keys where it names none.
fn range(stack: &AnimStack, keys: &[Mark]) -> (f64, f64) {
    let (begin, end) = (stack.time_begin, stack.time_end);
    if begin.is_finite() && end.is_finite() && end > begin {
        return (begin, end);
    }
    match (keys.first(), keys.last()) {
        (Some(first), Some(last)) => (first.time, last.time),
        _ => (0.0, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rate(samples: f64, frame: f64) -> Rate {
        Rate { samples, frame }
    }

    #[test]
    fn times_grow_and_steps_have_two_sides() {
        let marks = [
            Mark::at(1.0),
            Mark {
                before: true,
                ..Mark::at(1.5)
            },
            Mark {
                after: true,
                ..Mark::at(2.0)
            },
            Mark::at(2.5),
        ];
        let grid = Grid::through(&marks, &[], 1.0, rate(2.0, 0.0));
        assert!(grid.labels.windows(2).all(|w| w[0] < w[1]), "{grid:?}");
        assert!(grid.times.windows(2).all(|w| w[0] < w[1]), "{grid:?}");
        assert_eq!(grid.labels[0], 0.0);
        assert_eq!(*grid.labels.last().unwrap(), 1.5);
        let jumps: Vec<f32> = (0..grid.len())
            .filter(|&i| grid.jumps[i])
            .map(|i| grid.labels[i])
            .collect();
        assert_eq!(jumps, [before(0.5), 1.0]);
        // The far side of a step that comes after its key.
        assert!(grid.labels.contains(&after(1.0)));
    }

    #[test]
    fn keys_of_one_frame_have_nothing_between_them() {
        let frame = 1.0 / 30.0;
        let rate = rate(60.0, frame);
        let mut marks = [0.0, 1.0, 2.0, 3.0, 5.0].map(|at| Mark::at(at * frame));
        rate.find_bakes(&mut marks);
        let grid = Grid::through(&marks, &[], 0.0, rate);
        assert_eq!(grid.len(), 8, "{grid:?}");
        assert!(!grid.whole[0] && grid.whole[3..7].iter().all(|&whole| whole));
        assert_eq!(
            grid.within[..7],
            [true, true, true, false, false, false, false]
        );
    }

    #[test]
    fn what_spins_is_looked_at_within_frames_too() {
        let frame = 1.0 / 30.0;
        let rate = rate(60.0, frame);
        let spins = Mark {
            spin: 90.0,
            swing: 90.0,
            ..Mark::at(frame)
        };
        let mut marks = [
            Mark::at(0.0),
            spins,
            Mark::at(2.0 * frame),
            Mark::at(3.0 * frame),
        ];
        rate.find_bakes(&mut marks);
        let grid = Grid::through(&marks, &[], 0.0, rate);
        // 90 degrees in pieces of six, and all of them lie within a frame.
        assert_eq!(grid.len(), 3 + 15);
        assert!(grid.within[..17].iter().all(|&within| within));
    }

    #[test]
    fn keys_nearer_than_frames_or_alone_mean_what_lies_between() {
        let frame = 1.0 / 30.0;
        let rate = rate(30.0, frame);
        for gaps in [[0.2, 0.2, 0.2, 0.2], [1.0, 1.0, 3.0, 1.0]] {
            let mut time = 0.0;
            let mut marks = vec![Mark::at(0.0)];
            marks.extend(gaps.map(|gap| {
                time += gap * frame;
                Mark::at(time)
            }));
            rate.find_bakes(&mut marks);
            assert!(marks.iter().all(|mark| !mark.baked), "{gaps:?}");
        }
    }

    #[test]
    fn windows_hold_so_many_samples_and_meet() {
        let marks: Vec<Mark> = (0..100).map(|i| Mark::at(f64::from(i))).collect();
        let mut plan = Plan {
            marks,
            rate: rate(10.0, 0.0),
            more: Vec::new(),
            begin: 0.0,
            end: 99.0,
            spinning: BTreeSet::new(),
        };
        let more = plan.clone().with(&[3.26, 3.01]);
        let (few, many) = (Grid::of(&plan, 3..5), Grid::of(&more, 3..5));
        assert_eq!(many.len(), few.len() + 2);
        assert!(many.times.windows(2).all(|pair| pair[0] < pair[1]));
        let windows = plan.windows(95.0);
        assert_eq!((windows[0].start, windows[windows.len() - 1].end), (0, 100));
        for pair in windows.windows(2) {
            assert_eq!(pair[0].end, pair[1].start + 1, "both have the mark between");
        }
        assert!(windows.iter().all(|window| window.len() <= 10));
        plan.cut(5.0);
        assert_eq!(plan.len(), 199);
        assert!(plan.windows(5.0).iter().all(|window| window.len() == 2));
    }

    #[test]
    fn times_that_f32_cannot_tell_apart_are_one() {
        let marks = [Mark::at(1000.0), Mark::at(1000.0 + 1e-9), Mark::at(1001.0)];
        let grid = Grid::through(&marks, &[], 0.0, rate(1.0, 2.0));
        assert_eq!(grid.labels, [1000.0, 1000.5, 1001.0]);
    }
}
