//! What is said to a program that moves balls, and what it says: one JSON object a line, metres and seconds.
//! lab/avian/README.md has an example of each.

use serde::{Deserialize, Serialize};
use std::io;
use thiserror::Error;

/// Of these messages.
pub const PROTOCOL: u32 = 1;

/// What builds the program of avian.
pub const BUILD: &str = "cargo build --release --manifest-path lab/avian/Cargo.toml";

/// What it says first, before it is asked anything.
#[derive(Debug, Deserialize)]
pub struct Greeting {
    /// Of the messages that it knows.
    pub protocol: u32,
    /// What moves its balls.
    pub name: String,
    /// How it was built.
    pub profile: String,
}

/// What is said to it first: what balls there are and what lies under them.
#[derive(Debug, Serialize)]
pub struct World<'a> {
    /// Of all balls.
    pub radius: f32,
    /// Length of a step.
    pub seconds: f64,
    /// Cosine of the steepest slope that is stood on.
    pub walkable: f32,
    /// How far below a ball that stood ground still holds it; 0 for what the method does by itself.
    pub snap: f32,
    /// Of the mesh.
    pub vertices: Vec<[f32; 3]>,
    /// Three vertices each.
    pub triangles: &'a [[u32; 3]],
    /// Centers of the balls.
    pub places: Vec<[f32; 3]>,
}

/// The answer to a world.
#[derive(Debug, Deserialize)]
pub struct Ready {
    /// How many balls there are.
    pub balls: usize,
}

/// One step: where each ball wants to go.
#[derive(Debug, Serialize)]
pub struct Step {
    /// Metres, not metres a second.
    pub wishes: Vec<[f64; 3]>,
}

/// The answer to a step.
#[derive(Debug, Deserialize)]
pub struct Moved {
    /// Nanoseconds of the moves alone, of all balls together.
    pub ns: f64,
    /// Centers of the balls.
    pub places: Vec<[f32; 3]>,
    /// Which of them stand.
    pub stands: Vec<bool>,
}

/// Said in place of an answer.
#[derive(Debug, Deserialize)]
pub struct Refusal {
    /// What is wrong.
    pub error: String,
}

/// Why a program moves no balls, or none any more.
#[derive(Debug, Error)]
pub enum ProgramError {
    /// There is none, or the system does not run it.
    #[error("{program} cannot be started: {source}; that of avian is built by `{BUILD}`")]
    Start {
        /// Where it was looked for.
        program: String,
        /// Why not.
        source: io::Error,
    },
    /// It is gone, or has closed its output.
    #[error("{program} ended without an answer ({status})")]
    Ended {
        /// Which.
        program: String,
        /// How it ended, as far as is known.
        status: String,
    },
    /// It takes too long.
    #[error("{program} gave no answer in {seconds} s")]
    Silent {
        /// Which.
        program: String,
        /// How long it was waited for.
        seconds: f64,
    },
    /// It said something else.
    #[error("{program} said what is no answer: {reason}: {said:?}")]
    Answer {
        /// Which.
        program: String,
        /// What it said, or how that begins.
        said: String,
        /// What is wrong with it.
        reason: String,
    },
    /// It knows other messages.
    #[error(
        "{program} knows messages {known}, not {PROTOCOL}; that of avian is built by `{BUILD}`"
    )]
    Protocol {
        /// Which.
        program: String,
        /// Those that it knows.
        known: u32,
    },
    /// It says that something is wrong with what it was told.
    #[error("{program} refuses: {reason}")]
    Refused {
        /// Which.
        program: String,
        /// In its words.
        reason: String,
    },
}
