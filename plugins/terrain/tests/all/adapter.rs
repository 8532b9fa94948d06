//! The WGSL on whatever adapter there is: `terrain_height` at places up to 1e7 m away against
//! the f64 oracle. The output is filled with a sentinel first, so that an unwritten place is seen.

use crate::support;

use bevy::math::DVec2;
use bytemuck::{bytes_of, cast_slice, pod_collect_to_vec};
use dolomite_terrain::{
    Filter, Fractal, GroundPoint, HeightMap, Hill, Layer, Mask, PermutationNoise, Source, Sum,
    Terrain,
};
use dolomite_testkit::gpu::{Binding, Gpu, Kernel, for_test};
use support::{Random, SUMS, WARP, of_fractal, plain, terrain};

/// No height has these bits: a NaN with a payload.
const SENTINEL: u32 = 0x7fc0_dead;

struct Probe {
    gpu: Gpu,
    kernel: Kernel,
}

impl Probe {
    /// `None`, with a line that says so, where there is no adapter; in CI that is a failure.
    fn new() -> Option<Self> {
        let gpu = for_test()?;
        let module = dolomite_shaders::compose("terrain/probe.wgsl", &[]);
        let module = module.unwrap_or_else(|error| panic!("{error}"));
        let kernel = gpu.kernel(module, "probe").expect("compiles");
        Some(Self { gpu, kernel })
    }

    /// (value, d/dx, d/dz) at every place.
    fn run(&self, terrain: &Terrain, places: &[GroundPoint]) -> Vec<[f32; 3]> {
        let data = terrain.gpu();
        let mut heights: Vec<u8> = pod_collect_to_vec(&vec![SENTINEL; places.len() * 4]);
        let groups = &mut [
            vec![
                Binding::Read(cast_slice(places)),
                Binding::Write(&mut heights),
            ],
            vec![
                Binding::Read(cast_slice(&data.layers)),
                Binding::Read(cast_slice(&data.data)),
                Binding::Uniform(bytes_of(&data.uniform)),
            ],
        ];
        let workgroups = [(places.len() as u32).div_ceil(64), 1, 1];
        self.gpu
            .run(&self.kernel, groups, workgroups)
            .expect("runs");
        let words: Vec<u32> = pod_collect_to_vec(&heights);
        words
            .chunks_exact(4)
            .map(|answer| {
                assert_eq!(answer[3], 1.0_f32.to_bits(), "every place is answered");
                [answer[0], answer[1], answer[2]].map(f32::from_bits)
            })
            .collect()
    }

    /// Largest error of value and gradient, metres and rise over run, over places around `distance`.
    fn errors(&self, terrain: &Terrain, distance: f64, count: usize) -> (f64, f64) {
        let mut random = Random(distance as u32);
        let places: Vec<_> = (0..count).map(|_| random.place(distance)).collect();
        let points: Vec<_> = places.iter().map(|&xz| GroundPoint::new(xz)).collect();
        let mut largest = (0.0_f64, 0.0_f64);
        for (xz, [value, dx, dz]) in places.iter().zip(self.run(terrain, &points)) {
            let exact = terrain.sample_f64(*xz);
            let gradient = DVec2::new(f64::from(dx), f64::from(dz)) - exact.gradient;
            // NaN must not pass as small.
            let value = (f64::from(value) - exact.height).abs();
            assert!(value.is_finite() && gradient.is_finite(), "{xz}");
            largest = (largest.0.max(value), largest.1.max(gradient.length()));
        }
        largest
    }
}

#[test]
fn fbm_is_within_1e5_of_the_amplitude_at_any_distance() {
    let Some(probe) = Probe::new() else { return };
    let fractal = Fractal {
        amplitude: 1000.0,
        wavelength: 200.0,
        octaves: 8,
        seed: 7,
        ..Fractal::default()
    };
    let terrain = of_fractal(fractal);
    for distance in [1.0, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7] {
        let (value, gradient) = probe.errors(&terrain, distance, 20_000);
        let (value, gradient) = (value / 1000.0, gradient / (1000.0 / 200.0));
        println!(
            "{}: {distance:e} m: value {value:.2e}, gradient {gradient:.2e}",
            probe.gpu.name
        );
        assert!(
            value <= 1e-5 && gradient <= 1e-4,
            "{distance}: {value:e} {gradient:e}"
        );
    }
}

#[test]
fn every_kind_of_source_agrees() {
    let Some(probe) = Probe::new() else { return };
    let samples: Vec<f32> = (0..60 * 50)
        .map(|k| 800.0 + ((k * 7919) % 101) as f32)
        .collect();
    let map = |filter, origin| {
        let map = HeightMap::new(
            60,
            50,
            samples.clone(),
            origin,
            DVec2::new(25.0, 31.0),
            filter,
        );
        Source::Map(map.expect("valid"))
    };
    let centre = DVec2::new(-5000.0, 7000.0);
    let mut cases: Vec<(&str, Terrain, f64, f64, f64)> = Vec::new();
    for sum in SUMS {
        for warp in [None, Some(WARP)] {
            let fractal = Fractal {
                sum,
                warp,
                octaves: 8,
                ..Fractal::default()
            };
            // Amplitude 100 m, wavelength 1000 m; 1e-5 and 1e-4 of them for FBM as promised,
            // others as in tests/all/accuracy.rs, with room for what a GPU may reorder and fuse.
            let (value, gradient) = match (sum, warp) {
                (Sum::Fbm, None) => (1e-3, 1e-5),
                _ => (3e-4, 2.5e-5),
            };
            cases.push(("fractal", of_fractal(fractal), 1e6, value, gradient));
        }
    }
    let classic = plain(Source::Permutation(PermutationNoise::default()));
    cases.push((
        "classic",
        terrain(1e4, 0.0, vec![classic.clone()]),
        1e4,
        9e-4,
        4.5e-5,
    ));
    for filter in [Filter::Bilinear, Filter::Bicubic] {
        // 2 ulp of 900 m; 1e-5 of 100 m over 25 m.
        let source = plain(map(filter, DVec2::splat(-600.0)));
        cases.push(("map", terrain(1e4, 0.0, vec![source]), 500.0, 1.3e-4, 4e-5));
    }
    let hill = Hill {
        centre,
        radius: 6000.0,
        height: 500.0,
    };
    cases.push((
        "hill",
        terrain(1e4, 0.0, vec![plain(Source::Hill(hill))]),
        7000.0,
        4e-4,
        1e-6,
    ));
    let mask = |source, low, high| Layer {
        source,
        mask: Some(Mask { low, high }),
    };
    let fine = Source::Fractal(Fractal {
        amplitude: 5.0,
        wavelength: 30.0,
        ..Fractal::default()
    });
    let layers = vec![
        plain(map(Filter::Bicubic, DVec2::splat(-600.0))),
        mask(fine.clone(), 820.0, 860.0),
        mask(fine, 900.0, 840.0),
        classic,
    ];
    cases.push(("mixed", terrain(1e4, -100.0, layers), 500.0, 3e-3, 1e-3));
    for (name, terrain, distance, value_limit, gradient_limit) in &cases {
        let (value, gradient) = probe.errors(terrain, *distance, 4000);
        println!("{name}: value {value:.2e} m, gradient {gradient:.2e}");
        assert!(
            value <= *value_limit && gradient <= *gradient_limit,
            "{name}: {value:e} {gradient:e}"
        );
    }
}

#[test]
fn a_wrong_answer_is_seen() {
    // The harness must be able to fail: the adapter is given another terrain than the oracle.
    let Some(probe) = Probe::new() else { return };
    let one = of_fractal(Fractal {
        seed: 1,
        ..Fractal::default()
    });
    let other = of_fractal(Fractal {
        seed: 2,
        ..Fractal::default()
    });
    let xz = Random(1).place(100.0);
    let [value, ..] = probe.run(&one, &[GroundPoint::new(xz)])[0];
    assert!((f64::from(value) - other.sample_f64(xz).height).abs() > 0.01);
}

/// Edits over noise and over maps: the WGSL beside f64, near and beyond what was edited.
#[test]
fn edits_agree() {
    use dolomite_terrain::{Edit, EditKind, TerrainEdits};
    let Some(probe) = Probe::new() else { return };
    for filter in [Filter::Bilinear, Filter::Bicubic] {
        let samples = vec![40.0; 100 * 100];
        let spacing = DVec2::splat(3.0);
        let map = HeightMap::new(100, 100, samples, DVec2::ZERO, spacing, filter);
        let ground = terrain(900.0, 0.0, vec![plain(Source::Map(map.expect("valid")))]);
        let mut edits = TerrainEdits::new(&ground).expect("fits");
        let mut now = ground.clone();
        let mut random = Random(4);
        for k in 0..30 {
            let edit = Edit {
                kind: if k % 2 == 0 {
                    EditKind::Raise
                } else {
                    EditKind::Lower
                },
                place: DVec2::new(random.between(-200.0, 200.0), random.between(-200.0, 200.0)),
                radius: random.between(5.0, 60.0),
                strength: random.between(0.5, 20.0),
                falloff: random.unit(),
            };
            now = edits.apply(&now, &edit).expect("valid").terrain;
        }
        let places: Vec<_> = (0..20_000)
            .map(|_| DVec2::new(random.between(-500.0, 500.0), random.between(-500.0, 500.0)))
            .collect();
        let points: Vec<_> = places.iter().map(|&xz| GroundPoint::new(xz)).collect();
        let mut lifted = 0;
        for (xz, [value, dx, dz]) in places.iter().zip(probe.run(&now, &points)) {
            let exact = now.sample_f64(*xz);
            lifted += usize::from(exact.height != 40.0);
            // A few ulp of 100 m; slopes of some 20 m over 1.5 m.
            assert!((f64::from(value) - exact.height).abs() < 5e-5, "{xz}");
            let gradient = DVec2::new(f64::from(dx), f64::from(dz)) - exact.gradient;
            assert!(gradient.length() < 2e-4, "{xz}: {gradient}");
        }
        // Brushes cover a tenth of where is asked.
        assert!(lifted > 1500, "{lifted}");
    }
}

/// A map that is read by tiles: the adapter finds the level that the CPU finds, and the same heights.
#[test]
fn tiles_agree_wherever_they_are_fine_or_coarse() {
    let Some(gpu) = for_test() else { return };
    let module = dolomite_shaders::compose("terrain/probe.wgsl", &["TERRAIN_TILED"]);
    let module = module.unwrap_or_else(|error| panic!("{error}"));
    let kernel = gpu.kernel(module, "probe").expect("compiles");
    let probe = Probe { gpu, kernel };
    let raw = crate::tiled::Raw::new("adapter");
    for filter in [Filter::Bilinear, Filter::Bicubic] {
        let map = raw.map(filter, 12 << 20);
        crate::tiled::settle(&map, DVec2::new(-400.0, 200.0));
        let terrain = crate::tiled::on_ground(&map).expect("valid");
        let mut random = Random(5);
        let places: Vec<_> = (0..20_000)
            .map(|k| {
                let size = if k % 2 == 0 { 700.0 } else { 9000.0 };
                DVec2::new(-400.0, 200.0) + (DVec2::new(random.unit(), random.unit()) - 0.5) * size
            })
            .collect();
        let points: Vec<_> = places.iter().map(|&xz| GroundPoint::new(xz)).collect();
        let mut coarse = 0;
        for (point, [value, dx, dz]) in points.iter().zip(probe.run(&terrain, &points)) {
            let near = terrain.sample(*point);
            // 600 m in f32, and relief of some metres weighted in another order.
            assert!(
                (near.value - value).abs() < 5e-4,
                "{point:?}: {value}, {}",
                near.value
            );
            let slope = (near.gradient - bevy::math::Vec2::new(dx, dz)).length();
            assert!(slope < 1e-3, "{point:?}: {slope}");
            coarse += u32::from(map.error_at(point.to_dvec2()) > 0.0);
        }
        assert!((4000..16_000).contains(&coarse), "{coarse} of 20000");
    }
}
