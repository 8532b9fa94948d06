//! Rocks: a ball cut by planes, rough where it is broken, with lichen on top.

use std::collections::HashMap;

use glam::Vec3;

use crate::model::{Model, Vertex};
use crate::noise::fractal;
use crate::plant::Plant;
use crate::random::Random;

const STONE: Vec3 = Vec3::new(0.190, 0.183, 0.174);
const DARK: Vec3 = Vec3::new(0.090, 0.086, 0.082);
const LICHEN: Vec3 = Vec3::new(0.255, 0.250, 0.165);
const MOSS: Vec3 = Vec3::new(0.070, 0.105, 0.030);

/// What a rock is made by.
pub struct Rock {
    /// Half of its sides, metres.
    pub half: Vec3,
    /// How many planes cut it.
    pub cuts: u32,
    /// How deep they cut, as a share of the radius.
    pub depth: f32,
    /// How rough it is, as a share of the radius.
    pub rough: f32,
}

/// A rounded boulder, 1.4 m high.
pub const BOULDER: Rock = Rock {
    half: Vec3::new(1.0, 0.78, 0.88),
    cuts: 15,
    depth: 0.36,
    rough: 0.14,
};

/// A flat slab as scree is made of.
pub const SLAB: Rock = Rock {
    half: Vec3::new(0.95, 0.33, 0.7),
    cuts: 20,
    depth: 0.5,
    rough: 0.09,
};

/// A ball of 20 · 4⁵ triangles.
fn ball() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let g = 0.5 * (1.0 + 5.0_f32.sqrt());
    let mut places: Vec<Vec3> = Vec::new();
    for sign in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
        let [a, b] = [sign[0], sign[1] * g];
        places.extend([
            Vec3::new(0.0, a, b),
            Vec3::new(a, b, 0.0),
            Vec3::new(b, 0.0, a),
        ]);
    }
    let places: Vec<Vec3> = places.into_iter().map(Vec3::normalize).collect();
    // Three corners that are neighbours of each other are a triangle of the icosahedron.
    let near = |a: usize, b: usize| places[a].distance(places[b]) < 1.1;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(a, c) {
                    let out = (places[b] - places[a]).cross(places[c] - places[a]);
                    let turned = out.dot(places[a]) < 0.0;
                    let [b, c] = if turned { [c, b] } else { [b, c] };
                    triangles.push([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    let mut places = places;
    for _ in 0..5 {
        let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
        let mut finer = Vec::with_capacity(4 * triangles.len());
        for [a, b, c] in triangles {
            let mut middle = |a: u32, b: u32| {
                *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    places.push((places[a as usize] + places[b as usize]).normalize());
                    places.len() as u32 - 1
                })
            };
            let [d, e, f] = [middle(a, b), middle(b, c), middle(c, a)];
            finer.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]);
        }
        triangles = finer;
    }
    (places, triangles)
}

/// The rock of a seed.
#[must_use]
pub fn rock(of: &Rock, seed: u32) -> Plant {
    let mut random = Random::new(seed);
    let planes: Vec<(Vec3, f32)> = (0..of.cuts)
        .map(|_| {
            (
                random.direction(),
                1.0 - of.depth * random.within(0.15, 1.0),
            )
        })
        .collect();
    let shift = random.in_ball() * 50.0;
    let (mut places, triangles) = ball();
    for place in &mut places {
        let way = *place;
        // Where a plane cuts the ray; edges are rounded off by a soft minimum.
        let mut radius = 1.0_f32;
        for (normal, distance) in &planes {
            let slope = way.dot(*normal);
            if slope > 0.05 {
                let cut = distance / slope;
                let blend = (0.5 + 0.5 * (cut - radius) / 0.045).clamp(0.0, 1.0);
                radius = cut + (radius - cut) * blend - 0.045 * blend * (1.0 - blend);
            }
        }
        let broken = fractal(way * 2.1 + shift, 5, 0.52);
        // Bedding: layers that stand out a little.
        let layers = fractal(
            Vec3::new(0.4 * way.x, 5.0 * way.y, 0.4 * way.z) + shift,
            3,
            0.5,
        );
        radius *= 1.0 + of.rough * (broken + 0.45 * layers);
        *place = way * radius * of.half;
    }
    let mut normals = vec![Vec3::ZERO; places.len()];
    for [a, b, c] in &triangles {
        let [pa, pb, pc] = [a, b, c].map(|k| places[*k as usize]);
        let out = (pb - pa).cross(pc - pa);
        for k in [a, b, c] {
            normals[*k as usize] += out;
        }
    }
    let lift = of.half.y * 0.8;
    let vertices = places.iter().zip(&normals).map(|(place, normal)| {
        let normal = normal.normalize_or(Vec3::Y);
        let grain = fractal(*place * 3.0 + shift, 5, 0.6);
        let spots = fractal(*place * 2.2 - shift, 4, 0.55);
        let mut colour = STONE.lerp(DARK, (0.40 - 1.5 * grain).clamp(0.0, 1.0));
        let lichen = ((normal.y - 0.4) * 0.8 + 4.5 * spots - 0.25).clamp(0.0, 1.0);
        colour = colour.lerp(LICHEN, 0.55 * lichen);
        let low = 1.0 - ((place.y + lift) / (0.75 * lift)).clamp(0.0, 1.0);
        let moss = ((0.6 * low + 0.5 * normal.y.max(0.0)) + 1.4 * grain - 0.55).clamp(0.0, 1.0);
        colour = colour.lerp(MOSS, 0.55 * moss);
        // Less sky below.
        colour *= 0.55 + 0.45 * (0.5 + 0.5 * normal.y).clamp(0.0, 1.0) - 0.15 * low;
        Vertex {
            place: (*place + Vec3::Y * lift).to_array(),
            normal: normal.to_array(),
            colour: colour.to_array(),
        }
    });
    Plant {
        solid: Model {
            vertices: vertices.collect(),
            indices: triangles.into_iter().flatten().collect(),
        },
        leaves: Vec::new(),
        solid_shares: [0.11, 0.03, 0.008, 0.003],
        leaf_shares: [0.0; 4],
    }
}
