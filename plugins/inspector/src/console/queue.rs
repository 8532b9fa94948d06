//! What is to be done: lines that were typed, and scripts.

use std::collections::VecDeque;
use std::sync::Arc;

use bevy::ecs::world::World;

use super::table::{Meaning, Mistake, Step, Wait};
use super::{Console, Tone};

/// Most lines of one frame, so that a script which enters itself does not hold the app.
const A_FRAME: usize = 256;

/// Most scripts within scripts.
const DEEP: usize = 16;

/// Where a line of a script stands.
#[derive(Clone, Debug)]
struct Origin {
    script: Arc<str>,
    /// From 1 on.
    line: usize,
    /// A number for each entry of a script: of those that entered one another to come here, the outermost first.
    runs: Arc<[u64]>,
}

struct Queued {
    line: String,
    origin: Option<Origin>,
}

/// Lines that wait to be done.
#[derive(Default)]
pub struct Queue {
    lines: VecDeque<Queued>,
    /// What goes on, and where it came from.
    waiting: Option<(Option<Origin>, Wait)>,
    /// Where the command that is being done came from.
    current: Option<Origin>,
    runs: u64,
}

impl Queue {
    /// Whether nothing is to be done.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty() && self.waiting.is_none()
    }

    /// Adds a line behind all others.
    pub fn push(&mut self, line: &str) {
        self.lines.push_back(Queued {
            line: line.to_owned(),
            origin: None,
        });
    }

    /// Adds a script behind all others; before them where a command enters it, so that it is done in its place.
    pub fn push_script(&mut self, name: &str, text: &str) {
        self.runs += 1;
        let outer = self.current.iter().flat_map(|origin| origin.runs.iter());
        let runs: Arc<[u64]> = outer.copied().chain([self.runs]).collect();
        let script: Arc<str> = name.into();
        let lines: Vec<_> = text.lines().collect();
        let lines = lines.into_iter().enumerate().map(|(k, line)| Queued {
            line: line.to_owned(),
            origin: Some(Origin {
                script: script.clone(),
                line: k + 1,
                runs: runs.clone(),
            }),
        });
        if self.current.is_some() {
            for line in lines.rev() {
                self.lines.push_front(line);
            }
        } else {
            self.lines.extend(lines);
        }
    }

    /// How many scripts the line that is being done is within.
    #[must_use]
    pub fn is_too_deep(&self) -> bool {
        self.current
            .as_ref()
            .is_some_and(|origin| origin.runs.len() >= DEEP)
    }

    /// Leaves out what is left of the script, and of those that entered it.
    fn leave_out(&mut self, origin: &Origin) -> usize {
        let before = self.lines.len();
        self.lines.retain(|line| {
            let run = line.origin.as_ref().and_then(|other| other.runs.last());
            run.is_none_or(|run| !origin.runs.contains(run))
        });
        before - self.lines.len()
    }
}

/// Does what is to be done, until something goes on to the next frame.
pub fn advance(world: &mut World) {
    for _ in 0..A_FRAME {
        let Some(mut console) = world.get_resource_mut::<Console>() else {
            return;
        };
        if let Some((origin, mut wait)) = console.queue.waiting.take() {
            console.queue.current = origin.clone();
            let answer = wait(world);
            let mut console = world.resource_mut::<Console>();
            console.queue.current = None;
            match answer {
                None => {
                    console.queue.waiting = Some((origin, wait));
                    return;
                }
                Some(answer) => finish(&mut console, origin.as_ref(), answer),
            }
            continue;
        }
        let Some(Queued { line, origin }) = console.queue.lines.pop_front() else {
            return;
        };
        let meaning = console.table.parse(&line);
        if !matches!(meaning, Ok(Meaning::Nothing)) {
            console.say(Tone::Typed, &line);
        }
        let step = match meaning {
            Ok(Meaning::Nothing) => continue,
            Ok(Meaning::Help(text)) => Ok(Step::Said(text)),
            Ok(Meaning::Call(run, matches)) => {
                console.queue.current = origin.clone();
                let step = run(world, &matches);
                world.resource_mut::<Console>().queue.current = None;
                step
            }
            Err(mistake) => Err(mistake),
        };
        let mut console = world.resource_mut::<Console>();
        match step {
            Ok(Step::Said(text)) => finish(&mut console, origin.as_ref(), Ok(text)),
            Ok(Step::Wait(wait)) => console.queue.waiting = Some((origin, wait)),
            Err(mistake) => finish(&mut console, origin.as_ref(), Err(mistake)),
        }
    }
}

fn finish(console: &mut Console, origin: Option<&Origin>, answer: Result<String, Mistake>) {
    let answer = match (answer, origin) {
        (Err(mistake), Some(origin)) => {
            let left = console.queue.leave_out(origin);
            let lines = if left == 1 { "line is" } else { "lines are" };
            Err(Mistake(format!(
                "{}:{}: {mistake}\nthe script stops here; {left} more {lines} left out",
                origin.script, origin.line
            )))
        }
        (answer, _) => answer,
    };
    console.answer(answer);
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::{Arg, Command};

    /// A world whose console knows `echo WORD`, `fail`, `wait` (three frames) and `exec TEXT`.
    fn world() -> World {
        let mut console = Console::default();
        let text = || Arg::new("text").required(true);
        console
            .table
            .add(Command::new("echo").arg(text()), |_, matches| {
                let word = matches.get_one::<String>("text").expect("required");
                Ok(Step::Said(word.clone()))
            });
        console.table.add(Command::new("fail"), |_, _| {
            Err(Mistake("it fails".to_owned()))
        });
        console.table.add(Command::new("wait"), |_, _| {
            let mut frames = 0;
            Ok(Step::Wait(Box::new(move |_| {
                frames += 1;
                (frames == 3).then(|| Ok("waited".to_owned()))
            })))
        });
        console
            .table
            .add(Command::new("exec").arg(text()), |world, matches| {
                let mut console = world.resource_mut::<Console>();
                if console.queue.is_too_deep() {
                    return Err(Mistake("too deep".to_owned()));
                }
                let text = matches.get_one::<String>("text").expect("required");
                let text = if text == "self" { "exec self" } else { text };
                console.enter_script("inner", &text.replace(';', "\n"));
                Ok(Step::Said(String::new()))
            });
        let mut world = World::new();
        world.insert_resource(console);
        world
    }

    fn said(world: &World) -> Vec<String> {
        let output = world.resource::<Console>().output();
        output
            .filter(|(tone, _)| *tone != Tone::Typed)
            .map(|(_, line)| line.to_owned())
            .collect()
    }

    #[test]
    fn lines_are_done_in_order_and_wait_for_what_goes_on() {
        let mut world = world();
        let mut console = world.resource_mut::<Console>();
        for line in ["echo a", "wait", "echo b"] {
            console.enter(line);
        }
        advance(&mut world);
        // It was asked once in the frame that began it.
        assert_eq!(said(&world), ["a"]);
        advance(&mut world);
        assert_eq!(said(&world), ["a"]);
        advance(&mut world);
        assert_eq!(said(&world), ["a", "waited", "b"]);
        assert!(world.resource::<Console>().queue.is_empty());
    }

    #[test]
    fn a_mistake_in_a_script_is_named_and_the_rest_left_out() {
        let mut world = world();
        let mut console = world.resource_mut::<Console>();
        console.enter_script("a.txt", "echo a\n\n# words\nfail\necho b\necho c");
        console.enter("echo d");
        advance(&mut world);
        let said = said(&world);
        assert_eq!(said[..2], ["a", "a.txt:4: it fails"]);
        assert!(said[2].contains("2 more lines"), "{said:?}");
        assert_eq!(said[3..], ["d"]);
        assert_eq!(world.resource::<Console>().faults(), 1);
    }

    #[test]
    fn a_script_within_a_script_is_done_in_its_place_and_stops_both() {
        let mut world = world();
        let mut console = world.resource_mut::<Console>();
        console.enter_script("outer", "echo a\nexec 'echo b;echo c'\necho d");
        console.enter_script("second", "exec 'fail;echo e'\necho f");
        console.enter_script("third", "echo g");
        advance(&mut world);
        let said = said(&world);
        assert_eq!(said[..5], ["a", "b", "c", "d", "inner:1: it fails"]);
        assert!(said[5].contains("2 more lines"), "{said:?}");
        assert_eq!(said[6..], ["g"]);
    }

    #[test]
    fn a_script_that_enters_itself_ends() {
        let mut world = world();
        let mut console = world.resource_mut::<Console>();
        console.enter_script("outer", "exec self\necho never");
        for _ in 0..10 {
            advance(&mut world);
        }
        assert!(world.resource::<Console>().queue.is_empty());
        assert_eq!(said(&world)[0], "inner:1: too deep");
    }
}
