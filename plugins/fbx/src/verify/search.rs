//! Where the largest errors are looked for.
//!
//! The largest looks of each kind are kept; around each, as far as its neighbours, the largest error is searched
//! for, the largest look first.

use super::actors::Actors;

/// Looks of each kind around which is searched, at least and at most; between them one for so many looks.
const LEAST: usize = 8;
const MOST: usize = 32;
const SHARE: usize = 40;

/// What lies around a look is at most so many times as far off: others are not searched once more is found.
const LEAP: f64 = 2.0;

/// Looks of each of the steps of a search.
const LOOKS: usize = 7;

/// Steps of a search, each three times as fine as the last.
const STEPS: usize = 3;

/// A time that was looked at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    pub(super) error: f64,
    pub(super) time: f64,
    /// As far as it stands for.
    pub(super) begin: f64,
    pub(super) end: f64,
    /// It lies within frames.
    pub(super) within: bool,
}

/// The largest looks of each kind.
#[derive(Default)]
pub(super) struct Peaks {
    pub(super) keyed: Vec<Look>,
    pub(super) within: Vec<Look>,
    /// Looks of all.
    pub(super) times: usize,
}

impl Peaks {
    pub(super) fn add(&mut self, look: Look) {
        self.times += 1;
        self.keep(look);
    }

    fn keep(&mut self, look: Look) {
        let list = match look.within {
            true => &mut self.within,
            false => &mut self.keyed,
        };
        if list.len() == MOST && list[MOST - 1].error >= look.error {
            return;
        }
        let at = list.partition_point(|known| known.error >= look.error);
        list.insert(at, look);
        list.truncate(MOST);
    }

    /// With those of another part of the clip.
    pub(super) fn join(&mut self, part: Self) {
        self.times += part.times;
        let looks = part.keyed.into_iter().chain(part.within);
        looks.for_each(|look| self.keep(look));
    }

    /// Searches around the largest.
    pub(super) fn search(&mut self, actors: &mut Actors) {
        let count = (self.times / SHARE).clamp(LEAST, MOST);
        for list in [&mut self.keyed, &mut self.within] {
            let mut largest = 0.0_f64;
            for look in list.iter_mut().take(count) {
                if look.error * LEAP < largest {
                    break;
                }
                self.times += around(look, actors);
                largest = largest.max(look.error);
            }
        }
    }
}

/// Moves a look to the largest error around it; says how many looks that took.
fn around(look: &mut Look, actors: &mut Actors) -> usize {
    let (mut begin, mut end) = (look.begin, look.end);
    let mut looks = 0;
    for _ in 0..STEPS {
        if end <= begin {
            break;
        }
        let step = (end - begin) / (LOOKS - 1) as f64;
        for i in 0..LOOKS {
            let time = begin + step * i as f64;
            let error = actors.apart(time);
            if error > look.error {
                (look.error, look.time) = (error, time);
            }
        }
        looks += LOOKS;
        (begin, end) = (
            (look.time - step).max(look.begin),
            (look.time + step).min(look.end),
        );
    }
    looks
}
