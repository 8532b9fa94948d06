//! Numbers and crowds that nobody would choose.

use crate::support::{app, counters, faults, peak, play};
use bevy::prelude::*;
use dolomite_sound::{Loudness, PlaySound, SoundEmitter, SoundId, SoundSettings, Sounds, built_in};

fn sea() -> SoundEmitter {
    SoundEmitter {
        sound: built_in::SEA,
        ..default()
    }
}

#[test]
fn ten_thousand_emitters_and_messages_share_the_voices() {
    let mut app = app();
    for k in 0..10_000 {
        let place = Transform::from_xyz((k % 100) as f32 - 50.0, 0.0, (k / 100) as f32 - 50.0);
        app.world_mut().spawn((sea(), place));
    }
    for _ in 0..10_000 {
        app.world_mut()
            .write_message(PlaySound::at(built_in::SHOT, Vec3::X * 3.0));
    }
    let out = play(&mut app, 8);
    let counted = counters(&app);
    assert_eq!((counted.emitters, counted.voices), (10_000, 32));
    // And some of the shots that have not ended.
    assert!((10_000..=10_032).contains(&counted.audible), "{counted:?}");
    assert!(counted.crowded_out >= 9_968, "{counted:?}");
    assert!(peak(&out) <= 0.9701 && peak(&out) > 0.2);
    assert!(out.iter().flatten().all(|sample| sample.is_finite()));
    // Whoever is important is heard at once.
    let loudness = Loudness {
        priority: 250,
        volume: 0.05,
        ..default()
    };
    let before = counters(&app).played;
    app.world_mut()
        .write_message(PlaySound::at(built_in::CALL, Vec3::X * 30.0).with(loudness));
    play(&mut app, 2);
    assert_eq!(counters(&app).played, before + 1);
    // As few as are asked for, and never none or without end.
    for (asked, voices) in [(4, 4), (0, 1), (u32::MAX, 128)] {
        app.world_mut().resource_mut::<SoundSettings>().voices = asked;
        play(&mut app, 2);
        assert_eq!(counters(&app).voices, voices);
    }
}

/// Nobody takes turns: with nothing changed, the same are heard from frame to frame.
#[test]
fn voices_do_not_flicker() {
    let mut app = app();
    for k in 0..200 {
        let place = Transform::from_xyz(10.0 + 0.01 * (k % 10) as f32, 0.0, k as f32 * 0.02);
        app.world_mut().spawn((sea(), place));
    }
    play(&mut app, 10);
    let before = counters(&app).crowded_out;
    play(&mut app, 100);
    assert_eq!(counters(&app).crowded_out, before);
}

#[test]
fn what_is_no_number_is_refused_and_said() {
    let mut app = app();
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for number in bad {
        app.world_mut()
            .spawn((sea(), Transform::from_translation(Vec3::splat(number))));
        for field in 0..4 {
            let mut loudness = Loudness::default();
            *[
                &mut loudness.volume,
                &mut loudness.rate,
                &mut loudness.reference,
                &mut loudness.reach,
            ][field] = number;
            app.world_mut().spawn(SoundEmitter { loudness, ..sea() });
            app.world_mut()
                .write_message(PlaySound::new(built_in::SHOT).with(loudness));
        }
        app.world_mut()
            .write_message(PlaySound::at(built_in::SHOT, Vec3::new(0.0, number, 0.0)));
    }
    faults(&mut app);
    let out = play(&mut app, 1);
    assert_eq!(peak(&out), 0.0);
    let said = faults(&mut app);
    assert_eq!(said.len(), 2, "{said:?}");
    assert!(
        said[0].starts_with("15 of emitters") && said[1].starts_with("15 of messages"),
        "{said:?}"
    );
    assert_eq!((counters(&app).voices, counters(&app).refused), (0, 30));
    // And a listener that is nowhere.
    let mut app = crate::support::app();
    app.world_mut().spawn(SoundEmitter {
        everywhere: true,
        ..sea()
    });
    play(&mut app, 5);
    let mut ears = app
        .world_mut()
        .query_filtered::<&mut Transform, With<dolomite_sound::SoundListener>>();
    for number in bad {
        ears.single_mut(app.world_mut()).unwrap().translation = Vec3::splat(number);
        let out = play(&mut app, 5);
        assert!(out.iter().flatten().all(|sample| sample.is_finite()));
    }
}

/// Extremes that are numbers: they are brought into their ranges.
#[test]
fn extremes_are_played_within_their_ranges() {
    let mut app = app();
    for volume in [-1.0, 0.0, 1e30] {
        for rate in [-1.0, 0.0, 1e-30, 1e30] {
            for length in [-1.0, 0.0, 1e-30, 1e30] {
                let loudness = Loudness {
                    volume,
                    rate,
                    reference: length,
                    reach: length,
                    ..default()
                };
                app.world_mut().spawn(SoundEmitter { loudness, ..sea() });
                app.world_mut()
                    .write_message(PlaySound::new(built_in::HIT).with(loudness));
                app.world_mut().write_message(
                    PlaySound::at(built_in::HIT, Vec3::splat(f32::MAX)).with(loudness),
                );
            }
        }
    }
    let out = play(&mut app, 20);
    assert!(out.iter().flatten().all(|sample| sample.is_finite()) && peak(&out) <= 0.9701);
    assert!(faults(&mut app).is_empty());
}

#[test]
fn sounds_that_are_not_there_and_files_that_are_broken() {
    let mut app = app();
    app.world_mut().spawn(SoundEmitter {
        sound: SoundId(4711),
        ..default()
    });
    play(&mut app, 1);
    assert_eq!(
        faults(&mut app),
        ["there is no sound 4711; `Sounds::add` gives numbers"]
    );
    let mut sounds = app.world_mut().resource_mut::<Sounds>();
    let error = sounds.read("no/such.wav").unwrap_err().to_string();
    assert!(
        error.contains("no/such.wav") && error.contains("check the name"),
        "{error}"
    );
    let error = sounds
        .read(env!("CARGO_MANIFEST_PATH"))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("Cargo.toml") && error.contains("this is no WAV"),
        "{error}"
    );
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/shot.wav");
    let shot = sounds.read(path).unwrap();
    assert_eq!(sounds.find("shot"), Some(shot), "one's own comes first");
    assert!(sounds.get(shot, 0).unwrap().len() > 1000);
}
