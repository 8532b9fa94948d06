//! Meshes that movers walk on: 20 000 triangles each.

use bevy::math::{DVec3, Vec3, ops};
use dolomite_collision::{TreeSettings, TriangleMesh, TriangleTree};
use dolomite_testkit::random::mixed;

/// Cells of a side.
const CELLS: u32 = 100;

/// The side of a cell, metres.
const CELL: f32 = 0.5;

/// How far movers keep from the border, metres.
const BORDER: f64 = 2.0;

/// Half of the side, metres.
pub const HALF: f64 = (CELLS as f32 * CELL * 0.5) as f64;

/// What movers walk on.
pub struct Terrain {
    /// What it is called.
    pub name: &'static str,
    /// For others.
    pub vertices: Vec<Vec3>,
    /// For others.
    pub triangles: Vec<[u32; 3]>,
    /// Ours.
    pub tree: TriangleTree,
}

impl Terrain {
    fn new(name: &'static str, height: impl Fn(u32, u32) -> f32) -> Self {
        let side = 0..=CELLS;
        let vertices: Vec<Vec3> = side
            .clone()
            .flat_map(|x| side.clone().map(move |z| (x, z)))
            .map(|(x, z)| {
                let half = HALF as f32;
                Vec3::new(x as f32 * CELL - half, height(x, z), z as f32 * CELL - half)
            })
            .collect();
        let row = CELLS + 1;
        let triangles: Vec<[u32; 3]> = (0..CELLS)
            .flat_map(|x| (0..CELLS).map(move |z| x * row + z))
            .flat_map(|nw| {
                let (sw, ne, se) = (nw + 1, nw + row, nw + row + 1);
                [[nw, sw, ne], [sw, se, ne]]
            })
            .collect();
        let mesh = TriangleMesh::new(DVec3::ZERO, vertices.clone(), triangles.clone())
            .expect("heights are finite");
        Self {
            name,
            vertices,
            triangles,
            tree: TriangleTree::new(mesh, TreeSettings::default()),
        }
    }

    /// Hills of 2 m, slopes to 38°, after the character test of Jolt Physics.
    pub fn hills() -> Self {
        Self::new("hills", |x, z| {
            let at = |i: u32| i as f32 * 20.0 / CELLS as f32;
            2.0 * ops::sin(at(x)) * ops::cos(at(z))
        })
    }

    /// Every vertex up to 0.3 m above or below 0, in no order: creases and corners everywhere.
    pub fn gravel() -> Self {
        Self::new("gravel", |x, z| {
            let bits = mixed(x, z.wrapping_add(977)) >> 8;
            (bits as f32 / 16_777_216.0 * 2.0 - 1.0) * 0.3
        })
    }

    /// Both.
    pub fn all() -> [Self; 2] {
        [Self::hills(), Self::gravel()]
    }

    /// How high the surface is above a place, by a ray from above.
    pub fn surface(&self, place: DVec3) -> Option<f64> {
        let from = place.with_y(100.0);
        let ray = dolomite_collision::Ray::between(from, place.with_y(-100.0));
        let hit = self.tree.first_hit(&ray)?;
        Some(100.0 - 200.0 * hit.time)
    }
}

/// Whether a place is so near to the border that whoever goes on has to turn.
pub fn leaves(place: DVec3, way: DVec3) -> bool {
    let out = |at: f64, way: f64| at.abs() > HALF - BORDER && at * way > 0.0;
    out(place.x, way.x) || out(place.z, way.z)
}
