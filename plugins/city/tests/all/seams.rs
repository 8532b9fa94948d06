//! Borders: both faces of an edge draw the same points, and displacement is nothing there, with no slope.

use std::collections::HashMap;
use std::sync::Arc;

use dolomite_city::render::{faces_mesh, map_bytes};
use dolomite_city::{CityDetail, CityPatch, CityRules};
use dolomite_shaders::ShaderFile;
use dolomite_tessellation::layout::StageView;
use dolomite_tessellation::tables::Instance;
use dolomite_tessellation::{Domain, Mode, Spacing, Tessellator, Winding};
use dolomite_testkit::gpu::for_test;
use dolomite_testkit::stage::{StageOptions, StagePasses, StageRun};
use wgpu::BufferBindingType;

use crate::support::{MAPS, bytes, params, patches};

/// The parts of a side that a test walks: multiples of 1/64 and some between.
fn parts() -> impl Iterator<Item = f32> {
    (0..=64)
        .map(|k| k as f32 / 64.0)
        .chain((0..16).map(|k| (2 * k + 1) as f32 / 33.0))
}

/// (u, v) of a place on side u = 0, v = 0, u = 1 or v = 1.
fn on(side: usize, t: f32) -> [f32; 2] {
    match side {
        0 => [0.0, t],
        1 => [t, 0.0],
        2 => [1.0, t],
        _ => [t, 1.0],
    }
}

#[test]
fn displacement_and_slope_are_exactly_nothing_on_borders() {
    let rules = CityRules::default();
    let band = rules.relief.band;
    let (mut borders, mut inner) = (0, 0);
    for patch in patches(&rules, 3) {
        let map = &MAPS[patch.data.map[3] as usize];
        for side in 0..4 {
            if !patch.data.is_border(side) {
                continue;
            }
            for t in parts() {
                let [u, v] = on(side, t);
                let found = patch.data.relief(map, band, u, v);
                assert_eq!(
                    (found.height, found.slope),
                    (0.0, [0.0; 2]),
                    "{patch:?} {u} {v}"
                );
                borders += 1;
            }
        }
        inner += usize::from(patch.data.relief(map, band, 0.5, 0.5).height > 0.0);
    }
    assert!(borders > 100_000 && inner > 500, "{borders} {inner}");
}

/// Sides that lie on each other, walked from both ends.
#[test]
fn facing_sides_have_the_same_bits() {
    let rules = CityRules::default();
    let patches = patches(&rules, 5);
    let mut sides: HashMap<[[u32; 3]; 2], Vec<(usize, usize, bool)>> = HashMap::new();
    for (k, patch) in patches.iter().enumerate() {
        for (side, [a, b]) in [[0, 3], [0, 1], [1, 2], [3, 2]].into_iter().enumerate() {
            let [a, b] = [a, b].map(|c: usize| {
                let [x, y, z, _] = patch.corners[c];
                [x, y, z].map(f32::to_bits)
            });
            let (line, turned) = if a < b {
                ([a, b], false)
            } else {
                ([b, a], true)
            };
            sides.entry(line).or_default().push((k, side, turned));
        }
    }
    let band = rules.relief.band;
    let place = |k: usize, side: usize, turned: bool, t: f32| {
        let patch: &CityPatch = &patches[k];
        let [u, v] = on(side, if turned { 1.0 - t } else { t });
        let map = &MAPS[patch.data.map[3] as usize];
        patch
            .evaluate(map, band, u, v)
            .0
            .to_array()
            .map(f32::to_bits)
    };
    let mut compared = 0;
    for users in sides.values() {
        let [(a, a_side, a_turned), (b, b_side, b_turned)] = users[..] else {
            continue;
        };
        if patches[a].corners[0][3] == patches[b].corners[0][3] {
            // Shared: the stage evaluates it once.
            continue;
        }
        // Multiples of 1/64, for which 1 − t is exact as all of the stage's coordinates are.
        for k in 0..=64 {
            let t = k as f32 / 64.0;
            assert_eq!(place(a, a_side, a_turned, t), place(b, b_side, b_turned, t));
            compared += 1;
        }
    }
    assert!(compared > 200_000, "{compared}");
}

/// What the stage draws of some blocks, at even and at differing levels: every edge of a triangle is that of another
/// one, to the bit, but where the city or a wall ends.
#[test]
fn what_is_drawn_is_closed_to_the_bit_gpu() {
    let Some(gpu) = for_test() else { return };
    let rules = CityRules::default();
    let patches = patches(&rules, 2);
    let mesh = Arc::new(faces_mesh(&patches).expect("patches"));
    let source = dolomite_shaders::ALL
        .iter()
        .find(|file| file.path == "city/patches.wgsl")
        .expect("it is there")
        .source
        .replacen("dolomite::city::patches", "dolomite::stage::user", 1);
    let functions = [ShaderFile {
        path: "stage/user.wgsl",
        source: Box::leak(source.into_boxed_str()),
    }];
    let kinds = [
        BufferBindingType::Uniform,
        BufferBindingType::Storage { read_only: true },
    ];
    let tessellator = Tessellator {
        domain: Domain::Quads,
        spacing: Spacing::FractionalOdd,
        winding: Winding::Ccw,
        mode: Mode::Exact,
    };
    let options = StageOptions {
        functions: &functions,
        data: &kinds,
        ..Default::default()
    };
    let passes = StagePasses::with_options(&gpu, tessellator, &options).expect("they compile");
    let layout = mesh.layout();
    let entities = [(mesh.clone(), Instance::IDENTITY)];
    let mut run =
        StageRun::new(&gpu, &passes, layout, &entities, [1 << 20, 1 << 21]).expect("room");
    let maps = map_bytes(&MAPS);
    let view = StageView {
        planes: [[0.0, 0.0, 0.0, 1.0]; 6],
        eye: [30.0, 3.0, 30.0],
        pixels_per_radian: 935.0,
        pixels_per_edge: 8.0,
        ..bytemuck::Zeroable::zeroed()
    };
    run.set_view(view, 128.0);
    for detail in [
        CityDetail::Static(5.0),
        CityDetail::ErrorBound(4.0),
        CityDetail::ErrorBound(2.0),
    ] {
        run.set_data(&[&bytes(&params(&rules, detail)), &maps], &kinds);
        run.tessellate(1).expect("it runs");
        let emitted = run.read().expect("it comes back");
        assert!(emitted.guarded && emitted.head.lowered == 0, "{detail:?}");
        let place = |k: u32| {
            let [x, y, z, ..] = emitted.vertices[k as usize];
            [x, y, z]
        };
        let mut edges: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
        for corners in emitted.indices.chunks_exact(3) {
            for k in 0..3 {
                let (a, b) = (place(corners[k]), place(corners[(k + 1) % 3]));
                if a == b {
                    continue;
                }
                let (line, sign) = if a < b { ([a, b], 1) } else { ([b, a], -1) };
                *edges.entry(line).or_default() += sign;
            }
        }
        let end = 2.0 * rules.pitch;
        let ends = |[x, y, z]: [u32; 3]| {
            let [x, y, z] = [x, y, z].map(f32::from_bits);
            [x == 0.0, x == end, z == 0.0, z == end, y < -0.2]
        };
        let open = edges
            .iter()
            .filter(|(_, sum)| **sum != 0)
            .filter(|([a, b], _)| {
                let (a, b) = (ends(*a), ends(*b));
                !(0..5).any(|k| a[k] && b[k])
            })
            .count();
        println!(
            "{detail:?}: {} triangles, {} edges, {open} open",
            emitted.indices.len() / 3,
            edges.len()
        );
        assert_eq!(open, 0, "{detail:?}");
        assert!(edges.len() > 20_000, "{detail:?}: {}", edges.len());
    }
}
