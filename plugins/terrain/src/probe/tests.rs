//! Probes in an app: true answers at once, drawn ones two frames late from a synthetic renderer.

mod crowd;

use super::batch::Asked;
use super::*;
use crate::{GroundRect, Hill, Layer, Source, Terrain, TerrainData, TerrainPlugin};
use bevy::MinimalPlugins;
use bevy::app::App;
use bevy::transform::components::GlobalTransform;
use std::collections::VecDeque;

fn hill(height: f32) -> Terrain {
    let hill = Hill {
        centre: DVec2::ZERO,
        radius: 100.0,
        height,
    };
    Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 500.0),
        layers: vec![Layer {
            source: Source::Hill(hill),
            mask: None,
        }],
        base: 3.0,
        sea_level: None,
    })
    .expect("valid")
}

fn height(app: &App, probe: Entity) -> Option<f64> {
    app.world()
        .get::<GroundProbe>(probe)
        .and_then(|probe| probe.sample)
        .map(|s| s.height)
}

#[test]
fn probes_follow_their_entities_and_the_terrain() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TerrainPlugin));
    let parent = app
        .world_mut()
        .spawn(Transform::from_xyz(200.0, 0.0, 0.0))
        .id();
    let probe = app
        .world_mut()
        .spawn((GroundProbe::default(), ChildOf(parent)))
        .id();
    app.update();
    assert_eq!(height(&app, probe), None, "no terrain");

    let ground = app.world_mut().spawn(hill(50.0)).id();
    app.update();
    assert_eq!(
        height(&app, probe),
        Some(3.0),
        "beyond the hill, by the parent's place"
    );

    app.world_mut()
        .entity_mut(parent)
        .insert(Transform::default());
    app.update();
    assert_eq!(height(&app, probe), Some(53.0), "the parent moved");

    app.world_mut().entity_mut(ground).insert(hill(-1.0));
    app.update();
    assert_eq!(height(&app, probe), Some(2.0), "the ground changed");

    app.world_mut().entity_mut(ground).despawn();
    app.update();
    assert_eq!(height(&app, probe), None, "the ground is gone");
    assert!(app.world().get::<GlobalTransform>(probe).is_some());
}

#[test]
fn of_several_terrains_the_one_under_the_probe_answers() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TerrainPlugin));
    let flat = |x: f64, base: f32| {
        Terrain::new(TerrainData {
            extent: GroundRect::square(DVec2::new(x, 0.0), 100.0),
            layers: Vec::new(),
            base,
            sea_level: None,
        })
        .expect("valid")
    };
    // From x = -50 to 50 and from 150 to 250.
    let west = app.world_mut().spawn(flat(0.0, 1.0)).id();
    let east = app.world_mut().spawn(flat(200.0, 2.0)).id();
    let mut at = |x: f32| {
        let place = Transform::from_xyz(x, 0.0, 0.0);
        app.world_mut().spawn((GroundProbe::default(), place)).id()
    };
    let probes = [-60.0, 0.0, 99.0, 101.0, 200.0].map(&mut at);
    app.update();
    assert_eq!(
        probes.map(|probe| height(&app, probe)),
        [1.0, 1.0, 1.0, 2.0, 2.0].map(Some),
        "inside of an extent that one, between them the nearer one"
    );

    // Over each other the older one answers, in every frame.
    app.world_mut().entity_mut(east).insert(flat(0.0, 3.0));
    app.update();
    assert_eq!(height(&app, probes[1]), Some(1.0));

    app.world_mut().entity_mut(west).despawn();
    app.update();
    assert_eq!(height(&app, probes[1]), Some(3.0));
    assert_eq!(height(&app, probes[4]), Some(3.0), "none other is left");
}

#[test]
fn still_probes_are_not_written() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TerrainPlugin));
    app.world_mut().spawn(hill(50.0));
    let probe = app.world_mut().spawn(GroundProbe::default()).id();
    app.update();
    let written = |app: &App| {
        app.world()
            .entity(probe)
            .get_change_ticks::<GroundProbe>()
            .map(|ticks| ticks.changed)
    };
    let before = written(&app);
    app.update();
    app.update();
    assert_eq!(written(&app), before);
    assert!(before.is_some());
}

/// A renderer: takes each frame's question, answers it two frames later with a surface 1 m above the
/// true one, inside of the extent.
#[derive(Default)]
struct Renderer {
    under_way: VecDeque<ProbeQuestion>,
}

const LIFTED: f64 = 1.0;

impl Renderer {
    fn frame(&mut self, app: &mut App) {
        app.update();
        let terrain = app
            .world_mut()
            .query::<&Terrain>()
            .iter(app.world())
            .next()
            .cloned();
        let mut batch = app.world_mut().resource_mut::<ProbeBatch>();
        self.under_way.push_back(batch.question());
        if self.under_way.len() > 2 {
            let question = self.under_way.pop_front().unwrap();
            let terrain = terrain.unwrap();
            let answer = |place: &crate::GroundPoint| {
                let place = place.to_dvec2();
                if !terrain.extent().contains(place) {
                    return ProbeAnswer::NOTHING;
                }
                let truth = terrain.sample_f64(place);
                ProbeAnswer {
                    height: (truth.height + LIFTED) as f32,
                    gradient: [truth.gradient.x as f32, truth.gradient.y as f32],
                    bound: 1.5,
                    ..ProbeAnswer::default()
                }
            };
            let answers = question.places.iter().map(answer).collect();
            batch.fill(question, answers).unwrap();
        }
    }
}

fn slot_of(world: &World, entity: Entity) -> Option<u32> {
    world.get::<Asked>(entity).map(|asked| asked.slot)
}

fn spawned(app: &mut App, x: f32, z: f32) -> Entity {
    let probe = (GroundProbe::default(), Transform::from_xyz(x, 0.0, z));
    app.world_mut().spawn(probe).id()
}

fn probe(app: &App, entity: Entity) -> GroundProbe {
    *app.world().get::<GroundProbe>(entity).unwrap()
}

fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TerrainPlugin));
    app.world_mut().spawn(hill(50.0));
    app
}

#[test]
fn drawn_answers_arrive_with_their_frame_and_place() {
    let mut app = app();
    let mut renderer = Renderer::default();
    let walker = spawned(&mut app, -40.0, 0.0);
    let mut seen = 0;
    for step in 0..20_u16 {
        let x = f32::from(step) - 40.0;
        app.world_mut()
            .get_mut::<Transform>(walker)
            .unwrap()
            .translation
            .x = x;
        renderer.frame(&mut app);
        let now = app.world().resource::<ProbeBatch>().frame();
        let probe = probe(&app, walker);
        assert_eq!(probe.age(now), 0, "the truth is of now");
        let Some(drawn) = probe.drawn else { continue };
        seen += 1;
        // Asked in frame f, taken in after f + 2, seen in f + 3.
        assert_eq!(drawn.age(now), 3);
        assert_eq!(drawn.place, DVec2::new(f64::from(x) - 3.0, 0.0));
        let then = hill(50.0).sample_f64(drawn.place);
        // f32 of some 50 m: half a step of 4e-6 m.
        assert!((drawn.sample.height - then.height - LIFTED).abs() < 2e-6);
    }
    assert_eq!(seen, 17);
}

#[test]
fn the_drawn_answer_is_taken_while_it_is_fresh_and_fits() {
    let truth = hill(50.0).sample_f64(DVec2::new(30.0, 0.0));
    let drawn = DrawnAnswer {
        sample: GroundSample {
            height: truth.height + 0.2,
            gradient: truth.gradient,
        },
        place: DVec2::new(30.0, 0.0),
        bound: 0.25,
        frame: u32::MAX,
    };
    let probe = GroundProbe {
        drawn: Some(drawn),
        ..GroundProbe::default()
    };
    let at = |x: f64, now: u32| {
        let place = DVec2::new(x, 0.0);
        probe.answer(place, hill(50.0).sample_f64(place), now, 3)
    };
    // Frame numbers wrap: 2 is three frames after the last number.
    let fresh = at(30.0, 2);
    assert_eq!((fresh.source, fresh.age), (AnswerSource::Drawn, 3));
    assert_eq!(fresh.sample.height, truth.height + 0.2);
    assert_eq!(at(30.0, 3).source, AnswerSource::True, "too old");
    assert_eq!(
        at(30.02, 0).source,
        AnswerSource::Drawn,
        "along the triangle"
    );
    assert_eq!(at(80.0, 0).source, AnswerSource::True, "left behind");
    assert_eq!(
        at(80.0, 0).sample,
        hill(50.0).sample_f64(DVec2::new(80.0, 0.0))
    );
}

#[test]
fn beyond_the_world_the_truth_goes_on_and_nothing_is_drawn() {
    let mut app = app();
    let mut renderer = Renderer::default();
    let outside = spawned(&mut app, 5000.0, 0.0);
    let nowhere = spawned(&mut app, f32::NAN, 0.0);
    let endless = spawned(&mut app, 0.0, f32::INFINITY);
    let inside = spawned(&mut app, 0.0, 0.0);
    for _ in 0..5 {
        renderer.frame(&mut app);
    }
    assert_eq!(probe(&app, outside).sample.unwrap().height, 3.0);
    assert_eq!(probe(&app, outside).drawn, None);
    assert!(probe(&app, inside).drawn.is_some());
    for entity in [nowhere, endless] {
        let lost = probe(&app, entity);
        assert_eq!((lost.sample, lost.drawn), (None, None));
    }
    // From here to nowhere: what was known is taken back.
    app.world_mut()
        .get_mut::<Transform>(inside)
        .unwrap()
        .translation
        .x = f32::NAN;
    renderer.frame(&mut app);
    let lost = probe(&app, inside);
    assert_eq!((lost.sample, lost.drawn), (None, None));
    let waiting = app.world().resource::<ProbeBatch>().waiting();
    assert_eq!(waiting, 0, "a NaN is not asked again and again");
}

#[test]
fn slots_stay_and_a_new_probe_does_not_get_the_answers_of_an_old_one() {
    let mut app = app();
    let mut renderer = Renderer::default();
    let all: Vec<Entity> = (0..5_u16)
        .map(|i| spawned(&mut app, f32::from(i), 0.0))
        .collect();
    renderer.frame(&mut app);
    let slots = |app: &App| {
        all.iter()
            .map(|e| slot_of(app.world(), *e))
            .collect::<Vec<_>>()
    };
    let before = slots(&app);
    let question = app.world().resource::<ProbeBatch>().question();
    assert_eq!((question.places.len(), question.changed), (5, 0..5));

    app.world_mut().despawn(all[1]);
    app.world_mut().entity_mut(all[3]).remove::<GroundProbe>();
    renderer.frame(&mut app);
    let question = app.world().resource::<ProbeBatch>().question();
    assert!(question.changed.is_empty(), "nothing moved");
    let new = spawned(&mut app, 90.0, 0.0);
    renderer.frame(&mut app);
    let taken = slot_of(app.world(), new);
    assert!(
        [before[1], before[3]].contains(&taken),
        "a free slot is used"
    );
    let after = slots(&app);
    for i in [0, 2, 4] {
        assert_eq!(after[i], before[i]);
    }
    // The answer to the first frame's question is in by now; it was of another probe.
    renderer.frame(&mut app);
    assert_eq!(probe(&app, new).drawn, None);
    assert!(probe(&app, all[0]).drawn.is_some());
    renderer.frame(&mut app);
    renderer.frame(&mut app);
    assert_eq!(probe(&app, new).drawn.unwrap().place.x, 90.0);
    // Back on the entity whose probe was removed.
    app.world_mut()
        .entity_mut(all[3])
        .insert(GroundProbe::default());
    renderer.frame(&mut app);
    assert!(probe(&app, all[3]).sample.is_some());
    assert_eq!(app.world().resource::<ProbeBatch>().len(), 5);
}

#[test]
fn answers_that_do_not_fit_are_refused_or_passed_over() {
    let mut app = app();
    let one = spawned(&mut app, 0.0, 0.0);
    app.update();
    let mut batch = app.world_mut().resource_mut::<ProbeBatch>();
    let question = batch.question();
    let refusal = batch.fill(question.clone(), Vec::new()).unwrap_err();
    assert_eq!((refusal.expected, refusal.found), (1, 0));
    let wrong = |height: f32, slope: f32, bound: f32| ProbeAnswer {
        height,
        gradient: [slope, 0.0],
        bound,
        ..ProbeAnswer::default()
    };
    for answer in [
        wrong(f32::NAN, 0.0, 1.0),
        wrong(0.0, f32::INFINITY, 1.0),
        wrong(0.0, 0.0, f32::NAN),
        ProbeAnswer::NOTHING,
    ] {
        let mut batch = app.world_mut().resource_mut::<ProbeBatch>();
        batch.fill(question.clone(), vec![answer]).unwrap();
        app.update();
        assert_eq!(probe(&app, one).drawn, None, "{answer:?}");
    }
    // A later answer stays when an earlier one comes after it.
    app.update();
    let mut batch = app.world_mut().resource_mut::<ProbeBatch>();
    let later = batch.question();
    batch
        .fill(later.clone(), vec![wrong(2.0, 0.0, 1.0)])
        .unwrap();
    batch.fill(question, vec![wrong(1.0, 0.0, 1.0)]).unwrap();
    app.update();
    assert_eq!(probe(&app, one).drawn.unwrap().frame, later.frame);
}
