//! The bound on the triangles that the adapter drew close to the eye, where samples say little of the ground: at once,
//! while blocks are made, and settled. The reference has a longer search: `src/blocks/tests/near.rs`.

use super::support::{MOST, params, view_at};
use bevy::math::{DVec2, DVec3, Vec3};
use dolomite_ground::detail::{DetailGround, DetailView};
use dolomite_terrain::Terrain;
use dolomite_testkit::blocks::{BlockRun, BlockStage};
use dolomite_testkit::gpu::for_test;
use dolomite_testkit::missed::{massif, missed};
use dolomite_testkit::random::Random;
use std::f64::consts::TAU;

/// Tolerance, pixels of a picture of 640 × 360.
const PIXELS: f32 = 24.0;
/// Metres about the eye that are looked at, and how many places of them.
const REACH: f64 = 12.0;
const PLACES: usize = 2000;
/// Blocks made a choice: few, so that there is something to see before it is settled.
const BUDGET: u32 = 16;

/// Right, up, depth of a point relative to the view's anchor.
fn local(view: &DetailView, at: DVec3) -> DVec3 {
    let axis = |axis: [f32; 3]| Vec3::from(axis).as_dvec3();
    let from = at - axis(view.eye);
    DVec3::new(
        axis(view.right).dot(from),
        axis(view.up).dot(from),
        axis(view.forward).dot(from),
    )
}

/// Pixels between two points of which one is seen, as far as the way between them lies beyond the near plane.
fn pixels(view: &DetailView, a: DVec3, b: DVec3) -> Option<f64> {
    let (a, b) = (local(view, a), local(view, b));
    let (near, scale) = (f64::from(view.near), f64::from(view.scale));
    let on_screen = |at: DVec3| at.truncate() / at.z * scale;
    let sees = |at: DVec3| {
        let half = DVec2::new(320.0, 180.0);
        at.z >= near && on_screen(at).abs().cmple(half).all()
    };
    let cut = |from: DVec3, to: DVec3| {
        let cut = from.lerp(to, (near - from.z) / (to.z - from.z));
        on_screen(if from.z >= near { from } else { cut })
    };
    (sees(a) || sees(b)).then(|| cut(a, b).distance(cut(b, a)))
}

/// The largest error about the eye over `limit` pixels, and of how many places.
fn look(
    terrain: &Terrain,
    view: &DetailView,
    (run, anchor_height): (&BlockRun, f32),
    limit: f64,
    random: &mut Random,
) -> (f64, usize) {
    let anchor = view.anchor().as_dvec2();
    let eye = DVec2::new(f64::from(view.eye[0]), f64::from(view.eye[2]));
    let lift = DVec3::Y * f64::from(anchor_height);
    let flat = |at: DVec3| DVec2::new(at.x, at.z);
    let corner = |k: u32| Vec3::from(run.positions[k as usize]).as_dvec3() + lift;
    let near: Vec<[DVec3; 3]> = run
        .triangles
        .iter()
        .map(|corners| corners.map(corner))
        .filter(|&[a, b, c]| {
            let (low, high) = (flat(a.min(b).min(c)), flat(a.max(b).max(c)));
            low.cmplt(eye + REACH).all() && high.cmpgt(eye - REACH).all()
        })
        .collect();
    let (mut largest, mut looked) = (0.0_f64, 0);
    for _ in 0..PLACES {
        let turn = DVec2::from_angle(random.unit() * TAU);
        let share = random.unit();
        let at = eye + turn * REACH * (0.02 + 0.98 * share * share * share);
        let drawn = near.iter().find_map(|&[a, b, c]| {
            let area = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a);
            let [p, q, r] = [a, b, c].map(flat);
            let weights = [area(at, q, r), area(p, at, r), area(p, q, at)];
            let [u, v, w] = weights.map(|weight| weight / area(p, q, r));
            (u.min(v).min(w) >= -1e-9).then_some(u * a.y + v * b.y + w * c.y)
        });
        let Some(drawn) = drawn else {
            continue;
        };
        let truth = terrain.sample_f64(anchor + at).height.max(0.0);
        let place = |y: f64| DVec3::new(at.x, y, at.y);
        if let Some(pixels) = pixels(view, place(truth), place(drawn)) {
            looked += 1;
            largest = largest.max(pixels / limit);
        }
    }
    (largest, looked)
}

#[test]
fn gpu_triangles_near_the_eye_keep_to_what_is_said_to_be_held_where_samples_say_little() {
    let Some(gpu) = for_test() else { return };
    let terrain = massif();
    let mut random = Random::new(3);
    let hostile = missed(&terrain, 1000, 700.0, 1);
    let worst = hostile.first().map_or(0.0, |worst| worst.beyond);
    assert!(worst > 40.0, "samples miss {worst} m at most");
    let laid = DetailGround::new(terrain.clone(), 1.0 / 32.0);
    let mut stage = BlockStage::new(&gpu, &laid, 4096).expect("passes");
    let (mut largest, mut places) = (0.0_f64, 0);
    for k in 0..8 {
        let xz = hostile[k % hostile.len()].place;
        let above = 0.3 + 2.7 * random.unit() * random.unit();
        let turn = [TAU * random.unit(), 1.4 * random.signed_unit()];
        let view = view_at(&terrain, xz, above, turn, PIXELS);
        let params = params(&laid, view);
        let mut judge = |run: &BlockRun| {
            let held = f64::from(run.left.max(run.coarsening));
            let limit = f64::from(PIXELS) * held.max(1.0);
            let with = (run, params.anchor_height);
            let (most, looked) = look(&terrain, &view, with, limit, &mut random);
            assert!(most <= 1.0, "{most} of {limit} pixels, view {k}, at {xz}");
            largest = largest.max(most);
            places += looked;
        };
        for _ in 0..2 {
            judge(&stage.run(params, BUDGET).expect("runs"));
        }
        judge(&stage.settle(params, BUDGET, MOST).expect("runs").0);
    }
    println!("largest error {largest:.3} of what is held, {places} places");
    assert!(places > 3000 && largest > 0.05, "{places} {largest}");
}
