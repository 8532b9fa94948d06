//! What a picture does not show is left out, and nothing that it shows.

use super::support::{MOST, params, picture_of, terrain, view, view_at};
use bevy::math::{DQuat, DVec2, DVec3, EulerRot, Mat4, Quat, UVec2, Vec2, Vec3};
use dolomite_ground::detail::{CullView, DetailGround, DetailView, HorizonView, Metric};
use dolomite_terrain::{Fractal, GroundRect, Hill, Layer, Source, Terrain, TerrainData};
use dolomite_testkit::blocks::{BlockRun, BlockStage};
use dolomite_testkit::gpu::for_test;
use std::collections::HashSet;

type Triangle = [[u32; 3]; 3];

/// Corners of triangles by their bits, from the least on.
fn by_bits(run: &BlockRun, triangles: &[[u32; 3]]) -> HashSet<Triangle> {
    let at = |k: u32| run.positions[k as usize].map(f32::to_bits);
    let turned = triangles.iter().map(|corners| {
        let mut corners = corners.map(at);
        let least = (0..3).min_by_key(|&k| corners[k]).expect("three");
        corners.rotate_left(least);
        corners
    });
    turned.collect()
}

fn picture(view: &DetailView, yaw: f32) -> CullView {
    let rotation = Quat::from_euler(EulerRot::YXZ, yaw, -0.15, 0.0);
    let eye = Vec3::from(view.eye);
    CullView {
        clip: Mat4::perspective_infinite_reverse_rh(1.0, 16.0 / 9.0, 0.1)
            * Mat4::from_rotation_translation(rotation, eye).inverse(),
        half_size: Vec2::new(960.0, 540.0),
        one_sided: true,
    }
}

fn corners(triangle: &Triangle) -> [DVec3; 3] {
    triangle.map(|corner| Vec3::from(corner.map(f32::from_bits)).as_dvec3())
}

/// Whether a triangle cuts the way from `eye` to `to`, before its end by a ten-thousandth.
fn is_before(triangle: &[DVec3; 3], eye: DVec3, to: DVec3) -> bool {
    let [a, b, c] = *triangle;
    let (ab, ac, along) = (b - a, c - a, to - eye);
    let across = along.cross(ac);
    let size = ab.dot(across);
    if size == 0.0 {
        return false;
    }
    let from = eye - a;
    let u = from.dot(across) / size;
    let turned = from.cross(ab);
    let v = along.dot(turned) / size;
    let t = ac.dot(turned) / size;
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < 0.9999
}

/// Depth of the nearest triangle in each pixel, as bits; 0 where none is. Triangles across the near plane are left out.
fn depths(clip: &Mat4, size: [usize; 2], triangles: &HashSet<Triangle>) -> Vec<u64> {
    let clip = clip.as_dmat4();
    let mut nearest = vec![0_f64; size[0] * size[1]];
    for triangle in triangles {
        let drawn = corners(triangle).map(|at| clip * at.extend(1.0));
        if drawn.iter().any(|at| at.w <= 0.1) {
            continue;
        }
        let [a, b, c] = drawn.map(|at| {
            let x = (at.x / at.w + 1.0) * 0.5 * size[0] as f64;
            let y = (1.0 - at.y / at.w) * 0.5 * size[1] as f64;
            DVec3::new(x, y, at.z / at.w)
        });
        let area = (b - a).truncate().perp_dot((c - a).truncate());
        let low = a.min(b).min(c).max(DVec3::ZERO);
        let high = a.max(b).max(c);
        for y in low.y as usize..(high.y.max(0.0) as usize + 1).min(size[1]) {
            for x in low.x as usize..(high.x.max(0.0) as usize + 1).min(size[0]) {
                let at = DVec3::new(x as f64 + 0.5, y as f64 + 0.5, 0.0);
                let v = (at - a).truncate().perp_dot((c - a).truncate()) / area;
                let w = (b - a).truncate().perp_dot((at - a).truncate()) / area;
                if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
                    // Reversed: what is nearer is greater.
                    let depth = a.z + (b.z - a.z) * v + (c.z - a.z) * w;
                    let known = &mut nearest[y * size[0] + x];
                    *known = known.max(depth);
                }
            }
        }
    }
    nearest.into_iter().map(f64::to_bits).collect()
}

#[test]
fn gpu_blocks_leave_out_what_a_picture_does_not_show() {
    let Some(gpu) = for_test() else { return };
    let terrain = terrain();
    let laid = DetailGround::new(terrain.clone(), 0.25);
    let mut stage = BlockStage::new(&gpu, &laid, 4096).expect("passes");
    let metric = Metric::ErrorBound { pixels: 4.0 };
    for (yaw, above, most, least_behind) in [(0.0, 3.0, 0.8, 0.1), (2.0, 30.0, 0.9, 0.02)] {
        let view = view(&terrain, yaw, above, metric);
        let picture = picture(&view, yaw);
        let given = params(&laid, view);
        let (all, _) = stage.settle(given, 64, MOST).expect("runs");
        assert!(all.others.is_empty());
        let whole = by_bits(&all, &all.triangles);
        let run = stage.run(given.cull(&picture, true), 64).expect("runs");
        let (seen, others) = (by_bits(&run, &run.triangles), by_bits(&run, &run.others));
        assert!(seen.is_disjoint(&others));
        assert!(
            whole == seen.union(&others).copied().collect(),
            "none is lost or moved"
        );
        assert!(
            (seen.len() as f32) < most * whole.len() as f32,
            "{} of {}",
            seen.len(),
            whole.len()
        );
        // By the CPU reference. On the threshold, which has its margin, roundings may differ.
        let hides = |triangle: &Triangle| {
            picture.hides(triangle.map(|at| Vec3::from(at.map(f32::from_bits))))
        };
        let wrong =
            seen.iter().filter(|t| hides(t)).count() + others.iter().filter(|t| !hides(t)).count();
        assert!(wrong * 500 <= whole.len(), "{wrong} of {}", whole.len());
        let alone = stage.run(given.cull(&picture, false), 64).expect("runs");
        assert_eq!(by_bits(&alone, &alone.triangles), seen);
        assert!(alone.others.is_empty() && alone.positions.len() < run.positions.len());

        let horizon =
            HorizonView::new(&laid, &view, &picture, 0.0).expect("level, over the ground");
        let run = stage
            .run(given.cull(&picture, true).occlude(horizon), 64)
            .expect("runs");
        let (left, behind) = (by_bits(&run, &run.triangles), by_bits(&run, &run.others));
        assert!(
            whole == left.union(&behind).copied().collect(),
            "none is lost or moved"
        );
        let hidden: Vec<&Triangle> = seen.difference(&left).collect();
        let share = hidden.len() as f32 / seen.len() as f32;
        println!("{} of {} are behind others", hidden.len(), seen.len());
        assert!(share > least_behind, "{share}");
        // The picture is the same to the bit, and would not be without what is left.
        let draw = |triangles: &HashSet<Triangle>| depths(&picture.clip, [960, 540], triangles);
        let all_drawn = draw(&whole);
        assert!(all_drawn == draw(&left), "the picture changes");
        let some = left.iter().skip(1).step_by(2).copied().collect();
        assert!(all_drawn != draw(&some));
        // On the way to what is hidden, where it is in the picture, lies other ground.
        let eye = Vec3::from(view.eye).as_dvec3();
        let ground: Vec<[DVec3; 3]> = whole.iter().map(corners).collect();
        let clip = picture.clip.as_dmat4();
        let mut looked = 0;
        for triangle in hidden.iter().step_by(1 + hidden.len() / 200) {
            let [a, b, c] = corners(triangle);
            for [x, y, z] in [[0.98, 0.01, 0.01], [0.01, 0.98, 0.01], [0.01, 0.01, 0.98]] {
                let place = a * x + b * y + c * z;
                let drawn = clip * place.extend(1.0);
                if drawn.w <= 0.1 || drawn.x.abs() > drawn.w || drawn.y.abs() > drawn.w {
                    continue;
                }
                looked += 1;
                assert!(
                    ground.iter().any(|t| is_before(t, eye, place)),
                    "{place} is seen"
                );
            }
        }
        assert!(looked > 100, "{looked}");
    }
}

/// What is in view from so high: with what nearer ground hides, and without it.
fn sorted(
    stage: &mut BlockStage<'_>,
    laid: &DetailGround,
    above: f64,
    pitch: f64,
) -> [BlockRun; 2] {
    let turn = [0.0, pitch];
    let view = view_at(laid.terrain(), DVec2::ZERO, above, turn, 2.0);
    let given = params(laid, view);
    let turn = DQuat::from_euler(EulerRot::YXZ, turn[0], turn[1], 0.0);
    let picture = picture_of(&given, UVec2::new(640, 360), 60.0_f64.to_radians(), turn);
    let horizon = HorizonView::new(laid, &view, &picture, 0.0).expect("level, over the ground");
    stage.settle(given, 64, MOST).expect("runs");
    let culled = given.cull(&picture, true);
    [culled, culled.occlude(horizon)].map(|given| stage.run(given, 64).expect("runs"))
}

/// A plain behind a dune.
fn dune() -> Terrain {
    let layer = |source| Layer { source, mask: None };
    Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 1024.0),
        layers: vec![
            layer(Source::Fractal(Fractal {
                octaves: 4,
                amplitude: 2.0,
                wavelength: 20.0,
                ..Fractal::default()
            })),
            layer(Source::Hill(Hill {
                centre: DVec2::new(0.0, -60.0),
                radius: 50.0,
                height: 40.0,
            })),
        ],
        base: 0.0,
        sea_level: None,
    })
    .expect("valid")
}

#[test]
fn gpu_nearly_all_that_a_dune_hides_is_left_out() {
    let Some(gpu) = for_test() else { return };
    let laid = DetailGround::new(dune(), 0.5);
    let mut stage = BlockStage::new(&gpu, &laid, 4096).expect("passes");
    let [all, seen] = sorted(&mut stage, &laid, 8.0, 0.0);
    // Far behind the hill, near its axis.
    let beyond = |run: &BlockRun| {
        let is_there = |&k: &u32| {
            let [x, _, z] = run.positions[k as usize];
            z < -140.0 && x.abs() < -0.1 * z
        };
        let triangles = run.triangles.iter();
        triangles.filter(|t| t.iter().all(is_there)).count()
    };
    let (all, left) = (beyond(&all), beyond(&seen));
    println!("{left} of {all} beyond the hill are left");
    assert!(all > 100 && left * 20 < all, "{left} of {all}");
}

#[test]
fn gpu_who_may_look_below_the_ground_sees_through_nothing() {
    let Some(gpu) = for_test() else { return };
    let laid = DetailGround::new(dune(), 0.5);
    let mut stage = BlockStage::new(&gpu, &laid, 4096).expect("passes");
    // Below, at the very height, and with ground nearer than the near plane.
    for above in [-3.0, 0.0, 0.05] {
        let [all, seen] = sorted(&mut stage, &laid, above, -0.1);
        let triangles = |run: &BlockRun| by_bits(run, &run.triangles);
        assert!(triangles(&all) == triangles(&seen), "{above} m above");
    }
    let [all, seen] = sorted(&mut stage, &laid, 2.5, -0.1);
    assert!(seen.triangles.len() < all.triangles.len());
}
