//! Many probes: turns, and what a million of them cost.

use super::*;

#[test]
fn a_crowd_takes_turns_and_all_are_answered() {
    let mut app = app();
    app.world_mut().resource_mut::<ProbeBatch>().per_frame = 100;
    let all: Vec<Entity> = (0..1000_u16)
        .map(|i| spawned(&mut app, f32::from(i) * 0.1, 0.0))
        .collect();
    let answered = |app: &App| {
        all.iter()
            .filter(|e| probe(app, **e).sample.is_some())
            .count()
    };
    for frame in 1..=10 {
        app.update();
        assert_eq!(answered(&app), frame * 100);
    }
    assert_eq!(app.world().resource::<ProbeBatch>().waiting(), 0);
    let truth = hill(50.0).sample_f64(DVec2::new(f64::from(999.0_f32 * 0.1), 0.0));
    assert_eq!(probe(&app, all[999]).sample, Some(truth));
    // Many at once are the same bits as one by one: tasks only divide the list.
    app.world_mut().resource_mut::<ProbeBatch>().per_frame = 1 << 16;
    for entity in &all {
        app.world_mut()
            .get_mut::<Transform>(*entity)
            .unwrap()
            .translation
            .z = 7.0;
    }
    app.update();
    for (i, entity) in all.iter().enumerate() {
        let place = DVec2::new(f64::from(i as f32 * 0.1), 7.0);
        assert_eq!(
            probe(&app, *entity).sample,
            Some(hill(50.0).sample_f64(place))
        );
    }
}

#[test]
fn a_part_answers_its_slots_alone_and_says_what_heights_are_relative_to() {
    let mut app = app();
    let all: Vec<Entity> = (0..10_u8)
        .map(|i| spawned(&mut app, f32::from(i), 0.0))
        .collect();
    app.update();
    let mut batch = app.world_mut().resource_mut::<ProbeBatch>();
    let question = batch.question();
    let part = |first: u32, count: usize| ProbePart {
        first,
        base: 1e4,
        answers: vec![
            ProbeAnswer {
                height: 1.0,
                rise: 0.001,
                bound: 1.0,
                ..ProbeAnswer::default()
            };
            count
        ]
        .into(),
    };
    assert_eq!(batch.fill_part(question.clone(), part(4, 3)), Ok(()));
    for (first, expected, found) in [(8, 2, 3), (11, 0, 3), (u32::MAX, 0, 3)] {
        let refusal = batch.fill_part(question.clone(), part(first, 3));
        assert_eq!(refusal, Err(ProbeError { expected, found }));
    }
    app.update();
    for (slot, entity) in all.iter().enumerate() {
        let drawn = probe(&app, *entity).drawn;
        assert_eq!(drawn.is_some(), (4..7).contains(&slot), "{slot}");
        if let Some(drawn) = drawn {
            // An f32 of 10 km has steps of a millimetre; the sum of these has none.
            assert!((drawn.sample.height - 10_001.001).abs() < 1e-9);
            assert_eq!(drawn.place.x, slot as f64);
        }
    }
    assert_eq!(app.world().resource::<ProbeBatch>().probes(), 10);
    app.world_mut().despawn(all[3]);
    assert_eq!(app.world().resource::<ProbeBatch>().probes(), 9);
}

/// Measures a million probes; run by name: `cargo nextest run --run-ignored only a_million`.
#[test]
#[ignore = "a measurement; its assertion is generous"]
fn a_million_probes_do_not_hold_up_a_frame() {
    use crate::Fractal;
    use std::time::Instant;
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TerrainPlugin));
    let terrain = Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 4000.0),
        layers: vec![Layer {
            source: Source::Fractal(Fractal::default()),
            mask: None,
        }],
        base: 0.0,
        sea_level: None,
    });
    app.world_mut().spawn(terrain.unwrap());
    let probes = (0..1_000_000_u32).map(|i| {
        let place = Transform::from_xyz((i % 1000) as f32, 0.0, (i / 1000) as f32);
        (GroundProbe::default(), place)
    });
    app.world_mut().spawn_batch(probes);
    let mut timed = |what: &str, frames: u32, before: &dyn Fn(&mut App), renderer: bool| {
        let mut longest = 0.0_f64;
        for _ in 0..frames {
            before(&mut app);
            if renderer {
                let mut batch = app.world_mut().resource_mut::<ProbeBatch>();
                let question = batch.question();
                let hit = ProbeAnswer {
                    bound: 1.0,
                    ..ProbeAnswer::default()
                };
                let answers = vec![hit; question.places.len()];
                batch.fill(question, answers).unwrap();
            }
            let begun = Instant::now();
            app.update();
            longest = longest.max(begun.elapsed().as_secs_f64() * 1e3);
        }
        let waiting = app.world().resource::<ProbeBatch>().waiting();
        println!("{what}: longest frame {longest:.1} ms, {waiting} wait");
        longest
    };
    let nothing = |_: &mut App| {};
    timed("new", 1, &nothing, false);
    let answering = timed("waiting", 20, &nothing, false);
    timed("until all are answered", 80, &nothing, false);
    timed("at rest", 10, &nothing, false);
    timed("drawn answers for all", 5, &nothing, true);
    let walk = |app: &mut App| {
        let mut query = app.world_mut().query::<&mut Transform>();
        for mut place in query.iter_mut(app.world_mut()) {
            place.translation.x += 0.01;
        }
    };
    timed("all walk", 10, &walk, false);
    assert!(answering < 1000.0, "{answering} ms");
}
