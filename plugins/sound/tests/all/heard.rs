//! What comes out is what should be heard.

use crate::support::{FRAME, RATE, app, counters, loud, peak, play, steepest};
use bevy::prelude::*;
use dolomite_sound::{
    Bus, Loudness, PlaySound, Samples, SoundEmitter, SoundId, SoundListener, SoundSettings, Sounds,
    built_in, limiter, wind,
};

/// A tone of a second: 64 samples a wave.
fn tone(app: &mut App) -> SoundId {
    let wave = |k: usize| {
        let turns = (k % 64) as f32 / 64.0;
        bevy::math::ops::sin(std::f32::consts::TAU * turns)
    };
    let values: Vec<f32> = (0..RATE as usize / 64 * 64)
        .map(|k| 0.5 * wave(k))
        .collect();
    let samples = Samples::new(RATE, &values).expect("a tone");
    app.world_mut()
        .resource_mut::<Sounds>()
        .add("tone", vec![samples])
        .expect("one name")
}

fn far() -> Loudness {
    Loudness {
        reference: 5.0,
        reach: 2000.0,
        ..default()
    }
}

/// Whole frames after everything has faded in.
fn steady(app: &mut App) -> Vec<[f32; 2]> {
    play(app, 10);
    play(app, 20)
}

#[test]
fn a_sound_comes_from_its_side_and_as_loud_as_it_is_far() {
    let mut app = app();
    let sound = tone(&mut app);
    let emitter = SoundEmitter {
        sound,
        loudness: far(),
        everywhere: false,
    };
    let entity = app
        .world_mut()
        .spawn((emitter, Transform::from_xyz(0.0, 0.0, -5.0)))
        .id();
    let mut at = |place: Vec3| {
        app.world_mut()
            .entity_mut(entity)
            .get_mut::<Transform>()
            .unwrap()
            .translation = place;
        loud(&steady(&mut app))
    };
    let [left, right] = at(Vec3::NEG_Z * 5.0);
    // A tone of amplitude 0.5 has an RMS of 0.354; panned to the middle it is in both ears.
    assert!(
        (left - 0.3536).abs() < 0.004 && (left - right).abs() < 1e-4,
        "{left} {right}"
    );
    let [left, right] = at(Vec3::X * 5.0);
    // 11.6 dB between the ears.
    assert!((right / left - 3.79).abs() < 0.1, "{left} {right}");
    let [left, right] = at(Vec3::NEG_X * 5.0);
    assert!((left / right - 3.79).abs() < 0.1, "{left} {right}");
    let near = at(Vec3::NEG_Z * 20.0)[0];
    let twice = at(Vec3::NEG_Z * 40.0)[0];
    // Changes of less than a quarter of a decibel are not sent.
    assert!((twice / near - 0.5).abs() < 0.02, "{}", twice / near);
}

/// Turning the head turns what is heard, far from the origin as near it.
#[test]
fn the_listener_s_head_counts() {
    for origin in [Vec3::ZERO, Vec3::new(1.0e6, 300.0, -2.0e6)] {
        let mut app = app();
        let sound = tone(&mut app);
        let emitter = SoundEmitter {
            sound,
            loudness: far(),
            everywhere: false,
        };
        app.world_mut()
            .spawn((emitter, Transform::from_translation(origin + Vec3::X * 5.0)));
        let mut ears = app
            .world_mut()
            .query_filtered::<&mut Transform, With<SoundListener>>();
        // A quarter to the left: what was to the right is behind; to the back: it is to the left.
        for (turn, ratio) in [(0.0, 3.79), (0.25, 1.0), (0.5, 1.0 / 3.79)] {
            let mut ears = ears.single_mut(app.world_mut()).unwrap();
            *ears = Transform::from_translation(origin)
                .with_rotation(Quat::from_rotation_y(turn * std::f32::consts::TAU));
            let [left, right] = loud(&steady(&mut app));
            assert!(
                (right / left / ratio - 1.0).abs() < 0.05,
                "{origin} {turn}: {left} {right}"
            );
        }
    }
}

/// Sound takes its time: 343 m are a second.
#[test]
fn a_shot_is_heard_as_late_as_it_is_far() {
    for (distance, seconds) in [(1.0, 0.0029), (171.5, 0.5), (343.0, 1.0), (686.0, 2.0)] {
        let mut app = app();
        let loudness = Loudness {
            volume: 4.0,
            ..far()
        };
        let shot = PlaySound::at(built_in::SHOT, Vec3::NEG_Z * distance).with(loudness);
        app.world_mut().write_message(shot);
        let out = play(&mut app, 150);
        let most = peak(&out);
        let first = out
            .iter()
            .position(|pair| pair[0].abs() > 0.05 * most)
            .unwrap();
        let came = first as f32 / RATE as f32;
        // Kira begins sounds at the begin of 128 samples (2.9 ms), the limiter looks 1.5 ms ahead, and a string takes
        // some milliseconds to be loud.
        assert!(
            came >= seconds - 0.003 && came <= seconds + 0.012,
            "{distance} m: {came}"
        );
    }
    // Where sound is infinitely fast it is there at once.
    let mut app = app();
    app.world_mut()
        .resource_mut::<SoundSettings>()
        .speed_of_sound = 0.0;
    app.world_mut()
        .write_message(PlaySound::at(built_in::SHOT, Vec3::X * 600.0).with(far()));
    assert!(peak(&play(&mut app, 2)) > 0.0);
}

/// A loop goes on over its seam as it went on before: what is heard repeats to rounding, for a dozen rounds.
#[test]
fn loops_do_not_click() {
    for (sound, seconds) in [
        (built_in::WIND, 2.5),
        (built_in::SEA, 3.0),
        (built_in::FIRE, 1.2),
        (built_in::LIFT, 0.6),
    ] {
        let mut app = app();
        let emitter = SoundEmitter {
            sound,
            everywhere: true,
            ..default()
        };
        app.world_mut().spawn(emitter);
        play(&mut app, 12);
        let out = play(&mut app, 60 * 8);
        // A file of 11 025 Hz holds whole samples of 44 100 Hz: 0.6 s are 6615 of the first.
        let round = (seconds * RATE as f32) as usize / 4 * 4;
        let off = (0..out.len() - round)
            .map(|k| (out[k + round][0] - out[k][0]).abs())
            .fold(0.0, f32::max);
        println!(
            "{sound:?}: rounds differ by {off:e}, steepest step {}",
            steepest(&out)
        );
        assert!(peak(&out) > 0.3, "{}", peak(&out));
        assert!(off < 1e-4, "{sound:?}: {off}");
    }
}

#[test]
fn who_begins_moves_and_ends_does_not_click() {
    let mut app = app();
    let sound = tone(&mut app);
    // A tone of 689 Hz and amplitude 0.5 goes on by 0.049 in a sample at most; twice as much where two overlap.
    let emitter = SoundEmitter {
        sound,
        loudness: far(),
        everywhere: false,
    };
    let entity = app
        .world_mut()
        .spawn((emitter, Transform::from_xyz(3.0, 0.0, 0.0)))
        .id();
    let mut all = play(&mut app, 20);
    for k in 0..60 {
        let place = Vec3::new(3.0 - 0.1 * k as f32, 0.0, 0.0);
        app.world_mut()
            .entity_mut(entity)
            .get_mut::<Transform>()
            .unwrap()
            .translation = place;
        all.extend(play(&mut app, 1));
    }
    app.world_mut().despawn(entity);
    all.extend(play(&mut app, 20));
    assert!(peak(&all[all.len() - 4 * FRAME..]) < 1e-6, "it has ended");
    let step = steepest(&all);
    assert!(step < 0.07 * 1.42, "{step}");
    assert_eq!(counters(&app).voices, 0);
}

/// Everything at once, far louder than full scale: nothing is beyond it, and it is no rectangle either.
#[test]
fn nothing_is_beyond_full_scale() {
    let mut app = app();
    let mut out = Vec::new();
    let [low, high] = wind::emitters(30.0, Vec3::ZERO, 1.0);
    app.world_mut().spawn(low);
    app.world_mut().spawn(high);
    for k in 0..60 {
        let place = Vec3::new((k % 7) as f32 - 3.0, 0.0, (k % 5) as f32 - 2.0);
        let loudness = Loudness {
            volume: 4.0,
            ..far()
        };
        for sound in [built_in::SHOT, built_in::CALL, built_in::STEP_ROCK] {
            app.world_mut()
                .write_message(PlaySound::at(sound, place).with(loudness));
        }
        out.extend(play(&mut app, 1));
    }
    let most = peak(&out);
    assert!(most <= limiter::CEILING * 1.000_01, "{most}");
    assert!(most > 0.5, "{most}");
    let held = out
        .windows(2)
        .filter(|two| two[0][0] == two[1][0] && two[0][0].abs() > 0.9)
        .count();
    assert!(held < out.len() / 1000, "{held} samples stand at one value");
}

#[test]
fn a_pause_holds_everything_and_goes_on_where_it_was() {
    let mut app = app();
    app.world_mut().spawn(SoundEmitter {
        sound: built_in::LIFT,
        everywhere: true,
        ..default()
    });
    assert!(peak(&play(&mut app, 30)) > 0.3);
    app.world_mut().resource_mut::<Time<Virtual>>().pause();
    play(&mut app, 4);
    let frames = counters(&app).voices;
    // What is played in a pause is not heard later.
    app.world_mut()
        .write_message(PlaySound::new(built_in::SHOT));
    let rest = play(&mut app, 60);
    assert_eq!(peak(&rest), 0.0);
    assert_eq!((counters(&app).voices, frames), (1, 1));
    app.world_mut().resource_mut::<Time<Virtual>>().unpause();
    let again = play(&mut app, 30);
    assert!(peak(&again) > 0.3);
    assert_eq!(counters(&app).played, 0);
}

#[test]
fn volumes_are_those_of_the_settings() {
    let mut app = app();
    let sound = tone(&mut app);
    let emitter = |bus| SoundEmitter {
        sound,
        everywhere: true,
        loudness: Loudness { bus, ..far() },
    };
    app.world_mut().spawn(emitter(Bus::Effects));
    let mut with = |change: fn(&mut SoundSettings)| {
        change(&mut app.world_mut().resource_mut::<SoundSettings>());
        loud(&steady(&mut app))[0]
    };
    let whole = with(|_| {});
    let half = with(|settings| settings.volume = 0.5);
    assert!((half / whole - 0.5).abs() < 0.01, "{half} {whole}");
    let same = with(|settings| settings.ambience = 0.0);
    assert!((same / half - 1.0).abs() < 0.01);
    let quarter = with(|settings| settings.effects = 0.5);
    assert!((quarter / whole - 0.25).abs() < 0.01);
    assert_eq!(with(|settings| settings.volume = 0.0), 0.0);
    assert_eq!(with(|settings| settings.volume = f32::NAN), 0.0);
    let most = with(|settings| (settings.volume, settings.effects) = (9.0, f32::INFINITY));
    assert!((most / whole - 1.0).abs() < 0.01, "{most} {whole}");
}

/// Each kind of ground is another sound, and twice the same step is not the same.
#[test]
fn steps_differ_by_ground_and_from_step_to_step() {
    let step = |sound: SoundId, count: usize| {
        let mut app = app();
        let mut all = Vec::new();
        for _ in 0..count {
            app.world_mut().write_message(PlaySound::new(sound));
            all.push(play(&mut app, 24));
        }
        all
    };
    let grounds = [
        built_in::STEP_ROCK,
        built_in::STEP_GRASS,
        built_in::STEP_SAND,
        built_in::STEP_SNOW,
        built_in::STEP_ROAD,
        built_in::STEP_WATER,
    ];
    // How bright: crossings of zero in a second of what is loud.
    let bright = |samples: &[[f32; 2]]| {
        let most = peak(samples);
        let crossings = samples.windows(2).filter(|two| {
            (two[0][0] < 0.0) != (two[1][0] < 0.0) && (two[1][0] - two[0][0]).abs() > 0.02 * most
        });
        crossings.count()
    };
    let mut all = Vec::new();
    for ground in grounds {
        let steps = step(ground, 3);
        assert_ne!(steps[0], steps[1]);
        let out = steps[2].clone();
        println!(
            "{ground:?}: peak {:.2}, rms {:.3}, crossings {}",
            peak(&out),
            loud(&out)[0],
            bright(&out)
        );
        assert!(peak(&out) > 0.2);
        all.push(out);
    }
    for a in 0..all.len() {
        for b in 0..a {
            assert_ne!(all[a], all[b], "{a} {b}");
        }
    }
}
