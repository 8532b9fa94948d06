//! What a frame takes, by emitters. The numbers of the README come from here: `cargo nextest run --release --run-ignored
//! all -p dolomite_sound cost --no-capture`.

use crate::support::{FRAME, app, counters};
use bevy::prelude::*;
use dolomite_sound::{SoundEmitter, SoundOutput, SoundSystems, built_in};
use std::time::{Duration, Instant};

/// When the systems of a frame began, and how long they took.
#[derive(Resource)]
struct Clock(Instant, Duration);

/// The least of all frames, microseconds: what others do on the machine is not in it.
fn least(times: &[Duration]) -> f64 {
    times.iter().min().map_or(0.0, Duration::as_secs_f64) * 1e6
}

/// Microseconds of the systems, and of rendering a frame of samples.
fn measure(emitters: usize, frames: usize) -> (f64, f64) {
    let mut app = app();
    app.insert_resource(Clock(Instant::now(), Duration::ZERO));
    app.add_systems(
        PostUpdate,
        (
            (|mut clock: ResMut<Clock>| clock.0 = Instant::now())
                .before(SoundSystems)
                .after(TransformSystems::Propagate),
            (|mut clock: ResMut<Clock>| clock.1 = clock.0.elapsed()).after(SoundSystems),
        ),
    );
    for k in 0..emitters {
        let angle = k as f32 * 0.7;
        let place = Vec3::new(
            bevy::math::ops::cos(angle),
            0.0,
            bevy::math::ops::sin(angle),
        ) * (5.0 + (k % 90) as f32);
        let sound = [built_in::SEA, built_in::FIRE, built_in::LIFT][k % 3];
        app.world_mut().spawn((
            SoundEmitter { sound, ..default() },
            Transform::from_translation(place),
        ));
    }
    let (mut systems, mut rendered) = (Vec::new(), Vec::new());
    for k in 0..frames {
        // Everybody moves.
        let mut places = app
            .world_mut()
            .query_filtered::<&mut Transform, With<SoundEmitter>>();
        for mut place in places.iter_mut(app.world_mut()) {
            place.translation.x += if k % 2 == 0 { 0.5 } else { -0.5 };
        }
        app.update();
        systems.push(app.world().resource::<Clock>().1);
        let begin = Instant::now();
        app.world_mut().resource_mut::<SoundOutput>().render(FRAME);
        rendered.push(begin.elapsed());
    }
    assert_eq!(counters(&app).voices as usize, emitters.min(32));
    (least(&systems), least(&rendered))
}

/// Work grows with emitters no faster than they do, and 1000 of them are a small part of a frame, unoptimised too.
#[test]
fn a_thousand_emitters_are_a_small_part_of_a_frame() {
    for emitters in [10, 100, 1000] {
        let (systems, rendered) = measure(emitters, 60);
        println!(
            "{emitters} emitters: systems {systems:.0} us, samples of a frame {rendered:.0} us"
        );
        // A hundredth of what would be seen as a slow frame, on a busy machine of two cores.
        assert!(systems < 8000.0, "{emitters}: {systems} us");
    }
}

#[test]
#[ignore = "a measurement; alone on the machine"]
fn measured() {
    for emitters in [0, 10, 100, 1000, 10_000] {
        let (systems, rendered) = measure(emitters, 600);
        println!(
            "{emitters} emitters: systems {systems:.1} us, samples of a frame {rendered:.1} us"
        );
    }
}
