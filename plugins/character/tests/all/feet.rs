//! Feet on slopes: they stand where they stand, on the ground, and the legs reach.

#![expect(
    clippy::disallowed_methods,
    reason = "the ground and the way over it, in f64"
)]

use crate::support;
use crate::support::walk;

use bevy::math::{DVec2, DVec3, Quat, Vec3};
use dolomite_character::feet::{Footing, Place};
use dolomite_character::gait::Motion;
use dolomite_character::{FigureState, Input, Pose, Workspace};
use support::person;
use walk::{Seen, Walk, plane};

#[test]
fn feet_do_not_slide_on_slopes_to_30_degrees() {
    let figure = person::figure();
    let mut worst = Seen::default();
    for degrees in [0.0, 10.0, 20.0, 30.0] {
        for direction in [0.0, 0.8, 1.6, 2.4, 3.1] {
            let ground = plane(degrees, direction);
            // From slow steps over the walk's own pace to a run.
            for speed in [0.4, 0.8, 1.1, 1.6, 2.4, 3.0] {
                let mut walk = Walk::new(&figure, &ground);
                // The first second it gathers speed.
                walk.watch(1.0, speed, 0.0);
                let seen = walk.watch(4.0, speed, 0.0);
                assert!(seen.contacts > 8, "{seen:?}");
                worst.take(&seen);
            }
        }
    }
    eprintln!("slopes: {worst:?}");
    // The bound is 1 cm. What is left is that this test changes from heel to ball a millimetre
    // later than the planting does.
    assert!(
        worst.slide <= 2e-3 && worst.below <= 1e-3 && worst.above <= 2e-3,
        "{worst:?}"
    );
}

#[test]
fn without_planting_they_do_slide() {
    // So the test above can fail: the same clips at a pace that is not theirs, on a slope.
    let figure = person::figure();
    let ground = plane(20.0, 0.3);
    let mut walk = Walk::new(&figure, &ground);
    walk.planted = false;
    walk.watch(1.0, 0.8, 0.0);
    let seen = walk.watch(4.0, 0.8, 0.0);
    assert!(seen.slide > 0.02 && seen.below > 0.05, "{seen:?}");
}

/// Hills of 1.2 m, 9 m from top to top: slopes to 40°.
fn hills(xz: DVec2) -> Footing {
    let (rate, high) = (std::f64::consts::TAU / 9.0, 0.6);
    let (a, b) = (xz * rate).into();
    Footing {
        height: high * (a.sin() + b.cos()),
        gradient: DVec2::new(a.cos(), -b.sin()) * high * rate,
    }
}

#[test]
fn over_hills_round_corners_and_from_pace_to_pace() {
    let figure = person::figure();
    let mut walk = Walk::new(&figure, &hills);
    let mut worst = Seen::default();
    for (speed, turn) in [
        (1.1, 0.0),
        (1.1, 0.7),
        (2.5, -0.8),
        (0.6, 0.4),
        (3.0, 0.0),
        (0.0, 0.0),
        (1.5, 0.3),
    ] {
        worst.take(&walk.watch(4.0, speed, turn));
    }
    eprintln!("hills: {worst:?}");
    // Curved ground under a sole of 19 cm: what heel and ball have between them is not a plane. A sole
    // that lies on the tangent under the ankle is off by c d²/2 = 0.29 · 0.13²/2 = 2.5 mm at the ball.
    assert!(
        worst.slide <= 0.01 && worst.below <= 5e-3 && worst.above <= 5e-3,
        "{worst:?}"
    );
}

#[test]
fn who_comes_to_rest_stands_as_the_clip_does() {
    let figure = person::figure();
    let ground = plane(15.0, 1.0);
    let mut walk = Walk::new(&figure, &ground);
    walk.watch(1.37, 1.1, 0.0);
    walk.watch(3.0, 0.0, 0.0);
    let turned = walk.watch(0.6, 0.0, 1.4);
    let rest = walk.watch(3.0, 0.0, 0.0);
    assert!(
        turned.slide <= 0.01 && rest.slide <= 0.01,
        "{turned:?} {rest:?}"
    );
    let settings = &figure.feet;
    for side in 0..2 {
        let [heel, _] = walk.sole(side);
        let back = walk.place().rotation.inverse() * (heel - walk.position).as_vec3();
        // 0.09 m to the side; the tilt moves a point of the sole by less than a centimetre.
        let away = (back.x.abs() - 0.09).abs();
        assert!(away < settings.step_from + 0.02, "side {side}: {back}");
    }
}

#[test]
fn nothing_jumps() {
    let figure = person::figure();
    let mut walk = Walk::new(&figure, &hills);
    let mut before: Option<Vec<Vec3>> = None;
    let mut most = 0.0_f32;
    for frame in 0..1200 {
        // Start, stop, run and turn round in the middle of a fade.
        let speed = [0.0, 1.1, 3.0, 0.5, 2.0, 0.0][frame / 37 % 6];
        let turn = [0.0, 0.8, -0.8][frame / 61 % 3];
        walk.frame(speed, turn);
        let now: Vec<Vec3> = walk
            .model
            .iter()
            .map(|joint| joint.translation.into())
            .collect();
        if let Some(before) = before {
            for (now, before) in now.iter().zip(&before) {
                most = most.max(now.distance(*before));
            }
        }
        before = Some(now);
    }
    eprintln!("greatest way of a joint in a frame: {most:.3} m");
    // A foot that swings through 1.9 m in 0.41 s of a run has 7.0 m/s on the average, by a cubic 1.5 times
    // as much at most: 0.17 m in a sixtieth of a second.
    assert!(most < 0.19, "{most} m");
}

#[test]
fn no_answer_no_time_no_place() {
    let figure = person::figure();
    let (mut state, mut work) = (FigureState::default(), Workspace::default());
    let (mut pose, mut model) = (Pose::default(), Vec::new());
    let mut nothing = |_: DVec2| None;
    let mut steep = |_: DVec2| {
        Some(Footing {
            height: 1e9,
            gradient: DVec2::new(f64::NAN, 1e30),
        })
    };
    for dt in [0.0, f32::NAN, -1.0, 1e9, 1.0 / 60.0] {
        for x in [0.0, f64::NAN, 1e12] {
            let input = Input {
                dt,
                motion: Motion {
                    speed: dt,
                    turn_rate: f32::INFINITY,
                    climb: f32::NAN,
                    ..Default::default()
                },
                place: Place {
                    position: DVec3::new(x, 0.0, 0.0),
                    rotation: Quat::IDENTITY,
                },
            };
            for ground in [
                None,
                Some(&mut nothing as &mut dyn FnMut(DVec2) -> _),
                Some(&mut steep),
            ] {
                figure.advance(&mut state, &input, &mut work);
                figure.pose(&mut state, &input, ground, &mut work, &mut pose, &mut model);
                let finite = model.iter().all(|joint| joint.is_finite());
                assert!(finite, "{dt} {x}");
            }
        }
    }
}
