//! Rock: bedded dolomite broken into blocks, with cracks, chipped facets,
//! weathering and lichens.

use crate::colour::{blend, scale, srgb};
use crate::hash::{hash_cell, pcg, unit};
use crate::noise::{Cell, fbm, gradient, mix, ridged, smoothstep, voronoi};
use crate::surface::{Look, Surface, Texel};

/// Weathered dolomite: 15% to 25%, a warm grey.
pub const LOOK: Look = Look {
    mean_albedo: [0.204, 0.193, 0.176],
    relief: 0.26,
    flatten_height: 0.06,
    occlusion: 0.35,
};

/// Bedding steps over the whole range of the bulk relief.
const STEPS: f32 = 8.0;

/// Paints the layer.
pub fn paint(size: usize, seed: u32) -> Surface {
    let base = srgb(0x8b_867c);
    let pale = srgb(0xb1_a998);
    let rust = srgb(0x8c_7256);
    let dark = srgb(0x45_423e);
    let n = size as f32;
    Surface::paint(size, |u, v| {
        // Everything is bent by the same field, so that cracks follow blocks.
        let wu = 0.022 * fbm(u, v, [5, 5], 5, 0.6, seed ^ 1);
        let wv = 0.022 * fbm(u, v, [5, 5], 5, 0.6, seed ^ 2);
        let (x, y) = (u + wu, v + wv);
        let rough = fbm(u, v, [28, 28], 5, 0.65, seed ^ 7);
        let pits = ridged(u, v, [46, 46], 3, 0.6, seed ^ 8);

        // Blocks broken along planes of their own, and chips off them.
        let blocks = voronoi(x, y, [5, 8], 1.0, seed ^ 4);
        let chips = voronoi(x + 0.5 * wu, y, [12, 19], 1.0, seed ^ 5);
        let flakes = voronoi(x, y - 0.5 * wv, [36, 50], 1.0, seed ^ 6);
        let broken = smoothstep(-0.25, 0.35, gradient(x, y, [6, 6], seed ^ 9));
        let bulk = fbm(x, y, [4, 7], 3, 0.5, seed ^ 3);
        let fracture = facet(&blocks, 0.28, 0.48)
            + mix(0.35, 1.0, broken) * facet(&chips, 0.13, 0.42)
            + mix(0.25, 1.0, broken) * facet(&flakes, 0.055, 0.13);

        // Bedding: the bulk is worn down to one bed after another.
        let step = (bulk + 0.20 * fracture + 0.09 * rough) * STEPS;
        let bed = step.floor();
        let rise = step - bed;
        let worn = bed + smoothstep(0.70, 1.0, rise);
        let ledge = mix(bulk, worn / STEPS, 0.60);
        let bed_id = pcg(seed ^ (bed as i32).cast_unsigned());

        let joints = joint(x, y, [5, 2], seed ^ 10).max(joint(x, y, [-2, 5], seed ^ 11));
        let hair = hairline(x, y, seed ^ 12);
        let pair = unit(pcg(blocks.id ^ blocks.neighbour));
        let gap = if pair < 0.20 {
            crack(blocks.border, 0.03, rough)
        } else {
            0.0
        };
        let deep = joints.max(gap).max(0.45 * hair);

        let height = ledge + 0.8 * fracture + 0.11 * rough + 0.02 * pits
            - 0.16 * joints.max(gap)
            - 0.035 * hair;

        // Colour: every block and bed has its own tone; iron stains in places.
        let tone = unit(pcg(blocks.id ^ 21));
        let chip_tone = unit(pcg(chips.id ^ 22)) - 0.5;
        let flake_tone = unit(pcg(flakes.id ^ 24)) - 0.5;
        let bed_tone = unit(bed_id) - 0.5;
        let mut albedo = blend(base, pale, 0.35 + 0.7 * (tone - 0.5) + 0.8 * bed_tone);
        albedo = scale(albedo, 1.0 + 0.34 * chip_tone + 0.20 * flake_tone);
        albedo = scale(albedo, 1.0 + 0.55 * rough + 0.10 * pits);
        let stain = smoothstep(0.02, 0.40, fbm(x, y, [8, 12], 5, 0.65, seed ^ 13));
        albedo = blend(albedo, rust, 0.40 * stain);
        // Worn edges of beds are pale, the foot of the next one is dirty.
        let edge = smoothstep(0.55, 0.66, rise) * (1.0 - smoothstep(0.70, 0.95, rise));
        let foot = 1.0 - smoothstep(0.0, 0.16, rise);
        albedo = scale(albedo, 1.0 + 0.16 * edge - 0.20 * foot);
        albedo = blend(albedo, dark, 0.70 * deep);
        let speck = unit(hash_cell((u * n) as u32, (v * n) as u32, seed ^ 14)) - 0.5;
        albedo = scale(albedo, 1.0 + 0.22 * speck);

        let (albedo, growth) = lichens(u, v, albedo, 1.0 - deep, seed ^ 15);
        Texel {
            height: height + 0.006 * growth + 0.006 * speck,
            albedo,
            roughness: (0.80 + 0.15 * rough + 0.06 * growth + 0.10 * deep).clamp(0.0, 1.0),
        }
    })
}

/// Height of a cell broken along a plane of its own: an offset up to
/// `step`/2 and a tilt up to `tilt` over one cell.
fn facet(cell: &Cell, step: f32, tilt: f32) -> f32 {
    let signed = |salt: u32| unit(pcg(cell.id ^ salt)) * 2.0 - 1.0;
    let plane = signed(1) * cell.offset[0] + signed(2) * cell.offset[1];
    0.5 * step * signed(3) + tilt * plane
}

/// 1 in the middle of a crack, 0 from `width` off; `open` (about -0.5..0.5)
/// widens it and closes it.
fn crack(distance: f32, width: f32, open: f32) -> f32 {
    // A crack that closes grows shallow before it grows thinner than texels.
    let open = (0.35 + 1.5 * open).clamp(0.0, 1.2);
    let width = width * open.max(0.4);
    open.min(1.0) * (1.0 - smoothstep(0.2 * width, width, distance))
}

/// A set of nearly parallel joints: lines across the direction `normal`
/// (lines per tile along u and v), of which stretches are open.
fn joint(x: f32, y: f32, normal: [i32; 2], seed: u32) -> f32 {
    let lines = normal[0] as f32 * x + normal[1] as f32 * y + 0.35 * gradient(x, y, [5, 5], seed);
    let distance = (lines - (lines + 0.5).floor()).abs();
    let open = smoothstep(0.08, 0.45, gradient(x, y, [4, 4], seed ^ 1));
    crack(distance, 0.030, open * 0.6 - 0.25)
}

/// Thin cracks that run free of the blocks: zero lines of a noise.
fn hairline(x: f32, y: f32, seed: u32) -> f32 {
    let line = fbm(x, y, [7, 6], 4, 0.5, seed).abs();
    let present = smoothstep(0.05, 0.3, gradient(x, y, [6, 6], seed ^ 1));
    present * (1.0 - smoothstep(0.003, 0.012, line))
}

/// Crusts of lichen: round patches with ragged rims, in three kinds. Gives
/// the colour and how much lichen there is (0..=1).
fn lichens(u: f32, v: f32, albedo: [f32; 3], bare: f32, seed: u32) -> ([f32; 3], f32) {
    let kinds = [
        (srgb(0xa9_ab98), [11, 11], 0.55, 0.55),
        (srgb(0x96_8648), [19, 19], 0.16, 0.45),
        (srgb(0x4c_4b46), [23, 23], 0.42, 0.50),
    ];
    let ragged = 0.55 * fbm(u, v, [36, 36], 4, 0.7, seed);
    let place = gradient(u, v, [5, 5], seed ^ 1);
    let (mut colour, mut most) = (albedo, 0.0_f32);
    for (k, (kind, period, share, strength)) in kinds.into_iter().enumerate() {
        let cell = voronoi(u, v, period, 0.9, seed ^ (100 + k as u32));
        if unit(pcg(cell.id ^ 5)) > share + 0.5 * place {
            continue;
        }
        let radius = mix(0.10, 0.42, unit(pcg(cell.id ^ 6)));
        let r = (cell.offset[0] * cell.offset[0] + cell.offset[1] * cell.offset[1]).sqrt();
        let cover = bare * (1.0 - smoothstep(0.7 * radius, radius, r + 2.2 * ragged * radius));
        // Crusts are palest at their growing rim, cracked within.
        let inner = 0.85 + 0.3 * (r / radius) + 0.5 * ragged;
        let crust = scale(kind, inner);
        colour = blend(colour, crust, strength * cover);
        most = most.max(cover);
    }
    (colour, most)
}
