//! What a user may ask for, and how much a file may cost.

use crate::error::FbxError;
use crate::syntax::unpacked;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// Joints that a vertex may follow in the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weights {
    /// At most four (`JOINTS_0`), which every renderer of glTF draws.
    #[default]
    Four,
    /// At most eight (`JOINTS_0` and `JOINTS_1`); Bevy and many others draw the first four only.
    Eight,
}

impl Weights {
    /// How many joints.
    pub fn count(self) -> usize {
        match self {
            Self::Four => 4,
            Self::Eight => 8,
        }
    }
}

/// How long keys are searched for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Effort {
    /// Channel by channel, as fast as a file is read.
    #[default]
    Quick,
    /// All channels of a clip together, until the error at the skin leaves no key that could go: a
    /// twentieth to two fifths less bytes within the same bound, for some thirty times the time. Clips
    /// of more than 160 000 keys (two and a half minutes of thirty-five joints at 30 frames a second) are
    /// left as the quick search has them.
    Thorough,
}

/// How the bytes of meshes and clips are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Compression {
    /// As plain numbers, which every reader of glTF takes.
    #[default]
    None,
    /// By `EXT_meshopt_compression`, which a reader has to know: three.js, Babylon.js and others do, Bevy's
    /// loader does not. Views that would be no smaller are written plainly, and so is the whole file where that is no larger.
    /// Needs the feature `meshopt` of this crate.
    Meshopt,
}

/// How far along a conversion is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// What is being done.
    pub stage: &'static str,
    /// Share of this stage that is done, 0 to 1.
    pub done: f64,
}

/// Settings of a conversion.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// How far what the clips move may be from where the FBX file has it, metres at the skin: at 3 cm
    /// around each joint, or at the farthest vertex that follows it where that is farther. Above 0;
    /// default 0.0001. See [`Options::max_relative_error`].
    pub max_error: f64,
    /// The same as a share of the model's size (the diagonal of its box); the smaller of the two holds,
    /// so that a figure of two centimetres is not converted as coarsely as a house. Above 0; default
    /// 5e-6; infinite to do without.
    pub max_relative_error: f64,
    /// Joints a vertex.
    pub weights: Weights,
    /// Samples of a clip beside the file's own keys, per second; default 30. More find shorter bumps
    /// between far keys and cost time. 1 to 1000.
    pub sample_rate: f64,
    /// Holds what lies between two keys of the file to the bound even where they are no more than a
    /// frame apart. By default it is not: files that are baked have a key in every frame, three angles
    /// each, and what these angles do between two frames nobody sees or means. Costs time and bytes.
    pub within_frames: bool,
    /// How long keys are searched for; default quick.
    pub effort: Effort,
    /// How bytes are written; default plainly.
    pub compress: Compression,
    /// Threads that work on clips; 0 (the default) takes as many as the machine has. The result does
    /// not depend on it.
    pub threads: usize,
    /// Memory that a file may cost, bytes; `None` (the default) leaves it to the limits.
    pub max_memory: Option<usize>,
    /// What a file may cost; `None` (the default) sets [`Limits::of_contents`], and gives a thorough search forty
    /// times this work for itself.
    pub limits: Option<Limits>,
    /// Is told how far it is.
    pub progress: Option<&'a (dyn Fn(Progress) + Sync)>,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Self {
            max_error: 1e-4,
            max_relative_error: 5e-6,
            weights: Weights::default(),
            sample_rate: 30.0,
            within_frames: false,
            effort: Effort::default(),
            compress: Compression::default(),
            threads: 0,
            max_memory: None,
            limits: None,
            progress: None,
        }
    }
}

impl Options<'_> {
    /// # Errors
    /// [`FbxError::Option`] naming the first value out of range.
    pub fn check(&self) -> Result<(), FbxError> {
        let wrong = |option, value: f64, range| {
            let value = value.to_string();
            Err(FbxError::Option {
                option,
                value,
                range,
            })
        };
        if !(self.max_error > 0.0 && self.max_error.is_finite()) {
            return wrong("max error", self.max_error, "metres above 0");
        }
        if self.max_relative_error.is_nan() || self.max_relative_error <= 0.0 {
            return wrong(
                "max relative error",
                self.max_relative_error,
                "a share above 0",
            );
        }
        if !(1.0..=1000.0).contains(&self.sample_rate) {
            return wrong(
                "sample rate",
                self.sample_rate,
                "1 to 1000 samples a second",
            );
        }
        if self.compress == Compression::Meshopt && !cfg!(feature = "meshopt") {
            return Err(FbxError::Option {
                option: "compress",
                value: "meshopt".into(),
                range: "none, or build dolomite_fbx with its feature `meshopt`",
            });
        }
        Ok(())
    }

    /// Threads that are used.
    pub(crate) fn thread_count(&self) -> usize {
        match self.threads {
            // Asking reads files of the system: once is enough.
            0 => {
                static CORES: OnceLock<usize> = OnceLock::new();
                *CORES.get_or_init(|| std::thread::available_parallelism().map_or(1, usize::from))
            }
            n => n,
        }
    }

    pub(crate) fn report(&self, stage: &'static str, done: f64) {
        if let Some(tell) = self.progress {
            tell(Progress { stage, done });
        }
    }
}

/// What one file may cost, so that a broken or hostile one cannot take the machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Memory for what is read and what comes out of it, bytes.
    pub memory: usize,
    /// Work on what is read: poses of nodes, places of vertices, and what takes about as long, some
    /// microsecond each. It is counted and not timed, so that what becomes of a file is the same on every machine,
    /// however busy. A clip that needs more is looked at less closely and the error that is stated for it is larger; where not even a first
    /// look is within it, the file is refused.
    pub work: u64,
}

/// Work that every file may cost, and for each byte that it unpacks to.
const WORK: (u64, u64) = (2_000_000, 2);

impl Limits {
    /// Those of a file of so many bytes, unpacked: 48 MiB and 16 times the file, which leaves the rest of
    /// 64 MB + 20 times the file to the allocator and to the file itself; and two million poses of nodes and two more for
    /// each byte, where a key in a file has some twenty.
    pub fn of_file(bytes: usize) -> Self {
        Self {
            memory: (48_usize << 20).saturating_add(bytes.saturating_mul(16)),
            work: WORK.0.saturating_add(WORK.1.saturating_mul(bytes as u64)),
        }
    }

    /// Those of a file with these contents. Arrays in binary files are packed, some a hundred times:
    /// memory and work follow what they unpack to, up to 128 times the file.
    pub fn of_contents(file: &[u8]) -> Self {
        let most = file.len().saturating_mul(UNPACKED);
        Self::of_file(unpacked(file).min(most).max(file.len()))
    }
}

/// A file that unpacks to more than so many times its size counts as made to: a sound one stays far below.
const UNPACKED: usize = 128;

/// Where a file comes from.
#[derive(Debug, Clone, Default)]
pub struct Origin {
    /// Its name, for messages.
    pub name: String,
    /// Pictures that lie beside it, by the last part of their name; looked in before the folder.
    pub files: BTreeMap<String, Vec<u8>>,
    /// The folder that it lies in, where pictures which are not embedded are looked for: as the file
    /// says, beside it, and in `NAME.fbm`, `Textures` and `Texture`, in any case. `None` looks nowhere.
    pub folder: Option<PathBuf>,
    /// More folders that pictures are looked for in, and in the folders below them. Nothing outside
    /// of these and of [`Origin::folder`] is opened, and links do not lead out.
    pub textures: Vec<PathBuf>,
}

/// Work of searches for fewer bytes over that of everything else, where nobody sets limits.
const SEARCH: u64 = 40;

/// The purse of one conversion.
///
/// Work is paid for before it is done, and never by several threads that go on by what others paid: what is paid when is
/// the same in every run.
pub(crate) struct Budget {
    pub(crate) file: String,
    pub(crate) limits: Limits,
    /// Work that was paid for.
    paid: AtomicU64,
    /// Work that searches for fewer bytes may do beside all else; `None`: it counts as all else.
    search: Option<u64>,
    /// What they did so far.
    searched: AtomicU64,
    /// What checks of clips did so far.
    checked: AtomicU64,
}

impl Budget {
    pub(crate) fn new(file: &str, limits: Limits) -> Self {
        Self {
            file: file.to_owned(),
            limits,
            paid: AtomicU64::new(0),
            search: None,
            searched: AtomicU64::new(0),
            checked: AtomicU64::new(0),
        }
    }

    /// Of a file, with the limits of `options` or those of its contents.
    pub(crate) fn of(file: &str, bytes: &[u8], options: &Options) -> Self {
        let mut limits = options.limits.unwrap_or_else(|| Limits::of_contents(bytes));
        limits.memory = options.max_memory.unwrap_or(limits.memory);
        let search = limits.work.saturating_mul(SEARCH);
        Self {
            search: options.limits.is_none().then_some(search),
            ..Self::new(file, limits)
        }
    }

    /// Does `work` with a purse of its own, which holds what the last search left of it.
    pub(crate) fn search<T>(&self, work: impl FnOnce(&Self) -> T) -> T {
        let Some(most) = self.search else {
            return work(self);
        };
        let limits = Limits {
            work: most.saturating_sub(self.searched.load(Ordering::Relaxed)),
            ..self.limits
        };
        let own = Self::new(&self.file, limits);
        let out = work(&own);
        let paid = own.paid.load(Ordering::Relaxed);
        self.searched.fetch_add(paid, Ordering::Relaxed);
        out
    }

    /// For a second look at the whole file: as much as there was at first, or what is left where somebody set limits.
    pub(crate) fn again(&self) -> Self {
        let limits = match self.search {
            Some(_) => self.limits,
            None => Limits {
                work: self.left(),
                ..self.limits
            },
        };
        let checked = match self.search {
            Some(_) => 0,
            None => self.checked.load(Ordering::Relaxed),
        };
        Self {
            search: self.search,
            checked: AtomicU64::new(checked),
            ..Self::new(&self.file, limits)
        }
    }

    /// Pays for `work`, whether there is as much or not.
    pub(crate) fn pay(&self, work: usize) {
        self.paid.fetch_add(work as u64, Ordering::Relaxed);
    }

    /// Work that is left.
    pub(crate) fn left(&self) -> u64 {
        let paid = self.paid.load(Ordering::Relaxed);
        self.limits.work.saturating_sub(paid)
    }

    /// Pays for `work` if so much is left; says whether it was.
    pub(crate) fn pays(&self, work: usize) -> bool {
        let is_left = work as u64 <= self.left();
        if is_left {
            self.pay(work);
        }
        is_left
    }

    /// Pays for `work` without which there is no result.
    pub(crate) fn must(&self, work: usize, what: &'static str) -> Result<(), FbxError> {
        self.can_pay(work, what)?;
        self.pay(work);
        Ok(())
    }

    /// Refuses what cannot be paid for.
    pub(crate) fn can_pay(&self, work: usize, what: &'static str) -> Result<(), FbxError> {
        match work as u64 <= self.left() {
            true => Ok(()),
            false => Err(FbxError::Work {
                file: self.file.clone(),
                what,
                limit: self.limits.work,
            }),
        }
    }

    /// Work that checks of clips may still do: twice that of all else, so that an error can be stated of whatever else found.
    pub(crate) fn left_for_checks(&self) -> u64 {
        let most = self.limits.work.saturating_mul(2);
        most.saturating_sub(self.checked.load(Ordering::Relaxed))
    }

    /// Pays for the work of a check.
    pub(crate) fn pay_for_checks(&self, work: usize) {
        self.checked.fetch_add(work as u64, Ordering::Relaxed);
    }

    pub(crate) fn afford(&self, bytes: usize, what: &'static str) -> Result<(), FbxError> {
        match bytes > self.limits.memory {
            true => Err(self.too_much(what)),
            false => Ok(()),
        }
    }

    pub(crate) fn too_much(&self, what: &'static str) -> FbxError {
        FbxError::Memory {
            file: self.file.clone(),
            what,
            limit: self.limits.memory,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_search_has_a_purse_of_its_own() {
        let limits = |work| Limits { memory: 0, work };
        let budget = Budget {
            search: Some(50),
            ..Budget::new("", limits(20))
        };
        // More than all else may do, and then more than what is left of the search's own.
        assert!(budget.search(|own| own.pays(30)));
        assert_eq!(budget.left(), 20);
        assert!(!budget.search(|own| own.pays(30)));
        assert!(budget.search(|own| own.pays(20) && own.left() == 0));
        assert!(budget.pays(20) && !budget.pays(1));
        // Limits that were asked for hold for both.
        let budget = Budget::new("", limits(20));
        assert!(budget.search(|own| own.pays(15)));
        assert!(!budget.pays(15) && budget.pays(5));
        assert!(matches!(
            budget.must(1, "x"),
            Err(FbxError::Work { limit: 20, .. })
        ));
    }
}
