//! Grass: a meadow drawn blade by blade over soil and dead litter.

use crate::colour::{Rgb, blend, scale, srgb, tint};
use crate::hash::{Stream, direction, pcg};
use crate::noise::{fbm, gradient, mix, smoothstep, voronoi};
use crate::surface::{Look, Surface, TILE_METRES, Texel};

/// A meadow reflects 5% to 12% of visible light, most of it green.
pub const LOOK: Look = Look {
    mean_albedo: [0.088, 0.112, 0.034],
    relief: 0.042,
    flatten_height: 0.08,
    occlusion: 0.55,
};

/// Tufts along a side of the tile (one each 7 cm).
const TUFTS: i32 = 42;
/// Blades of a full tuft.
const BLADES: u32 = 44;
/// Dead blades that lie on the soil, per tile.
const LITTER: u32 = 9000;
/// Small broad leaves (clover and the like), per tile.
const LEAVES: u32 = 1500;

/// Paints the layer.
pub fn paint(size: usize, seed: u32) -> Surface {
    let wet = srgb(0x2c_2319);
    let dry = srgb(0x5e_4d38);
    let mut surface = Surface::paint(size, |u, v| {
        let lumps = fbm(u, v, [24, 24], 4, 0.6, seed ^ 1);
        let crumb = voronoi(u, v, [150, 150], 1.0, seed ^ 2);
        let height = 0.10 * lumps + 0.05 * crumb.border;
        let albedo = blend(wet, dry, 0.45 + 0.9 * lumps + 0.3 * (crumb.border - 0.25));
        Texel {
            height,
            albedo,
            roughness: 0.95,
        }
    });
    let mut random = Stream::new(seed ^ 3);
    for _ in 0..LITTER {
        let root = [random.unit(), random.unit()];
        let lean = random.direction();
        let pale = random.unit();
        let length = random.range(0.03, 0.09);
        draw(
            &mut surface,
            &Blade {
                root,
                lean,
                bend: random.signed() * 0.5,
                length,
                width: random.range(0.0025, 0.0042),
                base: random.range(0.02, 0.12),
                rise: random.range(0.02, 0.10),
                colours: [
                    srgb(0x5a_4a2e),
                    blend(srgb(0x7d_6a40), srgb(0xa8_966a), pale),
                ],
            },
        );
    }
    leaves(&mut surface, &mut random);
    for index in 0..TUFTS * TUFTS {
        tuft(&mut surface, index, seed);
    }
    surface
}

/// One blade: a tapering ribbon from its root, rising and then drooping.
struct Blade {
    /// Tiles.
    root: [f32; 2],
    /// Unit vector of the way it leans.
    lean: [f32; 2],
    /// Sideways bend at the tip, lengths.
    bend: f32,
    /// Length seen from above, metres.
    length: f32,
    /// Width at the root, metres.
    width: f32,
    /// Height of the root.
    base: f32,
    /// Height of the highest point over the root.
    rise: f32,
    /// Linear albedo at the root and the tip.
    colours: [Rgb; 2],
}

fn tuft(surface: &mut Surface, index: i32, seed: u32) {
    let mut random = Stream::new(seed ^ pcg(index.cast_unsigned()));
    let (i, j) = ((index % TUFTS) as f32, (index / TUFTS) as f32);
    let side = TUFTS as f32;
    let centre = [
        (i + 1.3 * random.unit()) / side,
        (j + 1.3 * random.unit()) / side,
    ];
    let [u, v] = centre;
    // Vigour varies over some 30 cm: lush, short and sparse places.
    let vigour = 0.5 + 1.1 * gradient(u, v, [9, 9], seed ^ 4) + 0.35 * random.signed();
    if random.unit() < 0.05 {
        return;
    }
    let vigour = vigour.clamp(0.15, 1.0);
    let blades = (BLADES as f32 * mix(0.7, 1.0, vigour)) as u32;
    let hue = 0.5 + 0.8 * gradient(u, v, [13, 13], seed ^ 5) + 0.35 * random.signed();
    let dryness = smoothstep(0.1, 0.5, gradient(u, v, [11, 11], seed ^ 6)) * 0.22 + 0.06;
    // A common wind leans all a little the same way, differently per place.
    let wind = direction(0.5 * gradient(u, v, [6, 6], seed ^ 7));
    for _ in 0..blades {
        let spread = random.direction();
        let reach = random.unit().sqrt();
        let away = 0.034 * reach / TILE_METRES;
        let lean = [
            spread[0] * reach + 0.45 * wind[0] + 0.9 * random.signed(),
            spread[1] * reach + 0.45 * wind[1] + 0.9 * random.signed(),
        ];
        let norm = (lean[0] * lean[0] + lean[1] * lean[1]).sqrt().max(1e-3);
        let tall = random.unit();
        let colours = blade_colours(&mut random, hue.clamp(0.0, 1.0), dryness);
        draw(
            surface,
            &Blade {
                root: [u + spread[0] * away, v + spread[1] * away],
                lean: [lean[0] / norm, lean[1] / norm],
                bend: random.signed() * 0.7,
                length: mix(0.03, 0.12, tall) * mix(0.6, 1.15, vigour),
                width: mix(0.0032, 0.0068, random.unit()),
                base: 0.1 + 0.1 * vigour,
                rise: mix(0.20, 0.85, random.unit()) * mix(0.5, 1.1, vigour),
                colours,
            },
        );
    }
}

fn blade_colours(random: &mut Stream, hue: f32, dryness: f32) -> [Rgb; 2] {
    let shade = random.range(0.72, 1.28);
    if random.unit() < dryness {
        let straw = blend(srgb(0x8f_7f45), srgb(0xc2_b07a), random.unit());
        return [scale(srgb(0x4c_4a22), shade), scale(straw, shade)];
    }
    let deep = blend(srgb(0x35_5220), srgb(0x4a_5a1e), hue);
    let fresh = blend(srgb(0x55_7a2c), srgb(0x86_9138), hue);
    let warmth = random.signed();
    let fresh = tint(fresh, [1.0 + 0.22 * warmth, 1.0, 1.0 - 0.15 * warmth]);
    let mut tip = fresh;
    if random.unit() < 0.18 {
        // Last year's growth: the tip has turned yellow.
        tip = blend(fresh, srgb(0xa8_9a52), 0.7);
    }
    [scale(deep, 0.55 * shade), scale(tip, shade)]
}

/// Draws a blade at a step of half a texel along and across.
fn draw(surface: &mut Surface, blade: &Blade) {
    let n = surface.size() as f32;
    let length = blade.length / TILE_METRES;
    let half_width = 0.5 * blade.width / TILE_METRES;
    let side = [-blade.lean[1], blade.lean[0]];
    let steps = (length * n * 2.0).ceil().max(2.0);
    for step in 0..=steps as u32 {
        let t = step as f32 / steps;
        let sideways = blade.bend * t * t;
        // The drooping end covers less ground per length of blade.
        let along = t * (1.0 - 0.15 * t * t);
        let centre = [
            blade.root[0] + length * (blade.lean[0] * along + side[0] * sideways),
            blade.root[1] + length * (blade.lean[1] * along + side[1] * sideways),
        ];
        let half = half_width * (1.0 - t * t) * mix(0.75, 1.0, (4.0 * t).min(1.0));
        // Highest at 0.7 of the length.
        let height = blade.base + blade.rise * t * (2.0 - t / 0.7) / 0.7;
        let colour = blend(blade.colours[0], blade.colours[1], (1.35 * t).min(1.0));
        let across = (half * n * 2.0).floor().max(0.0) as i32;
        for k in -across..=across {
            let s = if across == 0 {
                0.0
            } else {
                k as f32 / across as f32
            };
            let offset = s * half;
            // Folded along its midrib: one half of the blade shows lighter.
            let fold = 1.0 + 0.13 * s - if k == 0 { 0.10 } else { 0.0 };
            surface.stamp(
                centre[0] + side[0] * offset,
                centre[1] + side[1] * offset,
                Texel {
                    height: height - 0.03 * s.abs(),
                    albedo: scale(colour, fold),
                    roughness: mix(0.82, 0.58, t),
                },
            );
        }
    }
}

/// Scatters rosettes of three round leaflets.
fn leaves(surface: &mut Surface, random: &mut Stream) {
    for _ in 0..LEAVES {
        let centre = [random.unit(), random.unit()];
        let height = random.range(0.18, 0.42);
        let radius = random.range(0.0045, 0.009) / TILE_METRES;
        let turn = random.unit();
        let colour = scale(
            blend(srgb(0x3c_6128), srgb(0x6b_8c3e), random.unit()),
            random.range(0.8, 1.15),
        );
        for leaflet in 0..3_u8 {
            let d = direction(turn + f32::from(leaflet) / 3.0);
            let middle = [centre[0] + d[0] * radius, centre[1] + d[1] * radius];
            surface.stamp_disc(middle, radius, |du, dv| {
                let (x, y) = (du / radius, dv / radius);
                let r = x * x + y * y;
                let rib = (x * d[1] - y * d[0]).abs();
                (r < 1.0).then(|| Texel {
                    height: height + 0.05 * (1.0 - r) + 0.03 * rib,
                    albedo: scale(colour, if rib < 0.12 { 0.8 } else { 0.92 + 0.12 * r }),
                    roughness: 0.62,
                })
            });
        }
    }
}
