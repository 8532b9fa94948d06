//! The console's own.

use std::path::Path;

use clap::{Arg, Command, value_parser};

use super::{needed, text};
use crate::console::Console;
use crate::console::table::{Mistake, Step, Table};

/// Longest script, bytes: who names another kind of file by mistake does not wait for it.
const LONGEST: u64 = 1 << 20;

pub(super) fn add(table: &mut Table) {
    table.add(
        Command::new("exec")
            .about("Do the commands of a file, a line each; a mistake leaves out the rest")
            .arg(needed("file", "FILE")),
        |world, matches| {
            let file = text(matches, "file").unwrap_or_default();
            let mut console = world.resource_mut::<Console>();
            if console.queue.is_too_deep() {
                return Err(Mistake(format!("{file}: too many scripts within scripts")));
            }
            let script = read_script(Path::new(file))?;
            console.enter_script(file, &script);
            Ok(Step::Said(String::new()))
        },
    );
    table.add(
        Command::new("wait")
            .about("Let frames go by before the next command")
            .arg(
                Arg::new("frames")
                    .value_name("FRAMES")
                    .value_parser(value_parser!(u32).range(1..=1_000_000))
                    .default_value("1"),
            ),
        |_, matches| {
            let mut left = matches.get_one::<u32>("frames").copied().unwrap_or(1);
            Ok(Step::Wait(Box::new(move |_| {
                // It is asked once in the frame that it was typed in.
                if left == 0 {
                    return Some(Ok(String::new()));
                }
                left -= 1;
                None
            })))
        },
    );
    table.add(
        Command::new("history").about("List what was typed before"),
        |world, _| {
            Ok(Step::Said(
                world.resource::<Console>().history.lines().join("\n"),
            ))
        },
    );
    table.add(
        Command::new("clear").about("Forget what the console has said"),
        |world, _| {
            world.resource_mut::<Console>().clear();
            Ok(Step::Said(String::new()))
        },
    );
}

/// Reads a script.
///
/// # Errors
/// A [`Mistake`] that names the file and the reason.
pub fn read_script(file: &Path) -> Result<String, Mistake> {
    let wrong = |reason: String| Mistake(format!("{}: {reason}", file.display()));
    let data = std::fs::metadata(file).map_err(|error| wrong(error.to_string()))?;
    if !data.is_file() || data.len() > LONGEST {
        return Err(wrong(
            "no file of commands: it is none, or longer than 1 MiB".to_owned(),
        ));
    }
    std::fs::read_to_string(file).map_err(|error| wrong(error.to_string()))
}
