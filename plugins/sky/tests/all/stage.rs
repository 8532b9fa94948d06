//! The stage that a camera gets for its stars and moon, in an app without a renderer: what it asks for, and whose it is
//! when the sky goes.
use crate::support;

use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::prelude::*;
use dolomite_sky::Sky;
use dolomite_tessellation::GeometryCamera;
use support::{app, camera, found, small, sun};

#[test]
fn the_stage_of_a_camera_that_had_none_does_not_ask_for_a_g_buffer() {
    let mut app = app();
    let plain = camera(&mut app, small());
    let deferred = camera(&mut app, (small(), DepthPrepass, DeferredPrepass));
    let own = GeometryCamera {
        pixels_per_edge: 3.0,
        ..default()
    };
    let staged = camera(&mut app, (small(), own.clone()));
    sun(&mut app, -30.0);
    found(&mut app);
    let world = app.world();
    for (camera, expected) in [(plain, false), (deferred, true), (staged, true)] {
        let has = world.get::<DepthPrepass>(camera).is_some();
        assert_eq!(
            (has, world.get::<DeferredPrepass>(camera).is_some()),
            (expected, expected)
        );
    }
    assert!(world.get::<GeometryCamera>(plain).is_some());
    assert_eq!(world.get::<GeometryCamera>(staged), Some(&own));
    for camera in [plain, staged] {
        app.world_mut().entity_mut(camera).remove::<Sky>();
    }
    app.update();
    assert!(
        app.world().get::<GeometryCamera>(plain).is_none(),
        "it goes with the sky"
    );
    assert_eq!(app.world().get::<GeometryCamera>(staged), Some(&own));
}

/// As the view of a terrain is: it needs the stage.
#[derive(Component, Default)]
#[require(GeometryCamera)]
struct SeesGround;

#[test]
fn the_stage_stays_with_who_needs_it_when_the_sky_goes() {
    let mut app = app();
    let ground = camera(&mut app, small());
    let set = camera(&mut app, small());
    let plain = camera(&mut app, small());
    sun(&mut app, -30.0);
    found(&mut app);
    // After nightfall: the stage of the sky is there already.
    app.world_mut().entity_mut(ground).insert(SeesGround);
    let own = GeometryCamera {
        lines: true,
        ..default()
    };
    app.world_mut().entity_mut(set).insert(own.clone());
    for camera in [ground, set, plain] {
        app.world_mut().entity_mut(camera).remove::<Sky>();
    }
    found(&mut app);
    let stage = |camera| app.world().get::<GeometryCamera>(camera).cloned();
    assert_eq!(stage(ground), Some(GeometryCamera::default()));
    assert_eq!(stage(set), Some(own));
    assert_eq!(stage(plain), None, "it goes with the sky");
    let world = app.world();
    assert!(world.get::<DeferredPrepass>(ground).is_some());
    assert!(world.get::<DeferredPrepass>(plain).is_none());
    // A camera that goes with its sky is no fault.
    let last = camera(&mut app, small());
    found(&mut app);
    app.world_mut().despawn(last);
    found(&mut app);
}
