//! Messages, one JSON object a line, and who answers them.

use crate::walkers::{Ground, WalkError, Walkers};
use serde::{Deserialize, Serialize};
use std::io::{BufRead, Write};
use std::time::{Duration, Instant};
use thiserror::Error;

/// Of the messages: who knows another one has to say so before anything is moved.
pub const PROTOCOL: u32 = 1;

/// What moves the balls.
const NAME: &str = "avian3d 0.7.0, MoveAndSlide";

/// The first line, said before anything is asked.
#[derive(Serialize)]
struct Greeting {
    protocol: u32,
    name: &'static str,
    profile: &'static str,
}

/// What the balls are and what lies under them; metres and seconds.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct World {
    radius: f32,
    /// Length of a step.
    seconds: f64,
    /// Cosine of the steepest slope that is stood on.
    walkable: f32,
    /// How far below a ball that stood ground still holds it; 0 for `MoveAndSlide` alone.
    snap: f32,
    vertices: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    places: Vec<[f32; 3]>,
}

/// The answer to a [`World`].
#[derive(Serialize)]
struct Ready {
    balls: usize,
}

/// One step: where each ball wants to go in it, metres.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Step {
    wishes: Vec<[f64; 3]>,
}

/// The answer to a [`Step`].
#[derive(Serialize)]
struct Moved<'a> {
    /// Of the moves alone, nanoseconds of all balls together.
    ns: f64,
    /// Centers, metres.
    places: Vec<[f32; 3]>,
    stands: &'a [bool],
}

/// The last line where something went wrong.
#[derive(Serialize)]
struct Refusal {
    error: String,
}

/// Why it stopped before its input did.
#[derive(Debug, Error)]
pub enum DialogueError {
    /// Standard input or output.
    #[error("the messages cannot be read or written: {0}")]
    Pipe(#[from] std::io::Error),
    /// Not a message, or another one than was expected.
    #[error("line {line}: {source}")]
    Message {
        /// Which, from 1.
        line: usize,
        /// What is wrong with it.
        source: serde_json::Error,
    },
    /// A message that cannot be followed.
    #[error("line {line}: {source}")]
    Walk {
        /// Which, from 1.
        line: usize,
        /// Why not.
        source: WalkError,
    },
}

/// Greets, and answers every line of `input` until it ends. What is wrong is said on `output` too.
///
/// # Errors
/// [`DialogueError`].
pub fn hold(input: impl BufRead, mut output: impl Write) -> Result<(), DialogueError> {
    let profile = if cfg!(debug_assertions) {
        "dev"
    } else {
        "release"
    };
    let greeting = Greeting {
        protocol: PROTOCOL,
        name: NAME,
        profile,
    };
    say(&mut output, &greeting)?;
    let held = answer(input, &mut output);
    if let Err(error) = &held {
        // Who asked may be gone: then the exit code and standard error are left.
        let error = error.to_string();
        let _ = say(&mut output, &Refusal { error });
    }
    held
}

fn answer(input: impl BufRead, output: &mut impl Write) -> Result<(), DialogueError> {
    let mut walkers = None;
    for (line, text) in (1..).zip(input.lines()) {
        let text = text?;
        let message = |source| DialogueError::Message { line, source };
        let walk = |source| DialogueError::Walk { line, source };
        match &mut walkers {
            None => {
                let world = serde_json::from_str(&text).map_err(message)?;
                let made = made(world).map_err(walk)?;
                say(
                    output,
                    &Ready {
                        balls: made.places().len(),
                    },
                )?;
                walkers = Some(made);
            }
            Some(walkers) => {
                let step: Step = serde_json::from_str(&text).map_err(message)?;
                let took = timed(walkers, &step.wishes).map_err(walk)?;
                let moved = Moved {
                    ns: took.as_secs_f64() * 1e9,
                    places: walkers.places().iter().map(|at| at.to_array()).collect(),
                    stands: walkers.stands(),
                };
                say(output, &moved)?;
            }
        }
    }
    Ok(())
}

fn made(world: World) -> Result<Walkers, WalkError> {
    let ground = Ground {
        vertices: world.vertices.into_iter().map(Into::into).collect(),
        triangles: world.triangles,
    };
    Walkers::new(
        ground,
        world.places.into_iter().map(Into::into).collect(),
        world.radius,
        Duration::try_from_secs_f64(world.seconds).map_err(|_| WalkError::Number("seconds"))?,
        world.walkable,
        world.snap,
    )
}

/// Moves all balls, and says how long that took.
fn timed(walkers: &mut Walkers, wishes: &[[f64; 3]]) -> Result<Duration, WalkError> {
    let wishes: Vec<_> = wishes
        .iter()
        .map(|wish| wish.map(|part| part as f32).into())
        .collect();
    let begun = Instant::now();
    walkers.step(&wishes)?;
    Ok(begun.elapsed())
}

fn say(output: &mut impl Write, message: &impl Serialize) -> Result<(), DialogueError> {
    let mut line = serde_json::to_vec(message).map_err(std::io::Error::from)?;
    line.push(b'\n');
    output.write_all(&line)?;
    Ok(output.flush()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    /// A square of 20 m at height 0, and a ball of 0.4 m over it.
    fn world() -> Value {
        json!({
            "radius": 0.4, "seconds": 1.0 / 60.0, "walkable": 0.64, "snap": 0.0,
            "vertices": [[-10, 0, -10], [-10, 0, 10], [10, 0, -10], [10, 0, 10]],
            "triangles": [[0, 1, 2], [1, 3, 2]],
            "places": [[0.0, 0.5, 0.0]],
        })
    }

    /// What is said to these lines, the greeting left out, and whether it went well.
    fn said(lines: &[Value]) -> (Vec<Value>, bool) {
        let input: String = lines.iter().map(|line| format!("{line}\n")).collect();
        let mut output = Vec::new();
        let well = hold(input.as_bytes(), &mut output).is_ok();
        let text = String::from_utf8(output).unwrap();
        let mut lines = text.lines().map(|line| serde_json::from_str(line).unwrap());
        let greeting: Value = lines.next().unwrap();
        assert_eq!(greeting["protocol"], PROTOCOL);
        (lines.collect(), well)
    }

    #[test]
    fn a_world_and_its_steps_are_answered_line_by_line() {
        let down = json!({ "wishes": [[0.01, -0.05, 0.0]] });
        let (said, well) = said(&[world(), down.clone(), down.clone(), down]);
        assert!(well);
        assert_eq!(said[0], json!({ "balls": 1 }));
        assert_eq!(said.len(), 4);
        let [first, last] = [&said[1], &said[3]];
        assert!(first["ns"].as_f64().unwrap() > 0.0, "{first}");
        // 5 cm of the 10 cm above the floor, and no floor yet.
        assert!((first["places"][0][1].as_f64().unwrap() - 0.45).abs() < 1e-6);
        assert_eq!(first["stands"], json!([false]));
        assert_eq!(last["stands"], json!([true]));
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        let with = |name: &str, value: Value| {
            let mut world = world();
            world[name] = value;
            world
        };
        let step = json!({ "wishes": [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]] });
        for (lines, part) in [
            (vec![json!("no world")], "line 1"),
            (vec![with("radius", json!(-1.0))], "radius"),
            (vec![with("seconds", json!(-1.0))], "seconds"),
            (vec![with("snap", json!(-1.0))], "snap"),
            (vec![with("walkable", json!(2.0))], "walkable"),
            (vec![with("triangles", json!([[0, 1, 4]]))], "vertex 4"),
            (vec![with("triangles", json!([]))], "triangle"),
            (vec![with("colour", json!("red"))], "colour"),
            (vec![world(), step], "2 wishes"),
            (vec![world(), world()], "line 2"),
        ] {
            let (said, well) = said(&lines);
            let error = said.last().unwrap()["error"].as_str().unwrap().to_owned();
            assert!(!well && error.contains(part), "{part}: {error}");
        }
    }
}
