//! The person of the game: what its files say, and what its feet do.

use crate::walk;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use dolomite::character::gait::{ClipMotion, GaitData};
use dolomite::character::{Figure, Rig};
use dolomite::fbx::{Conversion, Options, Origin, convert};
use dolomite_game::view::hero::{GAITS, MODEL};
use serde::Deserialize;
use walk::{Seen, Walk, plane};

fn asset(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("assets")
        .join(name)
}

fn text(name: &str) -> String {
    std::fs::read_to_string(asset(name)).expect("it is committed")
}

fn converted() -> &'static Conversion {
    static MADE: OnceLock<Conversion> = OnceLock::new();
    MADE.get_or_init(|| {
        let bytes = std::fs::read(asset(MODEL)).expect("it is committed");
        convert(&bytes, &Origin::default(), &Options::default()).expect("a good file")
    })
}

fn gaits() -> GaitData {
    GaitData::from_ron(&text(GAITS)).expect("good RON")
}

fn person() -> &'static Figure {
    static PERSON: OnceLock<Figure> = OnceLock::new();
    PERSON.get_or_init(|| {
        let glb = converted().to_glb().expect("it fits");
        let rig = Rig::from_bytes(&glb, |_| Err(std::io::ErrorKind::NotFound.into()));
        Figure::new(rig.expect("a rig"), &gaits()).expect("its gaits")
    })
}

#[test]
fn nothing_of_the_person_is_lost() {
    let report = &converted().report;
    assert!(report.lost.is_empty(), "{:?}", report.lost);
    assert_eq!(report.clips.len(), 9);
    for clip in &report.clips {
        assert!(clip.keyed_error <= report.bound, "{clip:?}");
    }
    // To the joint of the head; the top of the skull is at 1.78 m.
    assert!((1.5..1.6).contains(&person().height), "{}", person().height);
}

/// `hero.ron`: measured from the clips when they were made.
#[derive(Deserialize)]
struct Measured {
    clips: Vec<MeasuredClip>,
}

#[derive(Deserialize)]
struct MeasuredClip {
    name: String,
    length: f32,
    looped: bool,
    speed: f32,
    turn_rate: f32,
    left: Vec<(f32, f32)>,
    right: Vec<(f32, f32)>,
}

#[test]
fn gaits_agree_with_what_was_measured() {
    let measured: Measured = ron::from_str(&text("hero/hero.ron")).expect("good RON");
    let find = |name: &str| {
        let found = measured.clips.iter().find(|clip| clip.name == name);
        found.unwrap_or_else(|| panic!("no clip {name}"))
    };
    for clip in &measured.clips {
        let played = person().rig.clip(&clip.name).expect(&clip.name).duration();
        // Clips end on a frame: half a frame of 30 a second.
        assert!(
            (played - clip.length).abs() < 0.5 / 30.0,
            "{}: {played}",
            clip.name
        );
    }
    let gaits = gaits();
    let agrees = |stride: &ClipMotion| {
        let clip = find(&stride.clip);
        assert!(clip.looped);
        assert_eq!(stride.speed, clip.speed, "{}", clip.name);
        let turning = clip.turn_rate.abs().to_radians();
        assert!((stride.turn_rate - turning).abs() < 1e-6, "{}", clip.name);
        assert_eq!(
            (stride.left, stride.right),
            (clip.left[0], clip.right[0]),
            "{}",
            clip.name
        );
    };
    gaits.strides.iter().for_each(agrees);
    [gaits.turn_left, gaits.turn_right]
        .iter()
        .flatten()
        .for_each(agrees);
    for name in [gaits.jump, gaits.land].iter().flatten() {
        assert!(!find(name).looped);
    }
}

#[test]
fn feet_do_not_slide_on_slopes_to_30_degrees() {
    let mut worst = Seen::default();
    for degrees in [0.0, 10.0, 20.0, 30.0] {
        for direction in [0.0, 0.8, 1.6, 2.4, 3.1] {
            let ground = plane(degrees, direction);
            for speed in [0.6, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0] {
                let mut walk = Walk::new(person(), &ground);
                // The first second it gathers speed.
                walk.watch(1.0, speed, 0.0);
                let seen = walk.watch(3.0, speed, 0.0);
                assert!(seen.contacts > 6, "{seen:?}");
                worst.take(&seen);
            }
        }
    }
    println!("slopes: {worst:?}");
    // The bound is a centimetre, for slides; for what is under or above the ground the same.
    assert!(
        worst.slide <= 0.01 && worst.below <= 0.01 && worst.above <= 0.01,
        "{worst:?}"
    );
}

#[test]
fn without_planting_they_do_slide() {
    let ground = plane(20.0, 0.3);
    let mut walk = Walk::new(person(), &ground);
    walk.planted = false;
    walk.watch(1.0, 1.2, 0.0);
    let seen = walk.watch(3.0, 1.2, 0.0);
    assert!(seen.slide > 0.02 && seen.below > 0.02, "{seen:?}");
}
