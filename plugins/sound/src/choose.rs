//! Who gets a voice: by priority, then by loudness, and who has one keeps it until another is clearly louder.

use std::cmp::Ordering;

/// Who has a voice counts as so much louder: 2 dB, so that two of about the same loudness do not take turns.
const KEEPS: f32 = 1.26;

/// Somebody who would be heard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// The greater number first.
    pub priority: u8,
    /// Amplitude.
    pub gain: f32,
    /// It has a voice already.
    pub sounds: bool,
    /// Decides between equals: the lesser number first. No two are the same.
    pub number: u64,
}

fn rank(a: &Candidate, b: &Candidate) -> Ordering {
    let loud = |one: &Candidate| {
        if one.sounds {
            KEEPS * one.gain
        } else {
            one.gain
        }
    };
    b.priority
        .cmp(&a.priority)
        .then_with(|| loud(b).total_cmp(&loud(a)))
        .then_with(|| a.number.cmp(&b.number))
}

/// Puts the `most` who get a voice first, and gives how many these are. Their order, and that of the others, is no
/// matter. Takes O(n).
pub fn choose(candidates: &mut [Candidate], most: usize) -> usize {
    let count = candidates.len().min(most);
    if count > 0 && count < candidates.len() {
        candidates.select_nth_unstable_by(count - 1, rank);
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(priority: u8, gain: f32, sounds: bool, number: u64) -> Candidate {
        Candidate {
            priority,
            gain,
            sounds,
            number,
        }
    }

    fn chosen(mut all: Vec<Candidate>, most: usize) -> Vec<u64> {
        let count = choose(&mut all, most);
        let mut numbers: Vec<_> = all[..count].iter().map(|one| one.number).collect();
        numbers.sort_unstable();
        numbers
    }

    #[test]
    fn priority_then_loudness_then_who_was_there() {
        let all = vec![
            one(1, 1.0, false, 0),
            one(2, 0.1, false, 1),
            one(1, 0.9, true, 2),
            one(1, 0.5, true, 3),
        ];
        assert_eq!(chosen(all.clone(), 1), [1]);
        assert_eq!(chosen(all.clone(), 2), [1, 2], "who sounds keeps its voice");
        assert_eq!(chosen(all.clone(), 3), [0, 1, 2]);
        assert_eq!(chosen(all.clone(), 9), [0, 1, 2, 3]);
        assert_eq!(chosen(all, 0), [0; 0]);
        assert_eq!(chosen(vec![], 4), [0; 0]);
        // Equals, whatever their order.
        let mut equals: Vec<_> = (0..100).map(|number| one(1, 0.5, false, number)).collect();
        equals.reverse();
        assert_eq!(chosen(equals, 3), [0, 1, 2]);
    }

    /// As a full sort has it, for any numbers.
    #[test]
    fn it_is_what_sorting_gives() {
        let mut state = 1_u32;
        let mut next = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            state >> 16
        };
        for _ in 0..200 {
            let all: Vec<_> = (0..next() % 60)
                .map(|k| {
                    one(
                        (next() % 3) as u8,
                        (next() % 8) as f32,
                        next() % 2 == 0,
                        u64::from(k),
                    )
                })
                .collect();
            let most = (next() % 40) as usize;
            let mut sorted = all.clone();
            sorted.sort_by(rank);
            sorted.truncate(most);
            let mut wanted: Vec<_> = sorted.iter().map(|one| one.number).collect();
            wanted.sort_unstable();
            assert_eq!(chosen(all, most), wanted);
        }
    }
}
