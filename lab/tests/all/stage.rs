//! The passes of the tessellation stage on whatever adapter there is.

use crate::support;

use dolomite_tessellation::half_edge::{Manifold, check};
use dolomite_tessellation::tables::Instance;
use dolomite_tessellation::{
    Domain, Levels, Mode, PatchLayout, PatchMesh, Primitives, Tessellator, Winding, shapes,
};
use dolomite_testkit::gpu::for_test;
use dolomite_testkit::raster::{Raster, SIDE};
use dolomite_testkit::stage::{StagePasses, StageRun};
use std::sync::Arc;
use support::{Random, SPACINGS, by_points, run, run_with, triangles};

/// Every patch of an octahedron's faces has random levels; the surface stays closed.
fn sphere(seed: u64, parts: u32, most: f32) -> PatchMesh {
    let mesh = shapes::octahedron(parts);
    let mut random = Random(seed);
    let points = mesh
        .points()
        .iter()
        .map(|[x, y, z, _]| [*x, *y, *z, 0.3 + random.next() * most])
        .collect();
    PatchMesh::new(PatchLayout::TRIANGLE, points, mesh.indices().to_vec()).expect("a mesh")
}

/// A patch whose position is its coordinate: the very vertices and primitives of the CPU reference.
#[test]
fn gpu_one_patch_is_the_cpu_references() {
    let Some(gpu) = for_test() else { return };
    let mut random = Random(5);
    for domain in [Domain::Triangles, Domain::Quads, Domain::Isolines] {
        for (spacing, mode, winding) in [
            (SPACINGS[0], Mode::Exact, Winding::Ccw),
            (SPACINGS[1], Mode::D3d, Winding::Cw),
            (SPACINGS[2], Mode::Exact, Winding::Ccw),
        ] {
            let tessellator = Tessellator {
                domain,
                spacing,
                winding,
                mode,
            };
            let passes = StagePasses::new(&gpu, tessellator).expect("passes");
            for _ in 0..6 {
                let mut w = || 0.2 + 36.0 * random.next() * random.next();
                let (layout, points, levels) = if domain == Domain::Triangles {
                    let w = [w(), w(), w()];
                    let points = vec![
                        [1.0, 0.0, 0.0, w[0]],
                        [0.0, 1.0, 0.0, w[1]],
                        [0.0, 0.0, 1.0, w[2]],
                    ];
                    let outer = [w[1] + w[2], w[2] + w[0], w[0] + w[1], 1.0];
                    let inner = outer[0].max(outer[1]).max(outer[2]);
                    (
                        PatchLayout::TRIANGLE,
                        points,
                        Levels {
                            outer,
                            inner: [inner; 2],
                        },
                    )
                } else {
                    let w = [w(), w(), w(), w()];
                    let points = vec![
                        [0.0, 0.0, 0.0, w[0]],
                        [1.0, 0.0, 0.0, w[1]],
                        [1.0, 1.0, 0.0, w[2]],
                        [0.0, 1.0, 0.0, w[3]],
                    ];
                    let outer = [w[3] + w[0], w[0] + w[1], w[1] + w[2], w[2] + w[3]];
                    let inner = [outer[1].max(outer[3]), outer[0].max(outer[2])];
                    let layout = if domain == Domain::Quads {
                        PatchLayout::QUAD
                    } else {
                        PatchLayout::lines(4)
                    };
                    (layout, points, Levels { outer, inner })
                };
                let indices = (0..points.len() as u32).collect();
                let mesh = PatchMesh::new(layout, points, indices).expect("one patch");
                let emitted = run_with(&gpu, &passes, mesh, by_points(), [1 << 13, 1 << 14]);
                let reference = tessellator.tessellate(&levels);
                assert!(emitted.guarded);
                let bits = |c: &[f32; 3]| {
                    [
                        c[0].to_bits(),
                        c[1].to_bits(),
                        if domain == Domain::Triangles {
                            c[2].to_bits()
                        } else {
                            0
                        },
                    ]
                };
                let expected: Vec<[u32; 3]> = reference.coordinates.iter().map(bits).collect();
                let found: Vec<[u32; 3]> = emitted
                    .vertices
                    .iter()
                    .map(|v| [v[0], v[1], v[2]])
                    .collect();
                assert!(found == expected, "{tessellator:?} {levels:?}");
                let flat: Vec<u32> = match reference.primitives {
                    Primitives::Triangles(triangles) => triangles.concat(),
                    Primitives::Segments(segments) => segments.concat(),
                };
                assert!(emitted.indices == flat, "{tessellator:?} {levels:?}");
            }
        }
    }
}

/// Shared edges are one: whatever the levels, a closed surface stays closed, and no vertex is left over.
#[test]
fn gpu_a_closed_surface_stays_closed() {
    let Some(gpu) = for_test() else { return };
    for (seed, spacing) in (1..).zip(SPACINGS) {
        let tessellator = Tessellator {
            spacing,
            ..Default::default()
        };
        let emitted = run(
            &gpu,
            tessellator,
            sphere(seed, 5, 30.0),
            by_points(),
            [1 << 19, 1 << 20],
        );
        let manifold = check(&triangles(&emitted), emitted.vertices.len()).expect("a manifold");
        assert_eq!(
            manifold,
            Manifold {
                borders: vec![],
                euler: 2
            }
        );
        let mut used = vec![false; emitted.vertices.len()];
        emitted
            .indices
            .iter()
            .for_each(|index| used[*index as usize] = true);
        assert!(used.iter().all(|used| *used));
        // Vertices share of a triangle: a half and two over all.
        assert_eq!(2 * emitted.vertices.len(), triangles(&emitted).len() + 4);
        assert_eq!((emitted.head.lowered, emitted.head.discarded), (0, 0));
    }
}

/// Pools of any size: nothing is written behind them; as long as level 1 fits, the surface is whole.
#[test]
fn gpu_pools_hold_what_they_say() {
    let Some(gpu) = for_test() else { return };
    for spacing in SPACINGS {
        let tessellator = Tessellator {
            spacing,
            ..Default::default()
        };
        let passes = StagePasses::new(&gpu, tessellator).expect("passes");
        let whole = run_with(
            &gpu,
            &passes,
            sphere(3, 3, 31.0),
            by_points(),
            [1 << 19, 1 << 20],
        );
        let mut last = 0;
        for pools in [
            [1, 1],
            [23, 46],
            [40, 71],
            [500, 3000],
            [3000, 999],
            [9000, 18_000],
            [1 << 16, 1 << 17],
        ] {
            let emitted = run_with(&gpu, &passes, sphere(3, 3, 31.0), by_points(), pools);
            assert!(emitted.guarded, "{pools:?}");
            let head = emitted.head;
            assert!(
                head.vertices <= pools[0] && head.primitives <= pools[1],
                "{head:?}"
            );
            assert_eq!(head.wanted_primitives, whole.head.primitives);
            let fits = whole.head.vertices <= pools[0] && whole.head.primitives <= pools[1];
            assert_eq!(head.lowered == 0, fits, "{pools:?} {head:?}");
            assert!(emitted.indices.iter().all(|index| *index < pools[0]));
            // 72 patches: at level 1 they are 72 triangles of 38 vertices (even spacing: more).
            if pools[0] >= 500 {
                let manifold = check(&triangles(&emitted), emitted.vertices.len());
                assert_eq!(
                    manifold.expect("a manifold").borders,
                    [[0; 0]; 0],
                    "{pools:?}"
                );
                assert!(head.primitives >= last);
                last = head.primitives;
            }
        }
    }
}

/// Levels that discard: NaN and negative ones take their patches away, the others stay whole.
#[test]
fn gpu_hostile_levels_and_patches() {
    let Some(gpu) = for_test() else { return };
    for poison in [f32::NAN, f32::NEG_INFINITY, -1e9] {
        let mesh = shapes::octahedron(2);
        let mut points: Vec<_> = mesh
            .points()
            .iter()
            .map(|[x, y, z, _]| [*x, *y, *z, 2.5])
            .collect();
        points[0][3] = poison;
        let with = |k: &&[u32]| !k.contains(&0);
        let kept = mesh.indices().chunks(3).filter(with).count() as u32;
        let mesh =
            PatchMesh::new(PatchLayout::TRIANGLE, points, mesh.indices().to_vec()).expect("a mesh");
        let patches = mesh.patches() as u32;
        let emitted = run(
            &gpu,
            Tessellator::default(),
            mesh,
            by_points(),
            [1 << 16, 1 << 16],
        );
        assert_eq!(emitted.head.discarded, patches - kept, "{poison}");
        let manifold = check(&triangles(&emitted), emitted.vertices.len()).expect("a manifold");
        assert_eq!((manifold.borders.len(), manifold.euler), (1, 1));
    }
    // Infinite levels are the greatest.
    let points = vec![
        [0.0, 0.0, 0.0, f32::INFINITY],
        [1.0, 0.0, 0.0, 1.0],
        [1.0, 1.0, 0.0, 1.0],
    ];
    let mesh = PatchMesh::new(PatchLayout::TRIANGLE, points, vec![0, 1, 2]).expect("a mesh");
    let emitted = run(
        &gpu,
        Tessellator::default(),
        mesh,
        by_points(),
        [1 << 16, 1 << 16],
    );
    assert!(emitted.guarded && emitted.head.primitives > 6 * 31 * 31);
    // Patches without area, folded onto themselves: the same triangles as others.
    let folded = PatchMesh::new(
        PatchLayout::QUAD,
        vec![[0.0, 0.0, 0.0, 4.0]; 3],
        vec![0, 1, 2, 1, 0, 0, 0, 0],
    );
    let quads = Tessellator {
        domain: Domain::Quads,
        ..Default::default()
    };
    let emitted = run(
        &gpu,
        quads,
        folded.expect("a mesh"),
        by_points(),
        [1 << 16, 1 << 16],
    );
    assert!(emitted.guarded && emitted.head.primitives == 2 * 2 * 8 * 8);
    // No patches at all.
    let none = PatchMesh::new(PatchLayout::TRIANGLE, vec![], vec![]).expect("an empty mesh");
    let emitted = run(&gpu, Tessellator::default(), none, by_points(), [16, 16]);
    assert!(emitted.guarded && emitted.head.primitives == 0);
}

/// A camera inside of a closed surface sees no background, whatever the levels of its edges: 1000
/// frames over a sentinel colour. A surface with a patch less shows the sentinel.
#[test]
fn gpu_no_background_in_a_thousand_frames() {
    let Some(gpu) = for_test() else { return };
    let raster = Raster::new(&gpu);
    let mut random = Random(77);
    let mut frames = 0;
    for spacing in SPACINGS {
        let tessellator = Tessellator {
            spacing,
            ..Default::default()
        };
        let passes = StagePasses::new(&gpu, tessellator).expect("passes");
        for seed in 0..6 {
            let mesh = sphere(seed, 4, 12.0);
            let layout = mesh.layout();
            // Every second surface is round: its patches bend at every corner.
            let points = mesh.points().iter().map(|[x, y, z, w]| {
                let length = if seed % 2 == 0 {
                    1.0
                } else {
                    (x * x + y * y + z * z).sqrt()
                };
                [x / length, y / length, z / length, *w]
            });
            let mesh = PatchMesh::new(layout, points.collect(), mesh.indices().to_vec());
            let entities = [(Arc::new(mesh.expect("a mesh")), by_points())];
            let run = StageRun::new(&gpu, &passes, layout, &entities, [1 << 17, 1 << 18]);
            let run = run.expect("a run");
            run.tessellate(1).expect("a run");
            for _ in 0..56 {
                let open = raster
                    .uncovered(&gpu, &run, &view(&mut random))
                    .expect("a picture");
                assert_eq!(open, 0, "{spacing:?}, surface {seed}, frame {frames}");
                frames += 1;
            }
        }
    }
    assert!(frames >= 1000, "{frames}");
    // The test can fail: without one patch some camera sees the sentinel.
    let mesh = sphere(1, 2, 4.0);
    let fewer = mesh.indices()[3..].to_vec();
    let mesh = PatchMesh::new(PatchLayout::TRIANGLE, mesh.points().to_vec(), fewer);
    let passes = StagePasses::new(&gpu, Tessellator::default()).expect("passes");
    let entities = [(Arc::new(mesh.expect("a mesh")), by_points())];
    let run = StageRun::new(
        &gpu,
        &passes,
        PatchLayout::TRIANGLE,
        &entities,
        [1 << 17, 1 << 18],
    );
    let run = run.expect("a run");
    run.tessellate(1).expect("a run");
    let open: usize = (0..40)
        .map(|_| {
            raster
                .uncovered(&gpu, &run, &view(&mut random))
                .expect("a picture")
        })
        .sum();
    assert!(open > SIDE as usize, "{open}");
}

/// A camera near the origin that looks somewhere, 90 degrees wide; column by column.
fn view(random: &mut Random) -> [f32; 16] {
    let mut next = || random.next() * 2.0 - 1.0;
    // A unit quaternion (x, y, z, w) from four numbers is a rotation.
    let q = [next(), next(), next(), next() + 1.5];
    let length = q.iter().map(|x| x * x).sum::<f32>().sqrt();
    let [x, y, z, w] = q.map(|x| x / length);
    let rows = [
        [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - z * w),
            2.0 * (x * z + y * w),
        ],
        [
            2.0 * (x * y + z * w),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - x * w),
        ],
        [
            2.0 * (x * z - y * w),
            2.0 * (y * z + x * w),
            1.0 - 2.0 * (x * x + y * y),
        ],
    ];
    let eye = [0.2 * next(), 0.2 * next(), 0.2 * next()];
    let moved = rows.map(|row| -(row[0] * eye[0] + row[1] * eye[1] + row[2] * eye[2]));
    // Clip space: x, y as they are, z = w - near (all of it in front), w = -z of the view.
    let depth = |k: usize| -rows[2][k];
    let near = 0.01;
    [
        rows[0][0],
        rows[1][0],
        depth(0),
        depth(0),
        rows[0][1],
        rows[1][1],
        depth(1),
        depth(1),
        rows[0][2],
        rows[1][2],
        depth(2),
        depth(2),
        moved[0],
        moved[1],
        -moved[2] - near,
        -moved[2],
    ]
}

/// A million patches: all of them where the pools are large enough; nothing out of range where they
/// are not.
#[test]
fn gpu_a_million_patches() {
    let Some(gpu) = for_test() else { return };
    let side = 1000_u32;
    let points = (0..=side)
        .flat_map(|j| (0..=side).map(move |i| [i as f32, j as f32, 0.0, 0.0]))
        .collect();
    let corner = |i: u32, j: u32| j * (side + 1) + i;
    let indices = (0..side)
        .flat_map(|j| (0..side).map(move |i| (i, j)))
        .flat_map(|(i, j)| {
            [
                corner(i, j),
                corner(i + 1, j),
                corner(i + 1, j + 1),
                corner(i, j + 1),
            ]
        })
        .collect();
    let mesh = PatchMesh::new(PatchLayout::QUAD, points, indices).expect("a million patches");
    let mesh = Arc::new(mesh);
    let quads = Tessellator {
        domain: Domain::Quads,
        ..Default::default()
    };
    let passes = StagePasses::new(&gpu, quads).expect("passes");
    let mut entity = Instance::IDENTITY;
    entity.params[0][0] = 1.0;
    let corners = (side + 1) * (side + 1);
    for pools in [[corners, 2 * side * side], [1 << 16, 1 << 17]] {
        let entities = [(mesh.clone(), entity)];
        let run = StageRun::new(&gpu, &passes, PatchLayout::QUAD, &entities, pools);
        let run = run.expect("fewer than a buffer holds");
        run.tessellate(1).expect("a run");
        let emitted = run.read().expect("what was emitted");
        assert!(emitted.guarded, "{pools:?}");
        assert!(emitted.indices.iter().all(|index| *index < pools[0]));
        assert_eq!(emitted.head.wanted_primitives, 2 * side * side);
        assert_eq!([emitted.head.vertices, emitted.head.primitives], pools);
    }
}
