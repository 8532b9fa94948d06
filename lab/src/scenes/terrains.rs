//! The grounds that levels of detail are compared on: a mountain, plain FBM, and real elevation.

use bevy::math::DVec2;
use dolomite_terrain::{
    Filter, Fractal, GroundRect, HeightMap, HeightMapFile, Hill, Layer, MapFormat, Mask, RawFormat,
    Source, Sum, Terrain, TerrainData, Warp,
};
use dolomite_testkit::random::Random;

/// All of them: mountain, FBM, real elevation.
#[must_use]
pub fn all(seed: u32) -> [Terrain; 3] {
    [mountain(seed), fbm(seed), dem(seed)]
}

/// An island massif, 16 384 m square, in the manner of the game's scene `mountain`: hills, ridged
/// and eroded fractals, warps, masks by height, and rough ground down to 60 cm.
#[must_use]
pub fn mountain(seed: u32) -> Terrain {
    let layer = |source| Layer { source, mask: None };
    let masked = |low, high, fractal| Layer {
        source: Source::Fractal(fractal),
        mask: Some(Mask { low, high }),
    };
    let hill = |x, z, radius, height| {
        layer(Source::Hill(Hill {
            centre: DVec2::new(x, z),
            radius,
            height,
        }))
    };
    let fractal = |sum, own: u32, octaves, gain, amplitude, wavelength| Fractal {
        sum,
        seed: seed.wrapping_mul(100).wrapping_add(own),
        octaves,
        gain,
        amplitude,
        wavelength,
        ..Fractal::default()
    };
    let warp = |strength, wavelength, octaves, own: u32| {
        Some(Warp {
            strength,
            wavelength,
            octaves,
            seed: seed.wrapping_mul(100).wrapping_add(own),
        })
    };
    new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 16_384.0),
        base: -40.0,
        sea_level: Some(0.0),
        layers: vec![
            hill(0.0, 0.0, 11_000.0, 360.0),
            masked(-40.0, 40.0, fractal(Sum::Fbm, 11, 7, 0.5, 180.0, 4100.0)),
            hill(1100.0, -1600.0, 5000.0, 400.0),
            hill(-2300.0, 1900.0, 4200.0, 230.0),
            masked(
                -10.0,
                420.0,
                Fractal {
                    warp: warp(330.0, 1500.0, 3, 23),
                    ..fractal(Sum::Billow, 12, 10, 0.42, -430.0, 1700.0)
                },
            ),
            masked(
                250.0,
                1500.0,
                Fractal {
                    warp: warp(200.0, 900.0, 2, 3),
                    ..fractal(Sum::Ridged, 5, 9, 0.5, 440.0, 1150.0)
                },
            ),
            masked(
                20.0,
                300.0,
                Fractal {
                    erosion: 1.5,
                    warp: warp(60.0, 400.0, 2, 29),
                    ..fractal(Sum::Eroded, 31, 12, 0.48, 90.0, 600.0)
                },
            ),
            masked(4.0, 60.0, fractal(Sum::Fbm, 47, 7, 0.5, 2.2, 38.0)),
        ],
    })
}

/// One sum of gradient noise, 8192 m square, from 2 km to 1 m.
#[must_use]
pub fn fbm(seed: u32) -> Terrain {
    new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 8192.0),
        base: 0.0,
        sea_level: None,
        layers: vec![Layer {
            source: Source::Fractal(Fractal {
                seed,
                octaves: 12,
                amplitude: 250.0,
                wavelength: 2000.0,
                ..Fractal::default()
            }),
            mask: None,
        }],
    })
}

/// The same, 512 m square and a fifth as high: every method meets an error of some pixels here with few
/// triangles.
#[must_use]
pub fn small(seed: u32) -> Terrain {
    new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 512.0),
        base: 0.0,
        sea_level: None,
        layers: vec![Layer {
            source: Source::Fractal(Fractal {
                seed,
                octaves: 8,
                amplitude: 50.0,
                wavelength: 400.0,
                ..Fractal::default()
            }),
            mask: None,
        }],
    })
}

/// The Jacksboro fault (`assets/dem`), 30 by 32 km of real elevation, with the detail below its
/// samples that the game's scene adds.
#[must_use]
pub fn dem(seed: u32) -> Terrain {
    let map = jacksboro(DVec2::ZERO);
    new(TerrainData {
        extent: map.rect(),
        base: 0.0,
        sea_level: None,
        layers: vec![
            Layer {
                source: Source::Map(map),
                mask: None,
            },
            Layer {
                source: Source::Fractal(Fractal {
                    sum: Sum::Eroded,
                    seed,
                    octaves: 10,
                    amplitude: 14.0,
                    wavelength: 150.0,
                    ..Fractal::default()
                }),
                mask: None,
            },
        ],
    })
}

/// Ground that can be moved: the same elevation about `centre`, and as many hills on it as a terrain may have, some higher
/// than wide. (Noise cannot: it is another one elsewhere.)
#[must_use]
pub fn movable(seed: u32, centre: DVec2) -> Terrain {
    let map = jacksboro(centre);
    let extent = map.rect();
    let mut random = Random::new(seed);
    // Multiples of 1/16 m, exact wherever the centre is.
    let mut along = |size: f64| ((random.unit() - 0.5) * size * 16.0).round() / 16.0;
    let hills = (1..Terrain::MAX_LAYERS).map(|k| {
        let centre = centre + DVec2::new(along(extent.size().x), along(extent.size().y));
        let radius = 5.0 * 1.1_f32.powf(k as f32);
        let height = radius * (0.5 + along(1.0) as f32);
        Layer {
            source: Source::Hill(Hill {
                centre,
                radius,
                height,
            }),
            mask: None,
        }
    });
    let hills: Vec<Layer> = hills.collect();
    let ground = Layer {
        source: Source::Map(map),
        mask: None,
    };
    new(TerrainData {
        extent,
        base: 0.0,
        sea_level: None,
        layers: [ground].into_iter().chain(hills).collect(),
    })
}

fn jacksboro(centre: DVec2) -> HeightMap {
    let file = HeightMapFile {
        path: "jacksboro_344x403_i16le_metres.raw".to_owned(),
        format: MapFormat::raw(RawFormat::I16, 403, 344),
        spacing: Some([74.574, 92.475]),
        centre: centre.to_array(),
        filter: Filter::Bicubic,
        ..HeightMapFile::default()
    };
    let bytes = include_bytes!("../../../assets/dem/jacksboro_344x403_i16le_metres.raw");
    file.decode(&file.path, bytes)
        .expect("the committed file has the size that is stated beside it")
}

fn new(data: TerrainData) -> Terrain {
    Terrain::new(data).expect("these settings are within the ranges that their fields state")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_make_other_ground_and_the_mountain_is_mostly_land() {
        let [mountain, fbm, dem] = all(1);
        let mut land = 0;
        for k in 0..1024 {
            let at = DVec2::new(f64::from(k % 32), f64::from(k / 32)) * 512.0 + 256.0;
            let xz = at - 8192.0;
            land += usize::from(mountain.sample_f64(xz).height > 0.0);
        }
        assert!(land > 700, "{land} of 1024 places");
        let xz = DVec2::new(1234.5, -987.6);
        for (terrain, other) in [mountain, fbm, dem].iter().zip(all(2)) {
            assert_ne!(terrain.sample_f64(xz).height, other.sample_f64(xz).height);
        }
    }
}
