//! Layers, and what hangs on other properties, against their definitions.

use crate::support::held::{
    ROTATION, SCALE, TRANSLATION, base, converted, hold, off, rotated, turned,
};
use crate::support::takes::{Curve, Layer, Node, file};
use dolomite_fbx::Origin;
use dolomite_fbx::check::{Played, Truth};
use glam::{DAffine3, DQuat, DVec3};

/// A property may take its value from another node's.
#[test]
fn what_hangs_on_another_property_moves_as_it() {
    let points = [(0.0, 0.0), (0.5, 40.0), (1.0, -25.0)];
    let rest = Node {
        vectors: vec![(ROTATION, [0.0; 3])],
        ..Node::default()
    };
    let text = file(
        &[rest.clone(), rest],
        &[base(vec![(0, ROTATION, 1, Curve::lines(&points))])],
        (0.0, 1.0),
    );
    let connections = "Connections:  {\n";
    let hangs = format!("{connections}\tC: \"PP\",1000, \"{ROTATION}\",1001, \"{ROTATION}\"\n");
    let text = text.replace(connections, &hangs);
    let made = hold(&text, (0.0, 1.0), 500, |time| {
        let angle = match time < 0.5 {
            true => 80.0 * time,
            false => 40.0 - 130.0 * (time - 0.5),
        };
        vec![rotated(DVec3::Y * angle); 2]
    });
    assert_eq!(made.report.clips[0].unseen, 0.0);
}

/// Layers: what plays, and how it comes together.
#[test]
fn layers_come_together() {
    let line = |to: f64| Curve::lines(&[(0.0, 0.0), (1.0, to)]);
    let first = || {
        base(vec![
            (0, TRANSLATION, 0, line(4.0)),
            (0, ROTATION, 2, line(80.0)),
            (0, SCALE, 0, Curve::lines(&[(0.0, 1.0), (1.0, 4.0)])),
        ])
    };
    let second = |settings: &[(&'static str, f64)]| Layer {
        settings: settings.to_vec(),
        curves: vec![
            (0, TRANSLATION, 0, Curve::lines(&[(0.0, 1.0), (1.0, 3.0)])),
            (0, ROTATION, 0, line(60.0)),
            (0, SCALE, 0, Curve::lines(&[(0.0, 2.0), (1.0, 2.0)])),
        ],
        weight: None,
    };
    // Translation along X, rotation and scale along X at a time, of the first layer and the second.
    let below = |t: f64| (4.0 * t, DVec3::Z * (80.0 * t), 1.0 + 3.0 * t);
    let above = |t: f64| (1.0 + 2.0 * t, DVec3::X * (60.0 * t), 2.0_f64);
    type Pose = (f64, DQuat, f64);
    let added = |t: f64, w: f64, whole: bool, multiplied: bool| -> Pose {
        let (a, b) = (below(t), above(t));
        let turn = match whole {
            true => turned(a.1) * DQuat::IDENTITY.slerp(turned(b.1), w),
            false => turned(a.1 + b.1 * w),
        };
        let scale = match multiplied {
            true => a.2 * power(b.2, w),
            false => a.2 + b.2 * w,
        };
        (a.0 + b.0 * w, turn, scale)
    };
    let through = |t: f64, w: f64| -> Pose {
        let (a, b) = (below(t), above(t));
        (
            a.0 * (1.0 - w) + b.0 * w,
            turned(a.1).slerp(turned(b.1), w),
            power(a.2, 1.0 - w) * power(b.2, w),
        )
    };
    let alone = |(t, r, s): (f64, DVec3, f64)| -> Pose { (t, turned(r), s) };
    let keyed = || Curve::lines(&[(0.0, 0.0), (1.0, 100.0)]);
    type Case<'a> = (&'a str, Vec<Layer>, Box<dyn Fn(f64) -> Pose + 'a>);
    let with_weight = |mut layer: Layer, lies_in: usize| {
        layer.weight = Some((keyed(), lies_in));
        layer
    };
    let muted_first = Layer {
        settings: vec![("Mute", 1.0)],
        ..first()
    };
    let cases: Vec<Case> = vec![
        (
            "muted",
            vec![first(), second(&[("Mute", 1.0)])],
            Box::new(|t| alone(below(t))),
        ),
        (
            "solo",
            vec![first(), second(&[("Solo", 1.0)])],
            Box::new(|t| {
                let b = above(t);
                // Added to the file's rest.
                (b.0, turned(b.1), b.2)
            }),
        ),
        (
            "first muted",
            vec![muted_first, second(&[("BlendMode", 1.0)])],
            Box::new(|t| alone(above(t))),
        ),
        (
            "added",
            vec![first(), second(&[])],
            Box::new(|t| added(t, 1.0, true, true)),
        ),
        (
            "half added",
            vec![first(), second(&[("Weight", 50.0)])],
            Box::new(|t| added(t, 0.5, true, true)),
        ),
        (
            "by channel",
            vec![
                first(),
                second(&[("Weight", 25.0), ("RotationAccumulationMode", 1.0)]),
            ],
            Box::new(|t| added(t, 0.25, false, true)),
        ),
        (
            "scales added",
            vec![
                first(),
                second(&[("Weight", 25.0), ("ScaleAccumulationMode", 1.0)]),
            ],
            Box::new(|t| added(t, 0.25, true, false)),
        ),
        (
            "override",
            vec![first(), second(&[("BlendMode", 1.0)])],
            Box::new(|t| alone(above(t))),
        ),
        (
            "through",
            vec![first(), second(&[("BlendMode", 2.0), ("Weight", 30.0)])],
            Box::new(|t| through(t, 0.3)),
        ),
        (
            "keyed weight",
            vec![first(), with_weight(second(&[("Weight", 100.0)]), 1)],
            Box::new(|t| added(t, t, true, true)),
        ),
        (
            "weight keyed in the first layer",
            vec![first(), with_weight(second(&[("BlendMode", 2.0)]), 0)],
            Box::new(|t| through(t, t)),
        ),
    ];
    for (name, layers, pose) in cases {
        let text = file(&[Node::default()], &layers, (0.0, 1.0));
        let made = converted(&text);
        let off = off(&made, (0.0, 1.0), 200, |time| {
            let (x, turn, scale) = pose(time);
            vec![DAffine3::from_scale_rotation_translation(
                DVec3::new(scale, 1.0, 1.0) + side(name),
                turn,
                DVec3::X * x,
            )]
        });
        // What checks hold results against knows the same layers.
        let truth = Truth::load(text.as_bytes(), &Origin::default()).unwrap();
        let (_, sources) = &made.sources()[&0];
        let played = Played::read(&made.to_glb().unwrap()).unwrap();
        for time in [0.0, 0.4, 1.0] {
            let (shapes, _) = played.at(Some(0), time);
            let (bodies, _) = truth.at(Some(0), time).unwrap();
            for (point, &source) in shapes[0].points.iter().zip(sources) {
                let wanted = truth.space().to_gltf(bodies[0].points[source as usize]);
                assert!((*point - wanted).length() < 1e-4, "{name} at {time}");
            }
        }
        let clip = &made.report.clips[0];
        assert!(off <= clip.error + 1e-6, "{name}: {off:e} m off, {clip:?}");
        assert!(clip.error <= made.report.bound, "{name}: {clip:?}");
        assert!(
            made.report.lost.is_empty(),
            "{name}: {:?}",
            made.report.lost
        );
    }
}

fn power(x: f64, exponent: f64) -> f64 {
    DVec3::splat(x).powf(exponent).x
}

/// What scales along Y and Z are beyond 1: the second layer has 1 there, which adds where scales are added.
fn side(name: &str) -> DVec3 {
    match name {
        "scales added" => DVec3::new(0.0, 0.25, 0.25),
        _ => DVec3::ZERO,
    }
}

/// What a file leaves open has a line of its own, with how much it comes to.
#[test]
fn what_layers_leave_open_is_said() {
    let first = base(vec![(
        0,
        TRANSLATION,
        0,
        Curve::lines(&[(0.0, 0.0), (1.0, 4.0)]),
    )]);
    for (settings, metres) in [
        // Whole or lessened: 2 or (4 t + 2) / 2, which are furthest apart at 1 s.
        (vec![("BlendMode", 1.0), ("Weight", 50.0)], 1.0),
        // Overriding or added: 2 or 4 t + 2.
        (vec![("BlendMode", 7.0)], 4.0),
    ] {
        let second = Layer {
            settings,
            curves: vec![(0, TRANSLATION, 0, Curve::lines(&[(0.0, 2.0), (1.0, 2.0)]))],
            weight: None,
        };
        let text = file(&[Node::default()], &[first.clone(), second], (0.0, 1.0));
        let made = hold(&text, (0.0, 1.0), 20, |_| {
            vec![DAffine3::from_translation(DVec3::X * 2.0)]
        });
        let lost = &made.report.lost;
        assert_eq!(lost.len(), 1, "{lost:?}");
        assert_eq!(lost[0].what, "layer");
        let said = lost[0].metres.unwrap();
        assert!((said - metres).abs() < 0.05 * metres, "{lost:?}");
    }
}
