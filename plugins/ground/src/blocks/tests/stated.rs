//! What is stated of grounds that are made to be missed, held to heights in f64 between the samples of blocks: how far what
//! is drawn at a place is off, and the interval of every block about it.
//!
//! Intervals hold. The error at a place does not everywhere: a vertex errs at most by a share of what it needs, and is cut to it
//! from above, so that what coarse blocks know too little of is stated too small in fine ones. How much farther the ground is
//! off than is stated is what was found, and no more.

use bevy::math::{DVec2, IVec2};
use dolomite_terrain::{
    Edit, EditKind, Filter, Fractal, GroundPoint, HeightMap, Hill, Layer, Mask, PermutationNoise,
    Source, Terrain, TerrainEdits,
};
use dolomite_testkit::missed::{islets, massif, missed, on_lattice};

use super::eyes::height;
use super::grounds::{Camera, Random, layer, of};
use crate::blocks::choose::{Choice, Limits, settle};
use crate::blocks::kept::KeptBlocks;
use crate::blocks::locate::locate;
use crate::blocks::place::BlockPlace;

/// Tolerances of the views, pixels of a picture 180 pixels high: from ground that is nearly all roots to fine ground.
const TOLERANCES: [f32; 4] = [60.0, 15.0, 4.0, 1.5];
/// Places that stand out, and as many at random.
const PLACES: usize = 40;

/// What was found of a ground.
#[derive(Debug, Default)]
struct Found {
    places: usize,
    blocks: usize,
    /// The largest of what is off over what is stated, both, metres, and where.
    error: (f64, f64, f64, DVec2),
    /// The farthest that the ground is out of an interval, metres.
    beyond: f64,
}

impl Found {
    fn look(&mut self, blocks: &KeptBlocks, choice: &Choice, place: DVec2) {
        let truth = height(blocks.terrain(), place);
        let at = GroundPoint::new(place);
        let found = locate(blocks, choice, at).expect("on the ground");
        let off = (found.height.max(f64::from(blocks.sea())) - truth).abs();
        let ratio = off / found.bound;
        self.places += 1;
        if ratio > self.error.0 {
            self.error = (ratio, off, found.bound, place);
        }
        let line = blocks.lattice.coordinates(at);
        for slot in blocks.used() {
            if holds(blocks.place(slot), line) {
                let head = &blocks.block(slot).head;
                let (low, high) = (f64::from(head.low), f64::from(head.high));
                self.beyond = self.beyond.max(low - truth).max(truth - high);
                self.blocks += 1;
            }
        }
    }
}

fn holds(place: BlockPlace, line: DVec2) -> bool {
    let cell = place.cell();
    let off = (line - cell.centre.as_dvec2()).abs();
    off.cmple(DVec2::splat(f64::from(cell.half))).all()
}

/// The places of a grid where the drawn surface is farthest from the mean of those around it.
fn summits(terrain: &Terrain) -> Vec<DVec2> {
    const SIDE: i32 = 200;
    let extent = terrain.extent();
    let step = extent.size() / f64::from(SIDE);
    let place = |at: IVec2| extent.min + step * (at.as_dvec2() + 0.5);
    let grid = (0..SIDE * SIDE).map(|k| IVec2::new(k % SIDE, k / SIDE));
    let near: Vec<f64> = grid.clone().map(|at| height(terrain, place(at))).collect();
    let at = |at: IVec2| {
        let at = at.clamp(IVec2::ZERO, IVec2::splat(SIDE - 1));
        near[(at.y * SIDE + at.x) as usize]
    };
    let alone = |of: IVec2| {
        let around = [IVec2::X, IVec2::NEG_X, IVec2::Y, IVec2::NEG_Y].map(|d| at(of + 4 * d));
        (at(of) - 0.25 * around.iter().sum::<f64>()).abs()
    };
    let mut order: Vec<_> = grid.map(|at| (alone(at), place(at))).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    order.into_iter().take(PLACES).map(|(_, at)| at).collect()
}

/// Looks at `hints`, at what stands out, and anywhere; from afar and from close to some of them.
fn search(terrain: &Terrain, hints: &[DVec2]) -> Found {
    let mut blocks = KeptBlocks::new(terrain.clone(), 0.125);
    let extent = terrain.extent();
    let mut random = Random::new(3);
    let mut any = || extent.min + extent.size() * DVec2::new(random.unit(), random.unit());
    let mut places = hints.to_vec();
    places.extend(summits(terrain));
    let close = [places[0], any()];
    places.extend((0..PLACES).map(|_| any()));
    let mut found = Found::default();
    let side = extent.size().max_element();
    let above = Camera::at(terrain, extent.centre(), side, 0.3, -1.5);
    let beside = |xz| Camera::at(terrain, xz, 3.0, 0.7, -0.4);
    let views = TOLERANCES.map(|pixels| (above, pixels));
    let views = views.into_iter().chain(close.map(|xz| (beside(xz), 4.0)));
    for (camera, pixels) in views {
        let choice = settle(&mut blocks, &camera.bound(pixels), Limits::default());
        for &place in &places {
            found.look(&blocks, &choice, place);
        }
    }
    found
}

/// Nothing is farther off than what is stated, and nothing lies beyond an interval.
fn is_true(name: &str, terrain: &Terrain, hints: &[DVec2]) {
    is_within(name, terrain, hints, 1.0);
}

/// The same with so many times what is stated.
fn is_within(name: &str, terrain: &Terrain, hints: &[DVec2], most: f64) {
    let found = search(terrain, hints);
    println!("{name}: {found:?}");
    assert!(found.error.0 <= most, "{name}: {found:?}");
    // Of heights in f32.
    assert!(found.beyond <= 1e-6, "{name}: {found:?}");
    assert!(
        found.places > 400 && found.blocks > 400,
        "{name}: {found:?}"
    );
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

/// Lower ground everywhere.
fn sunk(depth: f32) -> Layer {
    hill([0.0, 0.0], 1e6, -depth)
}

const AT: [[f64; 2]; 3] = [[38.4, -25.6], [-301.3, 207.7], [130.9, 411.1]];

#[test]
fn islets_narrower_than_samples_are_stated() {
    // Of noise that is under water nearly everywhere.
    for (depth, amplitude, wavelength) in [(4.0, 8.0, 60.0), (40.0, 90.0, 150.0), (0.5, 1.0, 5.0)] {
        let layers = vec![sunk(depth), layer(noise(4, 8, amplitude, wavelength))];
        is_true("noise", &of(1024.0, Some(0.0), layers), &[]);
    }
    is_true("islets", &islets(), &[]);
    // Hills, of which samples of large cells meet none.
    let mut layers = AT.map(|at| hill(at, 3.0, 30.0)).to_vec();
    layers.push(sunk(20.0));
    let hints = AT.map(DVec2::from);
    is_true("hills", &of(1024.0, Some(0.0), layers), &hints);
}

#[test]
fn ground_is_stated_whose_samples_all_stand_at_the_height_of_the_sea() {
    is_true("wet", &on_lattice(Some(0.0)), &[]);
    is_true("dry", &on_lattice(None), &[]);
}

#[test]
fn noise_is_stated_whose_lattice_the_samples_stand_on() {
    let default = layer(Source::Permutation(PermutationNoise::default()));
    is_true("permutation", &of(1600.0, None, vec![default]), &[]);
    // Of the offsets of 400 seeds those nearest to a lattice point, and nearest to a line.
    let near = |seed: &u32| {
        let terrain = of(1024.0, None, vec![layer(noise(*seed, 1, 1.0, 16.0))]);
        let at = (0..9).map(|k| height(&terrain, DVec2::splat(16.0 * f64::from(k))).abs());
        at.fold(0.0, f64::max)
    };
    let mut seeds: Vec<u32> = (0..400).collect();
    seeds.sort_by(|a, b| near(a).total_cmp(&near(b)));
    for seed in &seeds[..2] {
        let layers = vec![layer(noise(*seed, 1, 5.0, 16.0))];
        is_true("one octave", &of(1024.0, None, layers), &[]);
    }
}

#[test]
fn noise_of_high_frequency_is_stated() {
    for (wavelength, most) in [(0.5, 1.05), (3.3, 1.18)] {
        let layers = vec![layer(noise(7, 1, 2.0, wavelength))];
        is_within("one octave", &of(700.0, None, layers), &[], most);
    }
    let rough = Source::Fractal(Fractal {
        octaves: 9,
        gain: 0.8,
        amplitude: 10.0,
        wavelength: 90.0,
        ..Fractal::default()
    });
    is_true("rough", &of(700.0, None, vec![layer(rough)]), &[]);
}

/// A mask that opens within little height is a cliff wherever the ground below comes to that height.
#[test]
fn cliffs_are_stated() {
    for (width, most) in [(10.0, 1.0), (1.0, 1.42), (0.01, 1.79)] {
        let mut plateau = hill([0.0, 0.0], 1e6, 40.0);
        plateau.mask = Some(Mask {
            low: 2.0,
            high: 2.0 + width,
        });
        let layers = vec![layer(noise(9, 6, 30.0, 300.0)), plateau];
        is_within("cliffs", &of(1024.0, None, layers), &[], most);
    }
}

#[test]
fn peaks_that_stand_alone_are_stated() {
    let hints = AT.map(DVec2::from);
    let ground = || layer(noise(2, 7, 20.0, 200.0));
    for (radius, most) in [(0.4, 3.32), (3.0, 1.7), (20.0, 1.0)] {
        let mut layers = vec![ground()];
        layers.extend(AT.map(|at| hill(at, radius, 50.0)));
        is_within("hills", &of(1024.0, None, layers), &hints, most);
    }
    // Which open a mask.
    let mut layers = AT.map(|at| hill(at, 3.0, 4.0)).to_vec();
    let mut behind = hill([0.0, 0.0], 1e6, 80.0);
    behind.mask = Some(Mask {
        low: 0.5,
        high: 3.5,
    });
    layers.push(behind);
    is_within("masks", &of(1024.0, None, layers), &hints, 1.82);
    // Put there by a brush.
    let flat = of(1024.0, None, vec![ground()]);
    let mut edits = TerrainEdits::new(&flat).expect("fits");
    let mut edited = flat;
    for place in hints {
        let edit = Edit {
            kind: EditKind::Raise,
            place,
            radius: 1.6,
            strength: 30.0,
            falloff: 1.0,
        };
        edited = edits.apply(&edited, &edit).expect("valid").terrain;
    }
    is_within("edits", &edited, &hints, 1.93);
}

#[test]
fn a_map_of_one_spike_is_stated() {
    let (side, spike) = (257_u32, [77_u32, 130]);
    let (origin, spacing) = (DVec2::splat(-512.0), DVec2::splat(4.0));
    let at = origin + spacing * DVec2::new(f64::from(spike[0]), f64::from(spike[1]));
    for filter in [Filter::Bilinear, Filter::Bicubic] {
        for sea in [None, Some(0.0)] {
            let is_spike = |k: u32| [k % side, k / side] == spike;
            let samples = (0..side * side).map(|k| if is_spike(k) { 40.0 } else { 0.0 });
            let map = HeightMap::new(side, side, samples.collect(), origin, spacing, filter);
            let map = layer(Source::Map(map.expect("valid")));
            let layers = [Some(map), sea.map(|_| sunk(3.0))];
            let layers = layers.into_iter().flatten().collect();
            is_within("spike", &of(1000.0, sea, layers), &[at], 1.05);
        }
    }
}

#[test]
fn a_massif_whose_summits_samples_miss_is_stated() {
    let terrain = massif();
    let places = missed(&terrain, 1000, 60.0, 1);
    let places: Vec<DVec2> = places.iter().map(|missed| missed.place).take(40).collect();
    is_true("massif", &terrain, &places);
}
