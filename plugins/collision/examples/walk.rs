//! A figure walks over a floor, up a step, and along a blocker; no window, no GPU.
//!
//! `cargo run -p dolomite_collision --example walk`

use bevy::MinimalPlugins;
use bevy::app::App;
use bevy::ecs::prelude::*;
use bevy::math::{DVec3, Vec3};
use bevy::time::{Fixed, Time, TimeUpdateStrategy};
use bevy::transform::components::Transform;
use dolomite_collision::{
    Blocker, CharacterBody, Collider, CollisionPlugin, MeshError, MoveState, MoveWish,
    TreeSettings, TriangleMesh, TriangleTree,
};
use std::sync::Arc;
use std::time::Duration;

fn main() -> Result<(), MeshError> {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, CollisionPlugin));
    // One step an update, for the sake of this example.
    let step = Duration::from_millis(16);
    app.insert_resource(Time::<Fixed>::from_duration(step));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(step));

    let floor = TriangleMesh::cuboid(DVec3::new(0.0, -0.5, 0.0), Vec3::new(20.0, 0.5, 20.0))?;
    let stair = TriangleMesh::cuboid(DVec3::new(3.0, 0.1, 0.0), Vec3::new(1.0, 0.1, 4.0))?;
    for mesh in [floor, stair] {
        let tree = TriangleTree::new(mesh, TreeSettings::default());
        app.world_mut().spawn(Collider(Arc::new(tree)));
    }
    app.world_mut().spawn((
        Blocker {
            half_size: Vec3::new(0.5, 2.0, 5.0),
        },
        Transform::from_xyz(7.0, 2.0, 0.0),
    ));
    let figure = app
        .world_mut()
        .spawn((CharacterBody::default(), Transform::from_xyz(0.0, 1.0, 0.0)))
        .id();
    for count in 0..=150 {
        if count % 15 == 0 {
            let world = app.world();
            let place = world.get::<Transform>(figure).map(|t| t.translation);
            let stands = world.get::<MoveState>(figure).map(MoveState::grounded);
            println!("{count:3}: {place:?}, stands: {stands:?}");
        }
        app.world_mut()
            .entity_mut(figure)
            .insert(MoveWish(Vec3::new(0.06, -0.02, 0.01)));
        app.update();
    }
    Ok(())
}
