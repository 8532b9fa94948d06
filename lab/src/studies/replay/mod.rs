//! Study `replay`: a recording of actions, played in a town of soldiers, lifts and doors: the same hash for any number
//! of threads.
//!
//! A recording is a JSON file: `{"seed": 1, "steps": 640, "actions": [{"step": 3, "who": 17, "verb": "sleep"}, ...]}`;
//! `who` is the number of a part of the town in the order in which they are spawned, soldiers first. Without a file one
//! is made of the seed, and written beside the other results.

mod town;

use std::path::{Path, PathBuf};
use std::process::Command;

use dolomite_logic::random::Random;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use thiserror::Error;

use super::agents::asked;
use crate::study::{Asked, Options, Report, Study};
use town::play;

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "replay",
    about: "a recording of actions in a town, played by 1, 2 and 16 threads: hashes of the state",
    run,
    asked: &ASKED,
};

const ASKED: [Asked; 4] = [
    asked("Numbers of threads that were tried", "3", "/tried", ""),
    asked(
        "Hashes other than that of one thread",
        "0",
        "/different",
        "",
    ),
    asked("Steps of the recording", "", "/steps", ""),
    asked("Actions of the recording", "", "/actions", ""),
];

/// Says how many threads a process of ours plays with, and that it prints what it plays alone: pools of threads are one
/// for a process.
const THREADS: &str = "DOLOMITE_REPLAY_THREADS";

/// An action of a recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recorded {
    /// Before which step.
    pub step: u32,
    /// Number of the part of the town.
    pub who: u32,
    /// Name of the action.
    pub verb: String,
    /// Its parameter; nothing if there is none.
    #[serde(default)]
    pub number: Option<f32>,
}

/// A recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recording {
    /// Of the town.
    pub seed: u64,
    /// Steps, at most 1e6.
    pub steps: u32,
    /// In the order of their steps.
    pub actions: Vec<Recorded>,
}

/// Why a recording cannot be played.
#[derive(Debug, Error)]
pub enum RecordingError {
    /// The file.
    #[error("{}: {source}", path.display())]
    Read {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// What it holds.
    #[error("{}: {source}", path.display())]
    Form {
        /// Which.
        path: PathBuf,
        /// Why.
        source: serde_json::Error,
    },
    /// A number.
    #[error("{}: {reason}", path.display())]
    Value {
        /// Which.
        path: PathBuf,
        /// Why.
        reason: String,
    },
}

impl Recording {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// [`RecordingError`].
    pub fn read(path: &Path) -> Result<Self, RecordingError> {
        let value = |reason: String| RecordingError::Value {
            path: path.to_owned(),
            reason,
        };
        let text = std::fs::read_to_string(path).map_err(|source| RecordingError::Read {
            path: path.to_owned(),
            source,
        })?;
        let recording: Self =
            serde_json::from_str(&text).map_err(|source| RecordingError::Form {
                path: path.to_owned(),
                source,
            })?;
        if recording.steps > 1_000_000 {
            return Err(value(format!(
                "{} steps, of which there are 1e6 at most",
                recording.steps
            )));
        }
        if let Some(pair) = recording
            .actions
            .windows(2)
            .find(|pair| pair[0].step > pair[1].step)
        {
            return Err(value(format!(
                "an action of step {} comes after one of step {}",
                pair[1].step, pair[0].step
            )));
        }
        let wrong = recording
            .actions
            .iter()
            .find(|a| a.number.is_some_and(|n| !n.is_finite()));
        match wrong {
            Some(action) => Err(value(format!(
                "the parameter at step {} is not finite",
                action.step
            ))),
            None => Ok(recording),
        }
    }

    /// One by a seed.
    fn made(seed: u64, steps: u32) -> Self {
        let mut random = Random::new(seed ^ 0x7ec0);
        let verbs = [
            "sleep", "wake", "damage", "reload", "heal", "call", "open", "close",
        ];
        let actions = (0..steps)
            .filter_map(|step| {
                let verb = verbs[random.below(verbs.len() as u32) as usize];
                let (who, number) = (random.below(town::PARTS), (random.unit() * 60.0).floor());
                (random.unit() < 0.6).then(|| Recorded {
                    step,
                    who,
                    verb: verb.to_owned(),
                    number: ["damage", "heal", "call"].contains(&verb).then_some(number),
                })
            })
            .collect();
        Self {
            seed,
            steps,
            actions,
        }
    }
}

fn report(summary: Value, notes: Vec<String>) -> Report {
    Report {
        study: STUDY.name,
        rows: Vec::new(),
        figures: Vec::new(),
        notes,
        summary,
    }
}

fn run(options: &Options) -> Report {
    let steps = options.count.unwrap_or(640).min(1_000_000) as u32;
    let recording = match &options.folder {
        Some(file) => Recording::read(file),
        None => Ok(Recording::made(u64::from(options.seed), steps)),
    };
    let recording = match recording {
        Ok(recording) => recording,
        Err(reason) => return report(json!({ "error": reason.to_string() }), Vec::new()),
    };
    if let Ok(threads) = std::env::var(THREADS) {
        let played = play(&recording, threads.parse().unwrap_or(1));
        return report(
            json!({ "hash": format!("{:016x}", played.hash) }),
            Vec::new(),
        );
    }
    let mut notes = Vec::new();
    let folder = options.out.clone().unwrap_or_else(std::env::temp_dir);
    let file = folder.join("recording.json");
    let text = serde_json::to_string(&recording).unwrap_or_default();
    if let Err(reason) = std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&file, text))
    {
        notes.push(format!("The recording was not written: {reason}"));
    }
    let hashes: Vec<(u32, Option<String>)> = [1, 2, 16]
        .into_iter()
        .map(|threads| (threads, hash_of(&file, threads)))
        .collect();
    let first = hashes[0].1.clone();
    let known = hashes.iter().filter(|(_, hash)| hash.is_some()).count();
    let different = hashes.iter().filter(|(_, hash)| *hash != first).count();
    let by_threads: serde_json::Map<String, Value> = hashes
        .iter()
        .map(|(threads, hash)| (format!("{threads}_threads"), json!(hash)))
        .collect();
    report(
        json!({
            "recording": file, "steps": recording.steps, "actions": recording.actions.len(),
            "hashes": by_threads, "tried": known, "different": different,
            "profile": if cfg!(debug_assertions) { "dev" } else { "release" },
        }),
        notes,
    )
}

/// What a process of ours with so many threads says.
fn hash_of(file: &Path, threads: u32) -> Option<String> {
    let output = Command::new(std::env::current_exe().ok()?)
        .arg(STUDY.name)
        .arg(file)
        .args(["--out".as_ref(), std::env::temp_dir().as_os_str()])
        .env(THREADS, threads.to_string())
        .output()
        .ok()?;
    let said: Value = serde_json::from_slice(&output.stdout).ok()?;
    said["summary"]["hash"].as_str().map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recording_plays_again_and_another_is_another_game() {
        let recording = Recording::made(3, 160);
        let first = play(&recording, 2);
        assert_eq!(first, play(&recording, 2));
        assert!(first.hurt > 0, "somebody is shot: {first:?}");
        let mut other = recording.clone();
        // The last ones may be of soldiers who are out of it.
        other.actions.truncate(recording.actions.len() / 2);
        assert_ne!(first.hash, play(&other, 2).hash);
    }

    #[test]
    fn a_file_comes_back_and_a_broken_one_is_named() {
        let file =
            std::env::temp_dir().join(format!("dolomite_replay_{}.json", std::process::id()));
        let recording = Recording::made(5, 40);
        let whole = serde_json::to_string(&recording).unwrap();
        std::fs::write(&file, &whole).unwrap();
        assert_eq!(Recording::read(&file).unwrap(), recording);
        for end in (0..whole.len()).step_by(whole.len() / 40) {
            std::fs::write(&file, &whole[..end]).unwrap();
            let fault = Recording::read(&file).unwrap_err().to_string();
            assert!(fault.contains("dolomite_replay_"), "{fault}");
        }
        for wrong in [
            r#"{"seed": 1, "steps": 9999999, "actions": []}"#,
            r#"{"seed": 1, "steps": 9, "actions": [], "more": 1}"#,
            r#"{"seed": 1, "steps": 9, "actions": [{"step": 5, "who": 1, "verb": "x"}, {"step": 2, "who": 1, "verb": "x"}]}"#,
        ] {
            std::fs::write(&file, wrong).unwrap();
            assert!(Recording::read(&file).is_err(), "{wrong}");
        }
        std::fs::remove_file(file).unwrap();
    }
}
