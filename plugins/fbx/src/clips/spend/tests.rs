use super::*;
use crate::clips::Shells;
use crate::clips::grid::Grid;
use crate::clips::reduce::{leverage, moving_bytes};
use crate::clips::sample::{Samples as Sampled, Track};
use crate::model::{Model, Node, Trs};
use crate::options::{Budget, Limits, Options};
use glam::{DQuat, DVec2, DVec3};

/// Two seconds.
const FRAMES: usize = 60;

/// `count` nodes, each a metre above the last.
fn chain(count: usize) -> Model {
    let node = |number: usize| Node {
        name: format!("{number}"),
        parent: number.checked_sub(1),
        rest: Trs {
            translation: DVec3::Y,
            ..Trs::IDENTITY
        },
        mesh: None,
        skin: None,
        light: None,
        camera: None,
    };
    Model {
        nodes: (0..count).map(node).collect(),
        ..Model::default()
    }
}

/// A clip of so many frames in which each node is turned about its own axis by `angle` of its number and
/// the time.
fn turned(model: &Model, frames: usize, angle: impl Fn(usize, f64) -> f64) -> Sampled {
    let mut grid = Grid::default();
    for i in 0..=frames {
        let time = i as f64 / 30.0;
        grid.push(time, time as f32, false, true);
        grid.set_within(true);
    }
    let pose = |number: usize, time: f64| Trs {
        rotation: DQuat::from_axis_angle(
            DVec3::new(1.0, 0.3 * number as f64, -0.5).normalize(),
            angle(number, time),
        ),
        ..model.nodes[number].rest
    };
    let track = |node: usize| Track {
        node,
        spins: false,
        poses: grid.times.iter().map(|&time| pose(node, time)).collect(),
    };
    Sampled {
        tracks: (0..model.nodes.len()).map(track).collect(),
        morphs: Vec::new(),
        stops: (0..grid.len()).collect(),
        first: grid.len(),
        grid,
    }
}

fn sine(angle: f64) -> f64 {
    DVec2::from_angle(angle).y
}

/// Swings at different speeds, the last node hardly at all.
fn swings(number: usize, time: f64) -> f64 {
    match number {
        3 => 1e-5 * sine(9.0 * time),
        _ => 0.4 * sine((1.5 + number as f64) * time + number as f64),
    }
}

/// What a quick search would have given: all channels on all samples that are off by `error` metres
/// at most each by itself.
fn with_work(model: &Model, samples: &Sampled, test: impl FnOnce(&Work, &[Choice], &Options)) {
    let options = Options::default();
    let shells = Shells::of(model);
    let levers = leverage(samples, model, &shells);
    let work = Work::new(samples, model, &shells, levers, &options);
    let first = work.choose(1e-7, &[], &options);
    test(&work, &first, &options);
}

#[test]
fn keys_keep_to_the_bound_and_are_fewer() {
    let model = chain(4);
    let samples = turned(&model, FRAMES, swings);
    with_work(&model, &samples, |work, first, options| {
        let budget = Budget::new("", Limits::of_file(1 << 20));
        let dear = moving_bytes(first);
        let mut last = usize::MAX;
        for bound in [1e-4, 1e-3, 1e-2] {
            let spent = spend(work, first, bound, options, &budget).unwrap();
            let error = work.error(&spent, options);
            assert!(error <= bound, "{error:e} of {bound:e}");
            // Where there are many keys, the last one that could go was a small step from the bound.
            assert!(
                bound > 1e-4 || error > 0.8 * bound,
                "{error:e} of {bound:e}"
            );
            let bytes = moving_bytes(&spent);
            assert!(bytes < last && bytes < dear / 2, "{bytes} bytes of {dear}");
            last = bytes;
        }
    });
}

#[test]
fn what_hardly_moves_is_at_rest() {
    let model = chain(4);
    // More than the quick search forgives, less than the bound.
    let samples = turned(&model, FRAMES, swings);
    with_work(&model, &samples, |work, first, options| {
        let budget = Budget::new("", Limits::of_file(1 << 20));
        let still = |choices: &[Choice]| {
            let last = |choice: &&Choice| {
                (choice.channel.node, choice.channel.property) == (3, Property::Rotation)
            };
            choices.iter().find(last).unwrap().clone()
        };
        assert!(still(first).channel.times.len() > 1);
        let spent = spend(work, first, 1e-3, options, &budget).unwrap();
        assert!(still(&spent).at_rest && still(&spent).channel.times.len() == 1);
    });
}

/// What is kept up to date while keys go is what playing the written channels gives.
#[test]
fn the_error_that_is_kept_is_the_one_that_is_played() {
    let model = chain(4);
    let samples = turned(&model, FRAMES, swings);
    with_work(&model, &samples, |work, first, options| {
        let bound = 1e-3;
        let spending = Spending::new(work, first, bound).unwrap();
        let count = spending.open.len();
        for cubic in [false, true] {
            let plan = Plan {
                cubic: vec![cubic; count],
                groups: (0..count).map(|number| vec![number]).collect(),
            };
            let wanted = spending.wanted.iter().map(Vec::as_slice).collect();
            let mut thinning = Thinning::new(
                spending.state(),
                spending.dense(&plan),
                wanted,
                plan.groups.clone(),
                spending.samples(),
                bound,
            )
            .unwrap();
            thinning.run();
            let (state, curves) = thinning.parts();
            let kept = state.error();
            curves.iter_mut().for_each(|curve| curve.short = false);
            let played = work.error(&spending.choices(curves), options);
            // f32 has seven digits, and the tip is four metres away.
            assert!((kept - played).abs() < 2e-6, "{kept:e}, played {played:e}");
            assert!(kept <= bound && kept > 0.5 * bound, "{kept:e}");
        }
    });
}

/// Rounding to 16 bits from the roots to the tips leaves the tip of a long chain nearer than rounding
/// each joint by itself.
#[test]
fn joints_make_good_what_those_above_were_rounded_by() {
    let model = chain(12);
    let samples = turned(&model, FRAMES, |number, time| {
        0.3 * sine(time + number as f64)
    });
    with_work(&model, &samples, |work, first, options| {
        let spending = Spending::new(work, first, 1.0).unwrap();
        let count = spending.open.len();
        let plan = Plan {
            cubic: vec![false; count],
            groups: Vec::new(),
        };
        let dense = spending.dense(&plan);
        assert!(dense.iter().all(|curve| curve.short));
        let mut plain = dense.clone();
        plain.iter_mut().for_each(|curve| curve.write(&work.times));
        let mut made_good = dense;
        round::round(&spending.state(), &mut made_good, spending.samples());
        let error = |curves: &[Curve]| work.error(&spending.choices(curves), options);
        let (plain, made_good) = (error(&plain), error(&made_good));
        eprintln!("{made_good:e} m, plain {plain:e} m");
        // Measured: 4.9e-4 m and 1.1e-4 m.
        assert!(
            made_good < plain / 3.0,
            "{made_good:e} m, plain {plain:e} m"
        );
    });
}

#[test]
fn the_same_on_any_number_of_threads() {
    let model = chain(4);
    let samples = turned(&model, FRAMES, swings);
    with_work(&model, &samples, |work, first, options| {
        let budget = Budget::new("", Limits::of_file(1 << 20));
        let with = |threads: usize| {
            let options = Options {
                threads,
                ..*options
            };
            let spent = spend(work, first, 1e-4, &options, &budget).unwrap();
            spent
                .into_iter()
                .map(|choice| choice.channel)
                .collect::<Vec<_>>()
        };
        assert!(with(1) == with(3));
    });
}

/// Long clips are tried in fewer plans, and very long ones left as they are.
#[test]
fn long_clips_are_tried_less() {
    let model = chain(3);
    let budget = Budget::new("", Limits::of_file(1 << 24));
    for (frames, is_tried) in [(5_400, true), (54_000, false)] {
        let samples = turned(&model, frames, swings);
        with_work(&model, &samples, |work, _, options| {
            let first = work.choose(1e-3, &[], options);
            let spent = spend(work, &first, 1e-2, options, &budget);
            assert_eq!(spent.is_some(), is_tried);
            if let Some(spent) = spent {
                assert!(work.error(&spent, options) <= 1e-2);
                assert!(moving_bytes(&spent) < moving_bytes(&first));
            }
        });
    }
}
