//! The passes of a frame in parts: looking and making may be repeated before a choice is drawn.

use crate::blocks::layout::{Groups, PASSES, Second};

use super::record::{Extras, Step, beginning};

/// A part of a choice; parts are passes of their own on the GPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// What comes before: roots of a new ground are made, blocks are dropped, and others made anew or refreshed. Where the ground was
    /// edited counts are cleared before it.
    Begin,
    /// Finds what is to be made, and draws nothing. Counts are cleared before it.
    Look,
    /// The same, and what is drawn. Counts are cleared before it.
    Choose,
    /// Makes what the part before found.
    Make,
}

/// The last pass that finds what is to be made.
const LAST_LOOK: &str = "fit";

impl Part {
    /// Its dispatches.
    pub fn steps(self, extras: Extras) -> impl Iterator<Item = Step> {
        let first = (self == Self::Begin).then(|| beginning(extras));
        let first = first.into_iter().flatten();
        let fit = PASSES
            .iter()
            .position(|(_, entry, ..)| *entry == LAST_LOOK)
            .unwrap_or(PASSES.len());
        let is_wanted = move |pass: &usize| match PASSES[*pass] {
            (.., Groups::Sweep | Groups::Edit | Groups::EditAt(_)) => false,
            (.., Second::Ground, _) => self == Self::Make,
            (.., Groups::Horizon(_)) => self == Self::Choose && extras.occluded,
            _ => self == Self::Choose || (self == Self::Look && *pass <= fit),
        };
        let all = (0..PASSES.len()).filter(is_wanted);
        first.chain(all.map(|pass| Step { pass, groups: None }))
    }
}

#[cfg(test)]
mod tests {
    use super::super::record::steps;
    use super::*;

    fn names(parts: &[Part], extras: Extras) -> Vec<&'static str> {
        let steps = parts.iter().flat_map(|part| part.steps(extras));
        steps.map(|step| PASSES[step.pass].1).collect()
    }

    #[test]
    fn the_parts_of_a_choice_are_all_of_it() {
        for (roots, edits) in [(None, None), (Some(4), None), (None, Some(3))] {
            for (sweeps, occluded) in [(false, false), (true, false), (false, true), (true, true)] {
                let extras = Extras {
                    roots,
                    sweeps,
                    edits,
                    occluded,
                };
                let mut parts = names(&[Part::Begin, Part::Choose, Part::Make], extras);
                let mut whole: Vec<_> = steps(extras).map(|step| PASSES[step.pass].1).collect();
                let most = 20 + edits.map_or(0, |rounds| 5 * rounds as usize + 2);
                assert!(parts.len() <= most && parts.len() == whole.len());
                parts.sort_unstable();
                whole.sort_unstable();
                assert_eq!(parts, whole);
            }
        }
    }

    #[test]
    fn an_edit_makes_parents_before_children_and_drops_what_is_left() {
        let extras = Extras {
            edits: Some(2),
            ..Extras::default()
        };
        let round = [
            "spread_edits",
            "refresh_blocks",
            "sample_blocks",
            "slope_blocks",
            "make_blocks",
        ];
        let last = ["spread_edits", "drop_edited"];
        let expected = [&round[..], &round[..], &last[..]].concat();
        assert_eq!(names(&[Part::Begin], extras), expected);
        assert_eq!(names(&[Part::Begin], Extras::default()), [""; 0]);
    }

    #[test]
    fn a_round_before_looks_and_makes_alone() {
        let extras = Extras {
            occluded: true,
            ..Extras::default()
        };
        let round = names(&[Part::Look, Part::Make], extras);
        let expected = [
            "scan_blocks",
            "look_at_blocks",
            "fit",
            "sample_blocks",
            "slope_blocks",
            "make_blocks",
        ];
        assert_eq!(round, expected);
    }
}
