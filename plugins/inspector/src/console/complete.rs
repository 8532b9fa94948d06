//! What may stand where the line ends.

use clap::{Arg, Command};

use super::table::Table;
use super::words::words_so_far;

/// What fits the end of a line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Completion {
    /// Byte of the line from which on a candidate takes its place.
    pub from: usize,
    /// What may stand there, sorted.
    pub candidates: Vec<String>,
}

impl Completion {
    /// The line with as much as all candidates have in common; where there is one alone, all of it and a space.
    #[must_use]
    pub fn complete(&self, line: &str) -> String {
        let Some((first, rest)) = self.candidates.split_first() else {
            return line.to_owned();
        };
        let common = rest.iter().fold(first.as_str(), |common, candidate| {
            let same = common
                .char_indices()
                .zip(candidate.chars())
                .find(|((_, a), b)| a != b)
                .map_or(common.len().min(candidate.len()), |((at, _), _)| at);
            &common[..same]
        });
        let space = if rest.is_empty() { " " } else { "" };
        format!("{}{common}{space}", &line[..self.from])
    }
}

/// Candidates for the end of `line`. What can be known of the app alone (settings, entities ...) `known` gives for the
/// name of a value, such as `SETTING`.
#[must_use]
pub fn complete(table: &Table, line: &str, known: impl Fn(&str) -> Vec<String>) -> Completion {
    let (words, typed) = words_so_far(line);
    let (before, last, from) = match words.split_last() {
        Some((last, before)) if typed => (before, last.text.as_str(), last.at),
        _ => (words.as_slice(), "", line.len()),
    };
    let all = match before.split_first() {
        None => names(table.command()),
        Some((first, _)) if first.text == "help" => names(table.command()),
        Some((first, arguments)) => {
            let Some(command) = table.command().find_subcommand(&first.text) else {
                return Completion::default();
            };
            let arguments: Vec<_> = arguments.iter().map(|word| word.text.as_str()).collect();
            values(command, &arguments, last, known)
        }
    };
    let mut candidates: Vec<_> = all
        .into_iter()
        .filter(|candidate| starts_with(candidate, last))
        .collect();
    candidates.sort();
    candidates.dedup();
    Completion { from, candidates }
}

/// Without regard to case, as people type.
fn starts_with(candidate: &str, typed: &str) -> bool {
    let mut candidate = candidate.chars().flat_map(char::to_lowercase);
    typed
        .chars()
        .flat_map(char::to_lowercase)
        .all(|c| candidate.next() == Some(c))
}

fn names(command: &Command) -> Vec<String> {
    let names = command.get_subcommands().map(|c| c.get_name().to_owned());
    names.chain(["help".to_owned()]).collect()
}

fn values(
    command: &Command,
    before: &[&str],
    last: &str,
    known: impl Fn(&str) -> Vec<String>,
) -> Vec<String> {
    let option = |word: &str| {
        let name = word.strip_prefix("--")?;
        command
            .get_arguments()
            .find(|argument| argument.get_long() == Some(name))
    };
    let takes = |argument: &Arg| argument.get_action().takes_values();
    // A value of the option that stands before it.
    if let Some(argument) = before.last().and_then(|word| option(word))
        && takes(argument)
    {
        return of(argument, known);
    }
    if last.starts_with('-') {
        return command
            .get_arguments()
            .filter_map(|argument| argument.get_long())
            .chain(["help"])
            .map(|name| format!("--{name}"))
            .collect();
    }
    let mut places = 0;
    let mut words = before.iter();
    while let Some(word) = words.next() {
        match option(word) {
            Some(argument) if takes(argument) => {
                words.next();
            }
            Some(_) => {}
            None => places += 1,
        }
    }
    let mut positionals = command.get_positionals();
    // The last may stand for all that follow.
    let count = command.get_positionals().count();
    let place = if count > 0 && places >= count {
        let many = command.get_positionals().last().is_some_and(|last| {
            last.get_num_args()
                .is_some_and(|range| range.max_values() > 1)
        });
        if !many {
            return Vec::new();
        }
        count - 1
    } else {
        places
    };
    positionals
        .nth(place)
        .map_or_else(Vec::new, |argument| of(argument, known))
}

fn of(argument: &Arg, known: impl Fn(&str) -> Vec<String>) -> Vec<String> {
    let possible = argument.get_possible_values();
    if !possible.is_empty() {
        return possible
            .iter()
            .map(|value| value.get_name().to_owned())
            .collect();
    }
    match argument.get_value_names() {
        Some([name, ..]) => known(name),
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::console::table::Step;

    fn table() -> Table {
        let mut table = Table::default();
        for command in [
            Command::new("set")
                .arg(Arg::new("setting").value_name("SETTING").required(true))
                .arg(
                    Arg::new("value")
                        .value_name("VALUE")
                        .num_args(1..)
                        .required(true),
                ),
            Command::new("shot")
                .arg(Arg::new("size").long("size").value_name("SIZE"))
                .arg(
                    Arg::new("panel")
                        .long("panel")
                        .action(clap::ArgAction::SetTrue),
                )
                .arg(Arg::new("kind").value_parser(["png", "exr"])),
            Command::new("scene"),
        ] {
            table.add(command, |_, _| Ok(Step::Said(String::new())));
        }
        table
    }

    fn candidates(line: &str) -> Vec<String> {
        complete(&table(), line, |name| match name {
            "SETTING" => vec!["Sky.dust".to_owned(), "Sky.haze".to_owned()],
            "SIZE" => vec!["640x360".to_owned()],
            _ => Vec::new(),
        })
        .candidates
    }

    #[test]
    fn names_options_and_values_are_candidates() {
        assert_eq!(candidates("s"), ["scene", "set", "shot"]);
        assert_eq!(candidates("help se"), ["set"]);
        assert_eq!(candidates("set sky.d"), ["Sky.dust"]);
        assert_eq!(candidates("set Sky.dust 1 "), [""; 0]);
        assert_eq!(candidates("shot --"), ["--help", "--panel", "--size"]);
        assert_eq!(candidates("shot --size "), ["640x360"]);
        assert_eq!(candidates("shot --panel --size 1x1 "), ["exr", "png"]);
        assert_eq!(candidates("shot png "), [""; 0]);
        assert_eq!(candidates("nothing "), [""; 0]);
    }

    #[test]
    fn a_line_is_completed_as_far_as_candidates_agree() {
        let completed = |line: &str| {
            complete(&table(), line, |_| {
                vec!["Sky.dust".to_owned(), "Sky.daylight".to_owned()]
            })
            .complete(line)
        };
        assert_eq!(completed("sc"), "scene ");
        assert_eq!(completed("s"), "s");
        assert_eq!(completed("set s"), "set Sky.d");
        assert_eq!(completed("set x"), "set x");
        let same = Completion {
            from: 0,
            candidates: vec!["éa".to_owned(), "éb".to_owned(), "ëb".to_owned()],
        };
        assert_eq!(same.complete("x"), "");
    }
}
