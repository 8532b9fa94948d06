//! What is not there costs nothing.

use crate::support::{app, counters, deaf, faults, play};
use bevy::prelude::*;
use dolomite_sound::{
    PlaySound, SoundEmitter, SoundListener, SoundOutput, SoundPlugin, SoundSettings, SoundTarget,
    Sounds, built_in,
};

fn threads() -> Option<usize> {
    Some(std::fs::read_dir("/proc/self/task").ok()?.count())
}

fn is_open(app: &App) -> bool {
    app.world().contains_resource::<SoundOutput>()
}

#[test]
fn without_a_listener_nothing_is_opened_and_nothing_runs() {
    let mut app = deaf();
    app.update();
    let before = threads();
    for _ in 0..50 {
        app.world_mut().spawn(SoundEmitter::default());
        app.world_mut()
            .write_message(PlaySound::new(built_in::SHOT));
        app.update();
    }
    let counted = counters(&app);
    assert_eq!((counted.opened, counted.frames), (0, 0), "{counted:?}");
    assert!(!is_open(&app));
    // Not even the files that come with the crate are read.
    let sounds = app.world().resource::<Sounds>();
    assert!(sounds.get(built_in::WIND, 0).is_none());
    assert_eq!(threads(), before);
}

#[test]
fn off_closes_and_on_opens_again() {
    let mut app = app();
    let before = threads();
    app.world_mut().spawn(SoundEmitter {
        sound: built_in::WIND,
        everywhere: true,
        ..default()
    });
    assert!(crate::support::peak(&play(&mut app, 30)) > 0.1);
    assert_eq!(threads(), before, "samples have no thread");
    app.world_mut().resource_mut::<SoundSettings>().on = false;
    app.update();
    let off = counters(&app);
    assert!(!is_open(&app) && off.voices == 0);
    for _ in 0..20 {
        app.update();
    }
    assert_eq!(counters(&app).frames, off.frames, "no system runs");
    app.world_mut().resource_mut::<SoundSettings>().on = true;
    app.update();
    assert_eq!((counters(&app).opened, is_open(&app)), (2, true));
    // And without ears.
    let mut ears = app
        .world_mut()
        .query_filtered::<Entity, With<SoundListener>>();
    let ears = ears.single(app.world()).unwrap();
    app.world_mut().despawn(ears);
    app.update();
    assert!(!is_open(&app));
}

/// What a program without devices, or a machine without one, says: one line, once.
#[test]
fn no_device_is_said_once_and_the_app_goes_on() {
    let mut app = deaf();
    app.world_mut().resource_mut::<SoundSettings>().target = SoundTarget::Samples { rate: 1 };
    app.world_mut().spawn(SoundListener);
    let mut said = Vec::new();
    for _ in 0..20 {
        app.update();
        said.extend(faults(&mut app));
    }
    assert_eq!(
        said,
        ["a sample rate of 1 cannot be rendered; 8000 to 192000 can"]
    );
    assert_eq!((counters(&app).opened, counters(&app).frames), (0, 0));
    // Another target is another try, and so is off and on.
    app.world_mut().resource_mut::<SoundSettings>().target = SoundTarget::Samples { rate: 2 };
    app.update();
    assert_eq!(faults(&mut app).len(), 1);
    for on in [false, true] {
        app.world_mut().resource_mut::<SoundSettings>().on = on;
        app.update();
    }
    assert_eq!(faults(&mut app).len(), 1);
    #[cfg(not(feature = "device"))]
    {
        app.world_mut().resource_mut::<SoundSettings>().target = SoundTarget::Device;
        app.update();
        assert!(faults(&mut app)[0].contains("without the feature `device`"));
    }
}

#[test]
fn it_may_be_added_twice_and_before_bevy() {
    let mut app = App::new();
    app.add_plugins((SoundPlugin, SoundPlugin, MinimalPlugins, TransformPlugin));
    app.world_mut().resource_mut::<SoundSettings>().target = SoundTarget::Samples { rate: 8000 };
    app.world_mut().spawn(SoundListener);
    app.update();
    app.update();
    assert_eq!(counters(&app).opened, 1);
    assert_eq!(counters(&app).frames, 1 + u64::from(is_open(&app)));
}

/// Silent, far and unused emitters have no voice.
#[test]
fn what_is_not_heard_has_no_voice() {
    let mut app = app();
    let far = Transform::from_xyz(500.0, 0.0, 0.0);
    app.world_mut().spawn((
        SoundEmitter {
            sound: built_in::SEA,
            ..default()
        },
        far,
    ));
    let mut silent = SoundEmitter {
        sound: built_in::SEA,
        ..default()
    };
    silent.loudness.volume = 0.0;
    app.world_mut().spawn(silent);
    app.world_mut()
        .write_message(PlaySound::at(built_in::SHOT, Vec3::X * 300.0));
    let out = play(&mut app, 10);
    let counted = counters(&app);
    assert_eq!(
        (
            counted.emitters,
            counted.audible,
            counted.voices,
            counted.unheard
        ),
        (2, 0, 0, 1)
    );
    assert!(out.iter().flatten().all(|sample| *sample == 0.0));
}
