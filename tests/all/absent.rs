//! What a scene does not need costs nothing: the plugins in an app that renders, first without a
//! terrain, then without a view of it, add no image, no pipeline, no buffer and no pass; with both they do.

use crate::support::app;
use crate::support::camera;
use crate::support::hills;

use std::time::Duration;

use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::{PipelineCache, PollType};
use bevy::render::renderer::RenderDevice;
use dolomite::DolomitePlugins;
use dolomite::ground::detail::{DrawnProbes, TerrainLod};
use dolomite::ground::render::{AnswerCensus, DrawnProbeStats, answer_census};
use dolomite::ground::{GroundPlugin, PatchDetail, TerrainView};
use dolomite::terrain::{Fractal, GroundProbe, ProbeBatch, Terrain};
use dolomite::tessellation::render::{GeometryCensus, GeometryStats, census};

/// Frames of 16 ms.
const STEP: Duration = Duration::from_millis(16);

/// An app that renders without a window, with our plugins or without.
fn app(with_plugins: bool) -> Option<App> {
    app::app(STEP, |app| {
        if with_plugins {
            // A small relief map, so that it is there within the frames of a test. The group adds the plugin
            // again, which does nothing.
            app.add_plugins((GroundPlugin { relief_side: 64 }, DolomitePlugins));
        }
    })
}

fn camera(app: &mut App, components: impl Bundle) {
    let prepasses = (DepthPrepass, DeferredPrepass);
    let place = Transform::from_xyz(0.0, 50.0, 0.0);
    camera::camera(app, UVec2::splat(64), (prepasses, place, components));
}

fn terrain(app: &mut App) {
    let hills = hills::Hills {
        centre: DVec2::ZERO,
        side: 512.0,
        noise: Fractal::default(),
        base: 0.0,
        sea: None,
    };
    hills.spawn(app);
}

/// (what the stage holds, pipelines of the whole app, images) after some frames.
fn after_frames(app: &mut App) -> (GeometryCensus, usize, usize) {
    for _ in 0..12 {
        app.update();
        assert_eq!(app.should_exit(), None, "rendering stopped");
    }
    let world = app.sub_app(RenderApp).world();
    (
        census(world),
        world.resource::<PipelineCache>().pipelines().count(),
        images(app),
    )
}

fn images(app: &App) -> usize {
    app.world().resource::<Assets<Image>>().len()
}

#[test]
fn an_app_without_terrain_pays_nothing() {
    let (Some(mut bare), Some(mut with)) = (app(false), app(true)) else {
        return;
    };
    camera(&mut bare, ());
    camera(&mut with, ());
    let (_, pipelines, images) = after_frames(&mut bare);
    assert_eq!(
        after_frames(&mut with),
        (GeometryCensus::default(), pipelines, images),
        "nothing of ours"
    );
    camera(&mut bare, ());
    camera(&mut with, TerrainView);
    let (_, pipelines, images) = after_frames(&mut bare);
    assert_eq!(
        after_frames(&mut with),
        (GeometryCensus::default(), pipelines, images),
        "a view without terrain"
    );
}

#[test]
fn a_terrain_without_a_view_pays_nothing_and_with_one_it_is_seen() {
    let Some(mut app) = app(true) else { return };
    camera(&mut app, ());
    after_frames(&mut app);
    terrain(&mut app);
    let before = images(&app);
    let (found, _, after) = after_frames(&mut app);
    assert_eq!(
        (found, after),
        (GeometryCensus::default(), before),
        "a terrain that nobody looks at"
    );
    camera(&mut app, (TerrainView, PatchDetail::default()));
    let before = images(&app);
    let (found, _, mut after) = after_frames(&mut app);
    // The relief map is made in the background.
    for _ in 0..200 {
        if after > before {
            break;
        }
        (_, _, after) = after_frames(&mut app);
    }
    assert_eq!(after, before + 1, "its relief map");
    // The count can fail: with a view there is one, and what it needs.
    assert!(
        found.views == 1 && found.pipelines >= 7 && found.kinds == 1,
        "{found:?}"
    );
}

#[test]
fn a_detailed_view_at_rest_dispatches_nothing() {
    let Some(mut app) = app(true) else { return };
    terrain(&mut app);
    camera(&mut app, (TerrainView, TerrainLod::default()));
    let (found, ..) = after_frames(&mut app);
    assert_eq!((found.views, found.kinds), (1, 1), "{found:?}");
    let stats = |app: &App| app.world().resource::<GeometryStats>().clone();
    // Picture and ground are small: some hundred triangles are far more than the two of a flat one.
    assert!(stats(&app).primitives > 100, "{:?}", stats(&app));
    let drawn = stats(&app).primitives;
    for _ in 0..4 {
        app.update();
        assert_eq!((stats(&app).dispatches, stats(&app).primitives), (0, drawn));
    }
    // The count can fail: a camera that moves has its ground chosen anew.
    let mut cameras = app
        .world_mut()
        .query_filtered::<&mut Transform, With<TerrainLod>>();
    let world = app.world_mut();
    for mut place in cameras.iter_mut(world) {
        place.translation.x += 3.0;
    }
    let mut dispatched = 0;
    for _ in 0..4 {
        app.update();
        dispatched += stats(&app).dispatches;
    }
    assert!(dispatched > 20, "{dispatched}");
}

fn answers(app: &App) -> AnswerCensus {
    answer_census(app.sub_app(RenderApp).world())
}

fn probe_at(app: &mut App, x: f32, z: f32) -> Entity {
    let probe = (GroundProbe::default(), Transform::from_xyz(x, 0.0, z));
    app.world_mut().spawn(probe).id()
}

/// The probe, and the age of its drawn answer in the present frame; checks that it fits the truth.
fn answered(app: &App, probe: Entity) -> Option<u32> {
    let world = app.world();
    let now = world.resource::<ProbeBatch>().frame();
    let drawn = world.get::<GroundProbe>(probe)?.drawn?;
    let terrain = world
        .iter_entities()
        .find_map(|entity| entity.get::<Terrain>().cloned())?;
    let truth = terrain.sample_f64(drawn.place).height;
    let off = (drawn.sample.height - truth).abs();
    assert!(off <= drawn.bound && drawn.bound < 20.0, "{off} {drawn:?}");
    Some(drawn.age(now))
}

/// One update, then waits for the device: software Vulkan has no display that holds frames back, and may not
/// fall behind by more than one.
fn frame(app: &mut App) {
    app.update();
    let device = app.world().resource::<RenderDevice>();
    device.poll(PollType::wait_indefinitely()).expect("drawn");
}

/// Oldest answer that counts as fresh, frames.
const FRESH: u32 = 3;

#[test]
fn height_queries_cost_nothing_without_a_probe_and_rest_with_one() {
    let Some(mut app) = app(true) else { return };
    terrain(&mut app);
    camera(&mut app, (TerrainView, PatchDetail::default()));
    let probe = probe_at(&mut app, 3.0, -180.0);
    for _ in 0..12 {
        frame(&mut app);
    }
    assert_eq!(
        answers(&app),
        AnswerCensus::default(),
        "patches answer nothing"
    );
    assert!(answered(&app, probe).is_none());
    app.world_mut().despawn(probe);

    camera(&mut app, (TerrainView, TerrainLod::default()));
    for _ in 0..12 {
        frame(&mut app);
    }
    assert_eq!(answers(&app), AnswerCensus::default(), "nobody asks");

    let probe = probe_at(&mut app, 3.0, -180.0);
    for _ in 0..8 {
        frame(&mut app);
    }
    let found = answers(&app);
    assert!(found.pipelines == 1 && found.buffers >= 4, "{found:?}");
    assert!(found.dispatches > 0);
    // At rest the same answer is handed in again, and nothing is dispatched for it.
    for _ in 0..5 {
        frame(&mut app);
        assert_eq!(answers(&app), found);
        assert!(answered(&app, probe) <= Some(FRESH) && answered(&app, probe).is_some());
        assert_eq!(app.world().resource::<GeometryStats>().dispatches, 0);
    }
    // It walks while the view rests: asked in every frame, of the kept mesh.
    for step in 0..8_u16 {
        let at = |step: u16| 3.0 + 0.25 * f32::from(step);
        let mut place = app.world_mut().get_mut::<Transform>(probe).expect("there");
        place.translation.x = at(step);
        frame(&mut app);
        assert_eq!(answered(&app, probe), Some(2));
        let drawn = app
            .world()
            .get::<GroundProbe>(probe)
            .and_then(|probe| probe.drawn);
        let then = f64::from(at(step.saturating_sub(2)));
        assert_eq!(
            drawn.expect("just now").place.x,
            then,
            "where it was two frames before"
        );
    }
    let walked = answers(&app);
    // The first step is from 3 m to 3 m.
    assert_eq!(walked.dispatches - found.dispatches, 7, "{walked:?}");
    let stats = *app.world().resource::<DrawnProbeStats>();
    assert_eq!(
        (stats.asked, stats.drawn, stats.age),
        (1, 1, 2),
        "{stats:?}"
    );
    // Outside of the ground, and nowhere: no drawn answer, and the truth all the same.
    for x in [300.0, f32::NAN] {
        app.world_mut()
            .get_mut::<Transform>(probe)
            .expect("there")
            .translation
            .x = x;
        for _ in 0..4 {
            frame(&mut app);
        }
        assert!(answered(&app, probe).is_none(), "{x}");
    }
    app.world_mut().despawn(probe);
    for _ in 0..2 {
        frame(&mut app);
    }
    assert_eq!(answers(&app).buffers, 0, "what nobody asks for is not kept");
}

#[test]
fn a_crowd_takes_turns() {
    let Some(mut app) = app(true) else { return };
    terrain(&mut app);
    camera(&mut app, (TerrainView, TerrainLod::default()));
    app.insert_resource(DrawnProbes { per_frame: 64 });
    let crowd: Vec<Entity> = (0..500_u16)
        .map(|k| {
            probe_at(
                &mut app,
                f32::from(k % 20) - 10.0,
                -160.0 - f32::from(k / 20),
            )
        })
        .collect();
    for _ in 0..12 {
        frame(&mut app);
    }
    let before = answers(&app).dispatches;
    // 500 / 64: eight rounds, and two frames on the way.
    for _ in 0..10 {
        frame(&mut app);
    }
    assert_eq!(answers(&app).dispatches, before + 10, "one a frame");
    let now = app.world().resource::<ProbeBatch>().frame();
    for probe in &crowd {
        let age = answered(&app, *probe).expect("everybody's turn has come");
        assert!(age <= 8 + FRESH, "{age} in frame {now}");
    }
    app.insert_resource(DrawnProbes { per_frame: 0 });
    for _ in 0..3 {
        frame(&mut app);
    }
    assert_eq!(answers(&app).buffers, 0, "none is asked for");
}

#[test]
fn a_million_probes_neither_stall_nor_panic() {
    let Some(mut app) = app(true) else { return };
    terrain(&mut app);
    camera(&mut app, (TerrainView, TerrainLod::default()));
    for _ in 0..12 {
        frame(&mut app);
    }
    // In the picture, beyond the ground, and nowhere.
    let place = |k: u32| {
        let x = match k % 100 {
            98 => 1e6,
            99 => f32::NAN,
            _ => (k % 1000) as f32 * 0.05 - 25.0,
        };
        let z = -160.0 - (k / 1000) as f32 * 0.05;
        (GroundProbe::default(), Transform::from_xyz(x, 0.0, z))
    };
    app.insert_resource(DrawnProbes {
        per_frame: u32::MAX,
    });
    // A hundredth of them first, spread alike.
    let few = (0..10_000).map(|k| place(100 * (k / 100) * 100 + k % 100));
    let few: Vec<Entity> = app.world_mut().spawn_batch(few).collect();
    let mut of_few = Duration::ZERO;
    for _ in 0..5 {
        let start = std::time::Instant::now();
        frame(&mut app);
        of_few = of_few.max(start.elapsed());
    }
    for probe in few {
        app.world_mut().despawn(probe);
    }
    let crowd = (0..1_000_000).map(place);
    let crowd: Vec<Entity> = app.world_mut().spawn_batch(crowd).collect();
    let mut longest = Duration::ZERO;
    for _ in 0..5 {
        let start = std::time::Instant::now();
        frame(&mut app);
        longest = longest.max(start.elapsed());
    }
    let stats = *app.world().resource::<DrawnProbeStats>();
    eprintln!("a million: {stats:?}, longest frame {longest:?}");
    assert_eq!(stats.asked, 1_000_000);
    assert!(stats.drawn > 100_000 && stats.drawn <= 980_000, "{stats:?}");
    let drawn = |k: usize| {
        app.world()
            .get::<GroundProbe>(crowd[k])
            .is_some_and(|p| p.drawn.is_some())
    };
    assert!(!drawn(98) && !drawn(99));
    // A hundred times as many take a hundred times as long at most, and the machine has other work: four times
    // that. Whatever looks at all probes for each of them would take ten thousand times as long.
    assert!(
        longest < 400 * of_few,
        "{longest:?}, a hundredth {of_few:?}"
    );
}

#[test]
fn answers_are_three_frames_old_at_most_beside_a_pipelined_renderer() {
    let Some(mut app) = app::pipelined_app(STEP, true, |app| {
        app.add_plugins(DolomitePlugins);
    }) else {
        return;
    };
    terrain(&mut app);
    camera(&mut app, (TerrainView, TerrainLod::default()));
    let probe = probe_at(&mut app, 3.0, -180.0);
    let mut oldest = 0;
    for number in 0..40_u16 {
        let mut place = app.world_mut().get_mut::<Transform>(probe).expect("there");
        place.translation.x = 0.125 * f32::from(number);
        frame(&mut app);
        if number >= 20 {
            let age = answered(&app, probe).expect("answered by now");
            oldest = oldest.max(age);
        }
    }
    assert!((2..=FRESH).contains(&oldest), "{oldest}");
}
