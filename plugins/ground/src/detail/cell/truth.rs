//! What cells state of grounds that are made to be missed, held to heights in f64 between their samples.

use super::search::search;
use super::*;
use dolomite_terrain::{
    Edit, EditKind, Filter, Fractal, HeightMap, Hill, Layer, Mask, PermutationNoise, Source,
    TerrainData, TerrainEdits,
};
use dolomite_testkit::missed::{islets, massif, missed, on_lattice};

fn of(side: f64, sea_level: Option<f32>, base: f32, layers: Vec<Layer>) -> Terrain {
    Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, side),
        layers,
        base,
        sea_level,
    })
    .expect("valid")
}

fn layer(source: Source) -> Layer {
    Layer { source, mask: None }
}

fn hill(at: [f64; 2], radius: f32, height: f32) -> Layer {
    layer(Source::Hill(Hill {
        centre: DVec2::from(at),
        radius,
        height,
    }))
}

fn noise(seed: u32, octaves: u32, amplitude: f32, wavelength: f32) -> Source {
    Source::Fractal(Fractal {
        seed,
        octaves,
        amplitude,
        wavelength,
        ..Fractal::default()
    })
}

/// Nothing is farther off than what is stated, and nothing lies beyond an interval.
fn is_true(name: &str, terrain: &Terrain, hints: &[DVec2]) {
    let found = search(terrain, hints);
    println!("{name}: {found:?}");
    assert!(found.error.0 <= 1.0, "{name}: {found:?}");
    assert!(found.beyond.0 <= 1.0, "{name}: {found:?}");
}

#[test]
fn islets_narrower_than_samples_are_stated() {
    // Of noise that is under water nearly everywhere.
    for (base, amplitude, wavelength) in [(-4.0, 8.0, 60.0), (-40.0, 90.0, 150.0), (-0.5, 1.0, 5.0)]
    {
        let layers = vec![layer(noise(4, 8, amplitude, wavelength))];
        is_true("noise", &of(1024.0, Some(0.0), base, layers), &[]);
    }
    is_true("islets", &islets(), &[]);
    // Hills, of which samples of large cells meet none.
    let at = [[38.4, -25.6], [-301.3, 207.7], [130.9, 411.1]];
    let layers = at.map(|at| hill(at, 3.0, 30.0)).to_vec();
    let hints = at.map(DVec2::from);
    is_true("hills", &of(1024.0, Some(0.0), -20.0, layers), &hints);
}

#[test]
fn ground_is_stated_whose_samples_all_stand_at_the_height_of_the_sea() {
    is_true("wet", &on_lattice(Some(0.0)), &[]);
    is_true("dry", &on_lattice(None), &[]);
}

#[test]
fn noise_is_stated_whose_lattice_the_samples_stand_on() {
    let default = layer(Source::Permutation(PermutationNoise::default()));
    is_true("permutation", &of(1600.0, None, 0.0, vec![default]), &[]);
    // Of the offsets of 400 seeds those nearest to a lattice point, and nearest to a line.
    let near = |seed: &u32| {
        let source = noise(*seed, 1, 1.0, 16.0);
        let terrain = of(1024.0, None, 0.0, vec![layer(source)]);
        let at = (0..9).map(|k| {
            terrain
                .sample_f64(DVec2::splat(16.0 * f64::from(k)))
                .height
                .abs()
        });
        at.fold(0.0, f64::max)
    };
    let mut seeds: Vec<u32> = (0..400).collect();
    seeds.sort_by(|a, b| near(a).total_cmp(&near(b)));
    for seed in &seeds[..4] {
        let source = noise(*seed, 1, 5.0, 16.0);
        is_true(
            "one octave",
            &of(1024.0, None, 0.0, vec![layer(source)]),
            &[],
        );
    }
}

#[test]
fn noise_of_high_frequency_is_stated() {
    for wavelength in [0.5, 1.0, 3.3] {
        let source = noise(7, 1, 2.0, wavelength);
        is_true(
            "one octave",
            &of(700.0, None, 0.0, vec![layer(source)]),
            &[],
        );
    }
    let rough = Source::Fractal(Fractal {
        octaves: 9,
        gain: 0.8,
        amplitude: 10.0,
        wavelength: 90.0,
        ..Fractal::default()
    });
    is_true("rough", &of(700.0, None, 0.0, vec![layer(rough)]), &[]);
}

/// A mask that opens within little height is a cliff wherever the ground below comes to that height. Samples on either side
/// tell of it; where a plateau begins and ends between samples none does, and what is stated is not held: the bound that is
/// missed, as large as it was found to be (docs/measured/level-of-detail.md).
#[test]
fn cliffs_are_stated_but_for_plateaus_that_samples_miss() {
    let plateau = |low, high| Layer {
        source: Source::Hill(Hill {
            centre: DVec2::ZERO,
            radius: 1e6,
            height: 40.0,
        }),
        mask: Some(Mask { low, high }),
    };
    let ground = || layer(noise(9, 6, 30.0, 300.0));
    for (width, most) in [(10.0, 1.0), (5.0, 1.0), (1.0, 1.2), (0.01, 1.0)] {
        let terrain = of(1024.0, None, 0.0, vec![ground(), plateau(2.0, 2.0 + width)]);
        let found = search(&terrain, &[]);
        println!("opens within {width} m: {found:?}");
        assert!(found.error.0 <= most, "{width} m: {found:?}");
        assert!(found.beyond.0 <= 1.0, "{width} m: {found:?}");
    }
}

#[test]
fn peaks_that_stand_alone_are_stated() {
    let at = [[38.4, -25.6], [-301.3, 207.7], [130.9, 411.1]];
    let hints = at.map(DVec2::from);
    let ground = || layer(noise(2, 7, 20.0, 200.0));
    for radius in [0.4, 3.0, 20.0] {
        let mut layers = vec![ground()];
        layers.extend(at.map(|at| hill(at, radius, 50.0)));
        is_true("hills", &of(1024.0, None, 0.0, layers), &hints);
    }
    // Which open a mask.
    let mut layers = at.map(|at| hill(at, 3.0, 4.0)).to_vec();
    layers.push(Layer {
        source: Source::Hill(Hill {
            centre: DVec2::ZERO,
            radius: 1e6,
            height: 80.0,
        }),
        mask: Some(Mask {
            low: 0.5,
            high: 3.5,
        }),
    });
    is_true("masks", &of(1024.0, None, 0.0, layers), &hints);
    // Put there by a brush.
    let flat = of(1024.0, None, 0.0, vec![ground()]);
    let mut edits = TerrainEdits::new(&flat).expect("fits");
    let mut edited = flat;
    for at in at {
        let edit = Edit {
            kind: EditKind::Raise,
            place: DVec2::from(at),
            radius: 1.6,
            strength: 30.0,
            falloff: 1.0,
        };
        edited = edits.apply(&edited, &edit).expect("valid").terrain;
    }
    is_true("edits", &edited, &hints);
}

#[test]
fn a_map_of_one_spike_is_stated() {
    for (filter, sea, base) in [
        (Filter::Bilinear, None, 0.0),
        (Filter::Bicubic, None, 0.0),
        (Filter::Bilinear, Some(0.0), -3.0),
        (Filter::Bicubic, Some(0.0), -3.0),
    ] {
        let (side, spike) = (257_u32, [77_u32, 130]);
        let samples = (0..side * side)
            .map(|k| {
                if [k % side, k / side] == spike {
                    40.0
                } else {
                    0.0
                }
            })
            .collect();
        let origin = DVec2::splat(-512.0);
        let spacing = DVec2::splat(4.0);
        let map = HeightMap::new(side, side, samples, origin, spacing, filter).expect("valid");
        let at = origin + spacing * DVec2::new(f64::from(spike[0]), f64::from(spike[1]));
        let layers = vec![layer(Source::Map(map))];
        is_true("spike", &of(1000.0, sea, base, layers), &[at]);
    }
}

#[test]
fn a_massif_whose_summits_samples_miss_is_stated() {
    let terrain = massif();
    let places: Vec<DVec2> = missed(&terrain, 1000, 60.0, 1)
        .iter()
        .map(|missed| missed.place)
        .collect();
    is_true("massif", &terrain, &places);
}
