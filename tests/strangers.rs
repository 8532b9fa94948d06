//! Plugins in apps that nobody of ours wrote: added before Bevy's, added twice, or without what they need.
//! In any order the same is drawn.

#[expect(dead_code, reason = "plugins are added before Bevy's here")]
#[path = "support/app.rs"]
mod app;
#[path = "support/camera.rs"]
mod camera;
#[path = "support/hills.rs"]
mod hills;

use std::sync::Arc;
use std::time::Duration;

use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::render::render_resource::AsBindGroup;
use dolomite::DolomitePlugins;
use dolomite::character::render::{CrowdMaterial, CrowdPlugin};
use dolomite::ground::TerrainView;
use dolomite::ground::detail::TerrainLod;
use dolomite::terrain::Fractal;
use dolomite::tessellation::render::{GeometryStats, PatchKind, PatchPlugin, PatchShader};
use dolomite::tessellation::{GeometryCamera, PatchLayout, Patches, shapes};

/// A frame.
const STEP: Duration = Duration::from_millis(16);

/// An app in which `ours` adds plugins before Bevy's, and `after` behind them.
fn app(ours: impl FnOnce(&mut App), after: impl FnOnce(&mut App)) -> Option<App> {
    app::app_around(STEP, false, ours, after)
}

#[derive(Resource, AsBindGroup, Clone)]
struct Globe {}

impl PatchKind for Globe {
    const LAYOUT: PatchLayout = PatchLayout::TRIANGLE;

    fn shader() -> PatchShader {
        PatchShader::File("shaders/globe.wgsl")
    }
}

/// Triangles of the stage once they are there; shader files come from a thread of their own.
fn triangles(app: &mut App) -> u32 {
    let mut last = 0;
    for _ in 0..600 {
        app.update();
        assert_eq!(app.should_exit(), None, "rendering stopped");
        let stats = app.world().get_resource::<GeometryStats>();
        let now = stats.map_or(0, |stats| stats.primitives);
        if now > 8 && now == last {
            return now;
        }
        last = now;
        std::thread::sleep(Duration::from_millis(2));
    }
    panic!("nothing was drawn");
}

fn globe(app: &mut App) -> u32 {
    let mesh = Arc::new(shapes::octahedron(1));
    app.world_mut().spawn(Patches::<Globe>::new(mesh));
    let place = Transform::from_xyz(0.0, 0.0, 4.0);
    let view = (place, GeometryCamera::default());
    camera::camera(app, UVec2::splat(64), view);
    triangles(app)
}

fn ground(app: &mut App) -> u32 {
    let hills = hills::Hills {
        centre: DVec2::ZERO,
        side: 512.0,
        noise: Fractal::default(),
        base: 0.0,
        sea: None,
    };
    hills.spawn(app);
    let place = Transform::from_xyz(0.0, 50.0, 0.0);
    let prepasses = (DepthPrepass, DeferredPrepass);
    let view = (place, prepasses, TerrainView, TerrainLod::default());
    camera::camera(app, UVec2::splat(64), view);
    triangles(app)
}

mod gpu {
    use super::*;

    #[test]
    fn patches_are_drawn_in_any_order_of_plugins() {
        let add = |app: &mut App| {
            app.add_plugins(PatchPlugin(Globe {}));
        };
        same_in_any_order(add, globe);
    }

    #[test]
    fn ground_is_drawn_in_any_order_of_plugins() {
        let add = |app: &mut App| {
            app.add_plugins(DolomitePlugins);
        };
        same_in_any_order(add, ground);
    }

    /// Draws with what `add` adds behind Bevy's plugins, and before them.
    fn same_in_any_order(add: fn(&mut App), draw: fn(&mut App) -> u32) {
        let Some(mut usual) = app(|_| (), add) else {
            return;
        };
        let usual = draw(&mut usual);
        let mut before = app(add, |_| ()).expect("Vulkan was there just now");
        assert_eq!(draw(&mut before), usual);
    }

    #[test]
    fn crowds_join_in_any_order_and_more_than_once() {
        for (name, before, after) in [
            ("before", true, false),
            ("after", false, true),
            ("twice", true, true),
        ] {
            let add = |is: bool| {
                move |app: &mut App| {
                    if is {
                        app.add_plugins(CrowdPlugin);
                    }
                }
            };
            let Some(mut app) = app(add(before), add(after)) else {
                return;
            };
            camera::camera(&mut app, UVec2::splat(32), ());
            for _ in 0..3 {
                app.update();
                assert_eq!(app.should_exit(), None, "{name}: rendering stopped");
            }
            let there = app.world().contains_resource::<Assets<CrowdMaterial>>();
            assert!(there, "{name}");
        }
    }
}

#[test]
fn without_a_renderer_crowds_are_left_out() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, CrowdPlugin));
    app.finish();
    app.cleanup();
    app.update();
    assert_eq!(app.should_exit(), None);
    assert!(!app.world().contains_resource::<Assets<CrowdMaterial>>());
}
