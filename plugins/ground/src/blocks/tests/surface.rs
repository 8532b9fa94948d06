//! The mesh: closed, with the same bits on both sides of every edge, whatever has been made.

use bevy::math::{DVec2, DVec3, UVec2};
use dolomite_terrain::{GroundPoint, Source, Terrain, TerrainData};

use super::grounds::{
    Camera, Random, area, cameras, errors, faults, fbm, island, layer, map, of, triangles,
};
use super::guarantee::looked_at;
use crate::blocks::choose::{Limits, choose, settle};
use crate::blocks::kept::KeptBlocks;
use crate::blocks::locate::locate;
use crate::blocks::mesh::mesh;
use crate::blocks::record::ALWAYS;
use crate::detail::Metric;

/// Twice the area of the lattice.
fn whole(blocks: &KeptBlocks) -> i64 {
    let far = (blocks.lattice.roots << (blocks.lattice.depth + 1)).as_i64vec2();
    2 * far.x * far.y
}

#[test]
fn meshes_are_closed_and_errors_that_are_not_nested_tear_them() {
    let terrain = island();
    let mut blocks = looked_at(&terrain, 4.0);
    let metrics = [
        Metric::ErrorBound { pixels: 4.0 },
        Metric::EdgeLength { pixels: 64.0 },
        Metric::Classic {
            patch: 512.0,
            least: 1.0,
            greatest: 32.0,
            reach: 400.0,
            height: 10.0,
        },
    ];
    let mut depths = 0;
    for metric in metrics {
        for (k, camera) in cameras(&terrain).into_iter().enumerate() {
            let view = camera.view(metric);
            let choice = settle(&mut blocks, &view, Limits::default());
            let drawn = mesh(&blocks, &choice);
            assert_eq!(faults(&blocks, &drawn), [0; 3], "{metric:?} {k}");
            assert_eq!(area(&drawn), Some(whole(&blocks)), "{metric:?} {k}");
            let halves: std::collections::HashSet<_> =
                choice.blocks.iter().map(|b| b.place.cell().half).collect();
            depths = depths.max(halves.len());
        }
    }
    assert!(depths > 4, "blocks of {depths} sizes");
    // Every third vertex as if nothing that it needs had to be there.
    blocks.alter(|block| {
        for error in block.errors.iter_mut().skip(1).step_by(3) {
            *error *= if *error == ALWAYS { 1.0 } else { 4.0 };
        }
    });
    let none = Limits {
        made: 0,
        ..Limits::default()
    };
    let camera = cameras(&terrain)[0];
    let choice = choose(&mut blocks, &camera.bound(4.0), none);
    let [open, ..] = faults(&blocks, &mesh(&blocks, &choice));
    assert!(open > 20, "{open}");
}

#[test]
fn whatever_has_been_made_the_mesh_is_closed_and_as_good_as_it_says() {
    let terrain = fbm();
    let cameras = cameras(&terrain);
    for (keep, made) in [(4096, 0), (0, 8), (1, 1), (12, 3), (40, 5)] {
        let mut blocks = KeptBlocks::new(terrain.clone(), 0.125);
        blocks.keep = keep;
        let limits = Limits {
            made,
            ..Limits::default()
        };
        let mut last = f32::INFINITY;
        for frame in 0..12 {
            // Two looks one way, then another.
            let camera = cameras[(frame / 6) * 2];
            let choice = choose(&mut blocks, &camera.bound(2.0), limits);
            let drawn = mesh(&blocks, &choice);
            assert_eq!(faults(&blocks, &drawn), [0; 3], "{keep} {made} {frame}");
            assert_eq!(area(&drawn), Some(whole(&blocks)));
            assert!(blocks.len() <= keep + blocks.roots().len());
            let limit = 2.0 * f64::from(choice.held);
            let (largest, above, _) =
                errors(&terrain, &camera, limit, &triangles(&blocks, &drawn), 400);
            assert_eq!(above, 0, "{keep} {made} {frame}: {largest}");
            if frame > 0 && frame < 6 {
                assert!(choice.coarsening <= last, "what is made serves");
            }
            last = choice.coarsening;
        }
        if keep.min(made) < 2 {
            assert!(last > 1.0, "{last}: too little for this view");
        }
    }
}

#[test]
fn pools_that_are_too_small_are_not_overrun() {
    let terrain = fbm();
    let mut blocks = KeptBlocks::new(terrain.clone(), 0.125);
    let view = cameras(&terrain)[0].bound(1.0);
    let all = settle(&mut blocks, &view, Limits::default());
    let all = mesh(&blocks, &all);
    let few = Limits {
        vertices: 2000,
        ..Limits::default()
    };
    let choice = settle(&mut blocks, &view, few);
    let drawn = mesh(&blocks, &choice);
    let counts = [all.vertices.len(), drawn.vertices.len()];
    assert!(
        counts[0] > 8000 && counts[1] <= 2000 && counts[1] > 800,
        "{counts:?}"
    );
    assert!(choice.coarsening > 1.5 && choice.held >= choice.coarsening);
    assert_eq!(faults(&blocks, &drawn), [0; 3]);
}

/// The same map about another place.
fn moved(by: DVec2) -> Terrain {
    let origin = by - DVec2::splat(128.0);
    let source = Source::Map(map(UVec2::splat(65), 4.0, origin));
    let mut data: TerrainData = of(256.0, None, vec![layer(source)]).data().clone();
    data.extent.min += by;
    data.extent.max += by;
    Terrain::new(data).expect("valid")
}

#[test]
fn a_million_metres_away_the_mesh_is_the_same() {
    let draw = |by: DVec2| {
        let terrain = moved(by);
        let mut blocks = KeptBlocks::new(terrain.clone(), 0.125);
        let camera = Camera::at(&terrain, by + DVec2::new(20.0, 30.0), 1.7, 0.5, -0.1);
        let choice = settle(&mut blocks, &camera.bound(1.0), Limits::default());
        mesh(&blocks, &choice)
    };
    let (here, there) = (
        draw(DVec2::ZERO),
        draw(DVec2::new(1_048_576.0, -1_048_576.0)),
    );
    assert!(here.triangles.len() > 1000, "{}", here.triangles.len());
    assert_eq!(here.triangles, there.triangles);
    assert_eq!(here.vertices, there.vertices);
}

#[test]
fn the_triangle_under_a_place_is_the_one_that_is_drawn_and_errs_by_less_than_it_says() {
    let terrain = island();
    let mut blocks = looked_at(&terrain, 4.0);
    let mut random = Random::new(7);
    let (mut close, mut all) = (0, 0);
    for camera in cameras(&terrain) {
        let choice = choose(&mut blocks, &camera.bound(4.0), Limits::default());
        let drawn = triangles(&blocks, &mesh(&blocks, &choice));
        let mut look = |at: DVec3, height: Option<f64>| {
            let xz = DVec2::new(at.x, at.z);
            let found = locate(&blocks, &choice, GroundPoint::new(xz)).expect("on the ground");
            let lies = found.weights.iter().all(|&w| w > -1e-6);
            assert!(lies, "{found:?}");
            if let Some(height) = height {
                // A place of 2⁻³² m on a slope of 10.
                assert!((found.height - height).abs() < 1e-7, "{found:?} {height}");
            }
            let truth = terrain.sample_f64(xz).height.max(0.0);
            let off = (found.height.max(0.0) - truth).abs();
            assert!(off <= found.bound, "{off} {found:?}");
            all += 1;
            close += usize::from(off > 0.1 * found.bound);
        };
        for &[a, b, c] in drawn.iter().step_by(17) {
            let (mut u, mut v) = (random.unit(), random.unit());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let at = a + (b - a) * u + (c - a) * v;
            look(at, Some(at.y));
        }
        for _ in 0..200 {
            let at = DVec3::new(random.unit() - 0.5, 0.0, random.unit() - 0.5) * 1024.0;
            look(at, None);
        }
    }
    assert!(
        close > all / 20,
        "the bound says something: {close} of {all}"
    );
    let choice = choose(
        &mut blocks,
        &cameras(&terrain)[0].bound(4.0),
        Limits::default(),
    );
    for outside in [
        DVec2::new(513.0, 0.0),
        DVec2::new(f64::INFINITY, 0.0),
        DVec2::new(0.0, -1e300),
        DVec2::splat(2e9),
    ] {
        let found = locate(&blocks, &choice, GroundPoint::new(outside));
        assert_eq!(found, None, "{outside}");
    }
}

#[test]
fn flat_ground_stays_as_coarse_as_its_roots_however_near() {
    let terrain = of(16_384.0, None, Vec::new());
    let mut blocks = KeptBlocks::new(terrain.clone(), 0.125);
    let camera = Camera::at(&terrain, DVec2::new(3.0, 4.0), 1.0, 0.0, -0.1);
    let choice = settle(&mut blocks, &camera.bound(1.0), Limits::default());
    let drawn = mesh(&blocks, &choice);
    // A root is there with all corners of its cells.
    assert!(drawn.triangles.len() <= 512, "{}", drawn.triangles.len());
    assert_eq!(blocks.len(), blocks.roots().len(), "nothing was made");
}

/// Maps whose samples lie off the border of the extent by a part of a spacing, so that the outermost columns
/// are moved.
#[test]
fn on_a_maps_own_samples_the_extent_is_covered_and_the_bound_held_to_the_border() {
    let aligned = |size: u32, offset: f64, side: f64| {
        let source = Source::Map(map(
            UVec2::splat(size),
            2.0,
            DVec2::splat(offset - 0.5 * side),
        ));
        of(side, None, vec![layer(source)])
    };
    for (terrain, columns) in [
        (aligned(128, 1.0, 256.0), 128),
        (aligned(34, 0.0, 66.0), 32),
        (aligned(37, 0.3, 73.0), 0),
    ] {
        let mut blocks = KeptBlocks::new(terrain.clone(), 0.125);
        let lattice = blocks.lattice;
        let width = lattice.border.width;
        let count = (lattice.roots.x << (lattice.depth + 1)).checked_div(width);
        assert_eq!(count.unwrap_or(0), columns);
        let side = terrain.extent().size().x;
        let (mut looked, mut border) = (0, 0);
        // At a corner along two borders, over it, and from the middle.
        for (x, z, above, yaw) in [
            (-0.48, -0.49, 1.5, 3.6),
            (0.49, 0.47, 0.3, 0.6),
            (0.3, -0.45, 20.0, 0.5),
            (0.0, 0.0, 5.0, 2.0),
        ] {
            let xz = DVec2::new(x, z) * side;
            let camera = Camera::at(&terrain, xz, above, yaw, -0.2);
            let choice = settle(&mut blocks, &camera.bound(1.0), Limits::default());
            let drawn = mesh(&blocks, &choice);
            assert_eq!(faults(&blocks, &drawn), [0; 3]);
            assert_eq!(area(&drawn), Some(whole(&blocks)));
            let triangles = triangles(&blocks, &drawn);
            let limit = f64::from(choice.held);
            let (largest, above, count) = errors(&terrain, &camera, limit, &triangles, 20_000);
            assert_eq!(above, 0, "{columns}: {largest} at {xz}");
            looked += count;
            for corner in triangles.iter().flatten() {
                let out = DVec2::new(corner.x, corner.z).abs().max_element() - 0.5 * side;
                assert!(out < 1.0 / 256.0, "{corner} is outside");
                border += usize::from(out >= 0.0);
            }
            let at = locate(
                &blocks,
                &choice,
                GroundPoint::new(DVec2::splat(0.499 * side)),
            );
            let truth = terrain.sample_f64(DVec2::splat(0.499 * side)).height;
            let found = at.expect("on the ground");
            assert!(
                (found.height - truth).abs() <= found.bound,
                "{found:?} {truth}"
            );
        }
        assert!(looked > 10_000 && border > 100, "{looked} {border}");
    }
}
