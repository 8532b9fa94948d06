//! The guarantee of what the adapter draws, over as many cameras as one has time for. Each place's result is a line
//! of a file, so that a run that was stopped goes on where it was.

use super::drawn::at_a_place;
use super::guarantee::{AT_A_PLACE, merge};
use super::judge::Count;
use super::measure::Tally;
use crate::scenes::cameras::Kind;
use dolomite_testkit::blocks::BlockError;
use dolomite_testkit::gpu::Gpu;
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;
use thiserror::Error;

/// What is looked at.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Asked {
    /// Of grounds, cameras and places.
    pub seed: u32,
    /// In all.
    pub cameras: usize,
    /// Tolerances, pixels.
    pub taus: Vec<f64>,
    /// Places a camera and tolerance.
    pub samples: usize,
}

/// Why a soak ended early.
#[derive(Debug, Error)]
pub enum SoakError {
    /// The passes could not be run.
    #[error(transparent)]
    Passes(#[from] BlockError),
    /// What was found cannot be kept, or read again.
    #[error("{}: {source}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

/// One place, as it is kept.
#[derive(Debug, Serialize, Deserialize)]
struct Line {
    asked: Asked,
    place: u32,
    counts: Vec<Kept>,
}

/// A [`Count`], without its worst camera, which the seed finds again.
#[derive(Debug, Serialize, Deserialize)]
struct Kept {
    tau: f64,
    kind: Kind,
    reached: bool,
    views: u64,
    tally: Tally,
}

impl Kept {
    fn of(count: &Count) -> Self {
        Self {
            tau: count.tau,
            kind: count.kind,
            reached: count.reached,
            views: count.views,
            tally: count.tally.clone(),
        }
    }

    fn count(self) -> Count {
        Count {
            tau: self.tau,
            kind: self.kind,
            reached: self.reached,
            views: self.views,
            worst: None,
            tally: self.tally,
        }
    }
}

/// Runs it, with a line of progress a place; what `file` has already of the same question is not measured
/// again. Without a file nothing is kept.
///
/// # Errors
/// [`SoakError`].
pub fn soak(gpu: &Gpu, asked: &Asked, file: Option<&Path>) -> Result<Vec<Count>, SoakError> {
    let fault = |source| SoakError::File {
        path: file.map(Path::to_owned).unwrap_or_default(),
        source,
    };
    let mut known = file.map_or_else(Vec::new, |file| lines(file, asked));
    if let Some(folder) = file.and_then(Path::parent) {
        std::fs::create_dir_all(folder).map_err(fault)?;
    }
    let groups = asked.cameras.div_ceil(AT_A_PLACE);
    let (start, mut all, mut places) = (Instant::now(), Vec::new(), 0);
    for place in 0..groups as u32 {
        let cameras = AT_A_PLACE.min(asked.cameras - place as usize * AT_A_PLACE);
        let counts = match known.iter().position(|line| line.place == place) {
            Some(at) => {
                let kept = known.swap_remove(at).counts;
                kept.into_iter().map(Kept::count).collect()
            }
            None => {
                let of_place = (place, cameras);
                let counts = at_a_place(gpu, of_place, &asked.taus, asked.samples, asked.seed)?;
                if let Some(file) = file {
                    append(file, asked, place, &counts).map_err(fault)?;
                }
                counts
            }
        };
        places += counts.iter().map(|count| count.tally.samples).sum::<u64>();
        let above: u64 = counts.iter().map(Count::above).sum();
        eprintln!(
            "lod: drawn: place {} of {groups}, {places} places in all, {above} above here, {:.0} s",
            place + 1,
            start.elapsed().as_secs_f64()
        );
        merge(&mut all, counts);
    }
    Ok(all)
}

/// Lines of a file that answer the same question; a line that was cut off is none.
fn lines(file: &Path, asked: &Asked) -> Vec<Line> {
    let text = std::fs::read_to_string(file).unwrap_or_default();
    let of_line = |line: &str| serde_json::from_str::<Line>(line).ok();
    let lines = text.lines().filter_map(of_line);
    // More cameras go on where fewer ended, but at the last place, which had not all of its own.
    let same = |line: &Line| {
        let whole = |asked: &Asked| asked.cameras >= (line.place as usize + 1) * AT_A_PLACE;
        let question = |asked: &Asked| (asked.seed, asked.samples, asked.taus.clone());
        question(&line.asked) == question(asked)
            && (line.asked.cameras == asked.cameras || (whole(&line.asked) && whole(asked)))
    };
    lines.filter(same).collect()
}

fn append(file: &Path, asked: &Asked, place: u32, counts: &[Count]) -> std::io::Result<()> {
    let line = Line {
        asked: asked.clone(),
        place,
        counts: counts.iter().map(Kept::of).collect(),
    };
    let text = serde_json::to_string(&line).map_err(std::io::Error::other)?;
    let mut file = std::fs::OpenOptions::new()
        .create(true)
        .append(true)
        .open(file)?;
    writeln!(file, "{text}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(cameras: usize) -> Asked {
        Asked {
            seed: 1,
            cameras,
            taus: vec![2.0],
            samples: 100,
        }
    }

    fn count(holes: bool) -> Count {
        let mut tally = Tally::counting_above(1.0);
        let camera =
            crate::scenes::cameras::camera(&crate::scenes::terrains::fbm(1), Kind::Flying, 1);
        if holes {
            let view = camera.view();
            tally.hole(&view, view.eye + view.forward * 10.0);
        }
        Count {
            tau: 2.0,
            kind: Kind::Flying,
            reached: false,
            views: 3,
            worst: Some((camera, 2.0)),
            tally,
        }
    }

    #[test]
    fn what_was_found_is_known_again_and_another_question_is_not() {
        let folder = std::env::temp_dir().join(format!("dolomite_soak_{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("soak.jsonl");
        append(&file, &asked(500), 0, &[count(true), count(false)]).unwrap();
        append(&file, &asked(500), 2, &[count(false)]).unwrap();
        // A run that was stopped in the middle of a line.
        let mut text = std::fs::read_to_string(&file).unwrap();
        text += "{\"asked\":{\"seed\":1";
        std::fs::write(&file, text).unwrap();
        let places = |asked: &Asked| -> Vec<u32> {
            lines(&file, asked).iter().map(|line| line.place).collect()
        };
        assert_eq!(places(&asked(500)), [0, 2]);
        // Place 2 had 100 of its 200 cameras.
        assert_eq!(places(&asked(1000)), [0]);
        assert!(
            places(&Asked {
                seed: 2,
                ..asked(500)
            })
            .is_empty()
        );
        let mut first = lines(&file, &asked(500)).remove(0).counts.into_iter();
        let found = first.next().unwrap().count();
        assert_eq!((found.above(), found.tally.holes, found.views), (1, 1, 3));
        assert_eq!(found.tally.max, f64::INFINITY);
        let nothing = first.next().unwrap().count();
        assert_eq!((nothing.above(), nothing.tally.samples), (0, 0));
        assert_eq!(nothing.tally.max, f64::NEG_INFINITY);
        std::fs::remove_dir_all(folder).unwrap();
    }
}
