//! What a scene does not need costs nothing: counted.

use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::PipelineCache;
use dolomite_deferred::choice::Chosen;
use dolomite_deferred::render::{ViewLighting, ViewStats};
use dolomite_deferred::{DeferredLighting, DeferredStats, Way};

use dolomite_testkit::light as support;

/// Pipelines of the whole app, and of them ours.
fn pipelines(app: &App) -> (usize, usize) {
    let cache = app.sub_app(RenderApp).world().resource::<PipelineCache>();
    let ours = cache.pipelines().filter(|pipeline| {
        use bevy::render::render_resource::PipelineDescriptor::{
            ComputePipelineDescriptor, RenderPipelineDescriptor,
        };
        let label = match &pipeline.descriptor {
            RenderPipelineDescriptor(descriptor) => &descriptor.label,
            ComputePipelineDescriptor(descriptor) => &descriptor.label,
        };
        label
            .as_ref()
            .is_some_and(|label| label.starts_with("dolomite_deferred"))
    });
    (cache.pipelines().count(), ours.count())
}

fn views(app: &App) -> Vec<ViewStats> {
    app.world().resource::<DeferredStats>().views()
}

fn only(app: &App) -> ViewStats {
    let views = views(app);
    assert_eq!(views.len(), 1);
    views[0]
}

fn sphere(app: &mut App) {
    let mesh = app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(Sphere::new(1.0));
    let material = app
        .world_mut()
        .resource_mut::<Assets<StandardMaterial>>()
        .add(StandardMaterial::default());
    app.world_mut()
        .spawn((Mesh3d(mesh), MeshMaterial3d(material)));
}

fn eye() -> Transform {
    Transform::from_xyz(0.0, 0.0, 4.0)
}

#[test]
fn each_part_is_there_when_it_is_needed_and_only_then() {
    let (Some(mut bare), Some(mut app)) = (support::app(false), support::app(true)) else {
        return;
    };
    for app in [&mut bare, &mut app] {
        sphere(app);
        support::camera(app, [64, 64], eye(), ());
        support::frames(app, 10);
    }
    assert_eq!(
        pipelines(&bare),
        pipelines(&app),
        "without the component nothing is ours"
    );
    assert_eq!(views(&app), []);
    // Without lights the full-screen pass is all.
    let camera = support::camera(&mut app, [64, 64], eye(), DeferredLighting::default());
    support::frames(&mut app, 4);
    let none = only(&app);
    assert_eq!(
        (none.chosen, none.lights, none.passes),
        (Chosen::Nothing, 0, 1)
    );
    assert_eq!(none.bytes, 32, "the uniform");
    // Bevy's key of a view may be another one in its first frame.
    let first = pipelines(&app).1;
    assert!((1..=2).contains(&first), "{first}");
    // A light behind the camera is none.
    let lamp = (
        PointLight {
            range: 3.0,
            ..default()
        },
        Transform::from_xyz(0.0, 0.0, 9.0),
    );
    let behind = app.world_mut().spawn(lamp).id();
    support::frames(&mut app, 3);
    assert_eq!(only(&app).chosen, Chosen::Nothing);
    assert_eq!(pipelines(&app).1, first);
    // One in view is gone through.
    app.world_mut()
        .entity_mut(behind)
        .insert(Transform::from_xyz(0.0, 2.0, 2.0));
    support::frames(&mut app, 3);
    let one = only(&app);
    assert_eq!(
        (one.chosen, one.lights, one.passes),
        (Chosen::BruteForce, 1, 1)
    );
    // Rows and list, in powers of two.
    assert_eq!(one.bytes, 32 + 64 + 16);
    assert_eq!(pipelines(&app).1, first + 1);
    // Many are listed in tiles.
    for k in 0..20 {
        let place = Transform::from_xyz(k as f32 * 0.1 - 1.0, 1.5, 1.0);
        app.world_mut().spawn((PointLight::default(), place));
    }
    support::frames(&mut app, 3);
    let many = only(&app);
    assert_eq!(
        (many.chosen, many.lights, many.passes),
        (Chosen::Tiled, 21, 2)
    );
    assert_eq!(
        pipelines(&app).1,
        first + 3,
        "the lists, and the pass that reads them"
    );
    let tiled = many.bytes;
    app.world_mut()
        .entity_mut(camera)
        .insert(DeferredLighting { way: Way::Volumes });
    support::frames(&mut app, 3);
    let volumes = only(&app);
    assert_eq!((volumes.chosen, volumes.passes), (Chosen::Volumes, 2));
    assert_eq!(volumes.bytes, 32 + 2048 + 128 + 64 * 64 * 16);
    assert!(tiled > volumes.bytes);
    assert_eq!(
        pipelines(&app).1,
        first + 6,
        "points, spots, and the pass that reads their sum"
    );
    // With the component all goes but compiled pipelines.
    app.world_mut()
        .entity_mut(camera)
        .remove::<DeferredLighting>();
    support::frames(&mut app, 3);
    assert_eq!(views(&app), []);
    let world = app.sub_app_mut(RenderApp).world_mut();
    assert_eq!(world.query::<&ViewLighting>().iter(world).count(), 0);
}

#[test]
fn without_a_renderer_the_component_is_plain_data() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, dolomite_deferred::DeferredPlugin));
    let camera = app.world_mut().spawn(DeferredLighting::default()).id();
    app.finish();
    app.update();
    app.world_mut()
        .entity_mut(camera)
        .remove::<DeferredLighting>();
    app.world_mut().despawn(camera);
    app.update();
}
