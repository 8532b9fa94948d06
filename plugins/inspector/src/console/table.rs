//! The table of commands: how each is written, what it is for, and what it does.
//!
//! How a command is written is a [`clap::Command`], as on a command line, so that an app shows in its `--help` what the
//! console knows, and both from one table.

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::ecs::world::World;
use clap::error::ErrorKind;
use clap::{ArgMatches, Command};
use thiserror::Error;

use super::words::{Unclosed, words};

/// What a command did.
pub enum Step {
    /// It is done, and says this; nothing where empty.
    Said(String),
    /// It goes on: asked once a frame until it gives something. What was typed after it waits.
    Wait(Wait),
}

/// Asks a command that goes on whether it is done: `None` while it is not.
pub type Wait = Box<dyn FnMut(&mut World) -> Option<Result<String, Mistake>> + Send + Sync>;

/// Does what was asked for.
pub type Run = Arc<dyn Fn(&mut World, &ArgMatches) -> Result<Step, Mistake> + Send + Sync>;

/// Why a command was not done, in words for whoever typed it.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct Mistake(pub String);

impl Mistake {
    /// A mistake of the words of an error.
    pub fn of(error: impl std::fmt::Display) -> Self {
        Self(error.to_string())
    }
}

impl From<Unclosed> for Mistake {
    fn from(error: Unclosed) -> Self {
        Self::of(error)
    }
}

/// What a line means.
#[derive(Clone)]
pub enum Meaning {
    /// Nothing: it is empty, or a comment.
    Nothing,
    /// Help was asked for.
    Help(String),
    /// A command with its arguments.
    Call(Run, ArgMatches),
}

/// All commands.
#[derive(Clone)]
pub struct Table {
    command: Command,
    runs: BTreeMap<String, Run>,
}

impl Default for Table {
    fn default() -> Self {
        Self {
            command: Command::new("console")
                .multicall(true)
                .subcommand_required(true)
                .disable_version_flag(true)
                .subcommand_help_heading("Commands of the console"),
            runs: BTreeMap::new(),
        }
    }
}

impl Table {
    /// Adds a command, or replaces the one with its name.
    pub fn add(
        &mut self,
        command: Command,
        run: impl Fn(&mut World, &ArgMatches) -> Result<Step, Mistake> + Send + Sync + 'static,
    ) {
        self.insert(command, Arc::new(run));
    }

    /// Adds the commands of another table; its own where both have one of a name.
    pub fn extend(&mut self, other: Self) {
        for command in other.command.get_subcommands() {
            if let Some(run) = other.runs.get(command.get_name()) {
                self.insert(command.clone(), run.clone());
            }
        }
    }

    fn insert(&mut self, command: Command, run: Run) {
        let name = command.get_name().to_owned();
        let all = std::mem::replace(&mut self.command, Command::new(""));
        let command = command.disable_version_flag(true);
        self.command = if self.runs.contains_key(&name) {
            all.mut_subcommand(&name, |_| command)
        } else {
            all.subcommand(command)
        };
        self.runs.insert(name, run);
    }

    /// The commands as clap has them, in the order they were added.
    #[must_use]
    pub const fn command(&self) -> &Command {
        &self.command
    }

    /// Name and purpose of each command, in the order they were added.
    pub fn list(&self) -> impl Iterator<Item = (&str, String)> {
        self.command.get_subcommands().map(|command| {
            let about = command.get_about().map(ToString::to_string);
            (command.get_name(), about.unwrap_or_default())
        })
    }

    /// The list as text: for the `--help` of an app, and for `help`.
    #[must_use]
    pub fn help(&self) -> String {
        let width = self.list().map(|(name, _)| name.len()).max().unwrap_or(0);
        self.list()
            .map(|(name, about)| format!("{name:width$}  {about}\n"))
            .collect()
    }

    /// What a line means.
    ///
    /// # Errors
    /// A [`Mistake`] in the line, with how the command is written.
    pub fn parse(&self, line: &str) -> Result<Meaning, Mistake> {
        let words = words(line)?;
        if words.is_empty() {
            return Ok(Meaning::Nothing);
        }
        let words = words.into_iter().map(|word| word.text);
        let matches = match self.command.clone().try_get_matches_from(words) {
            Ok(matches) => matches,
            Err(error) => {
                let text = error.render().to_string();
                let text = text.trim();
                return match error.kind() {
                    ErrorKind::DisplayHelp => Ok(Meaning::Help(text.to_owned())),
                    _ => Err(Mistake(
                        text.strip_prefix("error: ").unwrap_or(text).to_owned(),
                    )),
                };
            }
        };
        match matches.subcommand() {
            Some((name, matches)) => match self.runs.get(name) {
                Some(run) => Ok(Meaning::Call(run.clone(), matches.clone())),
                // Subcommands are added with what they do, so this is clap's own.
                None => Ok(Meaning::Nothing),
            },
            None => Ok(Meaning::Nothing),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::{Arg, value_parser};

    fn table() -> Table {
        let mut table = Table::default();
        table.add(
            Command::new("wait").about("Waits some frames").arg(
                Arg::new("frames")
                    .required(true)
                    .value_parser(value_parser!(u32)),
            ),
            |_, matches| {
                let frames = matches.get_one::<u32>("frames").expect("required");
                Ok(Step::Said(frames.to_string()))
            },
        );
        table
    }

    fn said(table: &Table, line: &str) -> Result<String, String> {
        let mut world = World::new();
        match table.parse(line).map_err(|mistake| mistake.0)? {
            Meaning::Nothing => Ok(String::new()),
            Meaning::Help(text) => Ok(text),
            Meaning::Call(run, matches) => match run(&mut world, &matches) {
                Ok(Step::Said(text)) => Ok(text),
                Ok(Step::Wait(_)) => panic!("it waits"),
                Err(mistake) => Err(mistake.0),
            },
        }
    }

    #[test]
    fn a_line_is_nothing_a_call_help_or_a_mistake() {
        let table = table();
        table.command().clone().debug_assert();
        assert_eq!(said(&table, " # words"), Ok(String::new()));
        assert_eq!(said(&table, "wait 3 # words"), Ok("3".to_owned()));
        for help in ["help", "wait --help", "help wait"] {
            let text = said(&table, help).unwrap();
            assert!(text.contains("Waits some frames"), "{help}: {text}");
        }
        for (wrong, word) in [
            ("wiat 3", "wait"),
            ("wait", "frames"),
            ("wait x", "x"),
            ("wait 3 4", "4"),
            ("wait \"3", "column 6"),
            ("\u{0} ", "subcommand"),
        ] {
            let mistake = said(&table, wrong).unwrap_err();
            assert!(mistake.contains(word), "{wrong}: {mistake}");
            assert!(!mistake.starts_with("error"), "{mistake}");
        }
    }

    #[test]
    fn a_command_with_a_known_name_takes_its_place() {
        let mut table = table();
        table.add(Command::new("wait").about("Waits no more"), |_, _| {
            Ok(Step::Said("no".to_owned()))
        });
        assert_eq!(said(&table, "wait"), Ok("no".to_owned()));
        assert_eq!(table.help(), "wait  Waits no more\n");
    }
}
