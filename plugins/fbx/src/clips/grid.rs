//! The times at which a clip is looked at.

use super::keys::{Mark, SPIN, keys};
use crate::error::FbxError;
use crate::options::{Budget, Options};
use std::collections::BTreeSet;
use ufbx::{AnimStack, Scene};

/// Distance of the two sides of a jump on the file's clock, seconds: far less than a frame, far more
/// than the clock's resolution (1/46186158000 s).
const BESIDE: f64 = 1e-6;

/// Between two keys a sample is taken for every so many degrees that an angle changes by. FBX turns
/// three angles apart from each other, on paths that no rotation takes by itself.
const SWING: f64 = 6.0;

/// The most pieces that the time between two keys is cut into because of angles: two full turns.
const MOST_PIECES: f64 = 120.0;

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
        pair[1].time - pair[0].time <= self.frame * 1.001
    }

    /// Into how many pieces the time between two keys is cut.
    fn pieces(self, pair: &[Mark]) -> f64 {
        let length = pair[1].time - pair[0].time;
        if self.is_within(pair) && pair[0].spin < SPIN {
            return 1.0;
        }
        // A hair less than whole numbers, which frames of 1/30 s would else miss by rounding.
        let by_time = (length * self.samples - 1e-6).ceil();
        let by_angle = (pair[0].swing / SWING).ceil().min(MOST_PIECES);
        by_time.max(by_angle).max(2.0)
    }
}

impl Grid {
    pub(crate) fn len(&self) -> usize {
        self.labels.len()
    }

    /// Every key of the stack's curves, both sides of each step, and between keys that are more than a
    /// frame apart at least the middle and so many samples a second as `asked` says; at most `most`
    /// samples, for which what lies between keys is left out first. Gives the clip's begin too, and the
    /// nodes that spin.
    pub(crate) fn of_stack(
        scene: &Scene,
        stack: &AnimStack,
        asked: &Options,
        most: usize,
        budget: &Budget,
    ) -> Result<(f64, Self, BTreeSet<usize>), FbxError> {
        let rate = Rate::of(scene, asked);
        let (keys, spinning) = keys(scene, stack, budget)?;
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
        let dense: f64 = marks.windows(2).map(|pair| rate.pieces(pair)).sum();
        let rate = match dense <= most as f64 {
            true => Some(rate),
            false => None,
        };
        if marks.len() > most {
            return Err(budget.too_much("the keys of a clip"));
        }
        Ok((begin, Self::through(&marks, begin, rate), spinning))
    }

    fn through(marks: &[Mark], begin: f64, rate: Option<Rate>) -> Self {
        let mut grid = Self::default();
        for (i, mark) in marks.iter().enumerate() {
            if i > 0 && mark.before {
                let beside = (mark.time - BESIDE).max((marks[i - 1].time + mark.time) / 2.0);
                let last = before(((mark.time - begin) as f32).max(0.0));
                grid.push(beside, last, true, true);
            }
            grid.push(mark.time, (mark.time - begin) as f32, mark.after, true);
            let Some(next) = marks.get(i + 1) else { break };
            if mark.after {
                let beside = (mark.time + BESIDE).min((next.time + mark.time) / 2.0);
                let first = after((mark.time - begin) as f32);
                grid.push(beside, first, false, true);
            }
            let count = rate.map_or(1.0, |rate| rate.pieces(&[*mark, *next])) as usize;
            let first = grid.len() - 1;
            if count == 1 && !mark.after {
                grid.whole[first] = false;
            }
            for piece in 1..count {
                let time = mark.time + (next.time - mark.time) * (piece as f64 / count as f64);
                grid.push(time, (time - begin) as f32, false, false);
            }
            if rate.is_some_and(|rate| rate.is_within(&[*mark, *next])) {
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

fn before(x: f32) -> f32 {
    if x > 0.0 {
        f32::from_bits(x.to_bits() - 1)
    } else {
        0.0
    }
}

fn after(x: f32) -> f32 {
    f32::from_bits(x.max(0.0).to_bits() + 1)
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
        let grid = Grid::through(
            &marks,
            1.0,
            Some(Rate {
                samples: 2.0,
                frame: 0.0,
            }),
        );
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
    fn without_a_rate_there_are_keys_alone() {
        let grid = Grid::through(&[Mark::at(0.0), Mark::at(1.0)], 0.0, None);
        assert_eq!(grid.labels, [0.0, 1.0]);
        assert!(!grid.whole[0], "what lies between them does not count");
    }

    #[test]
    fn keys_of_one_frame_have_nothing_between_them() {
        let frame = 1.0 / 30.0;
        let rate = Rate {
            samples: 60.0,
            frame,
        };
        let marks = [Mark::at(0.0), Mark::at(frame), Mark::at(3.0 * frame)];
        let grid = Grid::through(&marks, 0.0, Some(rate));
        assert_eq!(grid.len(), 6, "{grid:?}");
        assert!(!grid.whole[0] && grid.whole[1..5].iter().all(|&whole| whole));
        assert_eq!(grid.within[..5], [true, false, false, false, false]);
    }

    #[test]
    fn what_spins_is_looked_at_within_frames_too() {
        let frame = 1.0 / 30.0;
        let rate = Rate {
            samples: 60.0,
            frame,
        };
        let spins = Mark {
            spin: 90.0,
            swing: 90.0,
            ..Mark::at(frame)
        };
        let marks = [Mark::at(0.0), spins, Mark::at(2.0 * frame)];
        let grid = Grid::through(&marks, 0.0, Some(rate));
        // 90 degrees in pieces of six, and all of them lie within a frame.
        assert_eq!(grid.len(), 2 + 15);
        assert!(grid.within[..16].iter().all(|&within| within));
    }

    #[test]
    fn times_that_f32_cannot_tell_apart_are_one() {
        let marks = [Mark::at(1000.0), Mark::at(1000.0 + 1e-9), Mark::at(1001.0)];
        let grid = Grid::through(&marks, 0.0, None);
        assert_eq!(grid.labels, [1000.0, 1001.0]);
    }
}
