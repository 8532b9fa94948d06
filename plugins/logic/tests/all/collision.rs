//! Beside `dolomite_collision`: its triggers are heard, its triangles hide.

use crate::support::{app_with, said, steps};
use bevy::math::Vec3;
use bevy::transform::components::Transform;
use dolomite_collision::{
    CharacterBody, CollisionPlugin, MoveWish, TreeSettings, TriangleMesh, TriangleTree, Trigger,
};
use dolomite_logic::collision::TriangleRays;
use dolomite_logic::random::Random;
use dolomite_logic::rays::{BoxRays, Rays};
use dolomite_logic::{Door, Key, Wire, Wires};
use std::sync::Arc;

#[test]
fn a_mover_in_a_trigger_opens_a_door() {
    let mut app = app_with(|app| {
        app.add_plugins(CollisionPlugin);
    });
    let door = app.world_mut().spawn(Door::default()).id();
    let wires = Wires(vec![Wire::new(Key::ENTERED, door, Key::OPEN)]);
    let trigger = Trigger {
        half_size: Vec3::ONE,
    };
    let place = Transform::from_xyz(4.0, 0.0, 0.0);
    let trigger = app.world_mut().spawn((trigger, wires, place)).id();
    let mover = app.world_mut().spawn(CharacterBody::default()).id();
    for _ in 0..2 {
        // 10 m in a step: 640 m/s, through the trigger and out of it.
        app.world_mut()
            .entity_mut(mover)
            .insert(MoveWish(Vec3::X * 10.0));
        app.update();
    }
    let expected = [(trigger, Key::ENTERED), (trigger, Key::LEFT)];
    assert_eq!(said(&mut app), expected);
    steps(&mut app, 70);
    assert_eq!(said(&mut app), [(door, Key::OPENED)]);
}

#[test]
fn triangles_of_boxes_hide_as_boxes_do() {
    let mut random = Random::new(8);
    let boxes: Vec<[Vec3; 2]> = (0..40)
        .map(|_| {
            let low = Vec3::new(random.signed(50.0), random.signed(5.0), random.signed(50.0));
            let size = Vec3::new(random.unit(), random.unit(), random.unit());
            [low, low + 1.0 + size * 9.0]
        })
        .collect();
    let mut triangles = Vec::new();
    for [low, high] in &boxes {
        let middle = ((*low + *high) / 2.0).as_dvec3();
        let mesh = TriangleMesh::cuboid(middle, (*high - *low) / 2.0).expect("the test made it so");
        triangles.extend((0..12).map(|triangle| mesh.corners(triangle)));
    }
    let mesh = TriangleMesh::from_triangles(&triangles).expect("the test made it so");
    let tree = TriangleTree::new(mesh, TreeSettings::default());
    let (rays, boxes) = (TriangleRays(Arc::new(tree)), BoxRays::new(boxes, 8.0));
    let (mut hits, mut known, mut differ) = (0, 0, 0);
    let mut last = None;
    for _ in 0..4000 {
        let place = |random: &mut Random| {
            Vec3::new(random.signed(60.0), random.signed(8.0), random.signed(60.0))
        };
        let (from, to) = (place(&mut random), place(&mut random));
        let (ours, theirs) = (rays.cast(from, to), boxes.cast(from, to));
        if theirs.is_some_and(|stop| stop.time == 0.0) {
            // Triangles have no inside.
            continue;
        }
        match (ours, theirs) {
            (Some(ours), Some(theirs)) => {
                assert!(
                    (ours.time - theirs.time).abs() < 1e-4,
                    "{ours:?} {theirs:?}"
                );
                hits += 1;
                known += u32::from(rays.still_blocks(ours.blocker, from, to));
                last = Some(ours.blocker);
            }
            (None, None) => {
                let other = last.is_some_and(|last| rays.still_blocks(last, from, to));
                assert!(!other, "what is in the way of nothing blocks nothing");
            }
            _ => differ += 1,
        }
    }
    // A way that grazes an edge may be decided either way by the rounding of f32.
    assert!(hits > 500 && differ <= 2, "{hits} {differ}");
    assert!(known >= hits - 2, "{known} of {hits}");
    assert!(!rays.still_blocks(u64::MAX, Vec3::ZERO, Vec3::X));
}
