//! Places where the ground lies beyond what samples about them say: summits and hollows between the samples of a
//! cell, islets in a sea that is deep at all of them.

use crate::random::Random;
use bevy::math::DVec2;
use dolomite_terrain::{
    Fractal, GroundPoint, GroundRect, Hill, Layer, Mask, PermutationNoise, Planes, Source, Sum,
    Terrain, TerrainData, Warp,
};

/// Samples along a side of a cell.
const COARSE: usize = 5;
/// Places along a side at which the ground is looked at: four between two samples.
const FINE: usize = 21;
/// As many of a size of cells.
const EACH: usize = 6;

/// Such a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Missed {
    /// Where it is, (x, z) in metres.
    pub place: DVec2,
    /// Side of the cell, metres.
    pub cell: f64,
    /// How far the drawn surface is beyond its lowest or highest sample, less their largest second difference, metres.
    pub beyond: f64,
}

/// A massif 16 km wide in a sea: hills, ridges and eroded ground behind masks. Summits of it stand up to 80 m beyond the
/// samples of cells that are a kilometre wide.
#[must_use]
pub fn massif() -> Terrain {
    let hill = |x, z, radius, height| Layer {
        source: Source::Hill(Hill {
            centre: DVec2::new(x, z),
            radius,
            height,
        }),
        mask: None,
    };
    let masked = |low, high, fractal| Layer {
        source: Source::Fractal(fractal),
        mask: Some(Mask { low, high }),
    };
    let warp = |strength, wavelength, octaves, seed| {
        Some(Warp {
            strength,
            wavelength,
            octaves,
            seed,
        })
    };
    let fractal = |sum, seed, octaves, gain, amplitude, wavelength| Fractal {
        sum,
        seed,
        octaves,
        gain,
        amplitude,
        wavelength,
        ..Fractal::default()
    };
    let billows = Fractal {
        warp: warp(330.0, 1500.0, 3, 23),
        ..fractal(Sum::Billow, 12, 10, 0.42, -430.0, 1700.0)
    };
    let ridges = Fractal {
        warp: warp(200.0, 900.0, 2, 3),
        ..fractal(Sum::Ridged, 5, 9, 0.5, 440.0, 1150.0)
    };
    let eroded = Fractal {
        erosion: 1.5,
        warp: warp(60.0, 400.0, 2, 29),
        ..fractal(Sum::Eroded, 31, 12, 0.48, 90.0, 600.0)
    };
    Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 16_384.0),
        base: 0.0,
        sea_level: Some(0.0),
        layers: vec![
            hill(0.0, 0.0, 11_000.0, 360.0),
            masked(-40.0, 40.0, fractal(Sum::Fbm, 11, 7, 0.5, 180.0, 4100.0)),
            hill(1100.0, -1600.0, 5000.0, 400.0),
            hill(-2300.0, 1900.0, 4200.0, 230.0),
            masked(-10.0, 420.0, billows),
            masked(250.0, 1500.0, ridges),
            masked(20.0, 300.0, eroded),
            masked(4.0, 60.0, fractal(Sum::Fbm, 47, 7, 0.5, 2.2, 38.0)),
        ],
    })
    .expect("these settings are within the ranges that their fields state")
}

/// Noise 4096 m square that rises out of the sea here and there, by a few metres on islets of as many.
#[must_use]
pub fn islets() -> Terrain {
    let fractal = Fractal {
        seed: 4,
        amplitude: 8.0,
        wavelength: 60.0,
        ..Fractal::default()
    };
    Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 4096.0),
        layers: vec![Layer {
            source: Source::Fractal(fractal),
            mask: None,
        }],
        base: -5.0,
        sea_level: Some(0.0),
    })
    .expect("these settings are within the ranges that their fields state")
}

/// Hills of 30 m, 2048 m square, that are 0 at every sample of cells of 256 m and more: permutation noise, on whose lattice they stand; in a sea or in
/// none, which is as high.
#[must_use]
pub fn on_lattice(sea_level: Option<f32>) -> Terrain {
    let noise = PermutationNoise {
        octaves: 6,
        amplitude: 30.0,
        wavelength: 64.0,
        ..PermutationNoise::default()
    };
    Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 2048.0),
        layers: vec![Layer {
            source: Source::Permutation(noise),
            mask: None,
        }],
        base: 0.0,
        sea_level,
    })
    .expect("these settings are within the ranges that their fields state")
}

/// Looks at `count` cells of each size: those into which the extent is divided 16 times, halved until they are `least`
/// metres wide. Six places of a size at most, the worst first; a cell's width apart.
#[must_use]
pub fn missed(terrain: &Terrain, count: usize, least: f64, seed: u32) -> Vec<Missed> {
    let extent = terrain.extent();
    let mut random = Random::new(seed);
    let mut all = Vec::new();
    let mut cells = 16.0;
    while extent.size().max_element() / cells >= least {
        let sides = extent.size() / cells;
        let mut found = Vec::new();
        for _ in 0..count {
            let number = DVec2::new(random.unit(), random.unit()) * cells;
            found.extend(in_cell(terrain, extent.min + number.floor() * sides, sides));
        }
        found.sort_by(|a: &Missed, b| b.beyond.total_cmp(&a.beyond));
        let mut taken: Vec<Missed> = Vec::new();
        for missed in found {
            let away = |other: &Missed| other.place.distance(missed.place) > missed.cell;
            if taken.len() < EACH && taken.iter().all(away) {
                taken.push(missed);
            }
        }
        all.extend(taken);
        cells *= 2.0;
    }
    all
}

/// The worst place of a cell, if there is one.
fn in_cell(terrain: &Terrain, first: DVec2, sides: DVec2) -> Option<Missed> {
    let grid = |n: usize| {
        let step = sides / (n - 1) as f64;
        (0..n * n).map(move |k| first + step * DVec2::new((k % n) as f64, (k / n) as f64))
    };
    let samples = heights(terrain, grid(COARSE));
    let at = |i: usize, j: usize| samples[j * COARSE + i];
    let mut bend = 0.0_f32;
    for even in (0..COARSE).step_by(2) {
        for odd in (1..COARSE).step_by(2) {
            let along = at(odd, even) - 0.5 * (at(odd - 1, even) + at(odd + 1, even));
            let across = at(even, odd) - 0.5 * (at(even, odd - 1) + at(even, odd + 1));
            bend = bend.max(along.abs()).max(across.abs());
        }
    }
    let low = samples.iter().copied().fold(f32::INFINITY, f32::min);
    let high = samples.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    heights(terrain, grid(FINE))
        .into_iter()
        .zip(grid(FINE))
        .map(|(height, place)| Missed {
            place,
            cell: sides.max_element(),
            beyond: f64::from((height - high).max(low - height) - bend),
        })
        .filter(|missed| missed.beyond > 0.0)
        .max_by(|a, b| a.beyond.total_cmp(&b.beyond))
}

/// Of the drawn surface, f32.
fn heights(terrain: &Terrain, places: impl Iterator<Item = DVec2>) -> Vec<f32> {
    let points: Vec<GroundPoint> = places.map(GroundPoint::new).collect();
    let mut planes = [(); 3].map(|()| vec![0.0; points.len()]);
    let [value, dx, dz] = &mut planes;
    terrain
        .fill_points(&points, Planes { value, dx, dz })
        .expect("three planes as long as the list");
    let sea = terrain.sea_level().unwrap_or(f32::NEG_INFINITY);
    let [value, ..] = planes;
    value.into_iter().map(|height| height.max(sea)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hill between samples is found, and no place where there is none.
    #[test]
    fn an_islet_between_samples_is_missed_and_a_plain_is_not() {
        // Samples of the largest cells are 16 m apart, places 3.2 m.
        let centre = DVec2::new(38.4, -25.6);
        let of = |height| {
            let hill = Hill {
                centre,
                radius: 7.0,
                height,
            };
            Terrain::new(TerrainData {
                extent: GroundRect::square(DVec2::ZERO, 1024.0),
                layers: vec![Layer {
                    source: Source::Hill(hill),
                    mask: None,
                }],
                base: -20.0,
                sea_level: Some(0.0),
            })
            .expect("valid")
        };
        let found = missed(&of(30.0), 2000, 64.0, 1);
        let worst = found.first().expect("an islet");
        assert!(worst.place.distance(centre) < 0.01, "{worst:?}");
        assert!((worst.beyond - 10.0).abs() < 0.01, "{worst:?}");
        assert_eq!(missed(&of(15.0), 2000, 64.0, 1), []);
    }
}
