//! Heights and slopes of a terrain of every kind of source, against the f32 CPU reference. An implementation may
//! fuse and reorder, so that they are held by bounds.

use bevy::math::DVec2;
use bytemuck::{bytes_of, cast_slice};
use dolomite_terrain::{
    Filter, Fractal, GroundPoint, GroundRect, HeightMap, Layer, PermutationNoise, Source, Terrain,
    TerrainData,
};
use dolomite_testkit::random::Random;

use super::CapsuleError;
use super::builder::Builder;
use super::format::{BindingKind, Capsule, Command, Field, FieldType, From, Step};

/// Places that are asked.
const PLACES: usize = 4096;

/// Units in the last place that a height may be off, of the sources' size.
const ULP: f64 = 4.0;

/// Sum of the sources' greatest heights, metres, and of their greatest slopes.
const SIZES: [f32; 2] = [1024.0, 8.0];

fn terrain() -> Terrain {
    let samples: Vec<f32> = (0..60 * 50)
        .map(|k| 200.0 + ((k * 7919) % 101) as f32)
        .collect();
    let map = HeightMap::new(
        60,
        50,
        samples,
        DVec2::new(-900.0, -800.0),
        DVec2::new(32.0, 32.0),
        Filter::Bicubic,
    );
    let fractal = Fractal {
        amplitude: 500.0,
        wavelength: 1000.0,
        octaves: 8,
        seed: 7,
        ..Fractal::default()
    };
    let layers = [
        Source::Fractal(fractal),
        Source::Permutation(PermutationNoise::default()),
        Source::Map(map.expect("60 x 50 samples")),
    ];
    Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 1e7),
        layers: layers
            .into_iter()
            .map(|source| Layer { source, mask: None })
            .collect(),
        base: 0.0,
        sea_level: None,
    })
    .expect("in range")
}

/// Heights at places up to 10 km away.
///
/// # Errors
/// If the shader is wrong.
///
/// # Panics
/// Never: the terrain is in range.
pub fn capsule(name: &str, about: &str, seed: u32) -> Result<Capsule, CapsuleError> {
    let terrain = terrain();
    let data = terrain.gpu();
    let mut random = Random::new(seed);
    let mut places = || {
        let at = DVec2::new(random.signed_unit(), random.signed_unit());
        GroundPoint::new(at * 1e4)
    };
    let places: Vec<GroundPoint> = (0..PLACES).map(|_| places()).collect();
    let expected: Vec<[f32; 4]> = places
        .iter()
        .map(|place| {
            let height = terrain.sample(*place);
            [height.value, height.gradient.x, height.gradient.y, 1.0]
        })
        .collect();
    let mut builder = Builder::new(name, about);
    let module = dolomite_shaders::compose("terrain/probe.wgsl", &[])?;
    let module = builder.module("terrain/probe.wgsl", &[], &module)?;
    let read = BindingKind::ReadOnlyStorage;
    let layouts = [
        builder.layout(&[read, BindingKind::Storage]),
        builder.layout(&[read, read, BindingKind::Uniform]),
    ];
    let pipeline = builder.pipeline(module, "probe", &layouts);
    let asked = builder.buffer("places", cast_slice(&places));
    let found = builder.filled("heights", PLACES as u64 * 16, 0xAB);
    let words = [
        builder.buffer("layers", cast_slice(&data.layers)),
        builder.buffer("data", cast_slice(&data.data)),
        builder.buffer("terrain", bytes_of(&data.uniform)),
    ];
    let groups = vec![
        builder.group(layouts[0], &[asked, found]),
        builder.group(layouts[1], &words),
    ];
    let steps = vec![Step {
        pipeline,
        groups,
        dispatch: Some([(PLACES as u32).div_ceil(64), 1, 1]),
        indirect: None,
    }];
    builder.command(Command::Pass { steps });
    let field = |name: &str, at, count, ty| Field {
        name: name.to_owned(),
        at,
        count,
        ty,
    };
    let number = |scale| FieldType::F32 { ulp: ULP, scale };
    let fields = vec![
        field("height", 0, 1, number(SIZES[0])),
        field("slope", 4, 2, number(SIZES[1])),
        field("answered", 12, 1, FieldType::U32),
    ];
    let at = (found, 0, 16);
    builder.check(
        "heights",
        at,
        fields,
        cast_slice(&expected),
        From::CpuReference,
    );
    Ok(builder.finish())
}
