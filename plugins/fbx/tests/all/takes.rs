//! Clips against their definitions, worked out here in f64: no stated error is below the true one.

use crate::support::held::{ROTATION, TRANSLATION, base, converted, hold, rotated, shares, turned};
use crate::support::takes::{CORNERS, CUBIC, Curve, Key, LINEAR, Node, STEP, STEP_NEXT, file};
use dolomite_fbx::check::Played;
use glam::{DAffine3, DQuat, DVec3};

/// A minute of many joints with few keys, which memory does not hold sample by sample.
#[test]
fn long_takes_of_few_keys() {
    for (joints, tail) in [(30, 0.0), (65, 0.0), (65, 0.37)] {
        let nodes: Vec<Node> = (0..joints)
            .map(|i: usize| Node {
                parent: i.checked_sub(1),
                vectors: vec![(TRANSLATION, [0.0, 0.1, 0.0])],
                ..Node::default()
            })
            .collect();
        // Each turns by up to 60 degrees and back within four seconds, without slopes at its keys; with a
        // tail none of them has its keys where another has them.
        let shift = |i: usize| tail * i as f64 / joints as f64;
        let points = |i: usize| -> Vec<(f64, f64)> {
            (0..=30)
                .map(|k| {
                    (
                        2.0 * f64::from(k) + shift(i),
                        if k % 2 == 0 {
                            0.0
                        } else {
                            60.0 / (1.0 + i as f64)
                        },
                    )
                })
                .collect()
        };
        let curves = (0..joints).map(|i| (i, ROTATION, i % 3, Curve::of(&points(i), CUBIC)));
        let text = file(&nodes, &[base(curves.collect())], (0.0, 60.0));
        let angle = |i: usize, time: f64| {
            let u = ((time - shift(i)) / 2.0).max(0.0);
            let (s, up) = (u.fract(), (u.floor() as i64) % 2 == 0);
            let s = s * s * (3.0 - 2.0 * s);
            60.0 / (1.0 + i as f64) * if up { s } else { 1.0 - s }
        };
        let made = hold(&text, (0.0, 60.0), 600, |time| {
            let mut world = DAffine3::IDENTITY;
            (0..joints)
                .map(|i| {
                    let mut degrees = DVec3::ZERO;
                    degrees[i % 3] = angle(i, time);
                    world = world * DAffine3::from_translation(DVec3::Y * 0.1) * rotated(degrees);
                    world
                })
                .collect()
        });
        assert_eq!(made.report.clips[0].seconds, 60.0);
    }
}

/// Two keys, any number of turns.
#[test]
fn spins_of_any_rate() {
    for (rate, seconds) in [
        (0.001, 100.0),
        (0.5, 3.0),
        (23.0, 10.0),
        (25.0, 10.0),
        (30.0, 10.0),
        (35.0, 10.0),
        (60.0, 10.0),
        (-47.3, 4.0),
        (1000.0, 2.0),
    ] {
        let curve = Curve::lines(&[(0.0, 0.0), (seconds, 360.0 * rate * seconds)]);
        let text = file(
            &[Node::default()],
            &[base(vec![(0, ROTATION, 2, curve)])],
            (0.0, seconds),
        );
        hold(&text, (0.0, seconds), 400, |time| {
            vec![rotated(DVec3::Z * (360.0 * rate * time))]
        });
    }
}

/// Two angles wind at once, which no straight way between rotations follows.
#[test]
fn angles_that_wind_together() {
    let span = (-3.0, 5.0);
    let line = |to: f64| Curve::lines(&[(-3.0, 0.0), (5.0, to)]);
    let text = file(
        &[Node::default()],
        &[base(vec![
            (0, ROTATION, 0, line(4000.0)),
            (0, ROTATION, 1, line(-1500.0)),
            (0, ROTATION, 2, line(300.0)),
        ])],
        span,
    );
    hold(&text, span, 2000, |time| {
        let share = (time + 3.0) / 8.0;
        vec![rotated(DVec3::new(4000.0, -1500.0, 300.0) * share)]
    });
}

/// Keys of a cubic that says more between two keys than at them.
#[test]
fn tangents_that_go_far() {
    let keys = [(0.0, 0.0), (2.0, 0.0)];
    let mut curve = Curve::of(&keys, CUBIC);
    curve.keys[0].slopes = [2000.0, 2000.0];
    let text = file(
        &[Node::default()],
        &[base(vec![(0, ROTATION, 1, curve)])],
        (0.0, 2.0),
    );
    hold(&text, (0.0, 2.0), 2000, |time| {
        let s = time / 2.0;
        let angle = 4000.0 * (s * s * s - 2.0 * s * s + s) + 4000.0 * (s * s * s - s * s);
        vec![rotated(DVec3::Y * angle)]
    });
}

/// Steps before and after keys.
#[test]
fn steps_of_both_kinds() {
    let points = [(0.0, 0.0), (0.7, 10.0), (1.3, 5.0), (2.0, 7.0)];
    for how in [STEP, STEP_NEXT] {
        let text = file(
            &[Node::default()],
            &[base(vec![(0, TRANSLATION, 0, Curve::of(&points, how))])],
            (0.0, 2.0),
        );
        hold(&text, (0.0, 2.0), 500, |time| {
            let at = points.iter().rposition(|point| point.0 <= time).unwrap();
            let at = (at + usize::from(how == STEP_NEXT)).min(3);
            vec![DAffine3::from_translation(DVec3::X * points[at].1)]
        });
    }
}

/// From a millisecond to hours, before 0 and after.
#[test]
fn takes_of_any_length() {
    for (begin, seconds) in [
        (0.0, 0.001),
        (5.0, 0.01),
        (-100.0, 0.03),
        (-2.0, 1.0),
        (0.0, 300.0),
        (0.0, 9000.0),
    ] {
        let span = (begin, begin + seconds);
        // Keys lie before and after the take too.
        let points: Vec<(f64, f64)> = (-1..=5)
            .map(|i| {
                (
                    begin + seconds * f64::from(i) / 4.0,
                    f64::from(i * i) * 20.0,
                )
            })
            .collect();
        let text = file(
            &[Node::default()],
            &[base(vec![
                (0, ROTATION, 0, Curve::lines(&points)),
                (0, ROTATION, 1, Curve::lines(&points)),
            ])],
            span,
        );
        let made = hold(&text, span, 300, |time| {
            let u = (time - begin) / seconds * 4.0;
            let i = u.floor().clamp(-1.0, 4.0);
            let angle = 20.0 * (i * i + (u - i) * (2.0 * i + 1.0));
            vec![rotated(DVec3::new(angle, angle, 0.0))]
        });
        let length = made.report.clips[0].seconds;
        assert!((length - seconds).abs() < 1e-6 * seconds, "{length}");
    }
}

/// What curves do beyond their keys.
#[test]
fn curves_go_on_as_they_say() {
    let span = (-4.0, 9.0);
    for letter in ['C', 'K', 'R', 'M', 'A'] {
        for count in [-1, 2] {
            let mut curve = Curve::lines(&[(0.0, 1.0), (1.0, 4.0), (2.0, 3.0)]);
            curve.beyond = [Some((letter, count)); 2];
            let text = file(
                &[Node::default()],
                &[base(vec![(0, TRANSLATION, 1, curve)])],
                span,
            );
            let inside = |t: f64| if t < 1.0 { 1.0 + 3.0 * t } else { 5.0 - t };
            hold(&text, span, 700, |time| {
                let past = if time < 0.0 { -time } else { time - 2.0 };
                let mut rounds = (past / 2.0).floor();
                let mut rest = past - 2.0 * rounds;
                if count > 0 && rounds >= f64::from(count) {
                    (rounds, rest) = (f64::from(count) - 1.0, 2.0);
                }
                let value = match (time < 0.0, time > 2.0, letter) {
                    (false, false, _) => inside(time),
                    (true, _, 'C') => 1.0,
                    (_, _, 'C') => 3.0,
                    (true, _, 'K') => 1.0 + 3.0 * time,
                    (_, _, 'K') => 3.0 - (time - 2.0),
                    (before, _, 'M') => {
                        let forth = (rounds as i64 % 2 == 0) == before;
                        inside(if forth { rest } else { 2.0 - rest })
                    }
                    (true, _, 'A') => inside(2.0 - rest) - 2.0 * (rounds + 1.0),
                    (_, _, 'A') => inside(rest) + 2.0 * (rounds + 1.0),
                    (true, ..) => inside(2.0 - rest),
                    _ => inside(rest),
                };
                vec![DAffine3::from_translation(DVec3::Y * value)]
            });
        }
    }
}

/// A clip of one pose is as long as its take.
#[test]
fn a_pose_lasts() {
    let curve = Curve::lines(&[(0.0, 90.0), (2.0, 90.0)]);
    let text = file(
        &[Node::default()],
        &[base(vec![(0, ROTATION, 1, curve)])],
        (0.0, 2.0),
    );
    let made = hold(&text, (0.0, 2.0), 5, |_| vec![rotated(DVec3::Y * 90.0)]);
    let times = made.model.clips[0].channels.iter().flat_map(|c| &c.times);
    assert_eq!(times.copied().fold(0.0, f32::max), 2.0);
}

/// A bake's three angles may go any way within a frame: that it is not followed is stated.
#[test]
fn what_bakes_do_within_frames_is_stated() {
    let frames = 20;
    // The same turning told in other angles at every other frame: 180 degrees more or less on all three.
    let flipped = |i: i32| f64::from(i % 2) * 180.0;
    let points = |start: f64, sign: f64| -> Vec<(f64, f64)> {
        (0..=frames)
            .map(|i| (f64::from(i) / 30.0, start + sign * flipped(i)))
            .collect()
    };
    let (x, z) = (points(10.0, 1.0), points(30.0, -1.0));
    let y: Vec<(f64, f64)> = (0..=frames)
        .map(|i| (f64::from(i) / 30.0, if i % 2 == 0 { 20.0 } else { 160.0 }))
        .collect();
    let seconds = f64::from(frames) / 30.0;
    let text = file(
        &[Node::default()],
        &[base(vec![
            (0, ROTATION, 0, Curve::lines(&x)),
            (0, ROTATION, 1, Curve::lines(&y)),
            (0, ROTATION, 2, Curve::lines(&z)),
        ])],
        (0.0, seconds),
    );
    let at = |points: &[(f64, f64)], time: f64| {
        let i = ((time * 30.0).floor() as usize).min(points.len() - 2);
        let share = time * 30.0 - i as f64;
        points[i].1 + (points[i + 1].1 - points[i].1) * share
    };
    let made = hold(&text, (0.0, seconds), 4000, |time| {
        vec![rotated(DVec3::new(
            at(&x, time),
            at(&y, time),
            at(&z, time),
        ))]
    });
    let clip = &made.report.clips[0];
    assert!(
        clip.error > 0.1 && clip.keyed_error <= made.report.bound,
        "{clip:?}"
    );
    assert_eq!(clip.unseen, 0.0, "{clip:?}");
}

/// Orders and rotations before and after a node's own.
#[test]
fn orders_and_rotations_around() {
    let line = |to: f64| Curve::lines(&[(0.0, 0.0), (1.0, to)]);
    let to = DVec3::new(70.0, -130.0, 200.0);
    let about = [
        DQuat::from_rotation_x,
        DQuat::from_rotation_y,
        DQuat::from_rotation_z,
    ];
    let orders = [
        [0, 1, 2],
        [0, 2, 1],
        [1, 2, 0],
        [1, 0, 2],
        [2, 0, 1],
        [2, 1, 0],
    ];
    for (number, order) in (0..).zip(orders) {
        let node = Node {
            vectors: vec![
                ("PreRotation", [10.0, 20.0, 30.0]),
                ("PostRotation", [-40.0, 5.0, 15.0]),
                ("RotationPivot", [0.5, -0.25, 1.0]),
            ],
            whole: vec![("RotationOrder", number), ("RotationActive", 1)],
            ..Node::default()
        };
        let curves = (0..3).map(|axis| (0, ROTATION, axis, line(to[axis])));
        let text = file(&[node], &[base(curves.collect())], (0.0, 1.0));
        hold(&text, (0.0, 1.0), 300, |time| {
            let own = order.iter().fold(DQuat::IDENTITY, |sum, &axis| {
                about[axis]((to[axis] * time).to_radians()) * sum
            });
            let all = turned(DVec3::new(10.0, 20.0, 30.0))
                * own
                * turned(DVec3::new(-40.0, 5.0, 15.0)).inverse();
            let pivot = DVec3::new(0.5, -0.25, 1.0);
            vec![
                DAffine3::from_translation(pivot)
                    * DAffine3::from_quat(all)
                    * DAffine3::from_translation(-pivot),
            ]
        });
    }
}

/// A key that the file has is a key of ours, whatever else is near: nothing of a curve is skipped.
#[test]
fn short_bumps_between_far_keys() {
    let key = |time: f64, value: f64| Key {
        time,
        value,
        how: LINEAR,
        slopes: [0.0; 2],
    };
    let keys = vec![
        key(0.0, 0.0),
        key(50.0, 0.0),
        key(50.004, 1.0),
        key(50.008, 0.0),
        key(100.0, 0.0),
    ];
    let curve = Curve {
        keys,
        ..Curve::default()
    };
    let text = file(
        &[Node::default()],
        &[base(vec![(0, TRANSLATION, 2, curve)])],
        (0.0, 100.0),
    );
    let made = converted(&text);
    let clip = &made.report.clips[0];
    let span = (50.0, 50.008);
    let played = Played::read(&made.to_glb().unwrap()).unwrap();
    let mut off = 0.0_f64;
    for share in shares(500) {
        let time = span.0 + (span.1 - span.0) * share;
        let height = 1.0 - (time - 50.004).abs() / 0.004;
        let (shapes, _) = played.at(Some(0), time);
        let (_, sources) = &made.sources()[&0];
        let corner = CORNERS[sources[0] as usize];
        off = off.max((shapes[0].points[0].z - corner[2] - height).abs());
    }
    // f32's steps there are 4 microseconds, a thousandth of the slope's metre.
    assert!(off <= clip.error + 1e-6, "{off:e} {clip:?}");
    assert!(off < 2e-3, "{off:e} {clip:?}");
}
