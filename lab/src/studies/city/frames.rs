//! Background pixels: the stage draws parts of a city without depth over a sentinel colour, from places from which
//! nothing else than that part is behind a pixel.
//!
//! A street grid's ground alone, seen from above. A building from within, with level ground under its foot alone. Each
//! is open on purpose too, by a patch that is taken out: the count can fail.

use std::sync::Arc;

use bevy::math::{DVec3, Vec3};
use dolomite_city::hash::pcg;
use dolomite_city::render::{faces_mesh, map_bytes};
use dolomite_city::{Block, CityDetail, CityPatch, CityRules, Classic, DisplacementMap, Faces};
use dolomite_shaders::ShaderFile;
use dolomite_tessellation::layout::StageView;
use dolomite_tessellation::tables::Instance;
use dolomite_tessellation::{Domain, Mode, Spacing, Tessellator, Winding};
use dolomite_testkit::gpu::Gpu;
use dolomite_testkit::random::Random;
use dolomite_testkit::raster::{Raster, SIDE};
use dolomite_testkit::stage::{StageError, StageOptions, StagePasses, StageRun};
use serde_json::{Value, json};
use wgpu::BufferBindingType;

use super::uniform::params;

const KINDS: [BufferBindingType; 2] = [
    BufferBindingType::Uniform,
    BufferBindingType::Storage { read_only: true },
];

/// Frames of closed parts for one that is open on purpose.
const CONTROLS: usize = 20;

/// What the stage makes room for: a building at the greatest level.
const POOLS: [u32; 2] = [3 << 19, 3 << 20];

/// How levels are chosen: bounds, one level, and by distance, where two faces of an edge may differ.
const DETAILS: [(&str, CityDetail); 4] = [
    ("bound_1_px", CityDetail::ErrorBound(1.0)),
    ("bound_4_px", CityDetail::ErrorBound(4.0)),
    ("static", CityDetail::Static(5.0)),
    (
        "by_distance",
        CityDetail::Classic(Classic {
            levels: (16.0, 1.0),
            ground: 120.0,
            walls: (10.0, 120.0),
            roofs: (10.0, 60.0),
        }),
    ),
];

/// A camera 90 degrees wide, column by column; depth is cut off at the eye alone.
fn clip(eye: Vec3, forward: Vec3, turn: f32) -> [f32; 16] {
    let side = if forward.y.abs() < 0.9 {
        Vec3::Y
    } else {
        Vec3::X
    };
    let right = forward.cross(side).normalize();
    let right = bevy::math::Quat::from_axis_angle(forward, turn) * right;
    let up = right.cross(forward);
    let mut clip = [0.0; 16];
    for k in 0..3 {
        clip[4 * k..4 * k + 4].copy_from_slice(&[right[k], up[k], forward[k], forward[k]]);
    }
    let near = 0.01;
    clip[12..].copy_from_slice(&[
        -right.dot(eye),
        -up.dot(eye),
        -forward.dot(eye) - near,
        -forward.dot(eye),
    ]);
    clip
}

/// What a frame shows.
struct Part {
    patches: Vec<CityPatch>,
    eye: Vec3,
    forward: Vec3,
}

fn direction(random: &mut Random) -> Vec3 {
    loop {
        let at = DVec3::from_array(std::array::from_fn(|_| random.signed_unit()));
        if (0.1..1.0).contains(&at.length()) {
            return at.normalize().as_vec3();
        }
    }
}

/// 6 × 6 cells of ground under the eye. A view 90 degrees wide that leans by up to 15 degrees reaches 70 degrees from
/// straight down, 2.8 heights away: 70 m from 25 m up, and the ground reaches 88 m and more.
fn ground(rules: &CityRules, maps: &[DisplacementMap], random: &mut Random) -> Part {
    let mut faces = Faces::new(rules, maps, [0, 0]);
    let within = |c: [i32; 2]| (0..6).contains(&c[0]) && (0..6).contains(&c[1]);
    for x in 0..6 {
        for z in 0..6 {
            faces.ground([x, z], within);
        }
    }
    let middle = 3.0 * rules.pitch;
    let [x, z] = [0; 2].map(|_| middle + 8.0 * random.signed_unit() as f32);
    let height = 1.0 + 24.0 * (random.unit() * random.unit()) as f32;
    let lean = Vec3::new(
        random.signed_unit() as f32,
        0.0,
        random.signed_unit() as f32,
    ) * 0.18;
    Part {
        patches: faces.patches,
        eye: Vec3::new(x, height, z),
        forward: (Vec3::NEG_Y + lean).normalize(),
    }
}

/// A building around the eye.
fn building(rules: &CityRules, maps: &[DisplacementMap], random: &mut Random) -> Part {
    loop {
        let cell = [0; 2].map(|_| (random.unit() * 1000.0) as i32);
        let block = Block::new(rules, cell);
        let Some(building) = block.buildings(rules).next() else {
            continue;
        };
        let mut faces = Faces::new(rules, maps, cell);
        faces.building(cell, &building);
        faces.far_ground(400.0);
        let inside = 0.6 * (building.half - building.inset);
        let [x, z] = building
            .centre
            .map(|c| c + inside * random.signed_unit() as f32);
        let height = 0.05 + (building.top - 0.5) * random.unit() as f32;
        return Part {
            patches: faces.patches,
            eye: Vec3::new(x, height, z),
            forward: direction(random),
        };
    }
}

#[derive(Default)]
struct Count {
    frames: usize,
    with_background: usize,
    pixels: usize,
    triangles: u64,
    lowered: usize,
}

impl Count {
    fn json(&self) -> Value {
        json!({
            "frames": self.frames, "frames_with_background": self.with_background,
            "background_pixels": self.pixels, "triangles": self.triangles, "lowered": self.lowered,
        })
    }
}

/// Draws so many frames and counts.
///
/// # Errors
/// If the adapter cannot.
pub fn frames(
    gpu: &Gpu,
    rules: &CityRules,
    maps: &[DisplacementMap],
    seed: u32,
    frames: usize,
) -> Result<Value, StageError> {
    let source = dolomite_shaders::ALL
        .iter()
        .find(|file| file.path == "city/patches.wgsl")
        .expect("the crate has it")
        .source
        .replacen("dolomite::city::patches", "dolomite::stage::user", 1);
    let functions = [ShaderFile {
        path: "stage/user.wgsl",
        source: Box::leak(source.into_boxed_str()),
    }];
    let tessellator = Tessellator {
        domain: Domain::Quads,
        spacing: Spacing::FractionalOdd,
        winding: Winding::Ccw,
        mode: Mode::Exact,
    };
    let options = StageOptions {
        functions: &functions,
        data: &KINDS,
        ..Default::default()
    };
    let passes = StagePasses::with_options(gpu, tessellator, &options)?;
    let raster = Raster::new(gpu);
    let texels = map_bytes(maps);
    let mut random = Random::new(seed ^ 0xc17);
    let draw =
        |part: &Part, detail: CityDetail, turn: f32| -> Result<(usize, u32, u32), StageError> {
            let mesh = Arc::new(faces_mesh(&part.patches).expect("patches of one city"));
            let entities = [(mesh.clone(), Instance::IDENTITY)];
            let mut run = StageRun::new(gpu, &passes, mesh.layout(), &entities, POOLS)?;
            let view = StageView {
                planes: [[0.0, 0.0, 0.0, 1.0]; 6],
                eye: part.eye.to_array(),
                pixels_per_radian: super::numbers::PIXELS,
                pixels_per_edge: 8.0,
                ..bytemuck::Zeroable::zeroed()
            };
            run.set_view(view, 128.0);
            run.set_data(&[&params(rules, maps, detail), &texels], &KINDS);
            run.tessellate(1)?;
            let pixels = raster.uncovered(gpu, &run, &clip(part.eye, part.forward, turn))?;
            let head = run.head()?;
            Ok((pixels, head.primitives, head.lowered))
        };
    let mut counts: [Count; DETAILS.len()] = Default::default();
    let mut open = Count::default();
    let add = |count: &mut Count, (pixels, triangles, lowered): (usize, u32, u32)| {
        count.frames += 1;
        count.with_background += usize::from(pixels > 0);
        count.pixels += pixels;
        count.triangles += u64::from(triangles);
        count.lowered += usize::from(lowered > 0);
    };
    for frame in 0..frames {
        let number = frame % (2 * DETAILS.len());
        let make = if number.is_multiple_of(2) {
            ground
        } else {
            building
        };
        let mut part = make(rules, maps, &mut random);
        let turn = (random.unit() * std::f64::consts::TAU) as f32;
        let (_, detail) = DETAILS[number / 2];
        add(&mut counts[number / 2], draw(&part, detail, turn)?);
        if frame % CONTROLS == 0 {
            // A wall, or the ground under the eye, is taken out: what is nearest before the eye.
            let ahead = part.eye + part.forward * part.eye.y.max(0.5);
            let distance = |patch: &CityPatch| {
                let [x, y, z, _] = patch.corners[0];
                let [a, b, c, _] = patch.corners[2];
                ((Vec3::new(x, y, z) + Vec3::new(a, b, c)) * 0.5).distance(ahead)
            };
            let nearest = (0..part.patches.len())
                .min_by(|a, b| distance(&part.patches[*a]).total_cmp(&distance(&part.patches[*b])))
                .unwrap_or(pcg(frame as u32) as usize % part.patches.len());
            part.patches.swap_remove(nearest);
            add(&mut open, draw(&part, detail, turn)?);
        }
        if frame % 100 == 99 {
            eprintln!("city: {} of {frames} frames", frame + 1);
        }
    }
    let mut value = json!({ "pixels_of_a_frame": SIDE * SIDE, "patch_taken_out": open.json() });
    let (mut all, mut background) = (0, 0);
    for ((name, _), count) in DETAILS.iter().zip(&counts) {
        value[*name] = count.json();
        // Levels of the literature differ on the two faces of an edge, and are a baseline.
        if *name != "by_distance" {
            all += count.frames;
            background += count.pixels;
        }
    }
    value["frames"] = json!(all);
    value["background_pixels"] = json!(background);
    Ok(value)
}
