//! Grounds, views and oracles of the tests.

use std::collections::HashMap;

use bevy::math::{DQuat, DVec2, DVec3, EulerRot, UVec2};
use dolomite_terrain::{
    Filter, Fractal, GroundRect, HeightMap, Hill, Layer, Mask, Source, Sum, Terrain, TerrainData,
};

use crate::blocks::kept::KeptBlocks;
use crate::blocks::mesh::BlockMesh;
use crate::detail::{DetailView, Lens, Metric, TerrainLod};

pub fn of(size: f64, sea_level: Option<f32>, layers: Vec<Layer>) -> Terrain {
    Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, size),
        layers,
        base: 0.0,
        sea_level,
    })
    .expect("valid")
}

pub fn layer(source: Source) -> Layer {
    Layer { source, mask: None }
}

/// One sum of noise, 1024 m square, to wavelengths of 25 cm.
pub fn fbm() -> Terrain {
    let source = Source::Fractal(Fractal {
        octaves: 12,
        amplitude: 60.0,
        wavelength: 500.0,
        ..Fractal::default()
    });
    of(1024.0, None, vec![layer(source)])
}

/// Ridges behind a mask, a hill, and a sea with a shore.
pub fn island() -> Terrain {
    let ridges = Layer {
        source: Source::Fractal(Fractal {
            sum: Sum::Ridged,
            seed: 5,
            octaves: 9,
            amplitude: 90.0,
            wavelength: 300.0,
            ..Fractal::default()
        }),
        mask: Some(Mask {
            low: -5.0,
            high: 60.0,
        }),
    };
    let hill = Hill {
        centre: DVec2::new(30.0, -20.0),
        radius: 480.0,
        height: 90.0,
    };
    of(
        1024.0,
        Some(0.0),
        vec![
            layer(Source::Hill(hill)),
            layer(Source::Fractal(Fractal {
                seed: 3,
                octaves: 10,
                amplitude: 40.0,
                wavelength: 200.0,
                ..Fractal::default()
            })),
            ridges,
        ],
    )
}

/// A rough map of `width` × `height` samples, `spacing` apart.
pub fn map(size: UVec2, spacing: f64, origin: DVec2) -> HeightMap {
    let samples = (0..size.x * size.y)
        .map(|k| {
            let (x, z) = (k % size.x, k / size.x);
            let mut h = x.wrapping_mul(0x9e37_79b9) ^ z.wrapping_mul(0x85eb_ca6b);
            h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
            let rough = (h >> 8) as f32 / (1 << 24) as f32;
            let (x, z) = (x as f32 / 17.0, z as f32 / 23.0);
            6.0 * bevy::math::ops::sin(x) * bevy::math::ops::cos(z) + 0.7 * rough
        })
        .collect();
    let spacing = DVec2::splat(spacing);
    HeightMap::new(size.x, size.y, samples, origin, spacing, Filter::Bilinear).expect("valid")
}

/// A camera, and what is measured in its picture.
#[derive(Clone, Copy)]
pub struct Camera {
    pub eye: DVec3,
    pub turn: DQuat,
    pub tangent: f64,
    pub size: UVec2,
    pub near: f64,
}

impl Camera {
    /// 60 degrees, 320 × 180, so high above the ground at a place.
    pub fn at(terrain: &Terrain, xz: DVec2, above: f64, yaw: f64, pitch: f64) -> Self {
        let sea = terrain.sea_level().map_or(f64::NEG_INFINITY, f64::from);
        let ground = terrain.sample_f64(xz).height.max(sea);
        Self {
            eye: DVec3::new(xz.x, ground + above, xz.y),
            turn: DQuat::from_euler(EulerRot::YXZ, yaw, pitch, 0.0),
            tangent: 0.577,
            size: UVec2::new(320, 180),
            near: 0.1,
        }
    }

    pub fn view(&self, metric: Metric) -> DetailView {
        let lens = Lens::Perspective(self.tangent);
        let mut view = DetailView::new(self.eye, self.turn, lens, self.size, self.near);
        view.set_metric(&TerrainLod {
            metric,
            ..TerrainLod::default()
        });
        view
    }

    pub fn bound(&self, pixels: f32) -> DetailView {
        self.view(Metric::ErrorBound { pixels })
    }

    /// Right, up, depth.
    fn local(&self, p: DVec3) -> DVec3 {
        let local = self.turn.inverse() * (p - self.eye);
        DVec3::new(local.x, local.y, -local.z)
    }

    fn on_screen(&self, local: DVec3) -> DVec2 {
        local.truncate() / local.z * (f64::from(self.size.y) / 2.0 / self.tangent)
    }

    pub fn sees(&self, p: DVec3) -> bool {
        let local = self.local(p);
        local.z >= self.near
            && self
                .on_screen(local)
                .abs()
                .cmple(self.size.as_dvec2() / 2.0)
                .all()
    }

    /// Pixels between two points, as far as the line between them lies beyond the near plane; `None` if neither is seen.
    pub fn pixels(&self, a: DVec3, b: DVec3) -> Option<f64> {
        if !(self.sees(a) || self.sees(b)) {
            return None;
        }
        let cut = |from: DVec3, to: DVec3| {
            let (from, to) = (self.local(from), self.local(to));
            let beyond = from.z >= self.near;
            let cut = from.lerp(to, (self.near - from.z) / (to.z - from.z));
            self.on_screen(if beyond { from } else { cut })
        };
        Some(cut(a, b).distance(cut(b, a)))
    }
}

/// Cameras of many kinds over a terrain.
pub fn cameras(terrain: &Terrain) -> Vec<Camera> {
    let at = |x: f64, z: f64, above, yaw, pitch| {
        Camera::at(terrain, DVec2::new(x, z), above, yaw, pitch)
    };
    let narrow = Camera {
        tangent: 0.05,
        ..at(-200.0, 260.0, 20.0, 0.7, -0.1)
    };
    let wide = Camera {
        tangent: 1.7,
        ..at(60.0, -90.0, 1.7, 2.0, 0.0)
    };
    let down = at(120.0, 40.0, 30.0, 0.0, -1.57);
    let over = Camera {
        turn: DQuat::from_euler(EulerRot::YXZ, 1.0, -0.2, std::f64::consts::PI),
        ..down
    };
    vec![
        at(-110.0, 150.0, 1.7, -0.6, 0.0),
        at(20.0, 30.0, 0.05, 2.4, 0.0),
        at(0.0, 400.0, 220.0, 0.0, -0.6),
        narrow,
        wide,
        down,
        over,
    ]
}

/// Corners of all triangles, world metres.
pub fn triangles(blocks: &KeptBlocks, mesh: &BlockMesh) -> Vec<[DVec3; 3]> {
    let place = |k: u32| {
        let vertex = &mesh.vertices[k as usize];
        let xz = blocks.lattice.point(vertex.at).to_dvec2();
        DVec3::new(xz.x, f64::from(vertex.height), xz.y)
    };
    mesh.triangles.iter().map(|t| t.map(place)).collect()
}

/// Random numbers from 0 to 1.
pub struct Random(u64);

impl Random {
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn unit(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / (1_u64 << 31) as f64
    }
}

/// The largest error over `limit` pixels, how many are above, and how many were looked at: some `count` places
/// of drawn triangles against f64.
pub fn errors(
    terrain: &Terrain,
    camera: &Camera,
    limit: f64,
    triangles: &[[DVec3; 3]],
    count: usize,
) -> (f64, usize, usize) {
    let sea = terrain.sea_level().map_or(f64::NEG_INFINITY, f64::from);
    let mut random = Random::new(count as u64);
    let seen: Vec<_> = triangles
        .iter()
        .filter(|t| t.iter().any(|&p| camera.sees(p)))
        .collect();
    let every = (4 * seen.len()).div_ceil(count).max(1);
    let first = (random.unit() * every as f64) as usize;
    let (mut largest, mut above, mut looked) = (0.0_f64, 0, 0);
    for &&[a, b, c] in seen.iter().skip(first).step_by(every) {
        let (mut u, mut v) = (random.unit(), random.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let places = [
            (a + b + c) / 3.0,
            (a + b) / 2.0,
            (b + c) / 2.0,
            a + (b - a) * u + (c - a) * v,
        ];
        for drawn in places {
            let height = terrain.sample_f64(DVec2::new(drawn.x, drawn.z)).height;
            let truth = DVec3::new(drawn.x, height.max(sea), drawn.z);
            let drawn = drawn.with_y(drawn.y.max(sea));
            if let Some(pixels) = camera.pixels(truth, drawn) {
                looked += 1;
                above += usize::from(pixels > limit);
                largest = largest.max(pixels / limit);
            }
        }
    }
    (largest, above, looked)
}

/// What is wrong with a mesh: edges that only one triangle has though they lie inside, edges that two have the same
/// way round, vertices at one place with different heights.
pub fn faults(blocks: &KeptBlocks, mesh: &BlockMesh) -> [usize; 3] {
    let mut heights = HashMap::new();
    let mut differ = 0;
    for vertex in &mesh.vertices {
        let bits = [
            vertex.height,
            vertex.bed,
            vertex.gradient.x,
            vertex.gradient.y,
        ]
        .map(|x| x.to_bits());
        differ += usize::from(*heights.entry(vertex.at.to_array()).or_insert(bits) != bits);
    }
    let mut edges: HashMap<_, usize> = HashMap::new();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|k| mesh.vertices[k as usize].at.to_array());
        for edge in [(a, b), (b, c), (c, a)] {
            *edges.entry(edge).or_default() += 1;
        }
    }
    let twice = edges.values().filter(|count| **count > 1).count();
    let far = (blocks.lattice.roots << (blocks.lattice.depth + 1)).to_array();
    let open = edges.keys().filter(|&&(a, b)| {
        let border = (0..2).any(|k| a[k] == b[k] && (a[k] == 0 || a[k] == far[k]));
        !border && !edges.contains_key(&(b, a))
    });
    [open.count(), twice, differ]
}

/// Twice the area of all triangles, and whether each faces up, lattice steps.
pub fn area(mesh: &BlockMesh) -> Option<i64> {
    let mut all = 0;
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|k| mesh.vertices[k as usize].at.as_i64vec2());
        let twice = (b - a).y * (c - a).x - (b - a).x * (c - a).y;
        if twice <= 0 {
            return None;
        }
        all += twice;
    }
    Some(all)
}
