//! Bounds hold whatever the terrain and the rectangle, and are not idle.

use crate::support;

use bevy::math::DVec2;
use dolomite_terrain::{
    Filter, Fractal, GroundRect, HeightBounds, HeightMap, Hill, Layer, Mask, PermutationNoise,
    Source, Sum, Terrain, Warp,
};
use proptest::prelude::*;
use support::{Random, WARP, of_fractal, plain, terrain};

/// What is really there: extremes over a grid that includes the rectangle's corners.
fn scan(terrain: &Terrain, rect: &GroundRect, side: u32) -> HeightBounds {
    let mut found = HeightBounds {
        min: f32::INFINITY,
        max: f32::NEG_INFINITY,
        max_slope: 0.0,
    };
    for row in 0..=side {
        for column in 0..=side {
            let share = DVec2::new(f64::from(column), f64::from(row)) / f64::from(side);
            let at = support::point(rect.min + rect.size() * share);
            let height = terrain.sample(at);
            found.min = found.min.min(height.value);
            found.max = found.max.max(height.value);
            found.max_slope = found.max_slope.max(height.gradient.length());
        }
    }
    found
}

fn assert_holds(terrain: &Terrain, rect: &GroundRect) {
    let bounds = terrain.bounds(rect);
    let found = scan(terrain, rect, 48);
    assert!(bounds.min <= found.min, "{rect:?}: {bounds:?} {found:?}");
    assert!(bounds.max >= found.max, "{rect:?}: {bounds:?} {found:?}");
    assert!(
        bounds.max_slope >= found.max_slope,
        "{rect:?}: {bounds:?} {found:?}"
    );
}

fn fractals() -> impl Strategy<Value = Fractal> {
    let sum = prop_oneof![
        Just(Sum::Fbm),
        Just(Sum::Ridged),
        Just(Sum::Billow),
        Just(Sum::Eroded)
    ];
    let warp = prop::option::of((0.0..300.0_f32, 50.0..3000.0_f32, 1..4_u32, any::<u32>()));
    let shape = (1..9_u32, 1.5..2.9_f32, 0.2..0.7_f32, 0.0..20.0_f32);
    let size = (-900.0..900.0_f32, 20.0..5000.0_f32, any::<u32>());
    (sum, warp, shape, size).prop_filter_map("amplitude 0", |(sum, warp, shape, size)| {
        let (octaves, lacunarity, gain, erosion) = shape;
        let (amplitude, wavelength, seed) = size;
        let warp = warp.map(|(strength, wavelength, octaves, seed)| Warp {
            strength,
            wavelength,
            octaves,
            seed,
        });
        let fractal = Fractal {
            sum,
            seed,
            octaves,
            lacunarity,
            gain,
            amplitude,
            wavelength,
            erosion,
            warp,
        };
        fractal.validate().is_ok().then_some(fractal)
    })
}

fn rects() -> impl Strategy<Value = GroundRect> {
    // Sides from 1 m to 64 km, also long and narrow; near the origin and far away.
    let side = || (0..16_u32, 1.0..2.0_f64).prop_map(|(k, share)| f64::from(1 << k) * share);
    let place = || prop_oneof![-1e4..1e4_f64, -1e7..1e7_f64];
    (place(), place(), side(), side())
        .prop_map(|(x, z, w, h)| GroundRect::new(DVec2::new(x, z), DVec2::new(x + w, z + h)))
}

fn maps() -> impl Strategy<Value = HeightMap> {
    let filter = prop_oneof![Just(Filter::Bilinear), Just(Filter::Bicubic)];
    (
        1..40_u32,
        1..40_u32,
        any::<u32>(),
        filter,
        1.0..90.0_f64,
        1.0..90.0_f64,
    )
        .prop_map(|(width, height, seed, filter, sx, sz)| {
            let mut random = Random(seed);
            let samples = (0..width * height)
                .map(|_| random.between(-500.0, 900.0) as f32)
                .collect();
            HeightMap::new(
                width,
                height,
                samples,
                DVec2::new(-100.0, 50.0),
                DVec2::new(sx, sz),
                filter,
            )
            .expect("valid")
        })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 192, ..ProptestConfig::default() })]

    #[test]
    fn fractal_bounds_hold(fractal in fractals(), rect in rects()) {
        assert_holds(&of_fractal(fractal), &rect);
    }

    #[test]
    fn map_bounds_hold(map in maps(), x in -2000.0..4000.0_f64, z in -2000.0..4000.0_f64, w in 0.1..4000.0_f64, h in 0.1..4000.0_f64) {
        let rect = GroundRect::new(DVec2::new(x, z), DVec2::new(x + w, z + h));
        assert_holds(&terrain(1000.0, 3.0, vec![plain(Source::Map(map))]), &rect);
    }

    #[test]
    fn masked_layers_hold(
        below in fractals(),
        above in fractals(),
        low in -300.0..300.0_f32,
        high in -300.0..300.0_f32,
        radius in 1.0..2000.0_f32,
        rect in rects(),
    ) {
        prop_assume!((high - low).abs() > 1.0);
        let hill = Hill { centre: rect.min, radius, height: -200.0 };
        let mask = Some(Mask { low, high });
        let layers = vec![
            plain(Source::Fractal(below)),
            plain(Source::Hill(hill)),
            Layer { source: Source::Fractal(above), mask },
            Layer { source: Source::Permutation(PermutationNoise::default()), mask },
        ];
        assert_holds(&terrain(1000.0, 3.0, layers), &rect);
    }
}

#[test]
fn hostile_rectangles_do_not_panic() {
    let terrain = of_fractal(Fractal {
        warp: Some(WARP),
        ..Fractal::default()
    });
    for rect in [
        GroundRect::new(DVec2::NAN, DVec2::ZERO),
        GroundRect::new(DVec2::NEG_INFINITY, DVec2::INFINITY),
        GroundRect::new(DVec2::splat(5.0), DVec2::splat(-5.0)),
        GroundRect::new(DVec2::ZERO, DVec2::ZERO),
    ] {
        let bounds = terrain.bounds(&rect);
        assert!(
            bounds.min <= bounds.max && bounds.max_slope.is_finite(),
            "{rect:?}: {bounds:?}"
        );
    }
}

/// How much wider than the truth bounds are, as a share of the true range: the largest over
/// patches of `side` metres.
fn slack(terrain: &Terrain, side: f64) -> f64 {
    let mut random = Random(21);
    (0..12).fold(0.0_f64, |largest, _| {
        let rect = GroundRect::square(random.place(5000.0), side);
        let (bounds, found) = (terrain.bounds(&rect), scan(terrain, &rect, 128));
        let range = f64::from(found.max - found.min);
        largest.max(f64::from(bounds.max - bounds.min) / range - 1.0)
    })
}

#[test]
fn bounds_are_tight_enough_to_cull_by() {
    // A mountain: 3.5 km and 600 m in the first octave.
    let fractal = |sum, warp| Fractal {
        sum,
        warp,
        octaves: 12,
        amplitude: 600.0,
        wavelength: 3500.0,
        ..Fractal::default()
    };
    let warp = Some(Warp {
        strength: 200.0,
        wavelength: 2500.0,
        octaves: 2,
        seed: 3,
    });
    for (sum, warp, small, large) in [
        (Sum::Fbm, None, 0.5, 1.2),
        (Sum::Ridged, None, 0.8, 1.6),
        (Sum::Billow, None, 1.2, 1.6),
        (Sum::Fbm, warp, 1.5, 2.0),
    ] {
        let terrain = of_fractal(fractal(sum, warp));
        let found = [16.0, 256.0, 4096.0].map(|side| slack(&terrain, side));
        println!("{sum:?} warped {}: slack {found:.2?}", warp.is_some());
        assert!(
            found[0] < small && found[1] < small && found[2] < large,
            "{sum:?}: {found:?}"
        );
    }
}
