//! The console: lines come in, are understood by a [`Table`], done one after another, and answered. Nothing here draws.
//!
//! | file | concern |
//! |---|---|
//! | [`words`] | from a line to its words |
//! | [`table`] | the commands; what a line means |
//! | [`complete`](mod@complete) | what may stand where the line ends |
//! | [`history`] | what was typed before |
//! | [`queue`] | what is to be done, and scripts |

pub mod complete;
pub mod history;
pub mod queue;
pub mod table;
pub mod words;

use std::collections::VecDeque;

use bevy::ecs::resource::Resource;

use history::History;
use queue::Queue;
use table::{Mistake, Table};

/// Most lines of output that are kept.
const MOST: usize = 4000;

/// What kind of line it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// It was typed, or came from a script.
    Typed,
    /// It answers.
    Said,
    /// It says that something was not done.
    Fault,
}

/// The console of an app.
#[derive(Resource, Default)]
pub struct Console {
    /// What it understands.
    pub table: Table,
    /// What was typed before.
    pub history: History,
    /// What is to be done.
    pub queue: Queue,
    output: VecDeque<(Tone, String)>,
    lines: u64,
    faults: u64,
}

impl Console {
    /// Enters a line as if it was typed. It is done in the next frame, after those before it.
    pub fn enter(&mut self, line: &str) {
        self.history.push(line);
        self.queue.push(line);
    }

    /// Enters a script: a command a line. A mistake is named with `name` and the line, and the rest is left out.
    pub fn enter_script(&mut self, name: &str, text: &str) {
        self.queue.push_script(name, text);
    }

    /// Adds a text to the output, a line of it each.
    pub fn say(&mut self, tone: Tone, text: &str) {
        self.faults += u64::from(tone == Tone::Fault);
        for line in text.trim_end().lines() {
            if self.output.len() == MOST {
                self.output.pop_front();
            }
            self.output.push_back((tone, line.to_owned()));
            self.lines += 1;
        }
    }

    /// Says what came of a command.
    pub fn answer(&mut self, answer: Result<String, Mistake>) {
        match answer {
            Ok(text) => self.say(Tone::Said, &text),
            Err(mistake) => self.say(Tone::Fault, &mistake.0),
        }
    }

    /// The output that is kept, the oldest line first.
    pub fn output(&self) -> impl DoubleEndedIterator<Item = (Tone, &str)> + ExactSizeIterator {
        self.output
            .iter()
            .map(|(tone, line)| (*tone, line.as_str()))
    }

    /// How many lines were ever said: who follows the output knows by it what is new.
    #[must_use]
    pub const fn lines_said(&self) -> u64 {
        self.lines
    }

    /// How many faults were said since the start: a run by a script has failed where there are some.
    #[must_use]
    pub const fn faults(&self) -> u64 {
        self.faults
    }

    /// Forgets the output.
    pub fn clear(&mut self) {
        self.output.clear();
    }
}
