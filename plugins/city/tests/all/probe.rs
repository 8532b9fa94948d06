//! The pure functions of the shaders on the adapter, against their CPU references.

use bytemuck::{cast_slice, pod_collect_to_vec};
use dolomite_city::hash::{pcg, unit};
use dolomite_city::levels::{Eye, PatchLevels};
use dolomite_city::windows::{WindowPlace, lit_number, window_hash};
use dolomite_city::{CityDetail, CityRules, Classic, ErrorBound};
use dolomite_shaders::ShaderFile;
use dolomite_testkit::gpu::{Binding, for_test};

use crate::support::{MAPS, bytes, params, patches, points};

const LEVELS: &str = "
#import dolomite::city::types::CityParams
#import dolomite::city::relief::PatchData
#import dolomite::city::levels::{Corners, city_levels}

@group(0) @binding(0) var<uniform> city: CityParams;
@group(0) @binding(1) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> eyes: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> found: array<vec4<f32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let k = id.x;
    if k >= arrayLength(&eyes) {
        return;
    }
    let data = PatchData(points[8u * k + 4u], points[8u * k + 5u], points[8u * k + 6u], points[8u * k + 7u]);
    let at = Corners(points[8u * k].xyz, points[8u * k + 1u].xyz, points[8u * k + 2u].xyz, points[8u * k + 3u].xyz);
    let levels = city_levels(city, eyes[k].xyz, eyes[k].w, data, at);
    found[2u * k] = levels.outer;
    found[2u * k + 1u] = vec4(levels.inner, 0.0, 0.0);
}
";

const WINDOWS: &str = "
#import dolomite::city::windows::{lit_number, window_hash}

@group(0) @binding(0) var<storage, read> windows: array<vec4<i32>>;
@group(0) @binding(1) var<storage, read_write> found: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let k = id.x;
    if k >= arrayLength(&windows) {
        return;
    }
    let w = windows[k];
    let place = u32(w.z);
    let window = window_hash(7u, w.xy, place & 3u, (place >> 2u) & 3u, (place >> 4u) & 7u, (place >> 7u) & 15u);
    found[k] = lit_number(window, u32(w.w));
}
";

fn composed(source: &'static str) -> naga::Module {
    let probe = ShaderFile {
        path: "city/probe_of_a_test.wgsl",
        source,
    };
    dolomite_shaders::compose_with(probe.path, &[], &[probe]).expect("it composes")
}

#[test]
fn shaders_are_valid() {
    for file in dolomite_shaders::ALL {
        if file.path.starts_with("city/") {
            dolomite_shaders::compose(file.path, &[]).unwrap_or_else(|e| panic!("{e}"));
        }
    }
}

/// Levels of 100 000 patches and eyes: by distance to the bit; by the bound within some roundings of a square root.
#[test]
fn levels_are_those_of_the_reference_gpu() {
    let Some(gpu) = for_test() else { return };
    let kernel = gpu.kernel(composed(LEVELS), "main").expect("it compiles");
    let rules = CityRules::default();
    let patches = patches(&rules, 6);
    let repeated: Vec<_> = (0..100_000).map(|k| patches[k % patches.len()]).collect();
    let eyes: Vec<Eye> = (0..100_000_u32)
        .map(|k| {
            let [x, y, z] = [1, 2, 3].map(|salt| unit(pcg(k ^ (salt << 20))));
            Eye {
                at: bevy::math::Vec3::new(x * 200.0, 1.0 + y * y * 60.0, z * 200.0),
                pixels_per_radian: 935.0,
            }
        })
        .collect();
    let eye_bytes: Vec<[f32; 4]> = eyes
        .iter()
        .map(|e| e.at.extend(e.pixels_per_radian).to_array())
        .collect();
    for detail in [
        CityDetail::Classic(Classic::default()),
        CityDetail::ErrorBound(1.0),
        CityDetail::Static(7.0),
    ] {
        let uniform = bytes(&params(&rules, detail));
        let control = points(&repeated);
        let mut out = vec![0xab_u8; 32 * repeated.len()];
        gpu.run(
            &kernel,
            &mut [vec![
                Binding::Uniform(&uniform),
                Binding::Read(cast_slice(&control)),
                Binding::Read(cast_slice(&eye_bytes)),
                Binding::Write(&mut out),
            ]],
            [repeated.len().div_ceil(64) as u32, 1, 1],
        )
        .expect("it runs");
        let found: Vec<[f32; 8]> = pod_collect_to_vec(&out);
        let bound = ErrorBound::new(&rules, &MAPS, 1.0);
        let (mut different, mut worst) = (0, 0.0_f32);
        for ((patch, eye), found) in repeated.iter().zip(&eyes).zip(&found) {
            let expected = match detail {
                CityDetail::Classic(classic) => classic.levels(eye, patch),
                CityDetail::ErrorBound(_) => bound.levels(eye, patch),
                CityDetail::Static(level) => PatchLevels {
                    outer: [level; 4],
                    inner: [level; 2],
                },
            };
            let [l, b, r, t] = expected.outer;
            let [u, v] = expected.inner;
            for (expected, found) in [l, b, r, t, u, v].into_iter().zip(found) {
                different += usize::from(expected.to_bits() != found.to_bits());
                worst = worst.max((expected - found).abs() / expected);
            }
        }
        println!("{detail:?}: {different} of 600000 differ, at most by {worst:e}");
        match detail {
            // A distance of some 200 m is off by 2⁻²³ of it; what is allowed near the eye is a difference of that and
            // of metres, so a hundred times as much of it.
            CityDetail::ErrorBound(_) => assert!(worst < 2e-3, "{worst}"),
            _ => assert_eq!(different, 0, "{detail:?}: by {worst}"),
        }
    }
}

#[test]
fn windows_are_those_of_the_reference_gpu() {
    let Some(gpu) = for_test() else { return };
    let kernel = gpu.kernel(composed(WINDOWS), "main").expect("it compiles");
    let windows: Vec<[i32; 4]> = (0..50_000_i32)
        .map(|k| {
            let hash = pcg(k as u32);
            [
                k % 300 - 150,
                k / 300 - 80,
                (hash & 0x7ff) as i32,
                (hash >> 11) as i32 % 24,
            ]
        })
        .map(|[x, z, place, hour]| [x, z, place, hour.abs()])
        .collect();
    let mut out = vec![0xab_u8; 4 * windows.len()];
    gpu.run(
        &kernel,
        &mut [vec![
            Binding::Read(cast_slice(&windows)),
            Binding::Write(&mut out),
        ]],
        [windows.len().div_ceil(64) as u32, 1, 1],
    )
    .expect("it runs");
    let found: Vec<u32> = pod_collect_to_vec(&out);
    for ([x, z, place, hour], found) in windows.iter().zip(found) {
        let place = *place as u32;
        let window = WindowPlace {
            cell: [*x, *z],
            lot: place & 3,
            side: (place >> 2) & 3,
            column: (place >> 4) & 7,
            storey: (place >> 7) & 15,
        };
        assert_eq!(
            lit_number(window_hash(7, &window), *hour as u32),
            found,
            "{window:?}"
        );
    }
}
