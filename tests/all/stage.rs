//! The programmable tessellation stage in an app that renders: what it costs, what it does with
//! several kinds, cameras and lights, and with functions that cannot be used.

use crate::support::app;
use crate::support::camera;
use crate::support::picture;

use std::sync::Arc;
use std::time::Duration;

use bevy::app::App;
use bevy::asset::io::embedded::EmbeddedAssetRegistry;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::AsBindGroup;
use dolomite::tessellation::render::{
    GeometryCensus, GeometryStats, PatchKind, PatchPlugin, PatchPool, PatchShader, census,
};
use dolomite::tessellation::{Drawing, GeometryCamera, PatchLayout, PatchMesh, Patches, shapes};

#[derive(Resource, AsBindGroup, Clone)]
struct Globe {
    pool: PatchPool,
}

impl PatchKind for Globe {
    const LAYOUT: PatchLayout = PatchLayout::TRIANGLE;

    fn shader() -> PatchShader {
        PatchShader::File("shaders/globe.wgsl")
    }

    fn pool(&self) -> PatchPool {
        self.pool
    }
}

#[derive(Resource, AsBindGroup, Clone)]
struct Tube {}

impl PatchKind for Tube {
    const LAYOUT: PatchLayout = PatchLayout::lines(4);
    const AMPLIFIED: u32 = 72;

    fn shader() -> PatchShader {
        PatchShader::File("shaders/tube.wgsl")
    }
}

/// Follows the time in the vertex shader of its draws.
#[derive(Resource, AsBindGroup, Clone)]
struct Waving {}

impl PatchKind for Waving {
    const LAYOUT: PatchLayout = PatchLayout::QUAD;
    const DRAWING: Drawing = Drawing::Evaluated;
    const ANIMATED: bool = true;
    const MOVES: bool = true;
    const CUSTOM_MATERIAL: bool = true;

    fn shader() -> PatchShader {
        PatchShader::File("embedded://waving.wgsl")
    }
}

/// A white flag that moves up and down by half its height twice a second.
const WAVING: &str = "
#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, patch_point, stage}
#import dolomite::geometry::draw_types::{Shaded, Surface}
fn control(input: Patch, view: StageView) -> PatchLevels {
    return PatchLevels(vec4(5.0), vec2(5.0));
}
fn place(at: vec3<f32>, time: f32) -> vec3<f32> {
    return vec3(at.x * 2.0 - 1.0, at.y * 0.5 - 0.25 + 0.5 * sin(12.566 * time), 0.0);
}
fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    return Vertex(place(at, stage.view.time), vec3(0.0, 0.0, 1.0), at.xy, place(at, stage.view.previous_time), 0u);
}
fn material(surface: Surface) -> Shaded {
    return Shaded(vec3(1.0), vec3(0.0), surface.normal, 1.0, 0.0, 0.5, 1.0, true, true);
}
";

/// Its file has no function `evaluate`.
#[derive(Resource, AsBindGroup, Clone)]
struct Broken {}

impl PatchKind for Broken {
    const LAYOUT: PatchLayout = PatchLayout::TRIANGLE;

    fn shader() -> PatchShader {
        PatchShader::File("embedded://broken.wgsl")
    }
}

/// Its file is not there.
#[derive(Resource, AsBindGroup, Clone)]
struct Missing {}

impl PatchKind for Missing {
    const LAYOUT: PatchLayout = PatchLayout::TRIANGLE;

    fn shader() -> PatchShader {
        PatchShader::File("shaders/there_is_no_such.wgsl")
    }
}

const ROOMY: Globe = Globe {
    pool: PatchPool {
        vertices: 1 << 16,
        primitives: 1 << 17,
    },
};

fn app(globe: Globe) -> Option<App> {
    app::app(Duration::from_millis(16), |app| {
        app.world()
            .resource::<EmbeddedAssetRegistry>()
            .insert_asset(
                "broken.wgsl".into(),
                std::path::Path::new("broken.wgsl"),
                b"#import dolomite::stage::api::{Patch, PatchLevels, StageView}\n\
          fn control(input: Patch, view: StageView) -> PatchLevels { return nonsense; }\n"
                    .as_slice(),
            );
        app.world()
            .resource::<EmbeddedAssetRegistry>()
            .insert_asset(
                "waving.wgsl".into(),
                std::path::Path::new("waving.wgsl"),
                WAVING.as_bytes(),
            );
        app.add_plugins((
            PatchPlugin(Waving {}),
            PatchPlugin(globe),
            PatchPlugin(Tube {}),
            PatchPlugin(Broken {}),
            PatchPlugin(Missing {}),
        ));
    })
}

fn camera(app: &mut App, components: impl Bundle) -> Entity {
    camera_into(app, components).0
}

fn camera_into(app: &mut App, components: impl Bundle) -> (Entity, Handle<Image>) {
    let place = Transform::from_xyz(0.0, 0.0, 4.0);
    camera::camera(app, UVec2::splat(64), (place, components))
}

fn line() -> PatchMesh {
    let points = [-2.0, -1.0, 1.0, 2.0_f32].map(|x| [x, x * x * 0.2, 0.0, 0.1]);
    PatchMesh::from_patches(PatchLayout::lines(4), &points).expect("one line")
}

/// Runs until `done` says so; the counters come back two or three frames late.
fn until(app: &mut App, what: &str, done: impl Fn(&GeometryStats) -> bool) -> GeometryStats {
    for _ in 0..600 {
        app.update();
        assert_eq!(app.should_exit(), None, "rendering stopped");
        let stats = app.world().resource::<GeometryStats>();
        if done(stats) {
            return stats.clone();
        }
        // Shader files come from a thread of their own.
        std::thread::sleep(Duration::from_millis(2));
    }
    panic!("{what}: {:?}", app.world().resource::<GeometryStats>());
}

fn found(app: &App) -> GeometryCensus {
    census(app.sub_app(RenderApp).world())
}

/// The counters of some more frames.
fn frames(app: &mut App, count: u32) -> Vec<u32> {
    (0..count)
        .map(|_| {
            app.update();
            app.world().resource::<GeometryStats>().dispatches
        })
        .collect()
}

#[test]
fn what_is_not_there_costs_nothing_and_what_rests_is_not_done_again() {
    let Some(mut app) = app(ROOMY) else { return };
    camera(&mut app, ());
    frames(&mut app, 5);
    assert_eq!(
        found(&app),
        GeometryCensus::default(),
        "no patches, no camera"
    );
    let fine = GeometryCamera {
        pixels_per_edge: 2.0,
        ..default()
    };
    let eye = camera(&mut app, fine);
    frames(&mut app, 5);
    assert_eq!(found(&app), GeometryCensus::default(), "no patches");
    let globe = Arc::new(shapes::octahedron(1));
    for x in [-0.4, 0.0, 0.4] {
        let place = Transform::from_xyz(x, 0.0, 0.0).with_scale(Vec3::splat(0.3));
        app.world_mut()
            .spawn((Patches::<Globe>::new(globe.clone()), place));
    }
    let first = until(&mut app, "three globes", |stats| stats.primitives > 24);
    assert_eq!((found(&app).kinds, found(&app).views), (1, 1));
    frames(&mut app, 4);
    assert!(
        frames(&mut app, 20)
            .iter()
            .all(|dispatches| *dispatches == 0),
        "nothing moves"
    );
    // The camera moves: seven dispatches, once.
    let mut place = app.world_mut().get_mut::<Transform>(eye).expect("a camera");
    place.translation.z = 1.8;
    let after = frames(&mut app, 8);
    assert_eq!(after.iter().sum::<u32>(), 7, "{after:?}");
    let closer = app.world().resource::<GeometryStats>().clone();
    assert!(closer.primitives > first.primitives, "{closer:?}");
    // Back again: the same, to the triangle.
    let mut place = app.world_mut().get_mut::<Transform>(eye).expect("a camera");
    place.translation.z = 4.0;
    frames(&mut app, 8);
    let back = app.world().resource::<GeometryStats>().clone();
    assert_eq!(
        (back.primitives, back.vertices),
        (first.primitives, first.vertices)
    );
}

/// Two kinds, five entities, two cameras, a light of four cascades for each: each kind is
/// tessellated once a camera, however many views draw it.
#[test]
fn shadow_views_draw_what_was_tessellated_once() {
    let Some(mut app) = app(ROOMY) else { return };
    let (globe, line) = (Arc::new(shapes::octahedron(1)), Arc::new(line()));
    for x in [-1.0, 0.0, 1.0] {
        let place = Transform::from_xyz(x, 0.0, 0.0).with_scale(Vec3::splat(0.4));
        app.world_mut()
            .spawn((Patches::<Globe>::new(globe.clone()), place));
    }
    for y in [-0.5, 0.5] {
        app.world_mut().spawn((
            Patches::<Tube>::new(line.clone()),
            Transform::from_xyz(0.0, y, 0.0),
        ));
    }
    let light = DirectionalLight {
        shadow_maps_enabled: true,
        ..default()
    };
    app.world_mut().spawn((
        light,
        Transform::default().looking_to(Vec3::new(-1.0, -2.0, -1.0), Vec3::Y),
    ));
    camera(&mut app, GeometryCamera::default());
    camera(&mut app, GeometryCamera::default());
    until(&mut app, "two kinds", |stats| stats.primitives > 60);
    frames(&mut app, 6);
    assert_eq!((found(&app).kinds, found(&app).views), (2, 4));
    assert!(
        frames(&mut app, 6)
            .iter()
            .all(|dispatches| *dispatches == 0)
    );
    // One globe moves: its kind alone, once for each camera. Nothing stores where it was.
    let mut globes = app
        .world_mut()
        .query_filtered::<&mut Transform, With<Patches<Globe>>>();
    let mut place = globes.iter_mut(app.world_mut()).next().expect("a globe");
    place.translation.y = 0.3;
    let after = frames(&mut app, 8);
    assert_eq!(after.iter().sum::<u32>(), 14, "{after:?}");
}

#[test]
fn functions_that_cannot_be_used_are_named_and_the_others_are_drawn() {
    let Some(mut app) = app(ROOMY) else { return };
    let globe = Arc::new(shapes::octahedron(1));
    app.world_mut().spawn(Patches::<Broken>::new(globe.clone()));
    app.world_mut()
        .spawn(Patches::<Missing>::new(globe.clone()));
    app.world_mut().spawn(Patches::<Globe>::new(globe));
    camera(&mut app, GeometryCamera::default());
    let stats = until(&mut app, "two faults and a globe", |stats| {
        stats.primitives > 8 && stats.faults.len() == 2
    });
    let fault = |kind: &str| {
        let named = |fault: &&_| -> bool {
            let fault: &dolomite::tessellation::render::GeometryFault = fault;
            fault.kind.ends_with(kind)
        };
        stats.faults.iter().find(named).expect(kind).to_string()
    };
    assert!(fault("Broken").contains("nonsense") || fault("Broken").contains("evaluate"));
    assert!(
        fault("Missing").contains("there_is_no_such.wgsl"),
        "{}",
        fault("Missing")
    );
}

#[test]
fn a_pool_of_a_kibibyte_lowers_levels_and_the_app_goes_on() {
    let pool = PatchPool::bytes(1024);
    let Some(mut app) = app(Globe { pool }) else {
        return;
    };
    app.world_mut()
        .spawn(Patches::<Globe>::new(Arc::new(shapes::octahedron(1))));
    camera(&mut app, GeometryCamera::default());
    let stats = until(&mut app, "a globe", |stats| stats.primitives > 0);
    assert!(
        stats.lowered > 0 && stats.vertices <= pool.vertices,
        "{stats:?}"
    );
    assert!(stats.primitives >= 8 && stats.wanted_primitives > stats.primitives);
}

/// The rows of the camera's picture that are white.
fn white_rows(app: &mut App, image: &Handle<Image>) -> Vec<usize> {
    let picture = picture::picture(app, image, 0);
    let bright = |row: &usize| {
        let pixel = picture.get_color_at(32, *row as u32).expect("a pixel");
        pixel.to_linear().green > 0.5
    };
    (0..64).filter(bright).collect()
}

/// A changed file takes effect at once, though nothing moves; a faulty one leaves what was drawn and
/// says so, and its correction is taken.
#[test]
fn functions_are_loaded_again() {
    let Some(mut app) = app(ROOMY) else { return };
    let points = [
        [0.0; 4],
        [1.0, 0.0, 0.0, 0.0],
        [1.0, 1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
    ];
    let mesh = PatchMesh::from_patches(PatchLayout::QUAD, &points).expect("one patch");
    app.world_mut()
        .spawn(Patches::<Waving>::new(Arc::new(mesh)));
    camera(&mut app, GeometryCamera::default());
    until(&mut app, "levels of 5", |stats| stats.primitives == 50);
    frames(&mut app, 6);
    let path = "embedded://waving.wgsl";
    let file: Handle<Shader> = app.world().resource::<AssetServer>().load(path);
    let save = |app: &mut App, source: String| {
        let mut shaders = app.world_mut().resource_mut::<Assets<Shader>>();
        let shader = Shader::from_wgsl(source, path);
        shaders
            .insert(file.id(), shader)
            .expect("a file that was loaded");
    };
    save(
        &mut app,
        WAVING.replace("vec4(5.0), vec2(5.0)", "vec4(7.0), vec2(7.0)"),
    );
    until(&mut app, "levels of 7", |stats| stats.primitives == 98);
    save(&mut app, WAVING.replace("vec4(5.0)", "vec4(five)"));
    until(&mut app, "a fault", |stats| {
        stats.primitives == 98
            && stats
                .faults
                .iter()
                .any(|fault| fault.kind.ends_with("Waving"))
    });
    save(
        &mut app,
        WAVING.replace("vec4(5.0), vec2(5.0)", "vec4(3.0), vec2(3.0)"),
    );
    until(&mut app, "levels of 3", |stats| {
        stats.primitives == 18
            && !stats
                .faults
                .iter()
                .any(|fault| fault.kind.ends_with("Waving"))
    });
}

/// Vertices that the draws evaluate: the flag waves, and nothing is dispatched for it.
#[test]
fn what_the_draws_evaluate_moves_without_a_dispatch() {
    let Some(mut app) = app(ROOMY) else { return };
    app.insert_resource(bevy::pbr::DefaultOpaqueRendererMethod::deferred());
    let points = [
        [0.0; 4],
        [1.0, 0.0, 0.0, 0.0],
        [1.0, 1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
    ];
    let mesh = PatchMesh::from_patches(PatchLayout::QUAD, &points).expect("one patch");
    app.world_mut()
        .spawn(Patches::<Waving>::new(Arc::new(mesh)));
    let (_, image) = camera_into(&mut app, (GeometryCamera::default(), Tonemapping::None));
    until(&mut app, "a flag", |stats| stats.primitives == 50);
    frames(&mut app, 6);
    assert!(
        frames(&mut app, 10)
            .iter()
            .all(|dispatches| *dispatches == 0)
    );
    let rows: Vec<Vec<usize>> = (0..6).map(|_| white_rows(&mut app, &image)).collect();
    assert!(rows.iter().all(|rows| !rows.is_empty()), "{rows:?}");
    assert!(rows.iter().any(|other| other != &rows[0]), "{rows:?}");
    assert_eq!(app.world().resource::<GeometryStats>().dispatches, 0);
    // 12 bytes a vertex.
    let stats = app.world().resource::<GeometryStats>();
    assert_eq!(stats.bytes, u64::from(stats.vertices) * 12 + 50 * 12);
}
