//! Levels by distance: those of the shader, to the bit those of the CPU, and both beside the formulas of the
//! literature in f64.

use bytemuck::{cast_slice, pod_collect_to_vec};
use dolomite_city::hash::{pcg, unit};
use dolomite_city::levels::{Eye, PatchLevels};
use dolomite_city::{CityDetail, CityPatch, CityRules, Classic, DisplacementMap};
use dolomite_shaders::ShaderFile;
use dolomite_testkit::gpu::{Binding, Gpu, GpuError};
use serde_json::{Value, json};

use super::uniform::{params, points};

const PROBE: ShaderFile = ShaderFile {
    path: "city/probe_of_a_study.wgsl",
    source: "
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
",
};

/// Left, low, right and high side, and both inner levels.
fn six(levels: &PatchLevels) -> [f32; 6] {
    let [a, b, c, d] = levels.outer;
    let [u, v] = levels.inner;
    [a, b, c, d, u, v]
}

/// The formulas in f64. Ground: 0.6 of the distance of a side's middle and 0.4 of flatness, which is 1 on level
/// ground. Walls, roofs and hedges: by horizontal distance, then a level a metre, the mean of both sides of an axis,
/// times the length of each.
fn literature(classic: &Classic, eye: &Eye, patch: &CityPatch) -> [f64; 6] {
    let (most, least) = (f64::from(classic.levels.0), f64::from(classic.levels.1));
    let surface = patch.data.material() & 7;
    let eye = eye.at.as_dvec3().to_array();
    let corner = patch.corners.map(|c| [c[0], c[1], c[2]].map(f64::from));
    let length = |v: [f64; 3]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    let ends = [[0, 3], [0, 1], [1, 2], [3, 2]].map(|[a, b]: [usize; 2]| (corner[a], corner[b]));
    let away = ends.map(|(a, b)| [0, 1, 2].map(|k| 0.5 * (a[k] + b[k]) - eye[k]));
    let outer = if surface <= 2 {
        let reach = f64::from(classic.ground);
        away.map(|way| {
            let distance = length(way);
            if distance > reach {
                least
            } else {
                most + (least - most) * (0.6 * distance / reach + 0.4)
            }
        })
    } else {
        let (near, far) = if surface == 5 {
            classic.roofs
        } else {
            classic.walls
        };
        let (near, far) = (f64::from(near), f64::from(far));
        let lengths = ends.map(|(a, b)| length([0, 1, 2].map(|k| b[k] - a[k])));
        let a_metre: Vec<f64> = (0..4)
            .map(|k| {
                let distance = length([away[k][0], 0.0, away[k][2]]);
                let share = ((distance - near) / (far - near)).clamp(0.0, 1.0);
                (most + (least - most) * share) / lengths[k]
            })
            .collect();
        [0, 1, 2, 3].map(|k| 0.5 * (a_metre[k] + a_metre[(k + 2) % 4]) * lengths[k])
    };
    let [l, b, r, t] = outer;
    [l, b, r, t, b.max(t), l.max(r)]
}

/// How many of so many patches' levels differ in bits between shader and CPU, and by how much the CPU's from the
/// formulas. `None` for what the adapter should have said where there is none.
pub fn levels(
    gpu: Option<&Gpu>,
    rules: &CityRules,
    maps: &[DisplacementMap],
    patches: &[CityPatch],
    count: usize,
) -> Result<Value, GpuError> {
    let classic = Classic::default();
    let patches: Vec<CityPatch> = (0..count)
        .map(|k| patches[pcg(k as u32) as usize % patches.len()])
        .collect();
    let eyes: Vec<Eye> = (0..count as u32)
        .map(|k| {
            let [x, y, z] = [1, 2, 3].map(|salt| unit(pcg(k ^ (salt << 20))));
            Eye {
                at: bevy::math::Vec3::new(x * 200.0, 1.0 + y * y * 60.0, z * 200.0),
                pixels_per_radian: super::numbers::PIXELS,
            }
        })
        .collect();
    let mut worst = 0.0_f64;
    let ours: Vec<[f32; 6]> = patches
        .iter()
        .zip(&eyes)
        .map(|(patch, eye)| {
            let levels = six(&classic.levels(eye, patch));
            for (ours, exact) in levels.iter().zip(literature(&classic, eye, patch)) {
                worst = worst.max((f64::from(*ours) - exact).abs() / exact);
            }
            levels
        })
        .collect();
    let mut value = json!({ "levels": 6 * count, "largest_error": worst });
    let Some(gpu) = gpu else {
        return Ok(value);
    };
    let module = dolomite_shaders::compose_with(PROBE.path, &[], &[PROBE])
        .expect("the study's own shader composes");
    let kernel = gpu.kernel(module, "main")?;
    let uniform = params(rules, maps, CityDetail::Classic(classic));
    let control = points(&patches);
    let eyes: Vec<[f32; 4]> = eyes
        .iter()
        .map(|eye| eye.at.extend(eye.pixels_per_radian).to_array())
        .collect();
    let mut out = vec![0xab_u8; 32 * count];
    gpu.run(
        &kernel,
        &mut [vec![
            Binding::Uniform(&uniform),
            Binding::Read(cast_slice(&control)),
            Binding::Read(cast_slice(&eyes)),
            Binding::Write(&mut out),
        ]],
        [count.div_ceil(64) as u32, 1, 1],
    )?;
    let found: Vec<[f32; 8]> = pod_collect_to_vec(&out);
    let different = ours.iter().zip(&found).flat_map(|(ours, found)| {
        ours.iter()
            .zip(found)
            .filter(|(a, b)| a.to_bits() != b.to_bits())
    });
    value["differing_from_the_shader"] = json!(different.count());
    Ok(value)
}
