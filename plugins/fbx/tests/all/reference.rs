//! Converted files against meshes that the programs which made them deformed, and against ufbx.

use crate::support::{files_below, shared_fbx};
use dolomite_fbx::check::{Frame, check_file, read_frames};
use dolomite_fbx::{Options, convert};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Every reference frame of `frames.json` is within its tolerance, and the median of the files'
/// largest errors is at most a hundred-thousandth of the model. Dual quaternions, which glTF does not
/// have, are held to what the report says is lost.
#[test]
fn reference_frames_are_within_tolerance() {
    let Some(folder) = shared_fbx() else { return };
    let frames = read_frames(&folder.join("frames.json")).unwrap();
    let mut by_file: BTreeMap<String, Vec<(PathBuf, Frame)>> = BTreeMap::new();
    for frame in frames {
        let obj = folder.join(&frame.obj);
        by_file
            .entry(frame.fbx.clone())
            .or_default()
            .push((obj, frame));
    }
    let mut shares = Vec::new();
    for (name, frames) in &by_file {
        let check = check_file(&folder.join(name), frames, 0, &Options::default()).unwrap();
        let lost = &check.conversion.report.lost;
        let dual = lost.iter().find(|lost| lost.what == "dual-quaternion");
        eprintln!(
            "{name}: {} frames, {:.1e}, {:.1e} of size, {:.2} of tolerance{}",
            check.frames,
            check.max_error,
            check.max_error_over_size,
            check.over_tolerance,
            if dual.is_some() {
                ", dual quaternions"
            } else {
                ""
            },
        );
        assert_eq!(check.frames, frames.len());
        if dual.is_none() {
            assert!(check.over_tolerance <= 1.0, "{name}");
            shares.push(check.max_error_over_size);
        }
    }
    shares.sort_by(f64::total_cmp);
    assert!(shares[shares.len() / 2] <= 1e-5, "{shares:?}");
}

/// Every file that can be read, at its own frames, vertex by vertex: within the bound of its keys, its
/// weights' error and what f32 rounds.
#[test]
fn every_file_is_as_ufbx_deforms_it() {
    let Some(folder) = shared_fbx() else { return };
    let mut held = 0;
    for path in files_below(&folder) {
        let Ok(check) = check_file(&path, &[], 12, &Options::default()) else {
            continue;
        };
        let report = &check.conversion.report;
        if report.lost.iter().any(|lost| lost.metres.is_some()) {
            continue;
        }
        // Vertices of refitted weights are held at other poses than those they were fitted to.
        let allowed = report.bound + 2.0 * report.weight_error + 1e-6 * report.size;
        let error = check.max_error * report.unit;
        assert!(
            error <= allowed,
            "{}: {error:e} m, {allowed:e} allowed",
            path.display()
        );
        held += 1;
    }
    assert!(held > 30, "{held} files were held");
}

/// The same bytes for any number of threads, and again.
#[test]
fn the_same_bytes_on_any_number_of_threads() {
    let Some(folder) = shared_fbx() else { return };
    for name in [
        "ufbx/maya_kenney_character_7700_binary.fbx",
        "mesh2motion/91_48.fbx",
        // Weights are fitted.
        "assimp/animation_with_skeleton.fbx",
    ] {
        let bytes = std::fs::read(folder.join(name)).unwrap();
        let with = |threads: usize| {
            // Within frames there is enough to do for several.
            let options = Options {
                threads,
                within_frames: true,
                ..Options::default()
            };
            convert(&bytes, &Default::default(), &options)
                .unwrap()
                .to_glb()
                .unwrap()
        };
        let one = with(1);
        for threads in [1, 2, 5] {
            assert!(with(threads) == one, "{name} on {threads} threads");
        }
    }
}

/// Four weights that are fitted are off by at most half of what the largest four are.
#[test]
fn fitted_weights_halve_the_error() {
    let Some(folder) = shared_fbx() else { return };
    let bytes = std::fs::read(folder.join("assimp/animation_with_skeleton.fbx")).unwrap();
    let report = convert(&bytes, &Default::default(), &Options::default())
        .unwrap()
        .report;
    assert_eq!(report.refitted, 721);
    assert!(
        report.weight_error <= 0.5 * report.largest_weights_error,
        "{report:?}"
    );
}
