//! The passes of the tessellation stage on whatever adapter there is.

use dolomite_lab::gpu::{Binding, Gpu, for_test};
use dolomite_lab::raster::{Raster, SIDE};
use dolomite_lab::stage::{Emitted, StageOptions, StagePasses, StageRun};
use dolomite_tessellation::stage::half_edge::{Manifold, check};
use dolomite_tessellation::stage::patches::WHOLE;
use dolomite_tessellation::stage::tables::Instance;
use dolomite_tessellation::stage::{
    Domain, Levels, Mode, PatchLayout, PatchMesh, Primitives, Spacing, Tessellator, Winding, shapes,
};
use std::sync::Arc;

const SPACINGS: [Spacing; 3] = [
    Spacing::Equal,
    Spacing::FractionalEven,
    Spacing::FractionalOdd,
];

/// Numbers from 0 to 1 (splitmix64: Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f32 / (1 << 24) as f32
    }
}

/// An entity whose edges take their levels from the fourth numbers of their ends.
fn by_points() -> Instance {
    let mut entity = Instance::IDENTITY;
    entity.params[0][0] = -1.0;
    entity
}

fn run(
    gpu: &Gpu,
    tessellator: Tessellator,
    mesh: PatchMesh,
    entity: Instance,
    pools: [u32; 2],
) -> Emitted {
    let passes = StagePasses::new(gpu, tessellator).expect("passes");
    run_with(gpu, &passes, mesh, entity, pools)
}

fn run_with(
    gpu: &Gpu,
    passes: &StagePasses,
    mesh: PatchMesh,
    entity: Instance,
    pools: [u32; 2],
) -> Emitted {
    let layout = mesh.layout();
    let stage = StageRun::new(gpu, passes, layout, &[(Arc::new(mesh), entity)], pools);
    let stage = stage.expect("a mesh of a few patches");
    stage.tessellate(1).expect("a run");
    stage.read().expect("what was emitted")
}

fn triangles(emitted: &Emitted) -> Vec<[u32; 3]> {
    let chunks = emitted.indices.chunks_exact(3);
    chunks.map(|chunk| [chunk[0], chunk[1], chunk[2]]).collect()
}

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

/// A patch whose position is its coordinate: the very vertices and primitives of the twin.
#[test]
fn gpu_one_patch_is_the_twins() {
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
                let twin = tessellator.tessellate(&levels);
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
                let expected: Vec<[u32; 3]> = twin.coordinates.iter().map(bits).collect();
                let found: Vec<[u32; 3]> = emitted
                    .vertices
                    .iter()
                    .map(|v| [v[0], v[1], v[2]])
                    .collect();
                assert!(found == expected, "{tessellator:?} {levels:?}");
                let flat: Vec<u32> = match twin.primitives {
                    Primitives::Triangles(triangles) => triangles.concat(),
                    Primitives::Segments(segments) => segments.concat(),
                };
                assert!(emitted.indices == flat, "{tessellator:?} {levels:?}");
            }
        }
    }
}

/// A square quadtree, refined at random but balanced, as quads of which sides may be split.
fn quadtree(random: &mut Random, most: f32) -> PatchMesh {
    // Leaves by least corner and side, on a lattice of 16 x 16.
    let mut leaves = vec![(0_u32, 0_u32, 16_u32)];
    for _ in 0..40 {
        let k = (random.next() * leaves.len() as f32) as usize % leaves.len();
        let (x, y, side) = leaves[k];
        // Split only where no neighbour is twice as large.
        let touches = |&(a, b, s): &(u32, u32, u32)| {
            s > side && x <= a + s && a <= x + side && y <= b + s && b <= y + side
        };
        if side > 1 && !leaves.iter().any(touches) {
            leaves.swap_remove(k);
            let half = side / 2;
            leaves.extend([0, 1, 2, 3].map(|q| (x + q % 2 * half, y + q / 2 * half, half)));
        }
    }
    let (mut points, mut known) = (Vec::new(), std::collections::HashMap::new());
    let mut indices = Vec::new();
    for &(x, y, side) in &leaves {
        for (dx, dy) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
            let at = (2 * (x + dx * side), 2 * (y + dy * side));
            indices.push(*known.entry(at).or_insert_with(|| {
                points.push([
                    at.0 as f32 / 32.0,
                    at.1 as f32 / 32.0,
                    0.0,
                    0.3 + random.next() * most,
                ]);
                points.len() as u32 - 1
            }));
        }
    }
    let middles: Vec<[u32; 4]> = leaves
        .iter()
        .map(|&(x, y, side)| {
            [(0, 1), (1, 0), (2, 1), (1, 2)].map(|(dx, dy)| {
                let at = (2 * x + dx * side, 2 * y + dy * side);
                known.get(&at).copied().unwrap_or(WHOLE)
            })
        })
        .collect();
    let layout = PatchLayout::QUAD.with_split_sides();
    PatchMesh::with_middles(layout, points, indices, &middles).expect("a balanced quadtree")
}

/// Patches beside two of half their size: the vertices and triangles of the twin, one sheet with one
/// border, of which no triangle is turned over.
#[test]
fn gpu_a_quadtree_is_one_sheet_and_the_twins() {
    let Some(gpu) = for_test() else { return };
    let mut random = Random(77);
    let mut split = 0;
    for (spacing, mode) in [
        (SPACINGS[0], Mode::Exact),
        (SPACINGS[1], Mode::D3d),
        (SPACINGS[2], Mode::Exact),
    ] {
        let tessellator = Tessellator {
            domain: Domain::Quads,
            spacing,
            mode,
            ..Default::default()
        };
        let options = StageOptions {
            split: true,
            ..Default::default()
        };
        let passes = StagePasses::with_options(&gpu, tessellator, &options).expect("passes");
        for round in 0..8 {
            let mesh = quadtree(&mut random, if round < 4 { 3.0 } else { 14.0 });
            split += mesh
                .topology()
                .halves
                .iter()
                .flatten()
                .filter(|w| **w != WHOLE)
                .count();
            let level = |patch: u32, a: usize, b: usize| {
                let of =
                    |k: usize| mesh.points()[mesh.indices()[patch as usize * 4 + k] as usize][3];
                of(a) + of(b)
            };
            let control = |patch| {
                let outer = [(3, 0), (0, 1), (1, 2), (2, 3)].map(|(a, b)| level(patch, a, b));
                Levels {
                    outer,
                    inner: [outer[1].max(outer[3]), outer[0].max(outer[2])],
                }
            };
            let pools = if round == 3 {
                [400, 500]
            } else {
                [1 << 16, 1 << 17]
            };
            let twin = tessellator.tessellate_mesh(&mesh, control, pools);
            let emitted = run_with(&gpu, &passes, mesh.clone(), by_points(), pools);
            assert!(emitted.guarded);
            assert_eq!(emitted.head.lowered, twin.lowered, "{spacing:?} {round}");
            let found = triangles(&emitted);
            assert!(found == twin.primitives.triangles(), "{spacing:?} {round}");
            assert_eq!(emitted.vertices.len(), twin.vertices.len());
            let manifold = check(&found, emitted.vertices.len()).expect("a manifold");
            assert_eq!((manifold.borders.len(), manifold.euler), (1, 1));
            // Exact: corners are multiples of 1/32, places of 2^-24, sides 16 at most.
            let place = |index: u32| {
                let vertex = emitted.vertices[index as usize];
                [0, 1].map(|k| f64::from(f32::from_bits(vertex[k])))
            };
            let mut area = 0.0;
            for corners in &found {
                let [a, b, c] = corners.map(place);
                let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
                assert!(
                    twice >= 0.0,
                    "{spacing:?} {round}: {corners:?} is turned over"
                );
                area += twice;
            }
            assert!((area - 2.0).abs() < 1e-12, "{area}");
        }
    }
    assert!(split > 100, "{split} halves are enough to mean something");
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

/// Half-spaces of a shadow view: x and y within ±`reach` of a centre.
fn shadow_view(centre: [f32; 2], reach: f32) -> [[f32; 4]; 5] {
    let [x, y] = centre;
    [
        [1.0, 0.0, 0.0, reach - x],
        [-1.0, 0.0, 0.0, reach + x],
        [0.0, 1.0, 0.0, reach - y],
        [0.0, -1.0, 0.0, reach + y],
        [0.0, 0.0, 0.0, 1.0],
    ]
}

/// The pass that chooses what shadow views draw: of each group of patches, from the first to the last
/// whose bounds meet the view; discarded patches count for nothing.
#[test]
fn gpu_shadow_views_draw_what_they_may_see() {
    let Some(gpu) = for_test() else { return };
    let bounds = dolomite_shaders::ShaderFile {
        path: "stage/user_bounds.wgsl",
        source: "#define_import_path dolomite::stage::user_bounds
#import dolomite::stage::api::{Patch, StageView, patch_point, stage_position}
// Around the middle of the three control points.
fn bounds(input: Patch, view: StageView) -> vec4<f32> {
    let a = stage_position(input, patch_point(input, 0u, 0u).xyz);
    let b = stage_position(input, patch_point(input, 1u, 0u).xyz);
    let c = stage_position(input, patch_point(input, 2u, 0u).xyz);
    let middle = (a + b + c) / 3.0;
    return vec4(middle, max(max(distance(a, middle), distance(b, middle)), distance(c, middle)));
}
",
    };
    let module =
        dolomite_shaders::compose_with("stage/shadow_ranges.wgsl", &["STAGE_READ"], &[bounds]);
    let kernel = gpu
        .kernel(module.expect("valid functions"), "shadow_ranges")
        .expect("a kernel");
    let passes = StagePasses::new(&gpu, Tessellator::default()).expect("passes");
    let mesh = Arc::new(shapes::octahedron(7));
    let patches = mesh.patches() as u32;
    // Level 3 everywhere; the second entity stands 10 m away and is discarded.
    let mut seen = Instance::IDENTITY;
    seen.params[0][0] = 3.0;
    let mut discarded = by_points();
    discarded.rows[0][3] = 10.0;
    let dead: Vec<[f32; 4]> = mesh
        .points()
        .iter()
        .map(|[x, y, z, _]| [*x, *y, *z, -1.0])
        .collect();
    let dead =
        PatchMesh::new(PatchLayout::TRIANGLE, dead, mesh.indices().to_vec()).expect("a mesh");
    let entities = [(mesh.clone(), seen), (Arc::new(dead), discarded)];
    let run = StageRun::new(
        &gpu,
        &passes,
        PatchLayout::TRIANGLE,
        &entities,
        [1 << 16, 1 << 17],
    );
    let run = run.expect("few patches");
    run.tessellate(1).expect("a run");
    let primitives = run.head().expect("counters").primitives;
    assert_eq!(primitives % patches, 0, "every patch has as many");
    let each = primitives / patches;

    let views = [
        shadow_view([0.0, 0.0], 5.0),
        shadow_view([0.7, 0.2], 0.15),
        shadow_view([-3.0, 0.0], 1.0),
        // Where only the discarded entity is.
        shadow_view([10.0, 0.0], 2.0),
    ];
    let mut planes = vec![[[0.0_f32; 4]; 5]; 16];
    planes[..4].copy_from_slice(&views);
    let [params, tables, data, work] = run.inputs().expect("what a pass reads");
    let mut ranges = vec![0xAB_u8; 16 * 64 * 20];
    gpu.run(
        &kernel,
        &mut [vec![
            Binding::Uniform(&params),
            Binding::Read(&tables),
            Binding::Read(&data),
            Binding::Read(&work),
            Binding::Write(&mut ranges),
            Binding::Uniform(bytemuck::cast_slice(&planes)),
        ]],
        [4, 1, 1],
    )
    .expect("the pass runs");
    let ranges: Vec<[u32; 5]> = bytemuck::pod_collect_to_vec(&ranges);

    let sphere = |patch: u32| {
        let corners = [0, 1, 2].map(|k| {
            let [x, y, z, _] = mesh.points()[mesh.indices()[patch as usize * 3 + k] as usize];
            bevy::math::Vec3::new(x, y, z)
        });
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let radius = corners.map(|c| c.distance(middle));
        (middle, radius[0].max(radius[1]).max(radius[2]))
    };
    let mut drawn = [0; 4];
    let size = (2 * patches).div_ceil(64);
    for (k, planes) in views.iter().enumerate() {
        // What lies within a thousandth of a plane may be taken or not: distances are rounded.
        let meets = |patch: u32, margin: f32| {
            let (middle, radius) = sphere(patch);
            planes.iter().all(|[a, b, c, d]| {
                middle.dot(bevy::math::Vec3::new(*a, *b, *c)) + d >= -radius + margin
            })
        };
        for group in 0..64 {
            let [count, instances, first, base, instance] = ranges[k * 64 + group as usize];
            assert_eq!((instances, base, instance), (1, 0, 0));
            let members = (group * size..(group + 1) * size).filter(|patch| *patch < patches);
            let due = |margin| {
                let seen: Vec<u32> = members
                    .clone()
                    .filter(|patch| meets(*patch, margin))
                    .collect();
                seen.first()
                    .zip(seen.last())
                    .map_or((0, 0), |(first, last)| {
                        ((last + 1 - first) * each * 3, first * each * 3)
                    })
            };
            let found = (count, if count == 0 { 0 } else { first });
            assert!(
                found == due(1e-3) || found == due(-1e-3),
                "view {k}, group {group}: {found:?}, not {:?}",
                due(0.0)
            );
            drawn[k] += count;
        }
    }
    assert_eq!(drawn[0], primitives * 3, "all of the first entity");
    assert!(drawn[1] > 0 && drawn[1] < primitives, "some: {drawn:?}");
    assert_eq!(
        drawn[2..],
        [0, 0],
        "nothing there, or nothing that is drawn"
    );
    // What no shadow view asked for is as it was.
    assert!(
        ranges[4 * 64..]
            .iter()
            .flatten()
            .all(|word| *word == 0xABAB_ABAB)
    );
}
