//! Dolomite's own noise on the CPU: one point at a time, and in batches.

use super::method::{Exact, GAIN, LACUNARITY, Method, Output, WAVELENGTH};
use super::points::Points;
use bevy::math::DVec2;
use dolomite_terrain::noise::{Octave, PreparedFractal};
use dolomite_terrain::{Fractal, GroundPoint, HeightTile, Planes, Sum};

/// Name of [`Scalar`].
pub const SCALAR: &str = "ours, f32 scalar";
/// Name of [`Batch`].
pub const BATCH: &str = "ours, f32 batch";
/// Name of [`BatchAllCores`].
pub const BATCH_ALL_CORES: &str = "ours, f32 batch, all cores";

/// The study's sum as settings of [`Fractal`], with an amplitude of 1 m.
pub fn fractal(octaves: u32, seed: u32) -> Fractal {
    Fractal {
        sum: Sum::Fbm,
        seed,
        octaves,
        lacunarity: LACUNARITY as f32,
        gain: GAIN as f32,
        amplitude: 1.0,
        wavelength: WAVELENGTH as f32,
        warp: None,
        ..Fractal::default()
    }
}

fn prepared(octaves: u32, seed: u32) -> PreparedFractal {
    fractal(octaves, seed)
        .prepare()
        .expect("the study's octaves, 1 to 12, from 256 m are in range")
}

/// Bytes of the octave table.
fn bytes(octaves: u32) -> usize {
    octaves as usize * size_of::<Octave>()
}

/// Our definition: the same sum in f64, by other formulas.
pub(super) fn definition(fractal: &PreparedFractal, at: DVec2) -> Exact {
    let sample = fractal.sample_f64(at);
    Exact {
        value: sample.height,
        gradient: Some(sample.gradient),
    }
}

/// One point at a time, value and gradient always together.
pub struct Scalar {
    fractal: PreparedFractal,
    octaves: u32,
}

impl Scalar {
    /// With the study's settings.
    pub fn new(octaves: u32, seed: u32) -> Self {
        Self {
            fractal: prepared(octaves, seed),
            octaves,
        }
    }
}

impl Method for Scalar {
    fn name(&self) -> &'static str {
        SCALAR
    }

    fn bytes(&self) -> usize {
        bytes(self.octaves)
    }

    fn amplitude(&self) -> f64 {
        1.0
    }

    fn has_gradient(&self) -> bool {
        true
    }

    fn evaluate(&mut self, points: &Points, with_gradient: bool, out: &mut Output) {
        if !with_gradient {
            for (p, value) in points.fixed.iter().zip(&mut out.values) {
                *value = self.fractal.sample(*p).value;
            }
            return;
        }
        let outputs = out.values.iter_mut().zip(&mut out.dx).zip(&mut out.dz);
        for (p, ((value, dx), dz)) in points.fixed.iter().zip(outputs) {
            let height = self.fractal.sample(*p);
            *value = height.value;
            *dx = height.gradient.x;
            *dz = height.gradient.y;
        }
    }

    fn definition(&self, at: DVec2) -> Option<Exact> {
        Some(definition(&self.fractal, at))
    }
}

/// The lattice of `points` as a tile.
fn tile(points: &Points) -> Option<HeightTile> {
    let lattice = points.lattice?;
    let side = lattice.side as usize;
    let origin = GroundPoint::from(lattice.origin);
    Some(HeightTile {
        origin,
        spacing: DVec2::splat(lattice.spacing),
        width: side,
        height: side,
    })
}

fn planes(out: &mut Output) -> Planes<'_> {
    Planes {
        value: &mut out.values,
        dx: &mut out.dx,
        dz: &mut out.dz,
    }
}

const FITS: &str = "the planes have room for exactly the points";

/// Many points in one call, on one core: lattices as tiles, others as lists. Gradients always come
/// with the values.
pub struct Batch {
    fractal: PreparedFractal,
    octaves: u32,
}

impl Batch {
    /// With the study's settings.
    pub fn new(octaves: u32, seed: u32) -> Self {
        Self {
            fractal: prepared(octaves, seed),
            octaves,
        }
    }
}

impl Method for Batch {
    fn name(&self) -> &'static str {
        BATCH
    }

    fn bytes(&self) -> usize {
        bytes(self.octaves)
    }

    fn amplitude(&self) -> f64 {
        1.0
    }

    fn has_gradient(&self) -> bool {
        true
    }

    fn evaluate(&mut self, points: &Points, _with_gradient: bool, out: &mut Output) {
        match tile(points) {
            Some(tile) => self.fractal.fill_tile(&tile, planes(out)),
            None => self.fractal.fill_points(&points.fixed, planes(out)),
        }
        .expect(FITS);
    }

    fn definition(&self, at: DVec2) -> Option<Exact> {
        Some(definition(&self.fractal, at))
    }
}

/// Tiles on all cores.
pub struct BatchAllCores(Batch);

impl BatchAllCores {
    /// With the study's settings.
    pub fn new(octaves: u32, seed: u32) -> Self {
        Self(Batch::new(octaves, seed))
    }
}

impl Method for BatchAllCores {
    fn name(&self) -> &'static str {
        BATCH_ALL_CORES
    }

    fn device(&self) -> String {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        format!("CPU, {cores} cores")
    }

    fn bytes(&self) -> usize {
        self.0.bytes()
    }

    fn amplitude(&self) -> f64 {
        1.0
    }

    fn has_gradient(&self) -> bool {
        true
    }

    fn takes(&self, points: &Points) -> bool {
        points.lattice.is_some()
    }

    fn evaluate(&mut self, points: &Points, _with_gradient: bool, out: &mut Output) {
        if let Some(tile) = tile(points) {
            self.0
                .fractal
                .fill_tile_parallel(&tile, planes(out))
                .expect(FITS);
        }
    }

    fn definition(&self, at: DVec2) -> Option<Exact> {
        self.0.definition(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_three_give_the_same_bits() {
        let points = Points::tile(2500, 0.5, 3);
        let results = |method: &mut dyn Method| {
            let mut out = Output::new(points.len());
            method.evaluate(&points, true, &mut out);
            let bits = |plane: &[f32]| plane.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            [bits(&out.values), bits(&out.dx), bits(&out.dz)]
        };
        let scalar = results(&mut Scalar::new(8, 5));
        assert!(scalar[0].iter().all(|v| !f32::from_bits(*v).is_nan()));
        assert_eq!(scalar, results(&mut Batch::new(8, 5)));
        assert_eq!(scalar, results(&mut BatchAllCores::new(8, 5)));
    }

    #[test]
    fn all_cores_only_take_lattices() {
        let method = BatchAllCores::new(2, 1);
        assert!(method.takes(&Points::tile(400, 1.0, 1)));
        assert!(!method.takes(&Points::scattered(400, 1.0, 1)));
    }
}
