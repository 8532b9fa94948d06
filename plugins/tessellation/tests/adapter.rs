//! The real compute shaders on the adapter, against their Rust twins: the same indices, integer
//! for integer, vertices within f32 rounding, and no crack by the bits of the positions.

mod support;

use bytemuck::{bytes_of, cast_slice, pod_collect_to_vec};
use dolomite_lab::gpu::{Binding, Gpu, Kernel, for_test};
use dolomite_terrain::{GpuTerrain, Terrain};
use dolomite_tessellation::cover::Cover;
use dolomite_tessellation::layout::{Corner, Edge, Patch, PlanResult, Vertex, ViewParams};
use dolomite_tessellation::twin;
use support::{Random, cracks, random_view, terrain};

/// What the shaders write before they run: no vertex and no index has these bits.
const SENTINEL: u8 = 0xcd;

struct Output {
    cover: Cover,
    result: PlanResult,
    vertices: Vec<Vertex>,
    indices: Vec<u32>,
}

/// The adapter and the three passes, compiled; `None` where there is no adapter.
struct Passes {
    gpu: Gpu,
    levels: Kernel,
    plan: Kernel,
    emit: Kernel,
}

impl Passes {
    fn new() -> Option<Self> {
        let gpu = for_test()?;
        let kernel = |name: &str| {
            let path = format!("tessellation/{name}.wgsl");
            let module = dolomite_shaders::compose(&path, &[])
                .unwrap_or_else(|error| panic!("{path}: {error}"));
            gpu.kernel(module, name)
                .unwrap_or_else(|error| panic!("{path}: {error}"))
        };
        let (levels, plan, emit) = (kernel("levels"), kernel("plan"), kernel("emit"));
        Some(Self {
            gpu,
            levels,
            plan,
            emit,
        })
    }
}

/// levels → plan → emit on the adapter.
fn run(passes: &Passes, cover: &Cover, params: &ViewParams, terrain: &Terrain) -> Output {
    let GpuTerrain {
        layers,
        data,
        uniform,
    } = terrain.gpu();
    let (layers, data): (&[u8], &[u8]) = (cast_slice(&layers), cast_slice(&data));
    let uniform = bytes_of(&uniform);
    let view = bytes_of(params);
    let mut corners: Vec<u8> = cast_slice(&cover.corners).to_vec();
    let mut edges: Vec<u8> = cast_slice(&cover.edges).to_vec();
    let mut patches: Vec<u8> = cast_slice(&cover.patches).to_vec();
    let mut result = vec![SENTINEL; size_of::<PlanResult>()];
    let heights = || {
        vec![
            Binding::Read(layers),
            Binding::Read(data),
            Binding::Uniform(uniform),
        ]
    };
    let items = params.edge_count.max(params.patch_count);
    passes
        .gpu
        .run(
            &passes.levels,
            &mut [
                vec![
                    Binding::Uniform(view),
                    Binding::Read(&corners),
                    Binding::Write(&mut edges),
                    Binding::Write(&mut patches),
                ],
                heights(),
            ],
            [items.div_ceil(64), 1, 1],
        )
        .expect("levels runs");
    passes
        .gpu
        .run(
            &passes.plan,
            &mut [vec![
                Binding::Uniform(view),
                Binding::Write(&mut corners),
                Binding::Write(&mut edges),
                Binding::Write(&mut patches),
                Binding::Write(&mut result),
            ]],
            [1, 1, 1],
        )
        .expect("plan runs");
    let result: PlanResult = bytemuck::pod_read_unaligned(&result);
    let mut vertices = vec![SENTINEL; result.vertices.max(1) as usize * 16];
    let mut indices = vec![SENTINEL; result.triangles.max(1) as usize * 12];
    passes
        .gpu
        .run(
            &passes.emit,
            &mut [
                vec![
                    Binding::Uniform(view),
                    Binding::Read(&corners),
                    Binding::Read(&edges),
                    Binding::Read(&patches),
                    Binding::Write(&mut vertices),
                    Binding::Write(&mut indices),
                ],
                heights(),
            ],
            [
                params.patch_count + params.edge_count + params.corner_count.div_ceil(64),
                1,
                1,
            ],
        )
        .expect("emit runs");
    vertices.truncate(result.vertices as usize * 16);
    indices.truncate(result.triangles as usize * 12);
    Output {
        cover: Cover {
            corners: pod_collect_to_vec::<u8, Corner>(&corners),
            edges: pod_collect_to_vec::<u8, Edge>(&edges),
            patches: pod_collect_to_vec::<u8, Patch>(&patches),
        },
        result,
        vertices: pod_collect_to_vec(&vertices),
        indices: pod_collect_to_vec(&indices),
    }
}

#[test]
fn the_adapter_agrees_with_the_twin() {
    let Some(passes) = Passes::new() else { return };
    let terrain = terrain(6);
    let mut random = Random(20);
    for round in 0..12 {
        let (cover, params) = random_view(&mut random, &terrain, 64.0);
        let ours = run(&passes, &cover, &params, &terrain);
        // The twin plans with the adapter's own wanted levels and visibility: from there on all
        // is integers.
        let mut twin_cover = cover.clone();
        twin::levels(&mut twin_cover, &params, &terrain);
        for (twin, adapter) in twin_cover.edges.iter_mut().zip(&ours.cover.edges) {
            let (a, b) = (f32::from_bits(twin.wanted), f32::from_bits(adapter.wanted));
            // Heights differ by f32 rounding of a sum of six octaves, some 1e-4 m at most; near
            // the eye that is 1e-4 of a distance of 0.1 m and more.
            assert!(
                (a - b).abs() <= 2e-3 * a,
                "round {round}: wanted {a} and {b}"
            );
            twin.wanted = adapter.wanted;
        }
        for (twin, adapter) in twin_cover.patches.iter_mut().zip(&ours.cover.patches) {
            twin.visible = adapter.visible;
        }
        let result = twin::plan(&mut twin_cover, &params);
        assert_eq!(
            result,
            PlanResult {
                pad: result.pad,
                ..ours.result
            },
            "round {round}"
        );
        let mesh = twin::emit(&twin_cover, &params, &terrain, &result);
        assert_eq!(mesh.indices, ours.indices, "round {round}");
        for (a, b) in mesh.vertices.iter().zip(&ours.vertices) {
            for axis in 0..3 {
                // x and z: one rounding of a metre coordinate up to 5 km (2.4e-4 m). y: 1e-5 of
                // the amplitude of 200 m on either side.
                let bound = if axis == 1 { 4e-3 } else { 5e-4 };
                let difference = (a.position[axis] - b.position[axis]).abs();
                assert!(difference <= bound, "round {round}: {a:?} and {b:?}");
            }
        }
    }
}

#[test]
fn two_hundred_cameras_have_no_crack_on_the_adapter() {
    let Some(passes) = Passes::new() else { return };
    let terrain = terrain(3);
    let mut random = Random(21);
    let mut triangles = 0;
    for round in 0..200 {
        let (cover, params) = random_view(&mut random, &terrain, 128.0);
        let output = run(&passes, &cover, &params, &terrain);
        triangles += output.indices.len() / 3;
        // Sentinel bits as an index are out of range, as a position far off: both are found.
        let found = cracks(&output.cover, &output.vertices, &output.indices);
        assert_eq!(found, Some(0), "round {round}");
    }
    assert!(
        triangles > 200_000,
        "{triangles} triangles are enough to mean something"
    );
}
