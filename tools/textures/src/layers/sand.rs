//! Sand: mixed grains, faint wind ripples, a few small shells and pebbles.

use crate::colour::{blend, scale, srgb, tint};
use crate::hash::{Stream, hash_cell, pcg, unit};
use crate::noise::{fbm, gradient, mix, smoothstep, voronoi};
use crate::surface::{Look, Surface, TILE_METRES, Texel};
use crate::wave::{Phasor, phasor};

/// Dry quartz sand reflects 0.3 to 0.4 of visible light, more of the red.
pub const LOOK: Look = Look {
    mean_albedo: [0.400, 0.316, 0.212],
    relief: 0.018,
    flatten_height: 0.06,
    occlusion: 0.15,
};

/// Ripples per tile: one each 9 cm or so, crests a little off the u axis.
const RIPPLES: [i32; 2] = [6, 31];
/// Lattice of the visible coarse grains, per tile (one each 12 mm).
const GRAINS: i32 = 250;
/// Pebbles and shell fragments per tile.
const PEBBLES: u32 = 150;

/// Paints the layer.
pub fn paint(size: usize, seed: u32) -> Surface {
    let wind = Phasor {
        waves: RIPPLES,
        kernels: 9,
        disorder: 0.31,
        seed: pcg(seed),
    };
    let pale = srgb(0xd9_c5a0);
    let warm = srgb(0xc2_9f70);
    let dark = srgb(0x6b_5a48);
    let n = size as f32;

    let mut surface = Surface::paint(size, |u, v| {
        // The wind's waves wander more than their kernels: bend the plane.
        let bend = 0.016 * fbm(u, v, [5, 5], 2, 0.5, seed ^ 1);
        let [c, s, coherence] = phasor(u + bend, v + bend, &wind);
        // The second harmonic leans the wave: long windward, short lee side.
        let wave = c + 0.30 * (2.0 * s * c);
        // Ripples fade in and out over a few crests.
        let presence = mix(
            0.50,
            1.0,
            smoothstep(-0.35, 0.35, gradient(u, v, [9, 9], seed ^ 2)),
        );
        let ripple = wave * presence * mix(0.35, 1.0, smoothstep(0.1, 0.6, coherence));

        let clump = fbm(u, v, [40, 40], 3, 0.6, seed ^ 3);
        let grit = fbm(u, v, [190, 190], 2, 0.7, seed ^ 4);
        let (x, y) = ((u * n) as u32, (v * n) as u32);
        let grain = unit(hash_cell(x, y, seed ^ 5)) - 0.5;
        let cell = voronoi(u, v, [GRAINS, GRAINS], 1.0, seed ^ 6);
        let kind = unit(pcg(cell.id));

        let height =
            0.34 * ripple + 0.26 * clump + 0.36 * grit + 0.14 * grain + 0.10 * (cell.border - 0.25);

        // Heavy dark minerals gather in the troughs, pale quartz on the crests.
        let mut albedo = blend(warm, pale, 0.5 + 0.12 * ripple + 0.5 * clump);
        albedo = scale(albedo, 1.0 + 0.34 * grain + 0.30 * grit);
        if kind < 0.07 {
            albedo = blend(albedo, dark, 0.55);
        } else if kind > 0.90 {
            albedo = scale(tint(albedo, [1.0, 1.02, 1.08]), 1.22);
        } else {
            let hue = unit(pcg(cell.id ^ 0x77)) - 0.5;
            albedo = tint(albedo, [1.0 + 0.10 * hue, 1.0, 1.0 - 0.14 * hue]);
        }
        // Single glints and specks, smaller than the coarse grains.
        let speck = unit(hash_cell(x, y, seed ^ 7));
        if speck < 0.025 {
            albedo = scale(albedo, 0.55);
        }
        Texel {
            height,
            albedo,
            roughness: 0.90 - 0.05 * grit - 0.06 * grain,
        }
    });

    let mut random = Stream::new(seed ^ 8);
    for _ in 0..PEBBLES {
        pebble(&mut surface, &mut random);
    }
    surface
}

/// A rounded pebble or a shell fragment of 4 to 14 mm, half buried.
fn pebble(surface: &mut Surface, random: &mut Stream) {
    let centre = [random.unit(), random.unit()];
    let size = random.unit();
    let radius = mix(0.002, 0.007, size * size) / TILE_METRES;
    let axis = random.direction();
    let squash = random.range(0.55, 0.95);
    let shell = random.unit() < 0.3;
    let colour = if shell {
        srgb(0xe8_ddca)
    } else {
        blend(srgb(0x8a_7a66), srgb(0xb8_a78e), random.unit())
    };
    let ground = surface.at(centre[0], centre[1]).height;
    surface.stamp_disc(centre, radius, |du, dv| {
        let along = (du * axis[0] + dv * axis[1]) / radius;
        let across = (dv * axis[0] - du * axis[1]) / (radius * squash);
        let r = along * along + across * across;
        (r < 1.0).then(|| Texel {
            height: ground - 0.1 + 0.6 * (1.0 - r).sqrt(),
            albedo: scale(colour, 0.85 + 0.15 * (1.0 - r)),
            roughness: if shell { 0.55 } else { 0.75 },
        })
    });
}
