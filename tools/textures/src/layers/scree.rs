//! Scree: angular stones of all sizes over gravel and soil.

use crate::colour::{Rgb, blend, scale, srgb, tint};
use crate::hash::{Stream, direction, hash_cell, pcg, unit};
use crate::noise::{fbm, mix, voronoi};
use crate::surface::{Look, Surface, TILE_METRES, Texel};

/// Broken grey stone with soil between: 12% to 20%.
pub const LOOK: Look = Look {
    mean_albedo: [0.176, 0.158, 0.134],
    relief: 0.10,
    flatten_height: 0.09,
    occlusion: 0.45,
};

/// Stones by size: how many per tile, and radii in metres.
const STONES: [(u32, f32, f32); 4] = [
    (5200, 0.010, 0.018),
    (1500, 0.018, 0.036),
    (330, 0.036, 0.065),
    (60, 0.065, 0.110),
];
/// Height of one metre in the units the layer is painted in.
const PER_METRE: f32 = 10.0;

/// Paints the layer.
pub fn paint(size: usize, seed: u32) -> Surface {
    let soil = srgb(0x4a_3f33);
    let dust = srgb(0x7f_7362);
    let n = size as f32;
    let mut surface = Surface::paint(size, |u, v| {
        let lumps = fbm(u, v, [12, 12], 5, 0.6, seed ^ 1);
        let coarse = voronoi(u, v, [95, 95], 1.0, seed ^ 2);
        let fine = voronoi(u, v, [210, 210], 1.0, seed ^ 3);
        // Gravel sits in the soil where its hash says so.
        let stony = unit(pcg(coarse.id)) < 0.55;
        let round = (coarse.border * 2.6).min(1.0);
        let gravel = if stony { round } else { 0.0 };
        let grit = (fine.border * 2.4).min(1.0);
        let height = 0.10 * lumps + 0.085 * gravel + 0.03 * grit;
        let mut albedo = blend(soil, dust, 0.40 + 0.8 * lumps + 0.2 * (grit - 0.5));
        albedo = scale(albedo, 0.8 + 0.5 * unit(pcg(fine.id)) * grit);
        if stony && coarse.border > 0.06 {
            let tone = unit(pcg(coarse.id ^ 9));
            albedo = blend(albedo, stone_colour(tone, unit(pcg(coarse.id ^ 8))), 0.8);
        }
        let speck = unit(hash_cell((u * n) as u32, (v * n) as u32, seed ^ 4)) - 0.5;
        Texel {
            height,
            albedo: scale(albedo, 1.0 + 0.2 * speck),
            roughness: 0.94,
        }
    });

    let mut random = Stream::new(seed ^ 5);
    let mut placed: Vec<[f32; 3]> = Vec::new();
    // The large ones are placed first and kept apart, and drawn last.
    let mut stones = Vec::new();
    for &(count, low, high) in STONES.iter().rev() {
        for _ in 0..count {
            let t = random.unit();
            let radius = mix(low, high, t * t) / TILE_METRES;
            if let Some(centre) = place(&mut random, radius, &mut placed) {
                stones.push(Stone::new(centre, radius, &mut random));
            }
        }
    }
    for stone in stones.iter().rev() {
        stone.draw(&mut surface, seed);
    }
    surface
}

/// A place that overlaps no stone by more than a third of its radius, if one
/// of a few throws finds it.
fn place(random: &mut Stream, radius: f32, placed: &mut Vec<[f32; 3]>) -> Option<[f32; 2]> {
    let wrapped = |d: f32| d - (d + 0.5).floor();
    for _ in 0..6 {
        let centre = [random.unit(), random.unit()];
        let free = placed.iter().all(|other| {
            let (du, dv) = (wrapped(other[0] - centre[0]), wrapped(other[1] - centre[1]));
            let apart = 0.72 * (other[2] + radius);
            du * du + dv * dv > apart * apart
        });
        if free {
            placed.push([centre[0], centre[1], radius]);
            return Some(centre);
        }
    }
    None
}

fn stone_colour(tone: f32, hue: f32) -> Rgb {
    let grey = blend(srgb(0x5d_5a55), srgb(0x9c_968a), tone);
    if hue < 0.16 {
        blend(grey, srgb(0x8a_6a4c), 0.5)
    } else if hue > 0.9 {
        blend(grey, srgb(0xc2_bcae), 0.55)
    } else {
        tint(
            grey,
            [1.0 + 0.10 * (hue - 0.5), 1.0, 1.0 - 0.12 * (hue - 0.5)],
        )
    }
}

/// A stone: the half-spaces it is the common part of, seen from above.
struct Stone {
    /// Tiles.
    centre: [f32; 2],
    /// Tiles.
    radius: f32,
    /// Planes as height = offset + slopes . position (in radii).
    planes: Vec<[f32; 3]>,
    colour: Rgb,
    id: u32,
}

impl Stone {
    fn new(centre: [f32; 2], radius: f32, random: &mut Stream) -> Self {
        // Flat stones lie on their broad side: a top, tilted, and a chamfer.
        let mut planes = Vec::new();
        let thick = random.range(0.45, 0.80);
        planes.push([thick, 0.30 * random.signed(), 0.30 * random.signed()]);
        planes.push([thick * 1.04, 0.75 * random.signed(), 0.75 * random.signed()]);
        let sides = 5 + (random.unit() * 3.0) as u32;
        let start = random.unit();
        let axis = random.direction();
        let squash = random.range(0.62, 1.0);
        for side in 0..sides {
            let turn = start + (side as f32 + 0.7 * (random.unit() - 0.5)) / sides as f32;
            let d = direction(turn);
            // How far out the side stands: less across the long axis.
            let along = (d[0] * axis[0] + d[1] * axis[1]).abs();
            let out = random.range(0.62, 0.92) * mix(squash, 1.0, along);
            let steep = random.range(1.1, 3.2);
            planes.push([out * steep, -d[0] * steep, -d[1] * steep]);
        }
        let colour = scale(
            stone_colour(random.unit(), random.unit()),
            random.range(0.8, 1.2),
        );
        Self {
            centre,
            radius,
            planes,
            colour,
            id: random.bits(),
        }
    }

    fn draw(&self, surface: &mut Surface, seed: u32) {
        let size = self.radius * TILE_METRES * PER_METRE;
        let [u0, v0] = self.centre;
        let ground = surface.at(u0, v0).height.min(0.2) - 0.10 * size;
        let r = self.radius;
        let n = surface.size() as f32;
        surface.stamp_disc(self.centre, 1.1 * r, |du, dv| {
            let (x, y) = (du / r, dv / r);
            let (u, v) = (u0 + du, v0 + dv);
            // The breaks are uneven, in proportion to the stone.
            let id = self.id;
            let waves = ((0.9 / r) as i32).clamp(2, 200);
            let uneven = fbm(u, v, [waves, waves], 4, 0.6, id & 7);
            let (x, y) = (x + 0.14 * uneven, y + 0.10 * uneven);
            let (mut height, mut face, mut next) = (f32::MAX, 0, f32::MAX);
            for (k, plane) in self.planes.iter().enumerate() {
                let h = plane[0] + plane[1] * x + plane[2] * y;
                if h < height {
                    (next, height, face) = (height, h, k);
                } else if h < next {
                    next = h;
                }
            }
            if height <= 0.0 {
                return None;
            }
            let tone = unit(pcg(id ^ face as u32)) - 0.5;
            // Edges are knocked pale; the foot is stained by the soil.
            let edge = 1.0 - ((next - height) * 9.0).min(1.0);
            let foot = (height * 3.5).min(1.0);
            let speck = unit(hash_cell(
                ((u + 1.0) * n) as u32,
                ((v + 1.0) * n) as u32,
                seed,
            )) - 0.5;
            let shade = 1.0 + 0.16 * tone + 0.14 * edge + 0.40 * uneven + 0.18 * speck;
            let stain = blend(srgb(0x4a_3f33), self.colour, 0.55 + 0.45 * foot);
            Some(Texel {
                height: ground + size * (height + 0.07 * uneven),
                albedo: scale(stain, shade),
                roughness: (0.82 - 0.08 * edge + 0.15 * uneven).clamp(0.0, 1.0),
            })
        });
    }
}
