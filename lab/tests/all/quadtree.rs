//! Patches beside two of half their size, through the stage's passes on whatever adapter there is.

use crate::support;

use dolomite_tessellation::half_edge::check;
use dolomite_tessellation::patches::WHOLE;
use dolomite_tessellation::{Domain, Levels, Mode, PatchLayout, PatchMesh, Tessellator};
use dolomite_testkit::gpu::for_test;
use dolomite_testkit::stage::{StageOptions, StagePasses};
use support::{Random, SPACINGS, by_points, run_with, triangles};

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

/// Patches beside two of half their size: the vertices and triangles of the CPU reference, one sheet with one
/// border, of which no triangle is turned over.
#[test]
fn gpu_a_quadtree_is_one_sheet_and_the_cpu_references() {
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
            let reference = tessellator.tessellate_mesh(&mesh, control, pools);
            let emitted = run_with(&gpu, &passes, mesh.clone(), by_points(), pools);
            assert!(emitted.guarded);
            assert_eq!(
                emitted.head.lowered, reference.lowered,
                "{spacing:?} {round}"
            );
            let found = triangles(&emitted);
            assert!(
                found == reference.primitives.triangles(),
                "{spacing:?} {round}"
            );
            assert_eq!(emitted.vertices.len(), reference.vertices.len());
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
