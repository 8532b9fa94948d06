//! The example of the README, drawn.
use crate::app;
use crate::waves;

use bevy::prelude::*;
use dolomite_geometry::GeometryStats;
use dolomite_geometry::render::{GeometryCensus, census};

#[test]
fn waves_are_drawn_among_bevys_meshes_gpu() {
    let Some(mut app) = app::app(|app| {
        app::bevys(app);
        app.add_plugins(waves::WavesPlugin)
            .add_systems(Startup, waves::setup);
    }) else {
        return;
    };
    app.update();
    let held = |app: &App| census(app.sub_app(bevy::render::RenderApp).world());
    let target = app::target(&mut app, [640, 360]);
    app::retarget(&mut app, &target);
    app::frames(&mut app, 40);
    let picture = app::picture(&mut app, &target);
    let blue = app::count(&picture, 0, 640, |c| c.blue > 1.5 * c.red && c.blue > 0.01);
    let red = app::count(&picture, 0, 640, |c| c.red > 2.0 * c.blue && c.red > 0.05);
    assert!(blue > 50_000 && red > 1000, "{blue} {red}");
    app::keep(picture, "waves.png");
    let stats = app.world().resource::<GeometryStats>().clone();
    assert_eq!(stats.primitives, 2 * 256 * 256, "{stats:?}");
    // The pools alone are 257² vertices of 20 bytes and 2 · 256² triangles of 12.
    let pools = 257 * 257 * 20 + 2 * 256 * 256 * 12;
    assert!(stats.allocated > pools, "{stats:?}");
    assert_eq!(held(&app).bytes, stats.allocated);
    assert_eq!(stats.pools.len(), 1);

    // Without its camera nothing is kept but for pipelines.
    let world = app.world_mut();
    let mut cameras = world.query_filtered::<Entity, With<Camera>>();
    for camera in cameras.iter(world).collect::<Vec<_>>() {
        world.despawn(camera);
    }
    app::frames(&mut app, 3);
    let left = held(&app);
    let none = GeometryCensus {
        pipelines: left.pipelines,
        ..default()
    };
    assert_eq!(left, none);
    assert_eq!(app.world().resource::<GeometryStats>().allocated, 0);
}
