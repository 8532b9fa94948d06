//! The tree of an agent as text, with what runs: for people.

use super::leaf::Leaves;
use super::mind::Mind;
use super::program::{NONE, Op, Program};
use super::store::Behaviours;
use crate::names::{Key, Names};
use std::fmt::Write;

/// Most lines of a tree.
const MOST: usize = 200;

/// What stands before a node that runs.
const RUNS: &str = "> ";
/// And before one that does not.
const RESTS: &str = "  ";

/// The tree of an agent as it runs: a line a node, `>` before those that run, from the root to the leaf; of each of these
/// the children, and of the others none. At most 200 lines. Names are those of [`Names`] and [`Leaves`].
#[must_use]
pub fn tree_of(mind: &Mind, behaviours: &Behaviours, names: &Names, leaves: &Leaves) -> String {
    let Some((name, program, edition)) = behaviours.entry(mind.behaviour()) else {
        return "a behaviour that is not there".to_owned();
    };
    let what = match mind.running() {
        // Its numbers are those of a text that was read again since.
        Some(_) if mind.edition != edition => "begins anew".to_owned(),
        Some(_) => format!("runs since step {}", mind.since),
        None => format!("between two rounds, after {:?}", mind.status()),
    };
    let mut text = format!("{name}: {what}\n");
    let running = match mind.running() {
        Some(node) if mind.edition == edition => node,
        _ => NONE,
    };
    let shown = Shown {
        program,
        running,
        names,
        leaves,
    };
    shown.write(&mut text);
    text
}

struct Shown<'a> {
    program: &'a Program,
    /// The node that runs, or none.
    running: u16,
    names: &'a Names,
    leaves: &'a Leaves,
}

impl Shown<'_> {
    fn write(&self, text: &mut String) {
        let nodes = &self.program.nodes;
        let (mut node, mut lines) = (0_usize, 0);
        while let Some(code) = nodes.get(node) {
            if lines == MOST {
                *text += "...\n";
                return;
            }
            lines += 1;
            let running = usize::from(self.running);
            let runs = self.running != NONE && (node..usize::from(code.end)).contains(&running);
            let mark = if runs { RUNS } else { RESTS };
            let depth = self.depth(code.parent);
            // Into a text nothing fails.
            let _ = writeln!(text, "{mark}{:depth$}{}", "", self.words(&code.op));
            // Of a root that does not run the children are shown all the same.
            let within = runs || node == 0;
            node = if within {
                node + 1
            } else {
                usize::from(code.end)
            };
        }
    }

    /// Twice as many spaces as there are nodes above it.
    fn depth(&self, mut parent: u16) -> usize {
        let mut depth = 0;
        while let Some(code) = self.program.nodes.get(usize::from(parent)) {
            parent = code.parent;
            depth += 2;
        }
        depth
    }

    fn words(&self, op: &Op) -> String {
        let name = |key: Key| self.names.text(key);
        match *op {
            Op::Sequence => "Sequence".to_owned(),
            Op::Select => "Select".to_owned(),
            Op::Choose => "Choose".to_owned(),
            Op::Not => "Not".to_owned(),
            Op::Anyway => "Anyway".to_owned(),
            Op::Repeat => "Repeat".to_owned(),
            Op::Cooldown(seconds, _) => format!("Cooldown {seconds} s"),
            Op::Limit(seconds, _) => format!("Limit {seconds} s"),
            Op::Above(key, value) => format!("If {} above {value}", name(key)),
            Op::Below(key, value) => format!("If {} below {value}", name(key)),
            Op::Is(key, value) => format!("If {} is {value:?}", name(key)),
            Op::Known(key) => format!("If {} is known", name(key)),
            Op::Unknown(key) => format!("If {} is unknown", name(key)),
            Op::Set(key, value) => format!("Set {} to {value:?}", name(key)),
            Op::Wait(seconds) => format!("Wait {seconds} s"),
            Op::Send(verb, to) => format!("Send {} to {}", name(verb), name(to)),
            Op::Say(key) => format!("Say {}", name(key)),
            Op::Do(leaf, _) => format!("Do {}", self.leaves.name(leaf).unwrap_or("?")),
        }
    }
}
