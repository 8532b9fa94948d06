//! The soldier of the levels: its clips are there and are laid over each other as logic says, and who falls lies.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use bevy::math::{Affine3A, DVec3, Quat, Vec3};
use dolomite::character::feet::{Footing, Place};
use dolomite::character::gait::{GaitData, Motion};
use dolomite::character::{Figure, FigureState, Input, Pose, Rig, Workspace};
use dolomite::fbx::{Options, Origin, convert};
use dolomite_game::view::level::soldiers::{FILES, shots};

fn asset(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("assets")
        .join(name)
}

fn gaits() -> GaitData {
    let text = std::fs::read_to_string(asset(FILES.gaits)).expect("it is committed");
    GaitData::from_ron(&text).expect("good RON")
}

fn soldier() -> &'static Figure {
    static SOLDIER: OnceLock<Figure> = OnceLock::new();
    SOLDIER.get_or_init(|| {
        let bytes = std::fs::read(asset(FILES.model)).expect("it is committed");
        let made = convert(&bytes, &Origin::default(), &Options::default()).expect("a good file");
        assert!(made.report.lost.is_empty(), "{:?}", made.report.lost);
        let glb = made.to_glb().expect("it fits");
        let rig = Rig::from_bytes(&glb, |_| Err(std::io::ErrorKind::NotFound.into()));
        Figure::new(rig.expect("a rig"), &gaits()).expect("its gaits")
    })
}

/// A soldier on level ground at 0.
#[derive(Default)]
struct Acts {
    state: FigureState,
    pose: Pose,
    model: Vec<Affine3A>,
    work: Workspace,
}

impl Acts {
    fn run(&mut self, speed: f32, seconds: f32) {
        let dt = 1.0 / 60.0;
        let input = Input {
            dt,
            motion: Motion {
                speed,
                ..Default::default()
            },
            place: Place {
                position: DVec3::ZERO,
                rotation: Quat::IDENTITY,
            },
        };
        for _ in 0..(seconds / dt) as u32 {
            soldier().advance(&mut self.state, &input, &mut self.work);
            let mut ground = |_| Some(Footing::default());
            soldier().pose(
                &mut self.state,
                &input,
                Some(&mut ground),
                &mut self.work,
                &mut self.pose,
                &mut self.model,
            );
        }
    }

    fn joint(&self, name: &str) -> Vec3 {
        let number = soldier().rig.skeleton.find(name).expect("it has it");
        self.model[number].translation.into()
    }
}

#[test]
fn the_game_asks_for_its_clips_by_their_right_numbers() {
    let names: Vec<String> = gaits()
        .one_shots
        .into_iter()
        .map(|shot| shot.clip)
        .collect();
    for (number, name) in [
        (shots::ALARM, "alarm"),
        (shots::AIM, "aim"),
        (shots::SHOOT, "shoot"),
        (shots::HIT, "hit"),
        (shots::FALL, "fall_back"),
    ] {
        assert_eq!(names[number], name);
    }
    assert_eq!(soldier().rig.clips.len(), 10);
}

#[test]
fn who_aims_holds_the_crossbow_up_until_told_otherwise() {
    let mut acts = Acts::default();
    acts.run(1.5, 1.0);
    let low = acts.joint("hand_r").y;
    assert!((0.9..1.25).contains(&low), "carried at the hip: {low} m");
    acts.state.locomotion.hold(Some(shots::AIM));
    acts.run(1.5, 6.0);
    let up = acts.joint("hand_r").y;
    assert!((1.25..1.5).contains(&up), "at the shoulder: {up} m");
    // A shot is over by itself, and the crossbow is up again.
    acts.state.locomotion.play(shots::SHOOT);
    acts.run(1.5, 0.8);
    assert!(acts.joint("hand_r").y < 1.25, "the string is drawn low");
    acts.run(1.5, 2.0);
    assert!((acts.joint("hand_r").y - up).abs() < 0.06);
    acts.state.locomotion.hold(None);
    acts.run(1.5, 1.0);
    assert!(acts.joint("hand_r").y < 1.25);
}

#[test]
fn who_falls_lies_and_stays() {
    let mut acts = Acts::default();
    acts.run(0.0, 0.5);
    assert!(acts.joint("head").y > 1.5);
    // In the middle of a hit.
    acts.state.locomotion.play(shots::HIT);
    acts.run(0.0, 0.1);
    acts.state.locomotion.hold(Some(shots::FALL));
    acts.state.locomotion.cut();
    acts.run(0.0, 2.0);
    let lies = |acts: &Acts| {
        for joint in ["hips", "chest", "head", "hand_l", "hand_r", "upper_leg_l"] {
            let height = acts.joint(joint).y;
            assert!((0.0..0.35).contains(&height), "{joint} at {height} m");
        }
    };
    lies(&acts);
    // No foot is pulled under the body by the ground.
    assert!(acts.joint("foot_l").z > 0.3, "{}", acts.joint("foot_l"));
    let head = acts.joint("head");
    acts.run(0.0, 60.0);
    lies(&acts);
    assert!(acts.joint("head").distance(head) < 1e-4);
}
