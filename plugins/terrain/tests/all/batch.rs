//! Batches give the bits of single points, on one core and on all, whatever the instruction set.

use crate::support;

use bevy::math::DVec2;
use bevy::tasks::TaskPoolBuilder;
use dolomite_terrain::{
    BatchError, Filter, Fractal, GroundPoint, Height, HeightMap, HeightTile, Hill, Layer, Mask,
    PermutationNoise, Planes, Source, Terrain,
};
use support::{Random, SUMS, WARP, of_fractal, plain, terrain};

struct Buffers([Vec<f32>; 3]);

impl Buffers {
    fn new(count: usize) -> Self {
        Self([(); 3].map(|()| vec![f32::NAN; count]))
    }

    fn planes(&mut self) -> Planes<'_> {
        let [value, dx, dz] = &mut self.0;
        Planes { value, dx, dz }
    }

    fn bits(&self) -> [Vec<u32>; 3] {
        [0, 1, 2].map(|k: usize| self.0[k].iter().map(|v| v.to_bits()).collect())
    }
}

fn bits(height: Height) -> [u32; 3] {
    [height.value, height.gradient.x, height.gradient.y].map(f32::to_bits)
}

/// Every kind of source, with and without masks.
fn mixed() -> Terrain {
    let samples = (0..40 * 30).map(|k| ((k * 7919) % 101) as f32).collect();
    let map = HeightMap::new(
        40,
        30,
        samples,
        DVec2::splat(-300.0),
        DVec2::splat(21.0),
        Filter::Bicubic,
    );
    let fractal = |sum, warp| {
        Source::Fractal(Fractal {
            sum,
            warp,
            octaves: 6,
            ..Fractal::default()
        })
    };
    let masked = |source, low, high| Layer {
        source,
        mask: Some(Mask { low, high }),
    };
    let mut layers = vec![
        plain(fractal(SUMS[0], None)),
        plain(Source::Map(map.expect("valid"))),
    ];
    layers.push(masked(fractal(SUMS[1], None), 0.0, 60.0));
    layers.push(masked(fractal(SUMS[3], Some(WARP)), 80.0, -20.0));
    layers.push(plain(Source::Hill(Hill {
        centre: DVec2::new(20.0, 10.0),
        radius: 90.0,
        height: 30.0,
    })));
    layers.push(plain(Source::Permutation(PermutationNoise::default())));
    terrain(1000.0, 12.5, layers)
}

#[test]
fn tiles_have_the_bits_of_single_points() {
    let mut random = Random(11);
    let mut terrains: Vec<Terrain> = Vec::new();
    for sum in SUMS {
        for warp in [None, Some(WARP)] {
            terrains.push(of_fractal(Fractal {
                sum,
                warp,
                octaves: 7,
                lacunarity: 2.07,
                ..Fractal::default()
            }));
        }
    }
    terrains.push(mixed());
    for terrain in &terrains {
        // Widths around the strip of 64, spacings from far below a cell to many cells.
        for (width, height, spacing) in [(1, 1, 1.0), (63, 3, 0.01), (65, 5, 3.7), (130, 4, 900.0)]
        {
            let origin = GroundPoint::new(random.place(1e6));
            let tile = HeightTile {
                origin,
                spacing: DVec2::new(spacing, spacing * 0.7),
                width,
                height,
            };
            let mut one = Buffers::new(tile.len());
            terrain.fill_tile(&tile, one.planes()).expect("right size");
            for row in 0..height {
                for column in 0..width {
                    let at = row * width + column;
                    let found = [0, 1, 2].map(|k: usize| one.0[k][at].to_bits());
                    assert_eq!(
                        found,
                        bits(terrain.sample(tile.point(column, row))),
                        "{column} {row}"
                    );
                }
            }
        }
    }
}

#[test]
fn all_cores_give_the_bits_of_one() {
    let terrain = mixed();
    let tile = HeightTile {
        origin: GroundPoint::new(DVec2::new(-400.0, 77.0)),
        spacing: DVec2::splat(1.5),
        width: 333,
        height: 130,
    };
    let (mut one, mut all) = (Buffers::new(tile.len()), Buffers::new(tile.len()));
    terrain.fill_tile(&tile, one.planes()).expect("right size");
    terrain
        .fill_tile_parallel(&tile, all.planes())
        .expect("right size");
    assert_eq!(one.bits(), all.bits());
    let pool = TaskPoolBuilder::new().num_threads(2).build();
    let mut named = Buffers::new(tile.len());
    terrain
        .fill_tile_on(&pool, &tile, named.planes())
        .expect("right size");
    assert_eq!(one.bits(), named.bits());
    assert!(
        one.0.iter().flatten().all(|v| v.is_finite()),
        "every sample is written"
    );
}

#[test]
fn lists_have_the_bits_of_single_points() {
    let mut random = Random(12);
    let terrain = mixed();
    let points: Vec<_> = (0..1500)
        .map(|_| GroundPoint::new(random.place(300.0)))
        .collect();
    let mut out = Buffers::new(points.len());
    terrain
        .fill_points(&points, out.planes())
        .expect("right size");
    for (at, &point) in points.iter().enumerate() {
        assert_eq!(
            [0, 1, 2].map(|k: usize| out.0[k][at].to_bits()),
            bits(terrain.sample(point))
        );
    }
}

#[test]
fn planes_of_the_wrong_size_are_refused() {
    let terrain = of_fractal(Fractal::default());
    let tile = HeightTile {
        origin: GroundPoint::default(),
        spacing: DVec2::ONE,
        width: 4,
        height: 4,
    };
    let mut short = Buffers::new(15);
    let error = BatchError {
        expected: 16,
        found: 15,
    };
    assert_eq!(terrain.fill_tile(&tile, short.planes()), Err(error));
    assert_eq!(
        terrain.fill_tile_parallel(&tile, short.planes()),
        Err(error)
    );
    let empty = HeightTile { width: 0, ..tile };
    assert_eq!(terrain.fill_tile(&empty, Buffers::new(0).planes()), Ok(()));
    assert_eq!(terrain.fill_points(&[], Buffers::new(0).planes()), Ok(()));
}
