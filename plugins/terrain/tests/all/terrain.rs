//! Terrains of several layers: what is refused, what masks do, and what scene files may say.

use crate::support;

use bevy::math::DVec2;
use dolomite_terrain::{
    Fractal, Ground, GroundRect, Hill, Layer, Mask, PermutationNoise, Source, Sum, Terrain,
    TerrainData, TerrainError,
};
use support::{Random, WARP, plain, terrain};

fn data(layers: Vec<Layer>) -> TerrainData {
    TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 100.0),
        layers,
        base: 0.0,
        sea_level: None,
    }
}

fn message(data: TerrainData) -> String {
    Terrain::new(data)
        .map(|_| ())
        .expect_err("refused")
        .to_string()
}

#[test]
fn bad_data_is_refused_by_name() {
    let good = || data(vec![plain(Source::Fractal(Fractal::default()))]);
    for extent in [
        GroundRect::new(DVec2::ZERO, DVec2::ZERO),
        GroundRect::new(DVec2::ONE, DVec2::ZERO),
        GroundRect::new(DVec2::NAN, DVec2::ONE),
        GroundRect::new(DVec2::ZERO, DVec2::INFINITY),
    ] {
        let refused = Terrain::new(TerrainData { extent, ..good() });
        assert!(
            matches!(refused, Err(TerrainError::Extent(_))),
            "{extent:?}"
        );
    }
    let far = GroundRect::square(DVec2::splat(2e8), 10.0);
    let refused = Terrain::new(TerrainData {
        extent: far,
        ..good()
    });
    assert!(matches!(refused, Err(TerrainError::ExtentRange(_))));

    assert!(
        message(TerrainData {
            base: f32::NAN,
            ..good()
        })
        .starts_with("base is NaN")
    );
    let sea = TerrainData {
        sea_level: Some(f32::INFINITY),
        ..good()
    };
    assert!(message(sea).starts_with("sea_level is inf"));

    let bad = |source| {
        message(data(vec![
            plain(Source::Permutation(PermutationNoise::default())),
            plain(source),
        ]))
    };
    let fractal = Source::Fractal(Fractal {
        wavelength: -1.0,
        ..Fractal::default()
    });
    assert!(bad(fractal).starts_with("layer 1: wavelength is -1"));
    let classic = Source::Permutation(PermutationNoise {
        octaves: 0,
        ..PermutationNoise::default()
    });
    assert!(bad(classic).starts_with("layer 1: octaves is 0"));
    let hill = Source::Hill(Hill {
        centre: DVec2::ZERO,
        radius: -1.0,
        height: 1.0,
    });
    assert!(bad(hill).starts_with("layer 1: radius is -1"));
    for (low, high) in [(1.0, 1.0), (f32::NAN, 1.0), (0.0, f32::INFINITY)] {
        let source = Source::Fractal(Fractal::default());
        let masked = data(vec![Layer {
            source,
            mask: Some(Mask { low, high }),
        }]);
        assert!(message(masked).starts_with("layer 0: mask from"));
    }
    let many =
        vec![plain(Source::Permutation(PermutationNoise::default())); Terrain::MAX_LAYERS + 1];
    assert!(message(data(many)).contains("33 layers, but a terrain may have at most 32"));
}

#[test]
fn masks_switch_layers_by_the_height_so_far() {
    let plateau = |height| {
        Source::Hill(Hill {
            centre: DVec2::ZERO,
            radius: 1e6,
            height,
        })
    };
    let on = |low, high| {
        let layers = vec![
            plain(plateau(50.0)),
            Layer {
                source: plateau(8.0),
                mask: Some(Mask { low, high }),
            },
        ];
        terrain(1000.0, 0.0, layers).height(DVec2::ZERO)
    };
    assert_eq!(on(10.0, 40.0), 58.0, "fully there above `high`");
    assert_eq!(on(60.0, 90.0), 50.0, "absent below `low`");
    assert_eq!(on(40.0, 60.0), 54.0, "half in the middle");
    assert_eq!(on(90.0, 60.0), 58.0, "inverted: there at and below `high`");
    assert_eq!(on(40.0, 10.0), 50.0, "inverted: absent at and above `low`");
}

#[test]
fn gradients_of_masked_sums_are_derivatives_and_f32_agrees() {
    let fractal = |sum, wavelength, amplitude, warp| {
        let octaves = 4;
        Source::Fractal(Fractal {
            sum,
            wavelength,
            amplitude,
            octaves,
            warp,
            ..Fractal::default()
        })
    };
    let mask = |low, high| Some(Mask { low, high });
    let ground = terrain(
        1000.0,
        20.0,
        vec![
            plain(fractal(Sum::Fbm, 900.0, 100.0, None)),
            Layer {
                source: fractal(Sum::Ridged, 400.0, 60.0, Some(WARP)),
                mask: mask(0.0, 50.0),
            },
            Layer {
                source: fractal(Sum::Eroded, 100.0, 9.0, None),
                mask: mask(80.0, 10.0),
            },
        ],
    );
    let mut random = Random(31);
    for _ in 0..2000 {
        let xz = random.place(3000.0);
        let exact = ground.sample_f64(xz);
        let h = 1e-4;
        let at = |d: DVec2| ground.height(xz + d);
        let slope = DVec2::new(
            (at(DVec2::X * h) - at(DVec2::X * -h)) / (2.0 * h),
            (at(DVec2::Y * h) - at(DVec2::Y * -h)) / (2.0 * h),
        );
        // The smooth step's second derivative jumps at its ends: h × 6/50² × slopes; rounding
        // 1e-13 / h.
        assert!(
            (slope - exact.gradient).length() < 1e-5,
            "{xz}: {slope} {}",
            exact.gradient
        );
        let near = ground.sample(support::point(xz));
        // 1e-5 of the amplitude of 100 m, 1e-4 of the steepest amplitude/wavelength, 0.15.
        assert!((f64::from(near.value) - exact.height).abs() < 1e-3);
        assert!(
            (near.gradient.as_dvec2() - exact.gradient).length() < 1e-4,
            "{xz}"
        );
        let normal = ground.normal(xz);
        assert!((normal.length() - 1.0).abs() < 1e-12 && normal.y > 0.0);
    }
}

#[test]
fn hostile_places_give_finite_heights() {
    let ground = terrain(
        1000.0,
        0.0,
        vec![plain(Source::Fractal(Fractal {
            warp: Some(WARP),
            ..Fractal::default()
        }))],
    );
    for xz in [
        DVec2::NAN,
        DVec2::INFINITY,
        DVec2::NEG_INFINITY,
        DVec2::splat(1e300),
        DVec2::splat(-5e-324),
    ] {
        let sample = ground.sample_f64(xz);
        assert!(
            sample.height.is_finite() && sample.gradient.is_finite(),
            "{xz}"
        );
        assert!(ground.sample(support::point(xz)).value.is_finite(), "{xz}");
    }
}

#[test]
fn scene_files_name_fields_and_refuse_unknown_ones() {
    let fractal: Fractal =
        ron::from_str("(sum: Ridged, seed: 4, amplitude: 300.0)").expect("valid");
    let expected = Fractal {
        sum: Sum::Ridged,
        seed: 4,
        amplitude: 300.0,
        ..Fractal::default()
    };
    assert_eq!(fractal, expected);
    let hill: Hill =
        ron::from_str("(centre: (1.0, 2.0), radius: 3.0, height: 4.0)").expect("valid");
    assert_eq!(hill.centre, DVec2::new(1.0, 2.0));
    let unknown = ron::from_str::<Fractal>("(amplitud: 300.0)").expect_err("refused");
    assert!(unknown.to_string().contains("amplitud"), "{unknown}");
}
