//! Plants: the passes that find the roots of a lattice on drawn triangles, against the CPU references of the lattice, of
//! the edges and of the law by which distance thins them.
//!
//! Records come in the order in which threads find them, so they are compared as a set, by the bits of their places.

use bevy::math::{DVec3, Vec2, Vec3};
use bytemuck::{Zeroable, bytes_of, cast_slice};
use dolomite_geometry::layout::GeometryHead;
use dolomite_geometry::vertex::pack;
use dolomite_terrain::GroundPoint;
use dolomite_testkit::random::Random;
use dolomite_vegetation::Law;
use dolomite_vegetation::density::NO_CLUMPS;
use dolomite_vegetation::law::entered;
use dolomite_vegetation::place::Lattice;
use dolomite_vegetation::render::edges::{height_at, holds, to_steps};
use dolomite_vegetation::render::layout::{
    ARGUMENT_BYTES, DIVIDE_ARGUMENTS, DRAW_ARGUMENTS, GROW_AGAIN_ARGUMENTS, GROW_ARGUMENTS,
    GrowCounts, GrowParams, LISTS, PIECE_BYTES, RECORD_BYTES,
};
use dolomite_vegetation::render::record::{PASSES, Second};
use dolomite_vegetation::render::rings::set_rings;

use super::CapsuleError;
use super::builder::Builder;
use super::format::{BindingKind, Capsule, Command, Field, FieldType, From, Indirect, Step};

/// World position of the anchor, metres: far from the origin.
const ANCHOR: [i64; 2] = [70_000, -31_000];
/// Lists that are used, and room in each.
const LODS: usize = 3;
const ROOM: u32 = 1 << 12;
const PIECES: u32 = 1 << 12;
/// Half the side of the ground, metres, and cells a side.
const HALF: f32 = 4.0;
const CELLS: u32 = 8;
/// Height of a blade, metres, and least heights in pixels of the two finer levels of detail.
const TALLEST: f32 = 0.5;
const PIXELS: [f32; 2] = [60.0, 36.0];
const PIXELS_PER_RADIAN: f32 = 300.0;
/// A number this near to a threshold, as a share of it, may be decided otherwise by an implementation that fuses.
const MARGIN: f32 = 1e-5;
/// Of heights: units in the last place of the size of their terms, slopes times the side of a triangle.
const ULP: f64 = 4.0;
const SIZE: f32 = 8.0;
const SEEDS: u32 = 64;

/// Triangles over a square about the anchor, and the normals of their corners.
struct Ground {
    vertices: Vec<Vec3>,
    normals: Vec<Vec3>,
    indices: Vec<u32>,
}

fn ground(random: &mut Random) -> Ground {
    let side = CELLS + 1;
    let step = 2.0 * HALF / CELLS as f32;
    let mut signed = || 2.0 * random.unit_f32() - 1.0;
    let (mut vertices, mut normals) = (Vec::new(), Vec::new());
    for k in 0..side * side {
        let [x, z] = [k % side, k / side].map(|k| {
            let inner = k > 0 && k < CELLS;
            (k as f32 + if inner { 0.2 * signed() } else { 0.0 }) * step - HALF
        });
        vertices.push(Vec3::new(x, signed(), z));
        normals.push(Vec3::new(0.4 * signed(), 1.0, 0.4 * signed()).normalize());
    }
    let quads = (0..CELLS * CELLS).map(|k| k / CELLS * side + k % CELLS);
    let indices = quads.flat_map(|a| [a, a + side, a + 1, a + 1, a + side, a + side + 1]);
    Ground {
        vertices,
        normals,
        indices: indices.collect(),
    }
}

fn params(seed: u32) -> Box<GrowParams> {
    let mut params: Box<GrowParams> = Box::new(GrowParams::zeroed());
    params.eye = [0.3, 1.7, -0.6];
    params.pixels_per_radian = PIXELS_PER_RADIAN;
    params.anchor = ANCHOR.map(|x| (x << 12) as i32);
    params.layer_count = 1;
    for lod in 0..LODS {
        params.rooms[lod] = ROOM;
        params.bases[lod] = ROOM * lod as u32;
        params.vertices[lod] = [15, 7, 3][lod];
    }
    params.piece_room = PIECES;
    let layer = &mut params.layers[0];
    layer.growth.lattice = Lattice {
        seed,
        pitch_log2: -3,
    };
    layer.growth.full = 1.0;
    layer.growth.height = [-1e6, 1e6, 1000.0];
    layer.growth.slope = [-1.0, 1e6, 1000.0];
    layer.growth.clump_size = NO_CLUMPS;
    layer.tallest = TALLEST;
    layer.lods = PIXELS;
    layer.reach = Law {
        first: 1.5,
        second: 4.0,
        fade: 5.0,
        reach: 8.0,
    };
    set_rings(layer, ANCHOR, [0.3, -0.6]);
    params
}

/// The records of each list, or nothing where a threshold is too near.
fn records(ground: &Ground, params: &GrowParams) -> Option<[Vec<[u32; 4]>; LODS]> {
    let layer = &params.layers[0];
    let (lattice, law) = (layer.growth.lattice, layer.reach);
    let triangles: Vec<([u32; 3], [[i32; 2]; 3])> = ground
        .indices
        .chunks_exact(3)
        .map(|corners| {
            let corners = [corners[0], corners[1], corners[2]];
            let at = corners.map(|k| ground.vertices[k as usize]);
            (corners, at.map(|p| to_steps(Vec2::new(p.x, p.z))))
        })
        .collect();
    let [from, to] =
        [-5_i64, 5].map(|off| GroundPoint::from_fixed(ANCHOR.map(|x| (x + off) << 32)));
    let eye = Vec3::from(params.eye);
    let mut lists = [const { Vec::new() }; LODS];
    for cell in lattice.cells(from, to) {
        let root = lattice.root(cell);
        let place = lattice.place(root).to_fixed();
        let at = [0, 1].map(|axis| ((place[axis] >> 20) - (ANCHOR[axis] << 12)) as i32);
        let Some((corners, steps)) = triangles.iter().find(|(_, steps)| holds(*steps, at)) else {
            continue;
        };
        let metres = at.map(|k| f64::from(k) / 4096.0);
        let corner = corners.map(|k| ground.vertices[k as usize]);
        let height = height_at(corner.map(|p| p.as_dvec3()), metres[0], metres[1]);
        let middle = DVec3::new(metres[0], height, metres[1]).as_vec3();
        let distance = middle.distance(eye);
        let rank = root.rank as f32 / (1 << 24) as f32;
        let share = law.drawn(distance);
        let near = |a: f32, b: f32| (a - b).abs() <= MARGIN * b.abs();
        let pixels = TALLEST * PIXELS_PER_RADIAN / distance.max(1e-3);
        if near(rank, share) || PIXELS.iter().any(|&least| near(pixels, least)) {
            return None;
        }
        if rank >= share.min(1.0) {
            continue;
        }
        let normals = corners.map(|k| ground.normals[k as usize]);
        let tilt = tilt(*steps, at, normals);
        let come = (entered(rank / share) * 63.0).round_ties_even() as u32;
        let [x, z] = at.map(|k| k.cast_unsigned() & 0xff_ffff);
        let lod = PIXELS.iter().filter(|&&least| pixels < least).count();
        lists[lod].push([
            x | (z << 24),
            (z >> 8) | (root.hash >> 16 << 16),
            (height as f32).to_bits(),
            come | ((root.hash >> 27) << 9) | (tilt[0] << 14) | (tilt[1] << 23),
        ]);
    }
    Some(lists)
}

/// x and z of the ground's normal in 511 steps.
fn tilt([a, b, c]: [[i32; 2]; 3], p: [i32; 2], normals: [Vec3; 3]) -> [u32; 2] {
    let to = |q: [i32; 2]| Vec2::new((q[0] - a[0]) as f32, (q[1] - a[1]) as f32);
    let (b, c, p) = (to(b), to(c), to(p));
    let area = b.perp_dot(c);
    let (v, w) = (p.perp_dot(c) / area, b.perp_dot(p) / area);
    let normal = normals[0] * (1.0 - v - w) + normals[1] * v + normals[2] * w;
    let normal = normal.normalize();
    [normal.x, normal.z].map(|x| ((x * 0.5 + 0.5) * 511.0).round_ties_even() as u32)
}

/// Roots on 128 triangles.
///
/// # Errors
/// If a shader is wrong, or a threshold is too near with every seed that is tried.
pub fn capsule(name: &str, about: &str, seed: u32) -> Result<Capsule, CapsuleError> {
    let found = (0..SEEDS).find_map(|k| {
        let own = seed.wrapping_add(k.wrapping_mul(7919));
        let ground = ground(&mut Random::new(own));
        let params = params(own);
        Some((records(&ground, &params)?, ground, params))
    });
    let (lists, ground, params) = found.ok_or_else(|| CapsuleError::Undecided {
        name: name.to_owned(),
        seed,
    })?;
    let mut builder = Builder::new(name, about);
    let vertices: Vec<[u32; 5]> = ground
        .vertices
        .iter()
        .zip(&ground.normals)
        .map(|(at, normal)| pack(*at, *normal, Vec2::ZERO, 0))
        .collect();
    let all = ground.indices.len() as u32;
    // The last third of the triangles lies in the list of those that are not seen.
    let seen = all / 9 * 6;
    let head = GeometryHead {
        indexed: [seen, 1, 0, 0, 0],
        others: [all - seen, 1, seen, 0, 0],
        ..GeometryHead::zeroed()
    };
    let counts = builder.filled("counts", size_of::<GrowCounts>() as u64, 0);
    let shared = [
        builder.buffer("params", bytes_of(&*params)),
        builder.buffer("vertices", cast_slice(&vertices)),
        builder.buffer("indices", cast_slice(&ground.indices)),
        builder.buffer("head", bytes_of(&head)),
        counts,
        builder.filled("pieces", u64::from(PIECES) * PIECE_BYTES, 0),
    ];
    let arguments = builder.filled("arguments", ARGUMENT_BYTES, 0);
    let kept = builder.filled(
        "records",
        u64::from(ROOM) * LODS as u64 * RECORD_BYTES,
        0xAB,
    );
    let (read, write) = (BindingKind::ReadOnlyStorage, BindingKind::Storage);
    let shared_layout = builder.layout(&[BindingKind::Uniform, read, read, read, write, write]);
    let second_layout = builder.layout(&[write]);
    let shared = builder.group(shared_layout, &shared);
    let to_arguments = builder.group(second_layout, &[arguments]);
    let to_records = builder.group(second_layout, &[kept]);
    let mut pipelines = Vec::new();
    for (file, entry, second) in PASSES {
        let module = dolomite_shaders::compose(file, &[])?;
        let module = builder.module(file, &[], &module)?;
        let layouts: &[u32] = match second {
            Second::Nothing => &[shared_layout],
            _ => &[shared_layout, second_layout],
        };
        pipelines.push(builder.pipeline(module, entry, layouts));
    }
    // As `record_passes` records them.
    let [plan, divide, ready, grow, thin, finish] = [0, 1, 2, 3, 4, 5].map(|k: usize| pipelines[k]);
    let one = |pipeline| Step {
        pipeline,
        groups: vec![shared, to_arguments],
        dispatch: Some([1; 3]),
        indirect: None,
    };
    let counted = |pipeline, groups: &[u32], offset| Step {
        pipeline,
        groups: groups.to_vec(),
        dispatch: None,
        indirect: Some(Indirect {
            buffer: arguments,
            offset,
        }),
    };
    let steps = vec![
        one(plan),
        counted(divide, &[shared], DIVIDE_ARGUMENTS),
        one(ready),
        counted(grow, &[shared, to_records], GROW_ARGUMENTS),
        one(thin),
        counted(grow, &[shared, to_records], GROW_AGAIN_ARGUMENTS),
        one(finish),
    ];
    builder.command(Command::Pass { steps });

    let from = From::CpuReference;
    let mut expected = GrowCounts {
        cut: 1.0,
        ..GrowCounts::default()
    };
    let mut draws = Vec::new();
    for (lod, list) in lists.iter().enumerate() {
        expected.records[lod] = list.len() as u32;
        expected.wanted += list.len() as u32;
        draws.push([params.vertices[lod], list.len() as u32, 0, 0]);
    }
    let fields = vec![
        Field::words(
            "records",
            core::mem::offset_of!(GrowCounts, records),
            LISTS as u64,
        ),
        Field::words("cut", core::mem::offset_of!(GrowCounts, cut), 1),
        Field::words("wanted", core::mem::offset_of!(GrowCounts, wanted), 1),
    ];
    let size = size_of::<GrowCounts>() as u64;
    builder.check(
        "counts",
        (counts, 0, size),
        fields,
        bytes_of(&expected),
        from,
    );
    let fields = vec![Field::words("draw", 0, 4)];
    let at = (arguments, DRAW_ARGUMENTS, 16);
    builder.check("draws", at, fields, cast_slice(&draws), from);
    let part = |low, bits, steps| FieldType::Part { low, bits, steps };
    for (lod, list) in lists.iter().enumerate() {
        let height = FieldType::F32 {
            ulp: ULP,
            scale: SIZE,
        };
        let fields = vec![
            Field::words("place and hash", 0, 2),
            Field::new("height", 8, 1, height),
            Field::new("entered", 12, 1, part(0, 6, 1)),
            Field::new("kind and clump", 12, 1, part(6, 8, 0)),
            Field::new("normal, x", 12, 1, part(14, 9, 1)),
            Field::new("normal, z", 12, 1, part(23, 9, 1)),
        ];
        let first = u64::from(params.bases[lod]) * RECORD_BYTES;
        let at = (kept, first, RECORD_BYTES);
        let name = format!("records of level {lod}");
        builder.check_unordered(&name, at, fields, cast_slice(list), from);
    }
    Ok(builder.finish())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_list_has_roots_and_distance_thins_them() {
        let of = |seed| records(&ground(&mut Random::new(seed)), &params(seed));
        let lists = (0..SEEDS).find_map(of);
        let counts = lists.expect("no threshold is near").map(|list| list.len());
        assert!(counts.iter().all(|&count| count > 50), "{counts:?}");
        // 4096 cells of 1/8 m on 64 m².
        assert!(counts.iter().sum::<usize>() < 3500, "{counts:?}");
    }
}
