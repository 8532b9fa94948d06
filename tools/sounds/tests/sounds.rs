//! The committed sounds are those that this program makes, and they are fit to be played.

use dolomite_sounds::catalogue::SOUNDS;
use dolomite_sounds::wave::wav;
use dolomite_sounds::{SEED, picture};
use std::path::Path;

/// What all files together may take.
const MOST_BYTES: usize = 300_000;

#[test]
fn the_committed_files_are_what_is_made() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../plugins/sound/assets");
    let mut all = 0;
    for sound in SOUNDS {
        let made = wav(&sound.samples(SEED), sound.rate);
        let path = folder.join(sound.name).with_extension("wav");
        let kept =
            std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert!(
            made == kept,
            "{} is another: `cargo run -p dolomite_sounds` makes it anew",
            sound.name
        );
        let other = wav(&sound.samples(SEED + 1), sound.rate);
        assert!(made != other, "{} is the same for any seed", sound.name);
        all += kept.len();
    }
    assert!(all <= MOST_BYTES, "{all} bytes");
    let files = std::fs::read_dir(&folder).unwrap().flatten();
    let waves = files.filter(|file| {
        file.path()
            .extension()
            .is_some_and(|ending| ending == "wav")
    });
    assert_eq!(waves.count(), SOUNDS.len(), "a file that nothing makes");
}

#[test]
fn the_committed_picture_is_what_is_made() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../plugins/sound/sounds.svg");
    let kept = std::fs::read_to_string(&path).unwrap();
    let made = picture::svg(SEED);
    assert!(
        made == kept,
        "{} is another: `cargo run -p dolomite_sounds -- --picture plugins/sound/sounds.svg` makes it anew",
        path.display()
    );
    let names = SOUNDS.iter().filter(|sound| {
        let name = sound.name.replace('_', " ");
        made.contains(&format!(">{name}</text>"))
    });
    assert_eq!(names.count(), SOUNDS.len());
}

/// Loops: the step over the seam is one as others are, and there is no more of them around it. Others begin and end in
/// silence.
#[test]
fn nothing_clicks_or_is_cut() {
    for sound in SOUNDS {
        let samples = sound.samples(SEED);
        let most = samples.iter().fold(0.0, |most, x| f64::max(most, x.abs()));
        assert!((0.5..=0.85).contains(&most), "{}: {most}", sound.name);
        if !sound.looped {
            assert!(samples[0].abs() < 1e-9, "{}: {}", sound.name, samples[0]);
            let last = samples[samples.len() - 1].abs();
            assert!(last < 1e-9, "{}: {last}", sound.name);
            continue;
        }
        let mean = samples.iter().sum::<f64>() / samples.len() as f64;
        assert!(mean.abs() < 1e-9, "{}: {mean}", sound.name);
        let seam = seam(&samples);
        println!("{}: {seam:.2} of the usual step", sound.name);
        // Steps of filtered noise are normally distributed: 3 of 1000 are greater than three times their RMS.
        assert!(seam <= 3.0, "{}: {seam}", sound.name);
    }
}

/// The RMS of all steps.
fn usual(samples: &[f64]) -> f64 {
    let square: f64 = samples
        .windows(2)
        .map(|two| (two[1] - two[0]) * (two[1] - two[0]))
        .sum();
    (square / (samples.len() - 1) as f64).sqrt()
}

/// The step from the end to the begin as a multiple of that.
fn seam(samples: &[f64]) -> f64 {
    (samples[0] - samples[samples.len() - 1]).abs() / usual(samples)
}

/// What the test above has to find: each loop clicks where it is cut at some wrong place.
#[test]
fn a_cut_loop_has_a_seam() {
    for sound in SOUNDS.iter().filter(|sound| sound.looped) {
        let samples = sound.samples(SEED);
        let usual = usual(&samples);
        let wrong = samples
            .iter()
            .filter(|last| (samples[0] - **last).abs() > 3.0 * usual);
        println!(
            "{}: {} of {} places",
            sound.name,
            wrong.clone().count(),
            samples.len()
        );
        assert!(wrong.count() > samples.len() / 100, "{}", sound.name);
    }
}
