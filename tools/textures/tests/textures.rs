//! What every layer must keep: no seam, plausible reflectance, no blotch that
//! betrays the tile, normals of the height, and the same bytes every time.

use std::path::Path;

use dolomite_textures::atlas::{ALBEDO_HEIGHT, Atlas, NORMAL_ROUGHNESS};
use dolomite_textures::colour::{decode_byte, luminance};
use dolomite_textures::error::TextureError;
use dolomite_textures::layers::Layer;
use dolomite_textures::plane::Plane;
use dolomite_textures::surface::TILE_METRES;
use dolomite_textures::tile::slopes;
use dolomite_textures::{SEED, SIZE, generate};

/// The bytes of a committed image.
fn committed(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/textures");
    let image = image::open(folder.join(name)).expect("the image is in the repository");
    assert_eq!(image.width() as usize, SIZE);
    assert_eq!(image.height() as usize, SIZE * Layer::ALL.len());
    image.into_rgba8().into_raw()
}

/// A layer as a renderer reads it from the committed images.
struct Decoded {
    layer: Layer,
    /// Linear.
    albedo: [Plane; 3],
    luminance: Plane,
    height: Plane,
    /// Normal along +u and +v.
    normal: [Plane; 2],
    roughness: Plane,
    occlusion: Plane,
}

fn layers() -> Vec<Decoded> {
    let (colours, normals) = (committed(ALBEDO_HEIGHT), committed(NORMAL_ROUGHNESS));
    let decode = |layer: Layer| {
        let start = layer as usize * SIZE * SIZE;
        let texel = |bytes: &[u8], i: usize, c: usize| bytes[4 * (start + i) + c];
        let linear = |bytes: &[u8], c: usize| {
            Plane::from_index(SIZE, |i| f32::from(texel(bytes, i, c)) / 255.0)
        };
        let albedo =
            [0, 1, 2].map(|c| Plane::from_index(SIZE, |i| decode_byte(texel(&colours, i, c))));
        let normal = [0, 1].map(|c| {
            let bytes = linear(&normals, c);
            Plane::from_index(SIZE, |i| 2.0 * bytes.values()[i] - 1.0)
        });
        Decoded {
            layer,
            luminance: Plane::from_index(SIZE, |i| {
                luminance([0, 1, 2].map(|c| albedo[c].values()[i]))
            }),
            albedo,
            height: linear(&colours, 3),
            normal,
            roughness: linear(&normals, 2),
            occlusion: linear(&normals, 3),
        }
    };
    Layer::ALL.map(decode).into()
}

/// How far the step over the seam between the last and the first column lies
/// from the steps between neighbouring columns inside, in their standard
/// deviations. A step is the mean absolute difference of two columns.
fn seam(width: usize, height: usize, value: impl Fn(usize, usize) -> f32) -> f32 {
    let step = |a: usize, b: usize| {
        (0..height)
            .map(|y| (value(a, y) - value(b, y)).abs())
            .sum::<f32>()
            / height as f32
    };
    let inside: Vec<f32> = (1..width).map(|x| step(x - 1, x)).collect();
    let mean = inside.iter().sum::<f32>() / inside.len() as f32;
    let variance = inside.iter().map(|s| (s - mean) * (s - mean)).sum::<f32>();
    (step(width - 1, 0) - mean) / (variance / inside.len() as f32).sqrt()
}

/// The worst seam of a plane cut to `size` texels, over both axes.
fn worst_seam(plane: &Plane, size: usize) -> f32 {
    let at = |x: usize, y: usize| plane.wrapped(x.cast_signed(), y.cast_signed());
    seam(size, size, at).max(seam(size, size, |x, y| at(y, x)))
}

/// 511 steps inside a tile spread to some 3 standard deviations; a real seam
/// lies at 6 and more (the test after this one).
const SEAM: f32 = 4.5;

#[test]
fn layers_have_no_seam() {
    for d in layers() {
        let planes = [
            &d.luminance,
            &d.height,
            &d.normal[0],
            &d.normal[1],
            &d.roughness,
            &d.occlusion,
        ];
        for (number, plane) in planes.into_iter().enumerate() {
            let seam = worst_seam(plane, SIZE);
            assert!(seam < SEAM, "{} plane {number}: {seam}", d.layer.name());
        }
    }
}

#[test]
fn a_cut_that_is_not_periodic_fails_the_seam_check() {
    // Part of a tile is the same material without its period.
    for d in layers() {
        let worst = worst_seam(&d.height, SIZE * 3 / 4);
        assert!(worst > 1.3 * SEAM, "{}: {worst}", d.layer.name());
    }
}

#[test]
fn mean_reflectance_is_that_of_the_material() {
    // Linear luminance: dry sand, meadow, weathered dolomite, settled snow,
    // stones with soil.
    let ranges = [
        (0.30, 0.40),
        (0.05, 0.12),
        (0.15, 0.25),
        (0.80, 0.90),
        (0.12, 0.20),
    ];
    for (d, (low, high)) in layers().iter().zip(ranges) {
        let mean = d.luminance.mean();
        assert!((low..=high).contains(&mean), "{}: {mean}", d.layer.name());
        // The mean the layer states, to the rounding of the bytes (half a
        // code of sRGB, which over many texels averages out).
        for (plane, stated) in d.albedo.iter().zip(d.layer.look().mean_albedo) {
            assert!(
                (plane.mean() / stated - 1.0).abs() < 0.01,
                "{}",
                d.layer.name()
            );
        }
    }
}

#[test]
fn no_albedo_is_beyond_what_matter_reflects() {
    for d in layers() {
        for plane in &d.albedo {
            let [low, high] = plane.quantiles(0.0, 1.0);
            // 0.01 and 0.97, and half a code of sRGB.
            assert!(
                low > 0.009 && high < 0.975,
                "{}: {low} {high}",
                d.layer.name()
            );
        }
    }
}

#[test]
fn heights_fill_the_whole_range() {
    for d in layers() {
        assert_eq!(
            d.height.quantiles(0.0, 1.0),
            [0.0, 1.0],
            "{}",
            d.layer.name()
        );
        // And use it, not only reach it.
        let [low, high] = d.height.quantiles(0.1, 0.9);
        assert!(high - low > 0.2, "{}: {low} {high}", d.layer.name());
    }
}

#[test]
fn roughness_and_occlusion_are_plausible() {
    for d in layers() {
        let rough = d.roughness.mean();
        assert!((0.5..1.0).contains(&rough), "{}: {rough}", d.layer.name());
        let [low, _] = d.roughness.quantiles(0.0, 1.0);
        assert!(low > 0.2, "{}: {low}", d.layer.name());
        let [deep, open] = d.occlusion.quantiles(0.01, 0.99);
        assert!(
            open > 0.9 && deep < open && deep > 0.0,
            "{}: {deep} {open}",
            d.layer.name()
        );
    }
}

/// Standard deviation of the means over squares of a quarter of a tile, at
/// 16x16 places, over the mean of all.
fn blotchiness(plane: &Plane) -> f32 {
    let n = plane.size();
    let (side, stride) = (n / 4, n / 16);
    let mean = plane.mean();
    let mut variance = 0.0;
    for place in 0..256 {
        let (x0, y0) = (stride * (place % 16), stride * (place / 16));
        let mut sum = 0.0_f64;
        for k in 0..side * side {
            let (x, y) = (x0 + k % side, y0 + k / side);
            sum += f64::from(plane.wrapped(x.cast_signed(), y.cast_signed()));
        }
        let d = (sum / (side * side) as f64) as f32 - mean;
        variance += d * d / 256.0;
    }
    variance.sqrt() / mean
}

#[test]
fn no_blotches_betray_the_tile() {
    for d in layers() {
        // 2% in luminance is about the least contrast the eye sees.
        let spread = blotchiness(&d.luminance);
        assert!(spread < 0.02, "{}: {spread}", d.layer.name());
    }
}

#[test]
fn the_check_for_blotches_sees_a_gentle_wave() {
    // One wave per tile of a tenth of the mean.
    let wave = Plane::from_index(128, |i| {
        0.3 + 0.03 * dolomite_textures::wave::sin_turns((i % 128) as f32 / 128.0)
    });
    assert!(blotchiness(&wave) > 0.05);
}

/// Correlation of two planes of mean 0, and the factor that brings the first
/// nearest to the second.
fn fit(a: &Plane, b: &Plane) -> [f64; 2] {
    let dot = |a: &Plane, b: &Plane| -> f64 {
        let pairs = a.values().iter().zip(b.values());
        pairs.map(|(&a, &b)| f64::from(a) * f64::from(b)).sum()
    };
    let (aa, bb, ab) = (dot(a, a), dot(b, b), dot(a, b));
    [ab / (aa * bb).sqrt(), ab / aa]
}

#[test]
fn normals_are_those_of_the_height() {
    for d in layers() {
        let scale = d.layer.look().relief * SIZE as f32 / TILE_METRES;
        let rise = slopes(&d.height, scale);
        let expected = [0, 1].map(|c| {
            Plane::from_index(SIZE, |i| {
                let [x, y] = [0, 1].map(|c| rise[c].values()[i]);
                -[x, y][c] / (1.0 + x * x + y * y).sqrt()
            })
        });
        let blurred = |planes: &[Plane; 2]| [0, 1].map(|c| planes[c].blurred(1.5));
        // The normals come from samples within the texel, the differences here
        // from heights two texels apart and rounded to bytes: they agree once
        // detail at the limit of the image is blurred, least where blades of
        // a texel's width stand (0.92); a wrong sign, axis or scale is far off.
        let (expected, normals) = (blurred(&expected), blurred(&d.normal));
        let name = d.layer.name();
        for (axis, expected) in expected.iter().enumerate() {
            let [correlation, factor] = fit(expected, &normals[axis]);
            assert!(correlation > 0.9, "{name} axis {axis}: {correlation}");
            // Detail that only one of them sees draws the fit off 1.
            assert!(
                (0.75..1.25).contains(&factor),
                "{name} axis {axis}: {factor}"
            );
            // Slanted ripples tie the two axes to each other, but less.
            let [crossed, _] = fit(expected, &normals[1 - axis]);
            assert!(crossed.abs() < 0.9, "{name} axis {axis}: {crossed}");
        }
    }
}

#[test]
fn layers_depend_on_the_seed_and_nothing_else() {
    let make = |seed| {
        generate(Layer::Scree, 64, seed)
            .expect("64 is supported")
            .to_tile()
    };
    assert_eq!(make(1), make(1));
    assert_ne!(make(1).albedo_height, make(2).albedo_height);
}

#[test]
fn the_committed_images_are_what_the_program_makes() {
    let atlas = Atlas::stack(&Layer::ALL.map(|layer| {
        generate(layer, SIZE, SEED)
            .expect("the committed size is supported")
            .to_tile()
    }));
    let images = Atlas {
        size: SIZE,
        albedo_height: committed(ALBEDO_HEIGHT),
        normal_roughness: committed(NORMAL_ROUGHNESS),
    };
    assert_eq!(atlas.hash(), images.hash(), "the images must be made again");
}

#[test]
fn sizes_that_are_not_supported_are_refused() {
    for size in [0, 32, 100, 511, 4096, usize::MAX] {
        let error = generate(Layer::Sand, size, 1).expect_err("not a supported size");
        assert!(matches!(error, TextureError::Size { size: named } if named == size));
    }
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let atlas = Atlas {
        size: 1,
        albedo_height: vec![0; 20],
        normal_roughness: vec![0; 20],
    };
    // A file stands where the folder should be.
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml/textures");
    let error = atlas.write(&path).expect_err("a file is in the way");
    assert!(matches!(error, TextureError::Folder { .. }), "{error}");
    assert!(error.to_string().contains("Cargo.toml"));
}
