//! Snow: soft wind drifts, a thin crust with ripples, grain and sparkle.

use crate::colour::{blend, scale};
use crate::hash::{hash_cell, pcg, unit};
use crate::noise::{fbm, gradient, mix, smoothstep};
use crate::surface::{Look, Surface, Texel};
use crate::wave::{Phasor, phasor};

/// Settled snow reflects 80% to 90%, the least of the red.
pub const LOOK: Look = Look {
    mean_albedo: [0.832, 0.856, 0.886],
    relief: 0.060,
    flatten_height: 0.065,
    occlusion: 0.25,
};

/// Paints the layer.
pub fn paint(size: usize, seed: u32) -> Surface {
    let wind = Phasor {
        waves: [4, 19],
        kernels: 7,
        disorder: 0.22,
        seed: pcg(seed),
    };
    let n = size as f32;
    // Reflectances relative to each other; the mean is set afterwards.
    let lit = [0.860, 0.872, 0.885];
    let hollow = [0.730, 0.800, 0.880];
    Surface::paint(size, |u, v| {
        let wu = 0.05 * fbm(u, v, [4, 4], 3, 0.5, seed ^ 1);
        let wv = 0.05 * fbm(u, v, [4, 4], 3, 0.5, seed ^ 2);
        // Drifts lie across the wind, which blows along v.
        let drift = fbm(u + wu, v + wv, [5, 7], 3, 0.36, seed ^ 3);
        let [c, s, coherence] = phasor(u + 0.3 * wu, v + 0.3 * wv, &wind);
        let lean = c + 0.30 * (2.0 * s * c);
        let presence = mix(
            0.0,
            1.0,
            smoothstep(-0.2, 0.3, gradient(u, v, [6, 6], seed ^ 4)),
        );
        let ripple = lean * presence * smoothstep(0.15, 0.7, coherence);
        let soft = fbm(u, v, [22, 26], 2, 0.5, seed ^ 5);
        let grit = fbm(u, v, [130, 130], 2, 0.7, seed ^ 7);
        let (x, y) = ((u * n) as u32, (v * n) as u32);
        let grain = unit(hash_cell(x, y, seed ^ 8)) - 0.5;

        let height = 0.9 * drift + 0.026 * ripple + 0.07 * soft + 0.016 * grit + 0.006 * grain;
        // Light is scattered through hollows, which takes out the red.
        let shade = 0.50 - 1.6 * drift - 0.10 * ripple - 0.5 * soft;
        let mut albedo = blend(lit, hollow, shade.clamp(0.0, 1.0) * 0.8);
        albedo = scale(albedo, 1.0 + 0.06 * grain + 0.06 * grit);
        // A crystal that faces the eye: bright and smooth.
        let glint = unit(hash_cell(x / 2, y / 2, seed ^ 9));
        let mut roughness = mix(0.62, 0.78, 0.5 + grit);
        if glint > 0.985 {
            albedo = [0.97; 3];
            roughness = 0.30;
        }
        Texel {
            height,
            albedo,
            roughness,
        }
    })
}
