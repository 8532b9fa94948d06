//! Broken, truncated and hostile files: refused by a typed error or converted, never a panic, within
//! two seconds and 64 MB + 20 times the file.
//!
//! The short tests run always. The full ones take minutes:
//! `cargo nextest run -p dolomite_fbx --release --run-ignored only -E 'test(full)' --no-capture`.

use crate::counting::{ALONE, base, peak};
use crate::support::{files_below, shared_fbx};
use dolomite_fbx::{FbxError, Options, Origin, convert};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What all cases came to.
#[derive(Debug, Default)]
struct Tally {
    cases: usize,
    refused: usize,
    slowest: f64,
    /// Peak memory over what is allowed, at most.
    memory: f64,
}

impl Tally {
    /// Converts `bytes` and writes them as .glb; `name` says which case it is if it fails.
    fn take(&mut self, bytes: &[u8], name: &str) {
        let base = base();
        let began = Instant::now();
        let origin = Origin {
            name: name.to_owned(),
            ..Origin::default()
        };
        let result = std::panic::catch_unwind(|| {
            convert(bytes, &origin, &Options::default()).and_then(|made| made.to_glb())
        });
        let seconds = began.elapsed().as_secs_f64();
        let peak = peak(base);
        let result = result.unwrap_or_else(|_| panic!("{name}: a panic"));
        match result {
            Ok(glb) => drop(glb),
            Err(error) => {
                self.refused += 1;
                assert!(
                    error.to_string().contains(name),
                    "{error} does not name {name}"
                );
                assert!(!matches!(error, FbxError::Option { .. }));
            }
        }
        assert!(seconds < 2.0, "{name}: {seconds} s");
        let allowed = 64e6 + 20.0 * bytes.len() as f64;
        assert!((peak as f64) < allowed, "{name}: {peak} bytes of {allowed}");
        self.cases += 1;
        self.slowest = self.slowest.max(seconds);
        self.memory = self.memory.max(peak as f64 / allowed);
    }
}

/// Splitmix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) % end as u64) as usize
    }
}

const FIVE: [&str; 5] = [
    "ufbx/maya_game_sausage_7500_binary_combined.fbx",
    "ufbx/maya_axes_anim_7700_ascii.fbx",
    "ufbx/blender_279_sausage_7400_binary.fbx",
    "magnum/skinning.fbx",
    "assimp/animation_with_skeleton.fbx",
];

fn five(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    FIVE.iter()
        .map(|name| folder.join(name))
        .map(|path| {
            (
                path.clone(),
                std::fs::read(path).expect("one of the shared files"),
            )
        })
        .collect()
}

fn truncations(step: usize) -> Option<Tally> {
    let _alone = ALONE.lock();
    let folder = shared_fbx()?;
    let mut tally = Tally::default();
    for (path, bytes) in five(&folder) {
        for end in (0..bytes.len()).step_by(step) {
            tally.take(&bytes[..end], &format!("{} cut at {end}", path.display()));
        }
    }
    Some(tally)
}

fn flips(count: usize) -> Option<Tally> {
    let _alone = ALONE.lock();
    let folder = shared_fbx()?;
    let files = five(&folder);
    let (mut tally, mut random) = (Tally::default(), Random(1));
    for case in 0..count {
        let (path, bytes) = &files[case % files.len()];
        let mut bytes = bytes.clone();
        let mut what = String::new();
        for _ in 0..1 + random.below(4) {
            let (at, with) = (random.below(bytes.len()), random.below(256) as u8);
            bytes[at] = with;
            what += &format!(" {at}={with}");
        }
        tally.take(&bytes, &format!("{} with{what}", path.display()));
    }
    Some(tally)
}

/// Broken files that others have collected, and whole ones.
#[test]
fn broken_files_are_refused_or_converted() {
    let _alone = ALONE.lock();
    let Some(folder) = shared_fbx() else { return };
    let mut tally = Tally::default();
    for path in files_below(&folder) {
        let bytes = std::fs::read(&path).unwrap();
        tally.take(&bytes, &path.display().to_string());
    }
    eprintln!("{tally:?}");
    assert!(tally.cases > 150 && tally.refused > 80, "{tally:?}");
}

#[test]
fn truncated_files_are_refused_or_converted() {
    let Some(tally) = truncations(4096) else {
        return;
    };
    eprintln!("{tally:?}");
    assert!(tally.cases > 100);
}

#[test]
fn flipped_bytes_are_refused_or_converted() {
    let Some(tally) = flips(200) else { return };
    eprintln!("{tally:?}");
    assert!(tally.cases == 200 && tally.refused < 200);
}

#[test]
#[ignore = "minutes; see the top of the file"]
fn full_truncations() {
    eprintln!("{:?}", truncations(256));
}

#[test]
#[ignore = "minutes; see the top of the file"]
fn full_flips() {
    eprintln!("{:?}", flips(20_000));
}

/// What is no FBX file at all.
#[test]
fn other_files_are_told_apart() {
    let of = |bytes: &[u8]| {
        convert(
            bytes,
            &Origin {
                name: "x.fbx".into(),
                ..Origin::default()
            },
            &Options::default(),
        )
        .unwrap_err()
    };
    assert!(matches!(of(b""), FbxError::NotFbx { .. }));
    assert!(matches!(
        of(b"glTF"),
        FbxError::NotFbx { .. } | FbxError::Broken { .. }
    ));
    let refusal = of(&[0; 4096]).to_string();
    assert!(refusal.starts_with("x.fbx"), "{refusal}");
}
