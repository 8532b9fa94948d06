//! A file under `EXT_meshopt_compression` is never larger than the plain one, as a whole, and what it decodes to is what
//! the error was measured on.

use crate::support::ascii::strip;
use crate::support::chain::chain;
use crate::support::motions::{alone, giant, shaken, spin, two_keys};
use crate::support::{files_below, shared_fbx};
use dolomite_fbx::check::{Played, Truth, vertex_error};
use dolomite_fbx::{Compression, Conversion, Effort, Options, Origin, convert};
use std::path::{Path, PathBuf};

/// Metres: from a centimetre to a micrometre.
const BOUNDS: [f64; 5] = [1e-2, 1e-3, 1e-4, 3e-5, 1e-6];

const NAME: &str = "EXT_meshopt_compression";

fn options(max_error: f64, effort: Effort, compress: Compression) -> Options<'static> {
    Options {
        max_error,
        max_relative_error: f64::INFINITY,
        effort,
        compress,
        ..Options::default()
    }
}

fn in_folder(path: &Path) -> Origin {
    Origin {
        name: path.display().to_string(),
        folder: path.parent().map(Into::into),
        ..Origin::default()
    }
}

/// The JSON chunk of a .glb.
fn json(glb: &[u8]) -> serde_json::Value {
    let length = u32::from_le_bytes(glb[12..16].try_into().expect("four bytes")) as usize;
    serde_json::from_slice(&glb[20..20 + length]).expect("JSON")
}

/// Converts both ways, holds the sizes, and what is read against what was measured; answers the compressed conversion, its
/// bytes, and those of the plain one.
fn hold(
    file: &[u8],
    origin: &Origin,
    bound: f64,
    effort: Effort,
) -> (Conversion, Vec<u8>, Vec<u8>) {
    let [plain, packed] = [Compression::None, Compression::Meshopt].map(|compress| {
        convert(file, origin, &options(bound, effort, compress)).expect("the test made it so")
    });
    let (large, small) = (
        plain.to_glb().expect("the test made it so"),
        packed.to_glb().expect("the test made it so"),
    );
    let name = format!("{} at {bound:e} m, {effort:?}", origin.name);
    assert!(
        small.len() <= large.len(),
        "{name}: {} bytes compressed, {} plain",
        small.len(),
        large.len()
    );
    let report = &packed.report;
    let root = json(&small);
    let needs = root["extensionsRequired"]
        .as_array()
        .is_some_and(|names| names.iter().any(|needed| needed == NAME));
    assert_eq!(needs, report.compression == Compression::Meshopt, "{name}");
    assert_eq!(report.plain_is_smaller, !needs, "{name}");
    let views = root["bufferViews"].as_array().cloned().unwrap_or_default();
    assert_eq!(
        views
            .iter()
            .any(|view| view["extensions"][NAME].is_object()),
        needs,
        "{name}"
    );
    assert_eq!(plain.report.compression, Compression::None);
    assert!(!plain.report.plain_is_smaller);
    // The same model written plainly, number by number.
    let mut same = packed.clone();
    same.report.compression = Compression::None;
    let same =
        Played::read(&same.to_glb().expect("the test made it so")).expect("the test made it so");
    let read = Played::read(&small).expect("the test made it so");
    assert_eq!(read.clips(), same.clips(), "{name}");
    assert_eq!(read.animation_bytes(), report.animation_bytes, "{name}");
    for clip in 0..same.clips().len() {
        for step in 0..=7 {
            let time = same.clips()[clip].1 * f64::from(step) / 7.0;
            assert_eq!(
                read.at(Some(clip), time),
                same.at(Some(clip), time),
                "{name}"
            );
        }
    }
    (packed, small, large)
}

/// What is decoded is no farther from the file than is stated.
fn hold_stated(file: &[u8], made: &Conversion, glb: &[u8]) {
    let report = &made.report;
    let played = Played::read(glb).expect("the test made it so");
    let truth = Truth::load(file, &Origin::default()).expect("the test made it so");
    for (number, clip) in made.model.clips.iter().enumerate() {
        for step in 0..=97 {
            let time = clip.duration * f64::from(step) / 97.0;
            let (shapes, _) = played.at(Some(number), time);
            let (bodies, _) = truth
                .at(Some(number), clip.begin + time)
                .expect("the test made it so");
            let error = vertex_error(&shapes, &bodies, &truth.space(), &made.sources());
            let allowed = report.error() + 1e-6 * report.size;
            assert!(
                error <= allowed,
                "at {time}: {error:e} m, {allowed:e} stated"
            );
        }
    }
}

#[test]
fn small_files_are_no_larger_at_any_bound() {
    let files = [
        ("two keys", two_keys()),
        ("a triangle", alone()),
        ("a spin", spin()),
        ("a bend", strip(170.0)),
        ("no bend", strip(0.0)),
        ("a chain", chain([0, 1, 2])),
        ("20 keys", shaken(20)),
        ("60 keys", shaken(60)),
        ("300 keys", shaken(300)),
    ];
    let (mut plain, mut packed) = (0, 0);
    for (name, file) in files {
        let origin = Origin {
            name: name.into(),
            ..Origin::default()
        };
        for bound in BOUNDS {
            let (made, small, large) = hold(file.as_bytes(), &origin, bound, Effort::Quick);
            println!(
                "{name} at {bound:e}: {} of {} bytes, {} of animation",
                small.len(),
                large.len(),
                made.report.animation_bytes
            );
            hold_stated(file.as_bytes(), &made, &small);
            match made.report.plain_is_smaller {
                true => plain += 1,
                false => packed += 1,
            }
        }
        let (made, small, _) = hold(file.as_bytes(), &origin, 3e-5, Effort::Thorough);
        hold_stated(file.as_bytes(), &made, &small);
    }
    assert!(plain > 10 && packed > 5, "{plain} plain, {packed} packed");
}

/// Where there is hardly any room to round: a key on every frame is no answer.
#[test]
fn a_giant_is_no_larger_at_fine_bounds() {
    let file = giant();
    let origin = Origin {
        name: "a giant".into(),
        ..Origin::default()
    };
    for bound in [1e-3, 1e-4, 5e-5, 3e-5, 2e-5, 1e-5] {
        let (made, small, large) = hold(file.as_bytes(), &origin, bound, Effort::Quick);
        println!(
            "at {bound:e}: {} of {} bytes, {} keys of {}, {:e} m",
            small.len(),
            large.len(),
            made.report.keys(),
            made.report.baked(),
            made.report.error()
        );
        hold_stated(file.as_bytes(), &made, &small);
    }
}

#[test]
fn the_files_of_the_tests_are_no_larger() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/field");
    for path in files_below(&data) {
        let bytes = std::fs::read(&path).expect("the test made it so");
        for bound in BOUNDS {
            hold(&bytes, &in_folder(&path), bound, Effort::Quick);
        }
    }
}

#[test]
fn the_hero_is_no_larger() {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/hero/hero.fbx");
    let bytes = std::fs::read(&path).expect("the test made it so");
    for bound in [1e-2, 1e-6] {
        let (made, small, large) = hold(&bytes, &in_folder(&path), bound, Effort::Quick);
        println!("at {bound:e}: {} of {} bytes", small.len(), large.len());
        assert!(!made.report.plain_is_smaller);
    }
}

/// A capture that its file calls 170 m tall.
#[test]
fn a_capture_is_no_larger_where_there_is_no_room_to_round() {
    let Some(folder) = shared_fbx() else { return };
    let path = folder.join("mesh2motion/91_48.fbx");
    let bytes = std::fs::read(&path).expect("the test made it so");
    let (made, small, large) = hold(&bytes, &in_folder(&path), 3e-5, Effort::Quick);
    println!(
        "{} of {} bytes, {} keys of {}",
        small.len(),
        large.len(),
        made.report.keys(),
        made.report.baked()
    );
}
