//! The thorough search: within the same bound as the quick one, with fewer bytes.

use crate::support::ascii::strip;
use crate::support::chain::chain;
use crate::support::{files_below, shared_fbx};
use dolomite_fbx::check::{Played, Truth, check_file, vertex_error};
use dolomite_fbx::{Effort, Options, convert};

/// A tenth of a millimetre, whatever the size of the model.
fn options(effort: Effort) -> Options<'static> {
    Options {
        max_error: 1e-4,
        max_relative_error: f64::INFINITY,
        effort,
        ..Options::default()
    }
}

/// Between the file's keys, which are a second apart, and on them.
#[test]
fn small_files_keep_to_the_bound_everywhere() {
    for text in [
        chain([0, 1, 2]),
        chain([1, 1, 1]),
        chain([2, 0, 1]),
        strip(170.0),
    ] {
        let made = convert(
            text.as_bytes(),
            &Default::default(),
            &options(Effort::Thorough),
        )
        .unwrap();
        let report = &made.report;
        assert!(report.clips.iter().all(|clip| clip.error <= report.bound));
        let played = Played::read(&made.to_glb().unwrap()).unwrap();
        let truth = Truth::load(text.as_bytes(), &Default::default()).unwrap();
        let (begin, seconds) = (made.model.clips[0].begin, made.model.clips[0].duration);
        for step in 0..=240 {
            let time = seconds * f64::from(step) / 240.0;
            let (shapes, _) = played.at(Some(0), time);
            let (bodies, _) = truth.at(Some(0), begin + time).unwrap();
            let error = vertex_error(&shapes, &bodies, &truth.space(), &made.sources());
            let allowed = report.bound + 1e-6 * report.size;
            assert!(
                error <= allowed,
                "at {time}: {error:e} m, {allowed:e} allowed"
            );
        }
    }
}

/// Every file that can be read, vertex by vertex at its own frames; and a file is never larger for the
/// longer search.
#[test]
fn shared_files_keep_to_the_bound_with_fewer_bytes() {
    let Some(folder) = shared_fbx() else { return };
    let (mut quick, mut thorough) = (0, 0);
    for path in files_below(&folder) {
        let Ok(check) = check_file(&path, &[], 12, &options(Effort::Thorough)) else {
            continue;
        };
        let report = &check.conversion.report;
        let bytes = std::fs::read(&path).unwrap();
        let other = convert(&bytes, &Default::default(), &options(Effort::Quick)).unwrap();
        let (few, many) = (report.animation_bytes, other.report.animation_bytes);
        assert!(few <= many, "{}: {few} bytes, quick {many}", path.display());
        (quick, thorough) = (quick + many, thorough + few);
        assert!(
            report
                .clips
                .iter()
                .all(|clip| clip.keyed_error <= report.bound)
        );
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
    }
    eprintln!("{thorough} bytes, quick {quick}");
    assert!(thorough > 0 && thorough < quick);
}

/// The game's person, whose skeleton is as large as those that people animate.
#[test]
fn the_hero_is_a_third_smaller() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/hero/hero.fbx");
    let bytes = std::fs::read(path).unwrap();
    let of = |effort| {
        let made = convert(&bytes, &Default::default(), &options(effort)).unwrap();
        let report = made.report;
        assert!(
            report
                .clips
                .iter()
                .all(|clip| clip.keyed_error <= report.bound)
        );
        report.animation_bytes
    };
    let (quick, thorough) = (of(Effort::Quick), of(Effort::Thorough));
    // Measured: 88 012 and 54 548, which is 62 %.
    assert!(
        thorough * 100 < quick * 65,
        "{thorough} bytes, quick {quick}"
    );
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    let text = strip(170.0);
    let with = |threads| {
        let options = Options {
            threads,
            ..options(Effort::Thorough)
        };
        let made = convert(text.as_bytes(), &Default::default(), &options).unwrap();
        made.to_glb().unwrap()
    };
    let one = with(1);
    assert!([2, 5].into_iter().all(|threads| with(threads) == one));
    let Some(folder) = shared_fbx() else { return };
    let name = "ufbx/maya_game_sausage_7500_binary_combined.fbx";
    let bytes = std::fs::read(folder.join(name)).unwrap();
    let with = |threads| {
        let options = Options {
            threads,
            ..options(Effort::Thorough)
        };
        let made = convert(&bytes, &Default::default(), &options).unwrap();
        made.to_glb().unwrap()
    };
    let one = with(1);
    assert!([2, 5].into_iter().all(|threads| with(threads) == one));
}
