//! What a scene does not need costs nothing: the plugins in an app that renders, first without a
//! terrain, then without a view of it, add no pipeline, no buffer and no pass; with both they do.

use std::time::Duration;

use bevy::app::{App, PluginGroup};
use bevy::camera::RenderTarget;
use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::log::LogPlugin;
use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::{PipelineCache, TextureFormat};
use bevy::render::{RenderApp, RenderPlugin};
use bevy::time::TimeUpdateStrategy;
use bevy::window::{ExitCondition, WindowPlugin};
use bevy::winit::WinitPlugin;
use dolomite::DolomitePlugins;
use dolomite::game::device;
use dolomite::terrain::{Fractal, GroundRect, Layer, Source, Terrain, TerrainData};
use dolomite::tessellation::detail::Detail;
use dolomite::tessellation::render::ground::texture::{LAYERS, texture_array};
use dolomite::tessellation::render::stage::{StageCensus, StageStats, census};
use dolomite::tessellation::{TerrainMaterial, TerrainView};

/// An app that renders without a window; `None`, after a line that says so, without Vulkan.
fn app(with_plugins: bool) -> Option<App> {
    if let Err(error) = device::probe() {
        assert!(
            std::env::var_os("CI").is_none(),
            "CI must not skip GPU tests: {error}"
        );
        eprintln!("skipped: {error}");
        return None;
    }
    let mut app = App::new();
    app.add_plugins(
        DefaultPlugins
            .build()
            .set(WindowPlugin {
                primary_window: None,
                exit_condition: ExitCondition::DontExit,
                ..default()
            })
            .set(RenderPlugin {
                render_creation: device::wgpu_settings().into(),
                synchronous_pipeline_compilation: true,
                ..default()
            })
            .disable::<LogPlugin>()
            .disable::<WinitPlugin>()
            .disable::<PipelinedRenderingPlugin>(),
    )
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(
        16,
    )));
    if with_plugins {
        app.add_plugins(DolomitePlugins);
    }
    app.finish();
    app.cleanup();
    Some(app)
}

fn camera(app: &mut App, components: impl Bundle) {
    let target = Image::new_target_texture(64, 64, TextureFormat::Rgba8UnormSrgb, None);
    let target = app.world_mut().resource_mut::<Assets<Image>>().add(target);
    app.world_mut().spawn((
        Camera3d::default(),
        Msaa::Off,
        (DepthPrepass, DeferredPrepass),
        RenderTarget::Image(target.into()),
        Transform::from_xyz(0.0, 50.0, 0.0),
        components,
    ));
}

fn terrain(app: &mut App) {
    let terrain = Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 512.0),
        layers: vec![Layer {
            source: Source::Fractal(Fractal::default()),
            mask: None,
        }],
        base: 0.0,
        sea_level: None,
    });
    let mut images = app.world_mut().resource_mut::<Assets<Image>>();
    let mut array = |srgb| {
        let size = bevy::render::render_resource::Extent3d {
            width: 4,
            height: 4 * LAYERS,
            depth_or_array_layers: 1,
        };
        let stack = Image::new_fill(
            size,
            bevy::render::render_resource::TextureDimension::D2,
            &[128; 4],
            TextureFormat::Rgba8Unorm,
            bevy::asset::RenderAssetUsages::all(),
        );
        images.add(texture_array(&stack, LAYERS, srgb).expect("a stack of squares"))
    };
    let material = TerrainMaterial::new(array(true), array(false));
    app.world_mut()
        .spawn((terrain.expect("the defaults are valid"), material));
}

/// (what the stage holds, pipelines of the whole app) after some frames.
fn after_frames(app: &mut App) -> (StageCensus, usize) {
    for _ in 0..12 {
        app.update();
        assert_eq!(app.should_exit(), None, "rendering stopped");
    }
    let world = app.sub_app(RenderApp).world();
    (
        census(world),
        world.resource::<PipelineCache>().pipelines().count(),
    )
}

#[test]
fn an_app_without_terrain_pays_nothing() {
    let (Some(mut bare), Some(mut with)) = (app(false), app(true)) else {
        return;
    };
    camera(&mut bare, ());
    camera(&mut with, ());
    let (_, pipelines) = after_frames(&mut bare);
    assert_eq!(
        after_frames(&mut with),
        (StageCensus::default(), pipelines),
        "nothing of ours"
    );
    camera(&mut bare, ());
    camera(&mut with, TerrainView::default());
    let (_, pipelines) = after_frames(&mut bare);
    assert_eq!(
        after_frames(&mut with),
        (StageCensus::default(), pipelines),
        "a view without terrain"
    );
}

#[test]
fn a_terrain_without_a_view_pays_nothing_and_with_one_it_is_seen() {
    let Some(mut app) = app(true) else { return };
    terrain(&mut app);
    camera(&mut app, ());
    assert_eq!(
        after_frames(&mut app).0,
        StageCensus::default(),
        "a terrain that nobody looks at"
    );
    camera(&mut app, TerrainView::default());
    let (found, _) = after_frames(&mut app);
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
    camera(&mut app, (TerrainView::default(), Detail::default()));
    let (found, _) = after_frames(&mut app);
    assert_eq!((found.views, found.kinds), (1, 1), "{found:?}");
    let stats = |app: &App| app.world().resource::<StageStats>().clone();
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
        .query_filtered::<&mut Transform, With<Detail>>();
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
