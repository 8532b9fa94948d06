//! Blends in any order, masks, additive layers, and fades that are turned round.

use crate::support;

use bevy::math::{Affine3A, Quat, Vec3};
use dolomite_character::clip::oracle::{self, Transform64};
use dolomite_character::{
    Blender, Channel, Clip, ClipData, Fade, Interpolation, Layer, Mask, Pose, Sampler, Skeleton,
    Values, make_additive,
};
use support::Random;

fn layer(pose: &Pose, weight: f32) -> Layer<'_> {
    Layer {
        pose,
        weight,
        mask: None,
    }
}

fn wide(pose: &Pose) -> Vec<Transform64> {
    let each = |joint| {
        let local = pose.get(joint);
        Transform64 {
            translation: local.translation.to_array().map(f64::from),
            rotation: local.rotation.to_array().map(f64::from),
            scale: local.scale.to_array().map(f64::from),
        }
    };
    (0..pose.len()).map(each).collect()
}

fn random_pose(random: &mut Random, skeleton: &Skeleton) -> Pose {
    let mut pose = skeleton.rest().clone();
    for joint in 0..skeleton.len() {
        // As far from rest as it goes: rest is no help in the choice of signs.
        let mut local = pose.get(joint);
        local.rotation *= random.rotation(std::f32::consts::PI);
        local.translation += Vec3::new(random.range(-0.1, 0.1), 0.0, 0.1);
        // The same rotation, the other sign.
        if random.unit() < 0.5 {
            local.rotation = -local.rotation;
        }
        pose.set(joint, local);
    }
    pose
}

/// Poses within a right angle of one another, as clips of one skeleton are.
fn near(random: &mut Random, pose: &Pose) -> Pose {
    let mut near = pose.clone();
    for joint in 0..pose.len() {
        let sign = if random.unit() < 0.5 { -1.0 } else { 1.0 };
        let turned = pose.get(joint).rotation * random.rotation(1.0);
        near.set_rotation(joint, turned * sign);
    }
    near
}

#[test]
fn the_order_of_inputs_changes_no_bit() {
    let mut random = Random::new(11);
    let mut blender = Blender::new();
    let skeleton = support::skeleton(&mut random);
    let (mut error, mut fold_error) = (0.0_f64, 0.0_f64);
    for round in 0..300 {
        let count = 3 + round % 5;
        let base = random_pose(&mut random, &skeleton);
        // Every third round anything goes.
        let poses: Vec<Pose> = (0..count)
            .map(|_| match round % 3 {
                0 => random_pose(&mut random, &skeleton),
                _ => near(&mut random, &base),
            })
            .collect();
        let mut weights: Vec<f32> = (0..count).map(|_| random.range(0.05, 1.0)).collect();
        if round % 4 == 0 {
            weights.fill(0.25);
        }
        let mut layers: Vec<Layer> = poses
            .iter()
            .zip(&weights)
            .map(|(p, w)| layer(p, *w))
            .collect();
        let mut first = Pose::default();
        blender.blend(skeleton.rest(), &layers, &mut first);
        let truth = oracle::blend(
            &poses
                .iter()
                .zip(&weights)
                .map(|(p, w)| (wide(p), f64::from(*w)))
                .collect::<Vec<_>>(),
        );
        let mut folds: Vec<Vec<Quat>> = Vec::new();
        for _ in 0..6 {
            for index in (1..layers.len()).rev() {
                layers.swap(index, random.below(index + 1));
            }
            let mut other = Pose::default();
            blender.blend(skeleton.rest(), &layers, &mut other);
            assert_eq!(first, other);
            folds.push(fold(&layers, skeleton.len()));
        }
        if round % 3 != 0 && round % 4 != 0 {
            for joint in 0..skeleton.len() {
                let got = first.get(joint).rotation.to_array().map(f64::from);
                error = error.max(oracle::angle(got, truth[joint].rotation));
                for fold in &folds {
                    let [a, b] =
                        [folds[0][joint], fold[joint]].map(|q| q.to_array().map(f64::from));
                    fold_error = fold_error.max(oracle::angle(a, b));
                }
            }
        }
    }
    eprintln!(
        "blend: {error:.2e} rad from f64; a fold of slerps: {fold_error:.2e} rad between orders"
    );
    assert!(error < 1e-5, "{error:e} rad");
    // The running fold that this replaces does depend on the order, so this test can fail.
    assert!(fold_error > 1e-2, "{fold_error:e} rad");
}

/// A running fold of spherical interpolations.
fn fold(layers: &[Layer], joints: usize) -> Vec<Quat> {
    (0..joints)
        .map(|joint| {
            let (mut total, mut sum) = (0.0, Quat::IDENTITY);
            for layer in layers {
                total += layer.weight;
                sum = sum.slerp(layer.pose.get(joint).rotation, layer.weight / total);
            }
            sum
        })
        .collect()
}

#[test]
fn one_input_is_itself_and_none_is_rest() {
    let mut random = Random::new(12);
    let skeleton = support::skeleton(&mut random);
    let pose = random_pose(&mut random, &skeleton);
    let (mut blender, mut out) = (Blender::new(), Pose::default());
    blender.blend(skeleton.rest(), &[layer(&pose, 0.3)], &mut out);
    for joint in 0..skeleton.len() {
        let (a, b) = (out.get(joint), pose.get(joint));
        assert!(a.translation.distance(b.translation) < 1e-6);
        let angle = oracle::angle(
            a.rotation.to_array().map(f64::from),
            b.rotation.to_array().map(f64::from),
        );
        assert!(angle < 1e-6, "{angle}");
    }
    for weight in [0.0, -1.0, f32::NAN] {
        blender.blend(skeleton.rest(), &[layer(&pose, weight)], &mut out);
        assert_eq!(&out, skeleton.rest());
    }
}

#[test]
fn masks_and_additive_layers() {
    let mut random = Random::new(13);
    let skeleton = support::skeleton(&mut random);
    let [a, b] = [(); 2].map(|()| random_pose(&mut random, &skeleton));
    let (mut blender, mut out) = (Blender::new(), Pose::default());
    let branch = Mask::branch(&skeleton, 5);
    let others = branch.inverted();
    let masked = |pose, mask| Layer {
        pose,
        weight: 1.0,
        mask: Some(mask),
    };
    blender.blend(
        skeleton.rest(),
        &[masked(&a, &branch), masked(&b, &others)],
        &mut out,
    );
    for joint in 0..skeleton.len() {
        let source = if skeleton.is_below(joint, 5) { &a } else { &b };
        let same = out
            .get(joint)
            .translation
            .distance(source.get(joint).translation);
        assert!(same < 1e-6, "joint {joint}: {same}");
    }
    // A pose that differs from b as a does, laid on b, is a; half of it lies between.
    let mut additive = Pose::default();
    make_additive(&a, &b, &mut additive);
    let mut sum = b.clone();
    blender.add(&[layer(&additive, 1.0)], &mut sum);
    let mut half = b.clone();
    blender.add(&[layer(&additive, 0.25), layer(&additive, 0.25)], &mut half);
    for joint in 0..skeleton.len() {
        let [a, b, sum, half] = [&a, &b, &sum, &half].map(|pose| pose.get(joint));
        let angle = |p: Quat, q: Quat| {
            oracle::angle(p.to_array().map(f64::from), q.to_array().map(f64::from))
        };
        assert!(angle(a.rotation, sum.rotation) < 2e-6);
        assert!((angle(b.rotation, half.rotation) - angle(a.rotation, half.rotation)).abs() < 5e-3);
        assert!(sum.translation.distance(a.translation) < 1e-6);
        assert!(
            half.translation
                .distance(b.translation.midpoint(a.translation))
                < 1e-6
        );
    }
    let mut nothing = b.clone();
    blender.add(&[layer(&additive, 0.0)], &mut nothing);
    assert_eq!(nothing, b);
}

/// A smooth clip: every joint swings, the pace and the way differ from clip to clip.
fn swing(skeleton: &Skeleton, rate: f32, reach: f32) -> Clip {
    // Splines through exact values and slopes of a sine: no kinks of their own.
    let times: Vec<f32> = (0..=160).map(|key| key as f32 / 40.0).collect();
    let channels = (0..skeleton.len()).map(|joint| {
        let phase = joint as f32 * 0.7;
        let values = times.iter().flat_map(|time| {
            let (sin, cos) = bevy::math::ops::sin_cos(time * rate + phase);
            let slope = rate * cos * reach;
            [
                [0.0, slope, 0.0],
                [0.0, 0.1 + reach * sin, 0.0],
                [0.0, slope, 0.0],
            ]
        });
        Channel {
            joint,
            times: times.clone(),
            interpolation: Interpolation::Cubic,
            values: Values::Translation(values.collect()),
        }
    });
    let data = ClipData {
        name: "swing".into(),
        channels: channels.collect(),
    };
    Clip::new(skeleton, &data).expect("made as clips have to be")
}

/// Greatest acceleration of any joint, m/s², while a fade from a to b is turned round after `turn`
/// seconds, in steps of `dt`.
fn acceleration(skeleton: &Skeleton, clips: &[Clip; 2], dt: f64, smooth: bool) -> f64 {
    let (mut sampler, mut blender) = (Sampler::new(), Blender::new());
    let (mut poses, mut out) = ([Pose::default(), Pose::default()], Pose::default());
    let mut fade = Fade::new(0);
    let mut linear = 0.0_f32;
    let (mut history, mut model): (Vec<Vec<Vec3>>, Vec<Affine3A>) = (Vec::new(), Vec::new());
    let frames = (1.2 / dt) as usize;
    for frame in 0..frames {
        let time = frame as f64 * dt;
        if (time - 0.3).abs() < dt / 2.0 {
            fade.go(1, 0.4);
        }
        if (time - 0.5).abs() < dt / 2.0 {
            fade.go(0, 0.4);
        }
        linear += match time {
            t if t < 0.3 => 0.0,
            t if t < 0.5 => dt as f32 / 0.4,
            _ => -dt as f32 / 0.4,
        };
        linear = linear.clamp(0.0, 1.0);
        let weight = if smooth { fade.weight(1) } else { linear };
        for (pose, clip) in poses.iter_mut().zip(clips) {
            sampler.sample(clip, time as f32, pose);
        }
        let layers = [layer(&poses[0], 1.0 - weight), layer(&poses[1], weight)];
        blender.blend(skeleton.rest(), &layers, &mut out);
        skeleton.local_to_model(&out, &mut model);
        history.push(model.iter().map(|joint| joint.translation.into()).collect());
        fade.advance(dt as f32);
    }
    let mut most = 0.0_f64;
    for three in history.windows(3) {
        for ((a, b), c) in three[0].iter().zip(&three[1]).zip(&three[2]) {
            let change = a.as_dvec3() - b.as_dvec3() * 2.0 + c.as_dvec3();
            most = most.max(change.length() / (dt * dt));
        }
    }
    most
}

#[test]
fn a_fade_that_is_turned_round_does_not_jerk() {
    let mut random = Random::new(14);
    let skeleton = support::skeleton(&mut random);
    let clips = [swing(&skeleton, 4.0, 0.02), swing(&skeleton, 5.0, -0.05)];
    let [coarse, fine] =
        [200.0, 800.0].map(|rate| acceleration(&skeleton, &clips, 1.0 / rate, true));
    let [kink, finer_kink] =
        [200.0, 800.0].map(|rate| acceleration(&skeleton, &clips, 1.0 / rate, false));
    eprintln!(
        "acceleration: {coarse:.1}, {fine:.1} m/s²; of straight weights {kink:.1}, {finer_kink:.1}"
    );
    // A bounded acceleration is the same however fine the steps (rounding of positions adds some
    // 3e-7 m · 800² = 0.2 m/s² to it); at a kink it grows as they shrink.
    assert!(fine < coarse * 1.05 + 0.3, "{coarse} then {fine}");
    assert!(finer_kink > kink * 2.0, "{kink} then {finer_kink}");
}
