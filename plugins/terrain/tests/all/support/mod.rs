//! What the tests of the terrain share.

use bevy::math::DVec2;
use dolomite_terrain::noise::hash::pcg;
use dolomite_terrain::{
    Fractal, GroundPoint, GroundRect, Layer, Source, Sum, Terrain, TerrainData, Warp,
};

/// Uniform numbers from a seed: PCG in a chain.
pub struct Random(pub u32);

impl Random {
    pub fn word(&mut self) -> u32 {
        self.0 = pcg(self.0);
        self.0
    }

    /// In [0, 1), 32 bits.
    pub fn unit(&mut self) -> f64 {
        f64::from(self.word()) / 4_294_967_296.0
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A place whose distance from the origin along each axis is near `distance`, exact in f64 and
    /// in 32.32 fixed point: multiples of 2⁻²⁸ m.
    pub fn place(&mut self, distance: f64) -> DVec2 {
        let mut axis = || {
            let sign = if self.word() & 1 == 0 { 1.0 } else { -1.0 };
            let at = sign * distance * (0.5 + self.unit());
            (at * 268_435_456.0).round() / 268_435_456.0
        };
        DVec2::new(axis(), axis())
    }
}

pub const SUMS: [Sum; 4] = [Sum::Fbm, Sum::Ridged, Sum::Billow, Sum::Eroded];

pub const WARP: Warp = Warp {
    strength: 40.0,
    wavelength: 700.0,
    octaves: 3,
    seed: 5,
};

pub fn terrain(extent: f64, base: f32, layers: Vec<Layer>) -> Terrain {
    let extent = GroundRect::square(DVec2::ZERO, extent);
    Terrain::new(TerrainData {
        extent,
        layers,
        base,
        sea_level: None,
    })
    .expect("valid")
}

pub fn plain(source: Source) -> Layer {
    Layer { source, mask: None }
}

pub fn of_fractal(fractal: Fractal) -> Terrain {
    terrain(1000.0, 0.0, vec![plain(Source::Fractal(fractal))])
}

pub fn point(xz: DVec2) -> GroundPoint {
    GroundPoint::new(xz)
}
