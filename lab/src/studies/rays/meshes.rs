//! Meshes that rays are timed on, and rays that meet them.

use bevy::math::{DVec3, Vec3};
use dolomite_collision::Ray;
use dolomite_testkit::mesh::bumpy_sphere;
use dolomite_testkit::places::{direction, place};
use dolomite_testkit::random::Random;

/// Vertices and triangles.
pub type Triangles = (Vec<Vec3>, Vec<[u32; 3]>);

/// A mesh and where rays at it come from.
pub struct Scene {
    /// What it is called.
    pub name: &'static str,
    /// Its triangles.
    pub mesh: Triangles,
    rays: fn(&mut Random) -> Ray,
}

impl Scene {
    /// That many, each held by f32, so that all are asked the same.
    pub fn rays(&self, random: &mut Random, count: usize) -> Vec<Ray> {
        (0..count).map(|_| (self.rays)(random)).collect()
    }
}

/// All that are timed: some 100 000 triangles each.
pub fn scenes(random: &mut Random) -> [Scene; 3] {
    [
        Scene {
            name: "bumpy sphere",
            mesh: bumpy_sphere(random, 160),
            rays: around,
        },
        Scene {
            name: "terrain",
            mesh: terrain(random, 224),
            rays: over_ground,
        },
        Scene {
            name: "soup",
            mesh: soup(random, 100_000),
            rays: around,
        },
    ]
}

fn between(from: DVec3, to: DVec3) -> Ray {
    let from = from.as_vec3().as_dvec3();
    Ray::new(from, (to - from).as_vec3().as_dvec3())
}

/// From a sphere around it at points in it, some of which miss.
fn around(random: &mut Random) -> Ray {
    let from = direction(random) * 4.0;
    between(from, place(random, 1.5))
}

/// As a figure looks and as a shot flies: from a few metres above the ground to another place of it.
fn over_ground(random: &mut Random) -> Ray {
    let mut at = |up: f64| {
        let p = place(random, 100.0);
        DVec3::new(p.x, up + 0.02 * p.y, p.z)
    };
    between(at(14.0), at(4.0))
}

/// 200 m of rough ground, `cells` along each side, heights from 0 to some 12 m: sums of tents of halving width.
pub fn terrain(random: &mut Random, cells: u32) -> Triangles {
    let side = cells + 1;
    let turns: Vec<[f32; 2]> = (0..7)
        .map(|_| [random.unit_f32(), random.unit_f32()])
        .collect();
    let height = |u: f32, v: f32| {
        let octaves = turns.iter().enumerate().map(|(i, turn)| {
            let scale = (1 << i) as f32;
            let tent = |x: f32| 1.0 - 2.0 * (x.fract() - 0.5).abs();
            let (u, v) = (u * scale + turn[0], v * scale + turn[1]);
            tent(u + 0.3 * tent(v)) * tent(v) / scale
        });
        8.0 * octaves.sum::<f32>()
    };
    let mut vertices = Vec::new();
    for row in 0..side {
        for column in 0..side {
            let (u, v) = (column as f32 / cells as f32, row as f32 / cells as f32);
            let place = Vec3::new(u - 0.5, 0.0, v - 0.5) * 200.0;
            vertices.push(place + Vec3::Y * height(u, v));
        }
    }
    let mut triangles = Vec::new();
    for row in 0..cells {
        for column in 0..cells {
            let a = row * side + column;
            let (b, c, d) = (a + 1, a + side, a + side + 1);
            triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    (vertices, triangles)
}

/// Triangles of all sizes and shapes, each for itself, a tenth of them needles right across.
fn soup(random: &mut Random, count: u32) -> Triangles {
    let mut vertices = Vec::new();
    for index in 0..count {
        let center = place(random, 1.0);
        let size = match index % 10 {
            0 => 1.0,
            _ => 0.02 * (1.0 + random.unit()),
        };
        let along = direction(random) * size;
        let across = direction(random) * 0.02 * random.unit();
        vertices.extend(
            [center, center + along, center + across].map(|corner: DVec3| corner.as_vec3()),
        );
    }
    let triangles = (0..count).map(|i| [0, 1, 2].map(|corner| 3 * i + corner));
    (vertices, triangles.collect())
}
