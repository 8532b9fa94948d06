//! A ground and views for the tests of the passes in blocks.

use bevy::math::{DMat4, DQuat, DVec2, DVec3, EulerRot, IVec2, Mat4, Quat, UVec2, Vec3, Vec4};
use bytemuck::Zeroable;
use dolomite_ground::blocks::kept::lattice_of;
use dolomite_ground::detail::layout::DetailParams;
use dolomite_ground::detail::{CullView, DetailGround, DetailView, Lens, Metric, TerrainLod};
use dolomite_terrain::{
    Filter, Fractal, GroundRect, HeightMap, Hill, Layer, Mask, Source, Sum, Terrain, TerrainData,
    Warp,
};
use dolomite_testkit::blocks::BlockRun;
use std::collections::HashSet;

/// Hills on rough ground, a sea, at 10⁵ m from the origin.
pub fn terrain() -> Terrain {
    let fractal = |seed, octaves, amplitude, wavelength| {
        Source::Fractal(Fractal {
            seed,
            octaves,
            amplitude,
            wavelength,
            ..Fractal::default()
        })
    };
    let centre = DVec2::new(1e5, -1e5);
    Terrain::new(TerrainData {
        extent: GroundRect::new(
            centre - DVec2::new(2048.0, 1024.0),
            centre + DVec2::new(2048.0, 1024.0),
        ),
        layers: vec![
            Layer {
                source: fractal(1, 10, 120.0, 900.0),
                mask: None,
            },
            Layer {
                source: Source::Hill(Hill {
                    centre: centre + DVec2::new(300.0, 100.0),
                    radius: 20.0,
                    height: 30.0,
                }),
                mask: None,
            },
            Layer {
                source: fractal(2, 4, 3.0, 40.0),
                mask: Some(Mask {
                    low: 5.0,
                    high: 40.0,
                }),
            },
        ],
        base: 10.0,
        sea_level: Some(0.0),
    })
    .expect("valid")
}

pub fn view(terrain: &Terrain, yaw: f32, above: f32, metric: Metric) -> DetailView {
    let xz = DVec2::new(1e5 + 37.25, -1e5 - 110.5);
    let anchor = xz.floor();
    let ground = terrain.sample_f64(xz).height.max(0.0) as f32;
    let at = (xz - anchor).as_vec2();
    let eye = Vec3::new(at.x, ground + above, at.y);
    let rotation = Quat::from_euler(EulerRot::YXZ, yaw, -0.15, 0.0);
    let (fov, aspect, near) = (1.0_f32, 16.0 / 9.0, 0.1);
    let tan = bevy::math::ops::tan(fov / 2.0);
    let clip = Mat4::perspective_infinite_reverse_rh(fov, aspect, near)
        * Mat4::from_rotation_translation(rotation, eye).inverse();
    let row = |k| clip.row(k);
    let planes = [
        row(3) + row(0),
        row(3) - row(0),
        row(3) + row(1),
        row(3) - row(1),
        row(3) - row(2),
        Vec4::W,
    ];
    let mut view = DetailView::zeroed();
    view.planes = planes.map(|plane| plane.to_array());
    view.eye = eye.to_array();
    view.scale = 540.0 / 2.0 / tan;
    view.right = (rotation * Vec3::X).to_array();
    view.up = (rotation * Vec3::Y).to_array();
    view.forward = (rotation * Vec3::NEG_Z).to_array();
    view.near = near;
    view.cos_corner = 1.0 / (1.0 + tan * tan * (1.0 + aspect * aspect)).sqrt();
    view.anchor = IVec2::new(anchor.x as i32, anchor.y as i32).to_array();
    view.set_metric(&TerrainLod {
        metric,
        ..TerrainLod::default()
    });
    view
}

/// A view of 640 x 360 from so high above the ground at a place.
pub fn view_at(
    terrain: &Terrain,
    xz: DVec2,
    above: f64,
    turn: [f64; 2],
    pixels: f32,
) -> DetailView {
    let sea = terrain.sea_level().map_or(f64::NEG_INFINITY, f64::from);
    let eye = DVec3::new(xz.x, terrain.sample_f64(xz).height.max(sea) + above, xz.y);
    let turn = DQuat::from_euler(EulerRot::YXZ, turn[0], turn[1], 0.0);
    let mut view = DetailView::new(
        eye,
        turn,
        Lens::Perspective(0.577),
        UVec2::new(640, 360),
        0.1,
    );
    view.set_metric(&TerrainLod {
        metric: Metric::ErrorBound { pixels },
        ..TerrainLod::default()
    });
    view
}

/// The ground of a height map alone.
pub fn of_map(extent: GroundRect, map: HeightMap) -> Terrain {
    Terrain::new(TerrainData {
        extent,
        layers: vec![Layer {
            source: Source::Map(map),
            mask: None,
        }],
        base: 0.0,
        sea_level: None,
    })
    .expect("valid")
}

/// A rough map whose samples begin so far outside of an extent, metres.
pub fn rough_map(size: u32, spacing: f64, before: f64, side: f64) -> Terrain {
    let samples = (0..size * size)
        .map(|k| {
            let (x, z) = (k % size, k / size);
            let mut h = x.wrapping_mul(0x9e37_79b9) ^ z.wrapping_mul(0x85eb_ca6b);
            h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
            let rough = (h >> 8) as f32 / (1 << 24) as f32;
            let (x, z) = (x as f32 / 17.0, z as f32 / 23.0);
            6.0 * bevy::math::ops::sin(x) * bevy::math::ops::cos(z) + 0.7 * rough
        })
        .collect();
    let origin = DVec2::splat(-0.5 * side - before);
    let spacing = DVec2::splat(spacing);
    let map = HeightMap::new(size, size, samples, origin, spacing, Filter::Bilinear);
    of_map(GroundRect::square(DVec2::ZERO, side), map.expect("valid"))
}

/// The classic scene's ground, where the shared data are.
pub fn classic() -> Option<Terrain> {
    let shared = std::env::var_os("DOLOMITE_SHARED")?;
    let file = std::path::Path::new(&shared).join("data/classic/heights_1024_f32le.raw");
    let bytes = std::fs::read(file).ok()?;
    let heights: Vec<f32> = bytes
        .as_chunks::<4>()
        .0
        .iter()
        .map(|&bytes| 100.0 * f32::from_le_bytes(bytes))
        .collect();
    let at = |k: usize| (k + 1023) & 1023;
    let metres = (0..1026 * 1026)
        .map(|k| heights[at(k / 1026) * 1024 + at(k % 1026)])
        .collect();
    let (first, spacing) = (DVec2::splat(-512.5), DVec2::ONE);
    let map = HeightMap::new(1026, 1026, metres, first, spacing, Filter::Bilinear).ok()?;
    Some(of_map(GroundRect::square(DVec2::ZERO, 1024.0), map))
}

/// A ground on the lattice that blocks have: on the samples of a map.
pub fn laid_on_samples(terrain: &Terrain, finest: f32) -> DetailGround {
    DetailGround::on(terrain.clone(), lattice_of(terrain, finest))
}

/// Choices that a view may take until it is settled.
pub const MOST: usize = 200;

pub fn params(laid: &DetailGround, view: DetailView) -> DetailParams {
    DetailParams::new(laid, view, 0, [1 << 17, 1 << 18])
}

/// Corners of triangles by their places, from the least on, to 1/1024 m: the same on CPU and GPU.
pub fn by_place(corners: impl Iterator<Item = [[f32; 3]; 3]>) -> HashSet<[[i32; 2]; 3]> {
    corners
        .map(|corners| {
            let places = corners.map(|[x, _, z]| [x, z].map(|v| (v * 1024.0).round() as i32));
            let least = (0..3).min_by_key(|&k| places[k]).expect("three");
            [0, 1, 2].map(|k| places[(least + k) % 3])
        })
        .collect()
}

/// Every edge has its counterpart, by the bits of its ends, or lies on the border of the ground of [`terrain`], all of which is
/// covered.
pub fn closed(run: &BlockRun) {
    closed_about(run, 2.0 * (4096.0 + 2048.0));
}

/// The same, with the length of the border.
pub fn closed_about(run: &BlockRun, length: f64) {
    let at = |k: u32| run.positions[k as usize].map(f32::to_bits);
    let mut edges = HashSet::new();
    for &[a, b, c] in &run.triangles {
        for edge in [(a, b), (b, c), (c, a)] {
            let edge = (at(edge.0), at(edge.1));
            assert!(edges.insert(edge), "an edge is used twice in one direction");
        }
    }
    let mut border = 0.0;
    for &(a, b) in &edges {
        if !edges.contains(&(b, a)) {
            let [a, b] = [a, b].map(|at| at.map(f32::from_bits));
            assert!(a[0] == b[0] || a[2] == b[2], "a gap at {a:?} {b:?}");
            border += f64::from((a[0] - b[0]).abs() + (a[2] - b[2]).abs());
        }
    }
    assert!((border - length).abs() < 0.02, "{border}");
}

/// What a view at the origin of its stage draws: perspective, reversed depth, one-sided.
pub fn picture_of(params: &DetailParams, size: UVec2, fov: f64, turn: DQuat) -> CullView {
    let [x, y, z] = params.view.eye.map(f64::from);
    let eye = DVec3::new(x, y - f64::from(params.anchor_height), z);
    let aspect = f64::from(size.x) / f64::from(size.y);
    let projection =
        DMat4::perspective_infinite_reverse_rh(fov, aspect, f64::from(params.view.near));
    CullView {
        clip: (projection * DMat4::from_rotation_translation(turn, eye).inverse()).as_mat4(),
        half_size: size.as_vec2() / 2.0,
        one_sided: true,
    }
}

/// An island massif, 16 384 m square, in the manner of the game's scene `mountain`: hills, ridged
/// and eroded fractals, warps, masks by height, and rough ground down to 60 cm.
pub fn mountain() -> Terrain {
    let seed = 1_u32;
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
    Terrain::new(TerrainData {
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
    .expect("valid")
}
