//! Many files, over all cores.

use crate::file::document;
use crate::generate::generate;
use crate::hold::{Failure, Seen, hold};
use crate::scene::Scene;
use crate::shrink::shrink;
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Conversions that a failure may be shrunk by.
const TRIES: usize = 600;

/// Slow files that are named.
const SLOWEST: usize = 8;

/// What came of many files.
#[derive(Debug, Default)]
pub struct Outcome {
    /// Files that were made.
    pub files: u64,
    /// Poses that were held.
    pub poses: usize,
    /// Files that were refused because of limits: which, and why.
    pub refused: Vec<(u64, String)>,
    /// The files that took longest: seconds, and which.
    pub slowest: Vec<(f64, u64)>,
    /// The largest true error over what is stated and allowed, of those that hold.
    pub worst: f64,
    /// For each file that holds and moves: the largest true error over what is stated and allowed, growing.
    pub shares: Vec<f64>,
    /// How many failed in each way.
    pub kinds: BTreeMap<&'static str, u64>,
    /// All that failed: seed, and how.
    pub failed: Vec<(u64, Failure)>,
    /// The first of each way, shrunk.
    pub failures: Vec<Failed>,
}

impl Outcome {
    /// How many times the true error what is stated and allowed is at most, for a share of all files.
    pub fn stated_over_true(&self, share: f64) -> f64 {
        let at = (self.shares.len() as f64 * (1.0 - share)) as usize;
        self.shares.get(at).map_or(1.0, |worst| 1.0 / worst)
    }
}

/// A file that does not hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Failed {
    /// Makes it again: `generate(seed)`.
    pub seed: u64,
    /// How the small file fails.
    pub failure: Failure,
    /// What it was made smaller to.
    pub scene: Scene,
    /// Where the small file was written to.
    pub path: Option<PathBuf>,
}

impl fmt::Display for Failed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "seed {}: {}: {}",
            self.seed, self.failure.kind, self.failure.detail
        )?;
        match &self.path {
            Some(path) => write!(f, "; the small file: {}", path.display()),
            None => Ok(()),
        }
    }
}

/// Makes and holds `count` files from `first` on; the first failures of each way are shrunk, `each` of them, and written
/// to `folder` as text.
pub fn run(first: u64, count: u64, each: u64, folder: &Path) -> Outcome {
    run_by(hold, first, count, each, folder)
}

/// A property of the file of a scene.
pub type Property = fn(&Scene, u64) -> Result<Seen, Failure>;

/// The same for another property.
pub fn run_by(property: Property, first: u64, count: u64, each: u64, folder: &Path) -> Outcome {
    let next = AtomicU64::new(first);
    let outcome = Mutex::new(Outcome::default());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= first + count {
                        return;
                    }
                    let scene = generate(seed);
                    let begun = Instant::now();
                    let held = property(&scene, seed);
                    slow(&outcome, seed, begun.elapsed().as_secs_f64());
                    take(&outcome, property, seed, &scene, held, each, folder);
                }
            });
        }
    });
    let mut outcome = outcome
        .into_inner()
        .unwrap_or_else(|broken| broken.into_inner());
    outcome.shares.sort_by(f64::total_cmp);
    outcome.failed.sort_by_key(|(seed, _)| *seed);
    outcome
        .failures
        .sort_by(|a, b| (a.failure.kind, a.seed).cmp(&(b.failure.kind, b.seed)));
    outcome
}

/// Keeps the longest.
fn slow(outcome: &Mutex<Outcome>, seed: u64, seconds: f64) {
    let mut outcome = outcome.lock().unwrap_or_else(|broken| broken.into_inner());
    let list = &mut outcome.slowest;
    let at = list.partition_point(|known| known.0 >= seconds);
    list.insert(at, (seconds, seed));
    list.truncate(SLOWEST);
}

fn take(
    outcome: &Mutex<Outcome>,
    property: Property,
    seed: u64,
    scene: &Scene,
    held: Result<Seen, Failure>,
    each: u64,
    folder: &Path,
) {
    let lock = || outcome.lock().unwrap_or_else(|broken| broken.into_inner());
    let failure = {
        let mut all = lock();
        all.files += 1;
        match held {
            Ok(seen) => {
                all.poses += seen.poses;
                all.refused.extend(seen.refused.map(|why| (seed, why)));
                all.worst = all.worst.max(seen.worst);
                all.shares.extend((seen.worst > 0.0).then_some(seen.worst));
                return;
            }
            Err(failure) => {
                all.failed.push((seed, failure.clone()));
                let known = all.kinds.entry(failure.kind).or_default();
                *known += 1;
                if *known > each {
                    return;
                }
                failure
            }
        }
    };
    let (scene, failure) = shrink(scene, seed, &failure, property, TRIES);
    let path = folder.join(format!("{}_{seed}.fbx", failure.kind));
    let written =
        std::fs::create_dir_all(folder).and_then(|()| std::fs::write(&path, document(&scene)));
    lock().failures.push(Failed {
        seed,
        failure,
        scene,
        path: written.is_ok().then_some(path),
    });
}
