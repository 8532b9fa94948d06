//! The surface that is drawn: the terrain in f64, above the sea.
//!
//! Many places are cheaper in f32 (`Terrain::fill_points`). How far the two may lie apart is known
//! beforehand: [`f32_bound`] adds up what the sources say of themselves. An error that cannot reach
//! the largest one even with that much added is not looked at in f64.

use super::camera::View;
use bevy::math::{DVec2, DVec3};
use dolomite_terrain::{GroundPoint, GroundRect, Planes, Source, Terrain};

/// A terrain with what is worked out of it once.
#[derive(Debug, Clone)]
pub struct Truth {
    /// The terrain.
    pub terrain: Terrain,
    /// [`f32_bound`] of it, metres.
    pub f32_bound: f64,
    sea: f64,
}

impl Truth {
    /// Of a terrain.
    #[must_use]
    pub fn new(terrain: &Terrain) -> Self {
        Self {
            terrain: terrain.clone(),
            f32_bound: f32_bound(terrain),
            sea: terrain.sea_level().map_or(f64::NEG_INFINITY, f64::from),
        }
    }

    /// Height of the sea, metres; −∞ without one.
    #[must_use]
    pub fn sea(&self) -> f64 {
        self.sea
    }

    /// Height of the bed, metres, f64.
    #[must_use]
    pub fn bed(&self, xz: DVec2) -> f64 {
        self.terrain.sample_f64(xz).height
    }

    /// Height of the surface, which is the sea where that is higher.
    #[must_use]
    pub fn height(&self, xz: DVec2) -> f64 {
        self.bed(xz).max(self.sea)
    }

    /// The point of the bed at a place.
    #[must_use]
    pub fn point(&self, xz: DVec2) -> DVec3 {
        DVec3::new(xz.x, self.bed(xz), xz.y)
    }

    /// Heights of the surface with how far each may be off, metres: in f32, and in f64 (off by 0)
    /// where that may be more than `pixels` of the view.
    #[must_use]
    pub fn heights(&self, view: &View, places: &[DVec2], pixels: f64) -> Vec<(f64, f64)> {
        let points: Vec<_> = places.iter().map(|&xz| GroundPoint::new(xz)).collect();
        let [mut value, mut dx, mut dz] = [(); 3].map(|()| vec![0.0_f32; points.len()]);
        let planes = Planes {
            value: &mut value,
            dx: &mut dx,
            dz: &mut dz,
        };
        self.terrain
            .fill_points(&points, planes)
            .expect("the planes have the length of the list");
        let near = |(&xz, &height): (&DVec2, &f32)| {
            let height = f64::from(height).max(self.sea);
            let point = DVec3::new(xz.x, height, xz.y);
            let far = view.to_camera(point).z < view.near - self.f32_bound;
            if far || view.pixels_at_most(point, self.f32_bound) <= pixels {
                (height, self.f32_bound)
            } else {
                (self.height(xz), 0.0)
            }
        };
        places.iter().zip(&value).map(near).collect()
    }

    /// Least and greatest height of the bed that a rectangle may contain, metres: never too narrow.
    #[must_use]
    pub fn bounds(&self, rect: &GroundRect) -> (f64, f64) {
        let bounds = self.terrain.bounds(rect);
        (f64::from(bounds.min), f64::from(bounds.max))
    }
}

/// How far the f32 height of a terrain may lie from the f64 one, metres.
///
/// Each source brings its documented share: 1e-5 of the amplitude for fractals whose amplitudes sum
/// up to twice the first (`Fractal`, and in proportion for others) and for the permutation noise, 4e-7
/// of a hill, 1e-6 of a map's altitude. A mask s(t) with t = (h − low)/(high − low) has |s′| ≤ 3/2,
/// so that an error below it comes out 1 + 3/2·|source|/|high − low| times as large. Sums and masks
/// are rounded: 8 steps of 2⁻²⁴ of all magnitudes so far are allowed a layer.
#[must_use]
pub fn f32_bound(terrain: &Terrain) -> f64 {
    let data = terrain.data();
    let step = 2.0_f64.powi(-24);
    let mut magnitude = f64::from(data.base).abs();
    let mut error = magnitude * step;
    for layer in &data.layers {
        let (source, own) = match &layer.source {
            Source::Fractal(fractal) => {
                let gain = f64::from(fractal.gain);
                let sum: f64 = (0..fractal.octaves).map(|k| gain.powi(k as i32)).sum();
                let amplitude = f64::from(fractal.amplitude).abs();
                (amplitude * sum, 1e-5 * amplitude * sum.max(2.0) / 2.0)
            }
            Source::Permutation(classic) => {
                let amplitude = f64::from(classic.amplitude).abs();
                (2.0 * amplitude, 1e-5 * amplitude)
            }
            Source::Map(map) => {
                // Bicubic interpolation may overshoot by 28 % of the range.
                let highest = map.samples().iter().fold(0.0_f32, |h, s| h.max(s.abs()));
                let highest = 1.56 * f64::from(highest);
                (highest, 1e-6 * highest)
            }
            Source::Hill(hill) => {
                let height = f64::from(hill.height).abs();
                (height, 4e-7 * height)
            }
        };
        if let Some(mask) = layer.mask {
            let width = (f64::from(mask.high) - f64::from(mask.low)).abs();
            error *= 1.0 + 1.5 * source / width;
        }
        magnitude += source;
        error += own + 8.0 * step * magnitude;
    }
    error
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::terrains;
    use dolomite_testkit::random::Random;

    #[test]
    fn f32_stays_within_its_bound_and_near_places_are_f64() {
        for terrain in terrains::all(5) {
            let truth = Truth::new(&terrain);
            let extent = terrain.extent();
            let view = crate::scenes::cameras::over(&terrain, 1).remove(0).view();
            let mut random = Random::new(9);
            let places: Vec<_> = (0..4000)
                .map(|_| extent.min + extent.size() * DVec2::new(random.unit(), random.unit()))
                .collect();
            let mut largest = 0.0_f64;
            for (&xz, (height, off)) in places.iter().zip(truth.heights(&view, &places, 0.1)) {
                let difference = (height - truth.height(xz)).abs();
                assert!(difference <= off, "{difference} {off}");
                largest = largest.max(difference);
            }
            println!("bound {:e}, seen {largest:e}", truth.f32_bound);
            // It must be a bound of something: no more than 10⁵ times what is seen, no zero.
            assert!(largest > 0.0 && truth.f32_bound < 1e5 * largest);
        }
    }
}
