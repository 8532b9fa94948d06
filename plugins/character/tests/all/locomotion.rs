//! From speed, turning and air to clips and weights.

use crate::support;

use bevy::math::{DVec3, Quat, Vec3};
use dolomite_character::feet::Place;
use dolomite_character::gait::{
    GaitData, GaitError, LocomotionState, Motion, OneShotData, Voice, root_delta,
};
use dolomite_character::{
    Channel, Clip, ClipData, Figure, FigureState, Input, Interpolation, Pose, Sampler, Values,
    Workspace,
};
use support::person;

const DT: f32 = 1.0 / 60.0;

fn input(motion: Motion) -> Input {
    Input {
        dt: DT,
        motion,
        place: Place {
            position: DVec3::ZERO,
            rotation: Quat::IDENTITY,
        },
    }
}

fn ground(speed: f32, turn_rate: f32) -> Motion {
    Motion {
        speed,
        turn_rate,
        ..Default::default()
    }
}

fn run(figure: &Figure, state: &mut FigureState, motion: Motion, seconds: f32) {
    let mut work = Workspace::default();
    for _ in 0..(seconds / DT) as usize {
        figure.advance(state, &input(motion), &mut work);
    }
}

fn voices(figure: &Figure, state: &FigureState) -> Vec<(String, Voice)> {
    let mut list = Vec::new();
    state
        .locomotion
        .voices(&figure.gait, &figure.rig.clips, |voice| {
            list.push((figure.rig.clips[voice.clip].name().to_owned(), voice));
        });
    list
}

fn weight(figure: &Figure, state: &FigureState, name: &str) -> f32 {
    let found = voices(figure, state)
        .into_iter()
        .filter(|(clip, _)| clip == name);
    found.map(|(_, voice)| voice.weight).sum()
}

#[test]
fn speeds_choose_clips() {
    let figure = person::figure();
    for (speed, turn, clip) in [
        (0.0, 0.0, "idle"),
        (1.1, 0.0, "walk"),
        (3.0, 0.0, "run"),
        (9.0, 0.0, "run"),
        (-1.1, 0.0, "walk"),
        (0.0, 1.6, "turn_left"),
        (0.0, -1.6, "turn_right"),
    ] {
        let mut state = FigureState::default();
        run(&figure, &mut state, ground(speed, turn), 4.0);
        let got = weight(&figure, &state, clip);
        assert!(got > 0.99, "{speed} m/s, {turn} rad/s: {clip} has {got}");
    }
    let mut state = FigureState::default();
    run(&figure, &mut state, ground(2.05, 0.0), 4.0);
    assert!((weight(&figure, &state, "run") - 0.5).abs() < 0.01);
}

#[test]
fn steps_are_as_long_as_the_way() {
    let figure = person::figure();
    let stride = figure.gait.strides[0];
    for speed in [0.7, 1.1] {
        let mut state = FigureState::default();
        run(&figure, &mut state, ground(speed, 0.0), 3.0);
        let (mut turns, mut before) = (0.0, state.locomotion.phase);
        for _ in 0..600 {
            figure.advance(
                &mut state,
                &input(ground(speed, 0.0)),
                &mut Workspace::default(),
            );
            turns += (state.locomotion.phase - before).rem_euclid(1.0);
            before = state.locomotion.phase;
        }
        let way = speed * 600.0 * DT;
        assert!(
            (way / turns - stride.reach).abs() < 1e-3,
            "{speed}: {}",
            way / turns
        );
    }
}

#[test]
fn feet_of_blended_clips_land_together() {
    // The run's right foot lands first in its file.
    let figure = person::figure();
    let mut state = FigureState::default();
    run(&figure, &mut state, ground(2.0, 0.0), 3.0);
    let (mut sampler, mut pose, mut model) = (Sampler::new(), Pose::default(), Vec::new());
    let foot = figure.rig.skeleton.find("foot_l").unwrap();
    for _ in 0..120 {
        figure.advance(
            &mut state,
            &input(ground(2.0, 0.0)),
            &mut Workspace::default(),
        );
        let heights: Vec<f32> = voices(&figure, &state)
            .iter()
            .map(|(_, voice)| {
                sampler.sample(&figure.rig.clips[voice.clip], voice.time, &mut pose);
                figure.rig.skeleton.local_to_model(&pose, &mut model);
                model[foot].translation.z
            })
            .collect();
        assert_eq!(heights.len(), 2);
        // While the left foot begins its stance it is in front in both.
        if state.locomotion.phase < 0.1 {
            assert!(heights.iter().all(|z| *z > 0.1), "{heights:?}");
        }
    }
}

#[test]
fn weights_sum_to_one_through_everything() {
    let figure = person::figure();
    let mut state = FigureState::default();
    let mut work = Workspace::default();
    let mut before: Option<Vec<(String, Voice)>> = None;
    for frame in 0..3000 {
        let motion = Motion {
            speed: [0.0, 1.2, 3.5, -0.5][frame / 50 % 4],
            turn_rate: [0.0, 2.0, -2.0][frame / 70 % 3],
            airborne: frame / 90 % 4 == 3,
            climb: if frame / 180 % 2 == 0 { 1.0 } else { -1.0 },
            ..Default::default()
        };
        figure.advance(&mut state, &input(motion), &mut work);
        let now = voices(&figure, &state);
        let sum: f32 = now.iter().map(|(_, voice)| voice.weight).sum();
        assert!((sum - 1.0).abs() < 1e-5, "{sum}");
        for (clip, voice) in &now {
            assert!(
                (-1e-6..=1.000_001).contains(&voice.weight),
                "{clip}: {voice:?}"
            );
        }
        if let Some(before) = &before {
            for clip in &figure.rig.clips {
                let of = |list: &[(String, Voice)]| -> f32 {
                    let same = list.iter().filter(|(name, _)| name == clip.name());
                    same.map(|(_, voice)| voice.weight).sum()
                };
                // The shortest fade takes 0.15 s, at most 15/8 as fast in its middle: 0.21 a frame; speeds
                // change the blend of strides besides.
                assert!(
                    (of(&now) - of(before)).abs() < 0.3,
                    "{} in frame {frame}",
                    clip.name()
                );
            }
        }
        before = Some(now);
    }
}

#[test]
fn into_the_air_and_back() {
    let figure = person::figure();
    let mut state = FigureState::default();
    let air = |climb: f32| Motion {
        airborne: true,
        climb,
        ..Default::default()
    };
    run(&figure, &mut state, ground(0.0, 0.0), 0.5);
    run(&figure, &mut state, air(3.0), 0.2);
    assert_eq!(state.locomotion.state(), LocomotionState::Jump);
    assert_eq!(state.locomotion.feet(&figure.gait), [0.0, 0.0]);
    run(&figure, &mut state, air(-1.0), 1.0);
    assert_eq!(state.locomotion.state(), LocomotionState::Fall);
    run(&figure, &mut state, ground(0.0, 0.0), 0.2);
    assert_eq!(state.locomotion.state(), LocomotionState::Land);
    run(&figure, &mut state, ground(0.0, 0.0), 1.5);
    assert_eq!(state.locomotion.state(), LocomotionState::Ground);
    assert!((weight(&figure, &state, "idle") - 1.0).abs() < 1e-6);
    // Off an edge, without a jump; on again at a run, without a landing.
    run(&figure, &mut state, air(-1.0), 0.3);
    assert_eq!(state.locomotion.state(), LocomotionState::Fall);
    run(&figure, &mut state, ground(3.0, 0.0), 0.1);
    assert_eq!(state.locomotion.state(), LocomotionState::Ground);
}

#[test]
fn a_wave_is_seen_above_the_hips_alone() {
    let figure = person::figure();
    let (mut state, mut plain) = (FigureState::default(), FigureState::default());
    run(&figure, &mut state, ground(1.1, 0.0), 2.0);
    run(&figure, &mut plain, ground(1.1, 0.0), 2.0);
    state.locomotion.play(0);
    run(&figure, &mut state, ground(1.1, 0.0), 0.75);
    run(&figure, &mut plain, ground(1.1, 0.0), 0.75);
    let poses = |state: &mut FigureState| {
        let (mut pose, mut model) = (Pose::default(), Vec::new());
        let still = input(ground(1.1, 0.0));
        figure.pose(
            state,
            &still,
            None,
            &mut Workspace::default(),
            &mut pose,
            &mut model,
        );
        pose
    };
    let (waving, walking) = (poses(&mut state), poses(&mut plain));
    for joint in 0..waving.len() {
        let angle = waving
            .get(joint)
            .rotation
            .angle_between(walking.get(joint).rotation);
        let name = figure.rig.skeleton.name(joint);
        if name == "arm_r" {
            assert!(angle > 1.0, "{angle}");
        } else if ["root", "hips", "thigh_l", "shank_r", "foot_l"].contains(&name) {
            assert!(angle < 1e-3, "{name}: {angle}");
        }
    }
    // It ends by itself.
    run(&figure, &mut state, ground(1.1, 0.0), 1.5);
    let mut overlays = 0;
    state.locomotion.overlays(|_| overlays += 1);
    assert_eq!(overlays, 0);
}

/// Which one-shots are laid over, with their weights and times.
fn overlays(state: &FigureState) -> Vec<(usize, f32, f32)> {
    let mut all = Vec::new();
    state
        .locomotion
        .overlays(|over| all.push((over.one_shot, over.weight, over.time)));
    all
}

#[test]
fn what_is_held_stays_and_comes_back_after_what_is_played() {
    let mut gaits = person::gaits();
    // The second is of the whole body.
    gaits.one_shots.push(OneShotData {
        clip: "land".into(),
        from: None,
    });
    let figure = Figure::new(person::rig(), &gaits).expect("made as it has to be");
    let mut state = FigureState::default();
    state.locomotion.hold(Some(1));
    run(&figure, &mut state, ground(0.0, 0.0), 10.0);
    let held = overlays(&state);
    assert!(
        held.len() == 1 && held[0].0 == 1 && held[0].1 > 0.999,
        "{held:?}"
    );
    assert!(held[0].2 > 9.0, "it is not begun anew: {held:?}");
    // Legs that are the one-shot's are not put onto the ground.
    let step = state.locomotion.step(&figure.gait, DT);
    assert!(step.ground < 1e-3 && step.firm[0] < 1e-3, "{step:?}");
    // The wave is seen to its end, and what was held comes back.
    state.locomotion.play(0);
    run(&figure, &mut state, ground(0.0, 0.0), 0.75);
    let waves = overlays(&state);
    assert!(
        waves.iter().any(|over| over.0 == 0 && over.1 > 0.999),
        "{waves:?}"
    );
    assert!(state.locomotion.step(&figure.gait, DT).ground > 0.999);
    run(&figure, &mut state, ground(0.0, 0.0), 3.0);
    assert!(overlays(&state).iter().all(|over| over.0 == 1));
    // Cut short, it gives way at once.
    state.locomotion.play(0);
    run(&figure, &mut state, ground(0.0, 0.0), 0.3);
    state.locomotion.cut();
    run(&figure, &mut state, ground(0.0, 0.0), 0.3);
    assert!(overlays(&state).iter().all(|over| over.0 == 1));
    // Held again is not begun again; let go, nothing is left.
    state.locomotion.hold(Some(1));
    assert!(overlays(&state)[0].2 > 9.0);
    state.locomotion.hold(None);
    run(&figure, &mut state, ground(0.0, 0.0), 0.5);
    assert_eq!(overlays(&state), []);
    assert!(state.locomotion.step(&figure.gait, DT).ground > 0.999);
}

#[test]
fn it_leans_into_the_slope_and_the_turn() {
    let figure = person::figure();
    let head = figure.rig.skeleton.find("head").unwrap();
    let lean = |motion: Motion| {
        let mut state = FigureState::default();
        let (mut pose, mut model) = (Pose::default(), Vec::new());
        run(&figure, &mut state, motion, 4.0);
        figure.pose(
            &mut state,
            &input(motion),
            None,
            &mut Workspace::default(),
            &mut pose,
            &mut model,
        );
        Vec3::from(model[head].translation)
    };
    let level = lean(ground(1.1, 0.0));
    let uphill = lean(Motion {
        slope: bevy::math::Vec2::new(0.0, 0.5),
        ..ground(1.1, 0.0)
    });
    assert!(uphill.z > level.z + 0.03, "{level} {uphill}");
    let left = lean(ground(3.0, 1.0));
    assert!(left.x > lean(ground(3.0, 0.0)).x + 0.03, "{left}");
}

#[test]
fn root_motion_is_the_way_of_the_root() {
    let skeleton = person::skeleton();
    // 1.5 m ahead and a quarter turn to the left in a second, and on so.
    let turn = |part: f32| Quat::from_rotation_y(part * std::f32::consts::FRAC_PI_2).to_array();
    let times: Vec<f32> = (0..=10).map(|key| key as f32 / 10.0).collect();
    let channel = |values| Channel {
        joint: 0,
        times: times.clone(),
        interpolation: Interpolation::Linear,
        values,
    };
    let data = ClipData {
        name: "travel".into(),
        channels: vec![
            channel(Values::Translation(
                times.iter().map(|t| [0.0, 0.0, 1.5 * t]).collect(),
            )),
            channel(Values::Rotation(times.iter().map(|t| turn(*t)).collect())),
        ],
    };
    let clip = Clip::new(&skeleton, &data).unwrap();
    let (mut sampler, mut scratch) = (Sampler::new(), Pose::default());
    let mut delta = |from, to| root_delta(&clip, 0, from, to, true, &mut sampler, &mut scratch);
    let whole = delta(0.0, 1.0 - 1e-6);
    assert!(
        (whole.translation - Vec3::Z * 1.5).length() < 1e-4
            && (whole.yaw - std::f32::consts::FRAC_PI_2).abs() < 1e-4
    );
    // In many small steps over the seam it is the same way.
    let mut sum = dolomite_character::gait::RootDelta::default();
    for step in 0..120 {
        sum = sum.then(delta(
            0.25 + step as f32 / 60.0,
            0.25 + (step + 1) as f32 / 60.0,
        ));
    }
    let once = delta(0.25, 2.25);
    assert!(
        (sum.translation - once.translation).length() < 1e-4,
        "{sum:?} {once:?}"
    );
    assert!((sum.yaw - std::f32::consts::PI).abs() < 1e-4);
    // And back again.
    let back = delta(2.25, 0.25);
    let nowhere = once.then(back);
    assert!(
        nowhere.translation.length() < 1e-4 && nowhere.yaw.abs() < 1e-4,
        "{nowhere:?}"
    );
}

#[test]
fn gaits_that_do_not_fit_are_refused_with_their_names() {
    let rig = person::rig();
    let refusal = |change: fn(&mut GaitData)| {
        let mut data = person::gaits();
        change(&mut data);
        data.resolve(&rig).unwrap_err()
    };
    let text = refusal(|data| data.idle = "stand".into()).to_string();
    assert!(text.contains("stand") && text.contains("walk"), "{text}");
    assert!(matches!(
        refusal(|data| data.pelvis = "tail".into()),
        GaitError::NoJoint { .. }
    ));
    assert!(matches!(
        refusal(|data| data.strides.reverse()),
        GaitError::Motion { .. }
    ));
    assert!(matches!(
        refusal(|data| data.strides[0].speed = 0.0),
        GaitError::Motion { .. }
    ));
    assert!(matches!(
        refusal(|data| data.strides[0].right.0 = 0.05),
        GaitError::Motion { .. }
    ));
    assert!(matches!(
        refusal(|data| data.legs.as_mut().unwrap()[0].knee = "head".into()),
        GaitError::Leg(0)
    ));
    let text = ron::to_string(&person::gaits()).unwrap();
    assert_eq!(GaitData::from_ron(&text).unwrap(), person::gaits());
    assert!(matches!(
        GaitData::from_ron("(idel: \"x\")"),
        Err(GaitError::Syntax(_))
    ));
}
