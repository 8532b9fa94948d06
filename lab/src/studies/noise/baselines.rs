//! Other libraries, each called as its documentation says, in a loop over points in its own format.

use super::method::{Exact, GAIN, LACUNARITY, Method, Output, WAVELENGTH, weight_sum};
use super::noiz_definition;
use super::points::Points;
use bevy::math::{DVec2, Vec2};
use noise::{MultiFractal, NoiseFn};
use noise_functions::modifiers::{Fbm, Frequency, Seeded};
use noise_functions::{Constant, Noise as _};
use noiz::cells::WithGradient;
use noiz::layering::{FractalLayers, LayeredNoise, Normed, Octave, Persistence};
use noiz::prelude::common_noise;
use noiz::{SampleableFor, ScalableNoise, SeedableNoise};

/// `noise` 0.9, `Fbm<Perlin>`: f64, a permutation of 256 entries an octave, values only.
pub struct Noise09 {
    fbm: noise::Fbm<noise::Perlin>,
    octaves: u32,
}

impl Noise09 {
    /// With its frequency, gain and lacunarity set to the study's.
    pub fn new(octaves: u32, seed: u32) -> Self {
        let fbm = noise::Fbm::new(seed)
            .set_octaves(octaves as usize)
            .set_frequency(1.0 / WAVELENGTH)
            .set_lacunarity(LACUNARITY)
            .set_persistence(GAIN);
        Self { fbm, octaves }
    }
}

impl Method for Noise09 {
    fn name(&self) -> &'static str {
        "noise 0.9 (f64)"
    }

    fn bytes(&self) -> usize {
        // 256 bytes of permutation and a seed for each octave.
        self.octaves as usize * size_of::<noise::Perlin>() + size_of_val(&self.fbm)
    }

    fn amplitude(&self) -> f64 {
        1.0 / weight_sum(self.octaves)
    }

    fn is_f64(&self) -> bool {
        true
    }

    fn evaluate(&mut self, points: &Points, _with_gradient: bool, out: &mut Output) {
        for (p, value) in points.exact.iter().zip(&mut out.values_f64) {
            *value = self.fbm.get([p.x, p.y]);
        }
    }
}

type NoizValue = noiz::Noise<common_noise::Fbm<common_noise::Perlin>>;
type NoizGradient = noiz::Noise<
    LayeredNoise<
        Normed<WithGradient<f32, Vec2>>,
        Persistence,
        FractalLayers<Octave<common_noise::PerlinWithDerivative>>,
    >,
>;

/// `noiz` 0.5, layered Perlin noise as in its own benchmark: f32, hashed, with analytic gradients.
pub struct Noiz05 {
    value: NoizValue,
    gradient: NoizGradient,
    octaves: u32,
    seed: u32,
}

impl Noiz05 {
    /// With its frequency, persistence and lacunarity set to the study's.
    pub fn new(octaves: u32, seed: u32) -> Self {
        let persistence = Persistence(GAIN as f32);
        let mut value = NoizValue::from(LayeredNoise::new(
            Normed::default(),
            persistence,
            FractalLayers {
                layer: Default::default(),
                lacunarity: LACUNARITY as f32,
                amount: octaves,
            },
        ));
        value.set_frequency((1.0 / WAVELENGTH) as f32);
        value.set_seed(seed);
        let mut gradient = NoizGradient::from(LayeredNoise::new(
            Normed::default(),
            persistence,
            FractalLayers {
                layer: Default::default(),
                lacunarity: LACUNARITY as f32,
                amount: octaves,
            },
        ));
        gradient.set_frequency((1.0 / WAVELENGTH) as f32);
        gradient.set_seed(seed);
        Self {
            value,
            gradient,
            octaves,
            seed,
        }
    }
}

impl Method for Noiz05 {
    fn name(&self) -> &'static str {
        "noiz 0.5 (f32)"
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.value)
    }

    fn amplitude(&self) -> f64 {
        1.0 / weight_sum(self.octaves)
    }

    fn has_gradient(&self) -> bool {
        true
    }

    fn evaluate(&mut self, points: &Points, with_gradient: bool, out: &mut Output) {
        if !with_gradient {
            for (p, value) in points.rounded.iter().zip(&mut out.values) {
                *value = self.value.sample(*p);
            }
            return;
        }
        // Its gradient is by the scaled position, so the frequency goes in as a last factor.
        let per_metre = (1.0 / WAVELENGTH) as f32;
        let outputs = out.values.iter_mut().zip(&mut out.dx).zip(&mut out.dz);
        for (p, ((value, dx), dz)) in points.rounded.iter().zip(outputs) {
            let both: WithGradient<f32, Vec2> = self.gradient.sample(*p);
            *value = both.value;
            *dx = both.gradient.x * per_metre;
            *dz = both.gradient.y * per_metre;
        }
    }

    fn definition(&self, at: DVec2) -> Option<Exact> {
        Some(noiz_definition::fbm(self.octaves, self.seed, at))
    }
}

fn fastnoise(octaves: u32, seed: u32) -> fastnoise_lite::FastNoiseLite {
    let mut noise = fastnoise_lite::FastNoiseLite::with_seed(seed as i32);
    noise.set_noise_type(Some(fastnoise_lite::NoiseType::Perlin));
    noise.set_fractal_type(Some(fastnoise_lite::FractalType::FBm));
    noise.set_fractal_octaves(Some(octaves as i32));
    noise.set_fractal_gain(Some(GAIN as f32));
    noise.set_fractal_lacunarity(Some(LACUNARITY as f32));
    noise.set_frequency(Some((1.0 / WAVELENGTH) as f32));
    noise
}

/// `fastnoise-lite` 1.1 with its `f64` feature: positions in f64, the rest in f32, values only.
pub struct FastNoiseLite11 {
    noise: fastnoise_lite::FastNoiseLite,
    octaves: u32,
}

impl FastNoiseLite11 {
    /// With its frequency, gain and lacunarity set to the study's.
    pub fn new(octaves: u32, seed: u32) -> Self {
        Self {
            noise: fastnoise(octaves, seed),
            octaves,
        }
    }
}

impl Method for FastNoiseLite11 {
    fn name(&self) -> &'static str {
        "fastnoise-lite 1.1 (f64 positions)"
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.noise)
    }

    fn amplitude(&self) -> f64 {
        1.0 / weight_sum(self.octaves)
    }

    fn evaluate(&mut self, points: &Points, _with_gradient: bool, out: &mut Output) {
        for (p, value) in points.exact.iter().zip(&mut out.values) {
            *value = self.noise.get_noise_2d(p.x, p.y);
        }
    }
}

/// `noise-functions` 0.8, `Perlin.fbm`: f32, hashed, values only.
///
/// Its Perlin noise is FastNoise Lite's, so the same noise with f64 positions serves as its
/// definition (exact but for the f32 arithmetic within a cell, some 2e-7 of the amplitude).
pub struct NoiseFunctions08 {
    noise: Seeded<Frequency<Fbm<noise_functions::Perlin>, Constant>>,
    same_with_f64_positions: fastnoise_lite::FastNoiseLite,
    octaves: u32,
}

impl NoiseFunctions08 {
    /// With its frequency, gain and lacunarity set to the study's.
    pub fn new(octaves: u32, seed: u32) -> Self {
        let fbm = noise_functions::Perlin.fbm(octaves, GAIN as f32, LACUNARITY as f32);
        Self {
            noise: fbm.frequency((1.0 / WAVELENGTH) as f32).seed(seed as i32),
            same_with_f64_positions: fastnoise(octaves, seed),
            octaves,
        }
    }
}

impl Method for NoiseFunctions08 {
    fn name(&self) -> &'static str {
        "noise-functions 0.8 (f32)"
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.noise)
    }

    fn amplitude(&self) -> f64 {
        // It divides by the weights of one octave more than it has.
        1.0 / weight_sum(self.octaves + 1)
    }

    fn evaluate(&mut self, points: &Points, _with_gradient: bool, out: &mut Output) {
        for (p, value) in points.rounded.iter().zip(&mut out.values) {
            *value = self.noise.sample2([p.x, p.y]);
        }
    }

    fn definition(&self, at: DVec2) -> Option<Exact> {
        let other = f64::from(self.same_with_f64_positions.get_noise_2d(at.x, at.y));
        let value = other * weight_sum(self.octaves) / weight_sum(self.octaves + 1);
        Some(Exact {
            value,
            gradient: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(method: &mut dyn Method, with_gradient: bool) -> (Points, Output) {
        let points = Points::scattered(2000, 200.0, 5);
        let mut out = Output::new(points.len());
        method.evaluate(&points, with_gradient, &mut out);
        (points, out)
    }

    /// The definitions that errors are measured by are the methods' own: near the origin, where a
    /// position loses little in f32, they agree. Some 30 roundings of 6e-8 are 2e-6, and twice that
    /// covers the positions of the eighth octave.
    const CLOSE: f64 = 4e-6;

    #[test]
    fn definitions_agree_with_their_methods_near_the_origin() {
        let methods: [Box<dyn Method>; 2] = [
            Box::new(Noiz05::new(8, 3)),
            Box::new(NoiseFunctions08::new(8, 3)),
        ];
        for mut method in methods {
            let (points, out) = near(method.as_mut(), false);
            for (p, value) in points.exact.iter().zip(&out.values) {
                let exact = method.definition(*p).unwrap().value;
                assert!(
                    (f64::from(*value) - exact).abs() < CLOSE,
                    "{} at {p}",
                    method.name()
                );
            }
        }
    }

    #[test]
    fn noiz_gradient_agrees_with_its_definition_near_the_origin() {
        let mut method = Noiz05::new(8, 3);
        let (points, out) = near(&mut method, true);
        for (i, p) in points.exact.iter().enumerate() {
            let exact = method.definition(*p).unwrap().gradient.unwrap();
            let found = DVec2::new(f64::from(out.dx[i]), f64::from(out.dz[i]));
            // Eight octaves have the same slope, and each errs by 3e-5 of amplitude/wavelength.
            let error = (found - exact).abs().max_element() * WAVELENGTH;
            assert!(error < 3e-4, "{error} at {p}");
        }
    }

    #[test]
    fn every_baseline_fills_every_value() {
        let methods: [Box<dyn Method>; 4] = [
            Box::new(Noise09::new(3, 1)),
            Box::new(Noiz05::new(3, 1)),
            Box::new(FastNoiseLite11::new(3, 1)),
            Box::new(NoiseFunctions08::new(3, 1)),
        ];
        for mut method in methods {
            let with_gradient = method.has_gradient();
            let (_, out) = near(method.as_mut(), with_gradient);
            let values: Vec<f64> = if method.is_f64() {
                out.values_f64
            } else {
                out.values.iter().map(|v| f64::from(*v)).collect()
            };
            assert!(values.iter().all(|v| v.abs() <= 1.0), "{}", method.name());
            let largest = values.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
            assert!(largest > 0.2, "{}: {largest}", method.name());
        }
    }

    #[test]
    fn noise_09_repeats_after_256_cells() {
        let method = Noise09::new(8, 1);
        let period = 256.0 * WAVELENGTH;
        for p in Points::scattered(100, 1000.0, 1).exact {
            let here = method.fbm.get([p.x, p.y]);
            assert_eq!(here, method.fbm.get([p.x + period, p.y - period]), "{p}");
        }
    }
}
