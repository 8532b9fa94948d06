//! A bot that plays levels to their end, by input alone, without a window.
//!
//! | file | concern |
//! |---|---|
//! | [`game`] | a level stepped by hand |
//! | [`pilot`], [`town`], [`lifts`] | what the bot wants; in a city; on its lifts |
//! | `seen` | what it sees |
//! | [`record`] | recorded games |

pub mod game;
pub mod lifts;
pub mod pilot;
pub mod record;
mod seen;
pub mod town;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use bevy::math::Vec2;
use dolomite::logic::Health;
use serde::Serialize;
use thiserror::Error;

use crate::level::parts::Cast;
use crate::level::sealed::SealedError;
use crate::level::{Level, LevelError, STEPS, Verdict, load};
use crate::play::figure::{WADING_DEPTH, depth};
use crate::scene::LoadedScene;
use game::Game;
use pilot::Pilot;
use record::Record;

/// Why the bot did not play.
#[derive(Debug, Error)]
pub enum BotError {
    /// There is no such level, or it is wrong.
    #[error(transparent)]
    Level(#[from] LevelError),
    /// A recording.
    #[error(transparent)]
    Record(#[from] SealedError),
    /// The report cannot be written.
    #[error("report {}: {source}", .path.display())]
    Report {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// No beacon can be put out of reach.
    #[error(
        "the level has no wall, and the border of its scene can be walked to: no beacon can be put out of reach"
    )]
    AllReachable,
    /// A process that plays the recording again.
    #[error("the recording cannot be played again by {threads} threads: {reason}")]
    Replay {
        /// How many.
        threads: usize,
        /// Why.
        reason: String,
    },
}

/// One game.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Played {
    /// Its seed.
    pub seed: u64,
    /// Whether it was won.
    pub won: bool,
    /// Why it ended.
    pub reason: Verdict,
    /// Steps, 60 a second.
    pub steps: u64,
    /// Beacons that burn.
    pub beacons: u32,
    /// Soldiers who fell.
    pub fallen: u32,
    /// Health at the end.
    pub health: f32,
    /// How often soldiers called one another.
    pub calls: u32,
    /// Of the whole game, hexadecimal.
    pub hash: String,
}

/// Some games.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Which level.
    pub level: String,
    /// Whether a beacon was put out of reach.
    pub unreachable: bool,
    /// Games.
    pub runs: u32,
    /// Games that were won.
    pub wins: u32,
    /// Games that were lost.
    pub losses: u32,
    /// Seconds that it took.
    pub seconds: f64,
    /// All of them.
    pub games: Vec<Played>,
}

/// What is to be played.
#[derive(Clone, Copy, Debug, Default)]
pub struct Job<'a> {
    /// The level.
    pub level: &'a str,
    /// The first seed; others follow.
    pub seed: u64,
    /// How many games.
    pub runs: u32,
    /// Threads of Bevy's pools, for the first games of a process.
    pub threads: Option<usize>,
    /// Whether the last beacon is where nobody comes to.
    pub unreachable: bool,
    /// Seconds until it is lost, in place of the level's own.
    pub limit: Option<f32>,
}

/// A level ready to be played many times.
pub struct Table {
    level: Level,
    scene: LoadedScene,
    threads: Option<usize>,
}

impl Table {
    /// Loads what is to be played.
    ///
    /// # Errors
    /// [`BotError::Level`], [`BotError::AllReachable`].
    pub fn new(job: &Job, assets: &Path) -> Result<Self, BotError> {
        let (mut level, scene) = load::load(job.level, job.seed, assets)?;
        if job.unreachable || job.limit.is_some() {
            let mut file = (*level.file).clone();
            if let Some(limit) = job.limit {
                file.seconds = limit;
            }
            if job.unreachable {
                let away = out_of_reach(&level, &scene).ok_or(BotError::AllReachable)?;
                if let Some(beacon) = file.beacons.last_mut() {
                    (beacon.at, beacon.lift) = (away.into(), None);
                }
                let mut built = (*level.built).clone();
                if let Some(roof) = built.roofs.last_mut() {
                    *roof = None;
                }
                level.built = Arc::new(built);
            }
            level.file = Arc::new(file);
        }
        Ok(Self {
            level,
            scene,
            threads: job.threads,
        })
    }

    /// The level with a seed, at its beginning.
    pub fn game(&self, seed: u64) -> Game {
        let level = Level {
            seed,
            ..self.level.clone()
        };
        Game::new(&level, &self.scene, self.threads)
    }

    /// Lets the bot play to the end.
    pub fn play(&self, seed: u64) -> (Played, Record) {
        let mut game = self.game(seed);
        let mut pilot = Pilot::new(seed);
        let mut inputs = Vec::new();
        while game.state().verdict.is_none() {
            let input = pilot.decide(game.app.world_mut());
            game.step(input);
            inputs.push(input);
        }
        let record = Record {
            level: self.level.name.to_owned(),
            seed,
            hash: game.hash(),
            inputs,
        };
        (played(&game, seed), record)
    }

    /// Plays a recording; the game at its end.
    pub fn replay(&self, record: &Record) -> Played {
        let mut game = self.game(record.seed);
        for &input in &record.inputs {
            game.step(input);
        }
        played(&game, record.seed)
    }
}

/// A place that nobody comes to: behind the wall of a level that has one, or out in the sea.
fn out_of_reach(level: &Level, scene: &LoadedScene) -> Option<Vec2> {
    let area = &level.file.area;
    if level.built.gate.is_some() {
        let half = area.side / 2.0 + 2.0 * level.file.reach;
        return Some(Vec2::from(area.middle) + Vec2::splat(half));
    }
    let corner = scene.terrain.extent().min + 64.0;
    (depth(corner, &scene.terrain) > WADING_DEPTH).then(|| corner.as_vec2())
}

fn played(game: &Game, seed: u64) -> Played {
    let state = game.state();
    let world = game.app.world();
    let player = world.resource::<Cast>().player;
    let reason = state.verdict.unwrap_or(Verdict::Late);
    Played {
        seed,
        won: reason == Verdict::Won,
        reason,
        steps: state.steps,
        beacons: state.lit,
        fallen: state.fallen,
        health: world.get::<Health>(player).map_or(0.0, |health| health.now),
        calls: state.calls,
        hash: format!("{:016x}", game.hash()),
    }
}

/// Plays as many games as were asked for; `done` hears of each, and the first is recorded.
///
/// # Errors
/// [`BotError`].
pub fn play(
    job: &Job,
    assets: &Path,
    mut done: impl FnMut(&Played),
) -> Result<(Report, Option<Record>), BotError> {
    let begun = Instant::now();
    let table = Table::new(job, assets)?;
    let mut first = None;
    let mut games = Vec::new();
    for run in 0..u64::from(job.runs) {
        let (game, record) = table.play(job.seed.wrapping_add(run));
        done(&game);
        first.get_or_insert(record);
        games.push(game);
    }
    let wins = games.iter().filter(|game| game.won).count() as u32;
    let report = Report {
        level: job.level.to_owned(),
        unreachable: job.unreachable,
        runs: job.runs,
        wins,
        losses: job.runs - wins,
        seconds: begun.elapsed().as_secs_f64(),
        games,
    };
    Ok((report, first))
}

/// Minutes of a number of steps.
pub fn minutes(steps: u64) -> f64 {
    steps as f64 / STEPS / 60.0
}
