//! Sampling and model matrices against f64.

use crate::support;

use dolomite_character::clip::oracle;
use dolomite_character::{Clip, ClipData, Pose, Sampler, Skeleton};
use support::Random;

/// Greatest distance of a joint from where it should be, metres, and greatest angle, radians.
fn worst(skeleton: &Skeleton, clip: &Clip, data: &ClipData, times: &[f32]) -> (f64, f64) {
    let (mut sampler, mut pose, mut model) = (Sampler::new(), Pose::default(), Vec::new());
    let (mut distance, mut angle) = (0.0_f64, 0.0_f64);
    for time in times {
        sampler.sample(clip, *time, &mut pose);
        skeleton.local_to_model(&pose, &mut model);
        let truth = oracle::sample(skeleton, data, f64::from(*time));
        let matrices = oracle::local_to_model(skeleton, &truth);
        for (joint, matrix) in matrices.iter().enumerate() {
            let at = model[joint].translation.to_array().map(f64::from);
            let off = |row: usize| at[row] - matrix[row][3];
            let square: f64 = (0..3).map(|row| off(row) * off(row)).sum();
            distance = distance.max(square.sqrt());
            let local = pose.get(joint).rotation.to_array().map(f64::from);
            angle = angle.max(oracle::angle(local, truth[joint].rotation));
        }
    }
    (distance, angle)
}

fn random_times(random: &mut Random, clip: &Clip, count: usize) -> Vec<f32> {
    (0..count)
        .map(|_| random.range(-0.1, clip.duration() + 0.1))
        .collect()
}

/// The bound of the issue, metres; f32 has 1.2e-7 m at 2 m, and a chain adds some ten of them.
const METRES: f64 = 1e-5;

#[test]
fn joints_of_the_knight_are_where_they_should_be() {
    let Some(rig) = support::knight() else { return };
    assert_eq!((rig.clips.len(), rig.skins[0].joints.len()), (76, 41));
    let mut random = Random::new(1);
    let (mut distance, mut angle) = (0.0_f64, 0.0_f64);
    // 132 moments of each of 76 clips: 10 032.
    for (clip, data) in rig.clips.iter().zip(&rig.sources) {
        let times = random_times(&mut random, clip, 132);
        let worst = worst(&rig.skeleton, clip, data, &times);
        distance = distance.max(worst.0);
        angle = angle.max(worst.1);
    }
    eprintln!("knight: {distance:.2e} m, {angle:.2e} rad");
    assert!(distance <= METRES, "{distance:e} m");
    assert!(angle <= 1e-5, "{angle:e} rad");
    // A joint in the wrong place is seen: the same clip a millisecond later.
    let (clip, data) = (rig.clip("Running_A").unwrap(), &rig.sources);
    let data = data.iter().find(|data| data.name == "Running_A").unwrap();
    let (mut sampler, mut pose, mut model) = (Sampler::new(), Pose::default(), Vec::new());
    sampler.sample(clip, 0.301, &mut pose);
    rig.skeleton.local_to_model(&pose, &mut model);
    let truth = oracle::local_to_model(&rig.skeleton, &oracle::sample(&rig.skeleton, data, 0.3));
    let hand = rig.skeleton.find("hand.l").unwrap();
    let off = (f64::from(model[hand].translation.x) - truth[hand][0][3]).abs();
    assert!(off > METRES, "{off:e} m");
}

#[test]
fn every_interpolation_in_every_mixture() {
    let mut random = Random::new(2);
    for round in 0..40 {
        let skeleton = support::skeleton(&mut random);
        let data = support::hostile_clip(&mut random, &skeleton, 2.0);
        let clip = Clip::new(&skeleton, &data).unwrap();
        let mut times = random_times(&mut random, &clip, 60);
        times.extend(
            data.channels
                .iter()
                .flat_map(|channel| channel.times.clone()),
        );
        let (distance, angle) = worst(&skeleton, &clip, &data, &times);
        assert!(
            distance <= METRES && angle <= 1e-5,
            "{round}: {distance:e} m, {angle:e} rad"
        );
    }
}

#[test]
fn one_clip_of_one_interpolation_takes_the_wide_way() {
    // All lanes alike: blocks of one axis, whose arithmetic is not that of mixed ones.
    let mut random = Random::new(3);
    for _ in 0..20 {
        let skeleton = support::skeleton(&mut random);
        let mut data = support::hostile_clip(&mut random, &skeleton, 2.0);
        let shared = data
            .channels
            .iter()
            .map(|channel| channel.times.len())
            .max()
            .unwrap();
        for kind in [0, 1, 2] {
            let mut alike = data.clone();
            alike.channels.retain(|channel| {
                channel.times.len() == shared && channel.interpolation as usize == kind
            });
            let clip = Clip::new(&skeleton, &alike).unwrap();
            let times = random_times(&mut random, &clip, 40);
            let (distance, angle) = worst(&skeleton, &clip, &alike, &times);
            assert!(
                distance <= METRES && angle <= 1e-5,
                "{kind}: {distance:e} m, {angle:e} rad"
            );
        }
        data.channels.clear();
        let rest = Clip::new(&skeleton, &data).unwrap();
        assert_eq!(rest.duration(), 0.0);
        assert!(worst(&skeleton, &rest, &data, &[0.0, 1.0]).0 <= METRES);
    }
}

#[test]
fn any_order_of_times_gives_the_same_bits() {
    let mut random = Random::new(4);
    let skeleton = support::skeleton(&mut random);
    let clip = Clip::new(
        &skeleton,
        &support::hostile_clip(&mut random, &skeleton, 2.0),
    )
    .unwrap();
    let times = random_times(&mut random, &clip, 500);
    let mut sampler = Sampler::new();
    let mut forward: Vec<usize> = (0..times.len()).collect();
    forward.sort_by(|a, b| times[*a].total_cmp(&times[*b]));
    let mut poses = vec![Pose::default(); times.len()];
    for index in forward {
        sampler.sample(&clip, times[index], &mut poses[index]);
    }
    let mut pose = Pose::default();
    for (index, time) in times.iter().enumerate() {
        sampler.sample(&clip, *time, &mut pose);
        assert_eq!(pose, poses[index]);
        Sampler::new().sample(&clip, *time, &mut pose);
        assert_eq!(pose, poses[index]);
    }
}

#[test]
fn times_that_are_none_and_clips_that_are_short() {
    let mut random = Random::new(5);
    let skeleton = support::skeleton(&mut random);
    let clip = Clip::new(
        &skeleton,
        &support::hostile_clip(&mut random, &skeleton, 2.0),
    )
    .unwrap();
    let (mut sampler, mut pose, mut first) = (Sampler::new(), Pose::default(), Pose::default());
    sampler.sample(&clip, f32::NEG_INFINITY, &mut first);
    for time in [f32::NAN, f32::MIN, -0.0, -1e-30] {
        sampler.sample(&clip, time, &mut pose);
        assert!((0..skeleton.len()).all(|joint| pose.get(joint).is_finite()));
    }
    sampler.sample(&clip, f32::NAN, &mut pose);
    assert_eq!(pose, first);
    for time in [f32::NAN, f32::INFINITY, -3.5, 1e30] {
        let looped = clip.looped(time);
        assert!(
            (0.0..=clip.duration()).contains(&looped),
            "{time}: {looped}"
        );
    }
}
