//! The same view is the same mesh, and nothing jumps.

use bevy::math::{DQuat, DVec2, DVec3};
use dolomite_terrain::{GroundPoint, Terrain};

use super::grounds::{Camera, Random, cameras, fbm, island};
use crate::blocks::choose::{Choice, Limits, choose, settle};
use crate::blocks::kept::KeptBlocks;
use crate::blocks::locate::locate;
use crate::blocks::mesh::{BlockMesh, mesh};

/// A mesh as a set: blocks may come in another order.
fn sorted(mesh: &BlockMesh) -> Vec<[[u32; 4]; 3]> {
    let corner = |k: u32| {
        let vertex = &mesh.vertices[k as usize];
        [
            vertex.at.x,
            vertex.at.y,
            vertex.height.to_bits(),
            vertex.share.to_bits(),
        ]
    };
    let mut all: Vec<_> = mesh.triangles.iter().map(|t| t.map(corner)).collect();
    all.sort_unstable();
    all
}

#[test]
fn looking_away_and_back_gives_the_same_bits() {
    let terrain = island();
    let cameras = cameras(&terrain);
    let mut blocks = KeptBlocks::new(terrain.clone(), 0.125);
    let look = |blocks: &mut KeptBlocks, camera: &Camera| {
        let choice = settle(blocks, &camera.bound(2.0), Limits::default());
        sorted(&mesh(blocks, &choice))
    };
    let first = look(&mut blocks, &cameras[0]);
    let other = look(&mut blocks, &cameras[3]);
    assert!(first.len() > 2000 && first != other);
    assert_eq!(first, look(&mut blocks, &cameras[0]));
    // Slots in another order, and after most was dropped.
    blocks.keep = 20;
    look(&mut blocks, &cameras[4]);
    blocks.keep = 4096;
    assert_eq!(first, look(&mut blocks, &cameras[0]));
    assert_eq!(
        first,
        look(&mut KeptBlocks::new(terrain, 0.125), &cameras[0])
    );
}

/// The largest number of pixels by which the drawn ground moves at a place from one choice to the next, as the
/// second camera sees it.
fn largest_move(
    blocks: &KeptBlocks,
    terrain: &Terrain,
    [before, after]: [&Choice; 2],
    camera: &Camera,
    random: &mut Random,
) -> f64 {
    let mut largest = 0.0_f64;
    let forward = camera.turn * DVec3::NEG_Z;
    for _ in 0..1500 {
        // Near ones as often as far ones.
        let share = random.unit() as f32;
        let away = 2.0 * f64::from(bevy::math::ops::powf(200.0, share));
        let aside = (random.unit() - 0.5) * 2.0 * away;
        let along = DVec2::new(forward.x, forward.z).normalize();
        let xz = DVec2::new(camera.eye.x, camera.eye.z) + along * away + along.perp() * aside;
        if !terrain.extent().contains(xz) {
            continue;
        }
        let height = |choice: &Choice| {
            let found = locate(blocks, choice, GroundPoint::new(xz)).expect("on the ground");
            DVec3::new(xz.x, found.height, xz.y)
        };
        if let Some(pixels) = camera.pixels(height(before), height(after)) {
            largest = largest.max(pixels);
        }
    }
    largest
}

#[test]
fn vertices_move_by_less_than_a_quarter_of_a_pixel_a_frame() {
    let terrain = fbm();
    let start = Camera::at(&terrain, DVec2::new(-60.0, 210.0), 30.0, 0.4, -0.3);
    let ahead = start.turn * DVec3::NEG_Z;
    let walk = Camera::at(&terrain, DVec2::new(-60.0, 210.0), 1.7, 0.4, -0.05);
    let mut random = Random::new(3);
    for (start, step, turn) in [
        (walk, ahead.with_y(0.0) * (1.4 / 60.0), 0.0),
        (start, ahead.with_y(0.0) * (200.0 / 60.0), 0.0),
        (start, DVec3::ZERO, std::f64::consts::PI / 60.0),
    ] {
        let mut blocks = KeptBlocks::new(terrain.clone(), 0.125);
        let camera = |frame: i32| Camera {
            eye: start.eye + step * f64::from(frame),
            turn: DQuat::from_rotation_y(turn * f64::from(frame)) * start.turn,
            ..start
        };
        let mut before = settle(&mut blocks, &camera(0).bound(1.0), Limits::default());
        let mut largest = 0.0_f64;
        for frame in 1..8 {
            let after = settle(&mut blocks, &camera(frame).bound(1.0), Limits::default());
            let moved = largest_move(
                &blocks,
                &terrain,
                [&before, &after],
                &camera(frame),
                &mut random,
            );
            largest = largest.max(moved);
            before = after;
        }
        println!("moved by {largest} pixels");
        assert!(largest > 0.0 && largest <= 0.25, "{largest}");
        // A jump of the tolerance is seen.
        let far = choose(&mut blocks, &camera(7).bound(2.0), Limits::default());
        let jump = largest_move(&blocks, &terrain, [&before, &far], &camera(7), &mut random);
        assert!(jump > 0.25, "{jump}");
    }
}
