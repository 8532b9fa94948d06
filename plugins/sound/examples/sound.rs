//! Wind, surf to the right, and a shot every second, each farther away: heard with the feature `device`, else as the
//! loudness of what would be heard.
//!
//! `cargo run -p dolomite_sound --example sound --features device`

use bevy::prelude::*;
use dolomite_sound::{
    PlaySound, SoundEmitter, SoundListener, SoundOutput, SoundPlugin, SoundSettings, SoundTarget,
    built_in, wind,
};
use std::time::Duration;

fn main() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, SoundPlugin));
    let samples = !cfg!(feature = "device");
    if samples {
        app.world_mut().resource_mut::<SoundSettings>().target =
            SoundTarget::Samples { rate: 48_000 };
    }
    app.world_mut().spawn(SoundListener);
    for emitter in wind::emitters(9.0, Vec3::ZERO, 0.5) {
        app.world_mut().spawn(emitter);
    }
    let sea = SoundEmitter {
        sound: built_in::SEA,
        ..default()
    };
    app.world_mut()
        .spawn((sea, Transform::from_xyz(6.0, 0.0, 0.0)));
    for second in 0..6 {
        let place = Vec3::new(-20.0 * second as f32, 0.0, -5.0);
        app.world_mut()
            .write_message(PlaySound::at(built_in::SHOT, place));
        let mut squares = [0.0_f32; 2];
        for _ in 0..60 {
            app.update();
            let mut output = app.world_mut().get_resource_mut::<SoundOutput>();
            let frames = output.as_mut().and_then(|output| output.render(800));
            for pair in frames.unwrap_or_default() {
                squares = [
                    squares[0] + pair[0] * pair[0],
                    squares[1] + pair[1] * pair[1],
                ];
            }
            if !samples {
                std::thread::sleep(Duration::from_millis(16));
            }
        }
        let [left, right] = squares.map(|sum| (sum / 48_000.0).sqrt());
        println!(
            "second {second}: a shot {:.0} m away; left {left:.3}, right {right:.3}",
            place.length()
        );
    }
}
