//! Triangles, and simple shapes of them.

use std::collections::HashMap;
use std::f64::consts::TAU;

use glam::DVec3;

/// A list of triangles, counter-clockwise seen from outside. Only that side is seen by a camera; both block light.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Corners.
    pub positions: Vec<DVec3>,
    /// A unit normal a corner; empty for flat triangles.
    pub normals: Vec<DVec3>,
    /// Indices of corners.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Every number as an f32 has it.
    #[must_use]
    pub fn rounded(mut self) -> Self {
        let round = |v: &mut DVec3| *v = v.as_vec3().as_dvec3();
        self.positions.iter_mut().for_each(round);
        self.normals.iter_mut().for_each(round);
        self
    }

    fn quad(&mut self, corners: [u32; 4]) {
        let [a, b, c, d] = corners;
        self.triangles.extend([[a, b, c], [a, c, d]]);
    }
}

/// A box about the origin with these half sizes, each face with its own normal.
pub fn cuboid(half: DVec3) -> Mesh {
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            let mut n = DVec3::ZERO;
            n[axis] = sign;
            let mut u = DVec3::ZERO;
            u[(axis + 1) % 3] = 1.0;
            let v = n.cross(u);
            let first = mesh.positions.len() as u32;
            for (s, t) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                mesh.positions.push(half * (n + s * u + t * v));
                mesh.normals.push(n);
            }
            mesh.quad([first, first + 1, first + 2, first + 3]);
        }
    }
    mesh
}

/// A square in the plane y = 0 about the origin, its normal +Y, of `cells` · `cells` quads.
pub fn grid(half: f64, cells: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let at = |k: u32| half * (2.0 * f64::from(k) / f64::from(cells) - 1.0);
    for z in 0..=cells {
        for x in 0..=cells {
            mesh.positions.push(DVec3::new(at(x), 0.0, at(z)));
            mesh.normals.push(DVec3::Y);
        }
    }
    let index = |x: u32, z: u32| z * (cells + 1) + x;
    for z in 0..cells {
        for x in 0..cells {
            mesh.quad([
                index(x, z),
                index(x, z + 1),
                index(x + 1, z + 1),
                index(x + 1, z),
            ]);
        }
    }
    mesh
}

/// A sphere of radius 1 about the origin: an icosahedron of which each triangle is divided into four, `steps` times.
/// Its normals are those of the sphere.
pub fn icosphere(steps: u32) -> Mesh {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut positions: Vec<DVec3> = Vec::new();
    for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        positions.push(DVec3::new(0.0, s, t * golden).normalize());
        positions.push(DVec3::new(s, t * golden, 0.0).normalize());
        positions.push(DVec3::new(t * golden, 0.0, s).normalize());
    }
    // A face is three corners at the distance of an edge.
    let edge = 2.0 / (1.0 + golden * golden).sqrt();
    let near = |a: usize, b: usize| (positions[a].distance(positions[b]) - edge).abs() < 1e-9;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(a, c) {
                    let [p, q, r] = [a, b, c].map(|k| positions[k]);
                    let outward = (q - p).cross(r - p).dot(p) > 0.0;
                    let (b, c) = if outward { (b, c) } else { (c, b) };
                    triangles.push([a, b, c].map(|k| k as u32));
                }
            }
        }
    }
    for _ in 0..steps {
        let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
        let mut finer = Vec::with_capacity(4 * triangles.len());
        for [a, b, c] in triangles {
            let mut middle = |i: u32, j: u32| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    let sum = positions[i as usize] + positions[j as usize];
                    positions.push(sum.normalize());
                    positions.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    Mesh {
        normals: positions.clone(),
        positions,
        triangles,
    }
}

/// A torus about the y axis with these radii, `around` · `through` quads, smooth.
pub fn torus(major: f64, minor: f64, around: u32, through: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..around {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(around)).sin_cos();
        for j in 0..through {
            let (s, c) = (TAU * f64::from(j) / f64::from(through)).sin_cos();
            let normal = DVec3::new(c * cos, s, c * sin);
            mesh.positions
                .push(major * DVec3::new(cos, 0.0, sin) + minor * normal);
            mesh.normals.push(normal);
        }
    }
    let index = |i: u32, j: u32| (i % around) * through + j % through;
    for i in 0..around {
        for j in 0..through {
            mesh.quad([
                index(i, j),
                index(i, j + 1),
                index(i + 1, j + 1),
                index(i + 1, j),
            ]);
        }
    }
    mesh
}

/// A closed cone of flat triangles: a base of radius 1 at y = 0, its tip at y = 1.
pub fn cone(sides: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let rim = |k: u32| {
        let (sin, cos) = (TAU * f64::from(k % sides) / f64::from(sides)).sin_cos();
        DVec3::new(cos, 0.0, sin)
    };
    for k in 0..sides {
        for corners in [
            [rim(k), DVec3::Y, rim(k + 1)],
            [DVec3::ZERO, rim(k), rim(k + 1)],
        ] {
            let [a, b, c] = corners;
            let normal = (b - a).cross(c - a).normalize();
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(corners);
            mesh.normals.extend([normal; 3]);
            mesh.triangles.push([first, first + 1, first + 2]);
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Volume by the divergence theorem, and whether every normal looks outward.
    fn volume(mesh: &Mesh) -> f64 {
        let mut volume = 0.0;
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|k| mesh.positions[k as usize]);
            volume += a.dot(b.cross(c)) / 6.0;
            let face = (b - a).cross(c - a);
            for k in t {
                assert!(mesh.normals[*k as usize].dot(face) > 0.0, "{t:?}");
                assert!((mesh.normals[*k as usize].length() - 1.0).abs() < 1e-12);
            }
        }
        volume
    }

    #[test]
    fn closed_shapes_have_their_volumes() {
        let volume_of_cuboid = volume(&cuboid(DVec3::new(1.0, 2.0, 3.0)));
        assert!((volume_of_cuboid - 48.0).abs() < 1e-12);
        // The icosahedron inscribed in the unit sphere: edge³ 5 (3 + √5) / 12.
        let edge = 2.0 / (0.5 * (5.0 + 5.0_f64.sqrt())).sqrt();
        let exact = edge.powi(3) * 5.0 * (3.0 + 5.0_f64.sqrt()) / 12.0;
        assert!((volume(&icosphere(0)) - exact).abs() < 1e-12);
        assert_eq!(icosphere(3).triangles.len(), 20 * 64);
        assert!((volume(&icosphere(4)) / (TAU * 2.0 / 3.0) - 1.0).abs() < 5e-3);
        // 2π² R r².
        let exact = 0.5 * TAU * TAU * 2.0 * 0.25;
        assert!((volume(&torus(2.0, 0.5, 128, 64)) / exact - 1.0).abs() < 3e-3);
        assert!((volume(&cone(256)) / (TAU / 6.0) - 1.0).abs() < 1e-3);
        volume(&grid(3.0, 4));
    }
}
