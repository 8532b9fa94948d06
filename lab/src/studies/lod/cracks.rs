//! Meshes of random cameras: every edge inside of the extent is there once in each direction. Blocks that meet have vertices
//! of their own on the border between them: those at one place are one vertex where the bits of their heights are the
//! same, and leave an edge open where they are not.

use crate::scenes::camera::Camera;
use crate::scenes::cameras::{KINDS, around};
use crate::scenes::selection::{blocks_of, bound, choose, detail_view, drawn};
use crate::scenes::terrains;
use bevy::math::{DVec2, UVec2};
use bevy::platform::collections::{HashMap, HashSet};
use dolomite_ground::blocks::kept::KeptBlocks;
use dolomite_ground::blocks::mesh::{BlockMesh, BlockVertex};

/// What is found in meshes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Cracks {
    /// Views.
    pub views: u64,
    /// Edges between two triangles, each counted once.
    pub shared: u64,
    /// Edges inside of the extent with a triangle on one side alone, or with more than two.
    pub open: u64,
    /// Vertices at a place where there is another, of another height.
    pub doubled: u64,
    /// Triangles that do not face up.
    pub turned: u64,
}

impl Cracks {
    /// Whether there is nothing wrong.
    #[must_use]
    pub fn none(&self) -> bool {
        (self.open, self.doubled, self.turned) == (0, 0, 0)
    }

    /// Of a mesh with one vertex where blocks have the same.
    fn add(&mut self, blocks: &KeptBlocks, mesh: &BlockMesh) {
        self.views += 1;
        let extent = blocks.terrain().extent();
        let place = |vertex: &BlockVertex| blocks.lattice.point(vertex.at).to_dvec2();
        let places: Vec<DVec2> = mesh.vertices.iter().map(place).collect();
        let mut known = HashSet::new();
        let at = mesh.vertices.iter().map(|vertex| vertex.at);
        self.doubled += at.filter(|&at| !known.insert(at)).count() as u64;
        let mut edges: HashMap<(u32, u32), u32> = HashMap::default();
        for &[a, b, c] in &mesh.triangles {
            for edge in [(a, b), (b, c), (c, a)] {
                *edges.entry(edge).or_default() += 1;
            }
            let [a, b, c] = [a, b, c].map(|k| places[k as usize]);
            // Upwards is z before x.
            self.turned += u64::from((b - a).perp_dot(c - a) >= 0.0);
        }
        // The lattice may be wider than the extent by less than this.
        let margin = 1.0 / 256.0;
        let border = |a: DVec2, b: DVec2| {
            let on = |p: f64, q: f64, at: f64| (p - at).abs() < margin && (q - at).abs() < margin;
            on(a.x, b.x, extent.min.x)
                || on(a.x, b.x, extent.max.x)
                || on(a.y, b.y, extent.min.y)
                || on(a.y, b.y, extent.max.y)
        };
        for (&(a, b), &count) in &edges {
            let back = edges.get(&(b, a)).copied().unwrap_or(0);
            let [from, to] = [a, b].map(|k| places[k as usize]);
            match (count, back) {
                (1, 1) => self.shared += u64::from(a < b),
                (1, 0) if border(from, to) => {}
                _ => self.open += 1,
            }
        }
    }
}

/// Meshes of random cameras until `edges` shared edges were looked at.
#[must_use]
pub fn cracks(edges: u64, seed: u32) -> Cracks {
    let mut found = Cracks::default();
    for group in 0.. {
        let own = seed.wrapping_mul(1000).wrapping_add(group);
        let terrains = terrains::all(own);
        let terrain = &terrains[group as usize % 3];
        let mut blocks = blocks_of(terrain, 0.125);
        for (_, camera) in around(terrain, KINDS.len(), own) {
            let camera = Camera {
                size: UVec2::new(480, 270),
                ..camera
            };
            let mut view = detail_view(&camera, bound(16.0));
            // No frustum: the border of the mesh is that of the ground.
            view.planes = [[0.0, 0.0, 0.0, 1.0]; 6];
            let choice = choose(&mut blocks, &view);
            found.add(&blocks, &drawn(&blocks, &choice));
            if found.shared >= edges {
                return found;
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::selection::welded;
    use dolomite_ground::blocks::mesh::mesh as mesh_of_blocks;

    #[test]
    fn meshes_are_closed_and_a_missing_or_a_turned_triangle_is_found() {
        let found = cracks(20_000, 2);
        assert!(found.none() && found.shared >= 20_000, "{found:?}");
        let terrain = terrains::fbm(1);
        let mut blocks = blocks_of(&terrain, 1.0);
        let (_, camera) = around(&terrain, 2, 1)[1];
        let choice = choose(&mut blocks, &detail_view(&camera, bound(8.0)));
        let mut mesh = drawn(&blocks, &choice);
        let of = |mesh: &BlockMesh| {
            let mut found = Cracks::default();
            found.add(&blocks, mesh);
            found
        };
        let whole = of(&mesh);
        assert!(whole.none(), "{whole:?}");
        let lost = mesh.triangles.pop().expect("many triangles");
        assert!(of(&mesh).open > whole.open);
        mesh.triangles.push([lost[0], lost[2], lost[1]]);
        assert_eq!(of(&mesh).turned, 1);
        mesh.vertices.push(mesh.vertices[0]);
        assert_eq!(of(&mesh).doubled, 1);
        // A vertex on the border of two blocks, which is another by a bit in one of them.
        let mut apart = mesh_of_blocks(&blocks, &choice);
        let mut known = HashSet::new();
        let again = apart.vertices.iter_mut().find(|v| !known.insert(v.at));
        let again = again.expect("blocks meet");
        again.height = again.height.next_up();
        let found = of(&welded(&apart));
        assert!(found.open > 0 && found.doubled == 1, "{found:?}");
    }
}
