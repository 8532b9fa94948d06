//! Plugins in apps that nobody of ours wrote: added before Bevy's, added twice, or without what they need.
//! In any order the same is drawn.

use crate::person;
use crate::support::app;
use crate::support::camera;
use crate::support::hills;
use crate::support::picture;

use std::sync::Arc;
use std::time::Duration;

use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::render::render_resource::AsBindGroup;
use bevy::render::storage::ShaderBuffer;
use dolomite::DolomitePlugins;
use dolomite::character::crowd::{CrowdFigure, Palette};
use dolomite::character::render::{Crowd, CrowdLook, CrowdMaterial, CrowdPlugin};
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
    fn crowds_are_drawn_in_any_order_and_more_than_once() {
        let mut first = None;
        for (name, before, after) in [
            ("after", false, true),
            ("before", true, false),
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
            let (_, target) = camera::camera(&mut app, UVec2::splat(SIDE), Tonemapping::None);
            assert_eq!(
                red(&mut app, &target),
                0,
                "{name}: an empty world has a figure"
            );
            figure(&mut app);
            let drawn = red(&mut app, &target);
            // Seventeen boxes of 12 cm, some before others: three pixels of a side each.
            assert!(drawn > 60, "{name}: {drawn} pixels of a figure");
            assert_eq!(*first.get_or_insert(drawn), drawn, "{name}");
        }
    }
}

/// Pixels of a side of the crowd's picture.
const SIDE: u32 = 64;

/// A crowd of one, red in any light, three metres ahead.
fn figure(app: &mut App) {
    let rig = person::rig_with_mesh();
    let clips: Vec<usize> = (0..rig.clips.len()).collect();
    let palette = Palette::bake(&rig, 0, &clips, 30.0).expect("clips of the rig");
    let red = StandardMaterial {
        base_color: Color::srgb(1.0, 0.0, 0.0),
        unlit: true,
        ..default()
    };
    let look = app
        .world_mut()
        .resource_scope(|world, mut meshes: Mut<Assets<Mesh>>| {
            world.resource_scope(|world, mut materials: Mut<Assets<CrowdMaterial>>| {
                let mut buffers = world.resource_mut::<Assets<ShaderBuffer>>();
                let parts = [(&rig.meshes[0], red)];
                CrowdLook::new(
                    &palette,
                    &parts,
                    1,
                    &mut meshes,
                    &mut materials,
                    &mut buffers,
                )
            })
        });
    let frame = palette.frame(1, 0.0, true);
    let crowd = Crowd {
        anchor: Vec3::new(0.0, -1.0, -3.0),
        figures: vec![CrowdFigure::new(Vec3::ZERO, 0.0, frame, 0)],
    };
    app.world_mut().spawn((crowd, look));
}

/// Red pixels that the camera sees.
fn red(app: &mut App, target: &Handle<Image>) -> usize {
    let image = picture::picture(app, target, 10);
    let is_red = |index: &u32| {
        let pixel = image
            .get_color_at(index % SIDE, index / SIDE)
            .expect("a pixel")
            .to_srgba();
        pixel.red > 0.9 && pixel.green.max(pixel.blue) < 0.1
    };
    (0..SIDE * SIDE).filter(is_red).count()
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
