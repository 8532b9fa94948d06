//! The definition of `noiz` 0.5's layered Perlin noise, in f64.
//!
//! Written from its documentation and its public parts: the hash ([`NoiseRng`]), the gradient table
//! ([`QuickGradients`]), cubic fade 3t² − 2t³, corners' dot products scaled by √2, and a sum over
//! octaves divided by the sum of its weights. The gradient is the derivative of that.

use super::method::{Exact, GAIN, LACUNARITY, WAVELENGTH, weight_sum};
use bevy::math::{DVec2, IVec2, Vec2};
use noiz::cell_noise::{GradientGenerator, QuickGradients};
use noiz::rng::NoiseRng;

/// Value in units of the whole sum, and gradient per metre, at `at` metres.
pub fn fbm(octaves: u32, seed: u32, at: DVec2) -> Exact {
    let mut rng = NoiseRng(seed);
    let mut frequency = 1.0 / WAVELENGTH;
    let mut weight = 1.0 / weight_sum(octaves);
    let (mut value, mut gradient) = (0.0, DVec2::ZERO);
    for _ in 0..octaves {
        let (v, g) = perlin(rng, at * frequency);
        value += weight * v;
        gradient += weight * frequency * g;
        rng.re_seed();
        frequency *= LACUNARITY;
        weight *= GAIN;
    }
    Exact {
        value,
        gradient: Some(gradient),
    }
}

/// One octave: value, and gradient by the position in cells.
fn perlin(rng: NoiseRng, at: DVec2) -> (f64, DVec2) {
    let floor = at.floor();
    let t = at - floor;
    let corner = |x: i32, y: i32| {
        let cell = floor.as_ivec2().wrapping_add(IVec2::new(x, y));
        let slope: Vec2 = QuickGradients.get_gradient(rng.rand_u32(cell));
        let slope = slope.as_dvec2() * std::f64::consts::SQRT_2;
        (slope.dot(t - DVec2::new(f64::from(x), f64::from(y))), slope)
    };
    let fade = t * t * (3.0 - 2.0 * t);
    let fade_slope = 6.0 * t * (1.0 - t);
    let ((a, ga), (b, gb)) = (corner(0, 0), corner(1, 0));
    let ((c, gc), (d, gd)) = (corner(0, 1), corner(1, 1));
    let low = a + fade.x * (b - a);
    let high = c + fade.x * (d - c);
    let value = low + fade.y * (high - low);
    let of_corners = ga.lerp(gb, fade.x).lerp(gc.lerp(gd, fade.x), fade.y);
    let of_fades = DVec2::new(
        fade_slope.x * ((b - a) + fade.y * ((d - c) - (b - a))),
        fade_slope.y * (high - low),
    );
    (value, of_corners + of_fades)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gradient_is_the_derivative_of_the_value() {
        for at in [DVec2::new(3.3, -700.2), DVec2::new(-1e6 + 0.4, 12.9)] {
            let gradient = fbm(8, 7, at).gradient.unwrap();
            // Central difference over 2h: error h²/6 of the third derivative (some 1e1 / m³ here, at
            // a finest wavelength of 2 m) and 1e-16/h of rounding.
            let h = 1e-4;
            let slope =
                |step: DVec2| (fbm(8, 7, at + step).value - fbm(8, 7, at - step).value) / (2.0 * h);
            let difference = DVec2::new(slope(DVec2::new(h, 0.0)), slope(DVec2::new(0.0, h)));
            assert!(
                (difference - gradient).length() < 1e-6,
                "{difference} {gradient}"
            );
        }
    }
}
