//! Meshes of views that see all: every edge inside of the extent is there once in each direction.

use crate::scenes::camera::Camera;
use crate::scenes::cameras::{KINDS, around};
use crate::scenes::selection::{bound, cells_of, choose, detail_view};
use crate::scenes::terrains;
use bevy::math::{DVec2, UVec2};
use bevy::platform::collections::{HashMap, HashSet};
use dolomite_ground::detail::{DetailMesh, mesh};
use dolomite_terrain::GroundRect;

/// What is found in meshes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Cracks {
    /// Views.
    pub views: u64,
    /// Edges between two triangles, each counted once.
    pub shared: u64,
    /// Edges inside of the extent with a triangle on one side alone, or with more than two.
    pub open: u64,
    /// Vertices at a place where there is another.
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

    fn add(&mut self, mesh: &DetailMesh, extent: GroundRect) {
        self.views += 1;
        let places: Vec<DVec2> = mesh.vertices.iter().map(|v| v.point.to_dvec2()).collect();
        let mut known = HashSet::new();
        let points = mesh.vertices.iter().map(|vertex| vertex.point.to_fixed());
        self.doubled += points.filter(|&point| !known.insert(point)).count() as u64;
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
        let mut cells = cells_of(terrain, 0.125);
        for (_, camera) in around(terrain, KINDS.len(), own) {
            let camera = Camera {
                size: UVec2::new(480, 270),
                ..camera
            };
            let mut view = detail_view(&camera, bound(16.0));
            // No frustum: the border of the mesh is that of the ground.
            view.planes = [[0.0, 0.0, 0.0, 1.0]; 6];
            let selection = choose(&mut cells, &view);
            found.add(&mesh::mesh(&cells, &selection), terrain.extent());
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

    #[test]
    fn meshes_are_closed_and_a_missing_or_a_turned_triangle_is_found() {
        let found = cracks(20_000, 2);
        assert!(found.none() && found.shared >= 20_000, "{found:?}");
        let terrain = terrains::fbm(1);
        let mut cells = cells_of(&terrain, 1.0);
        let (_, camera) = around(&terrain, 4, 1)[3];
        let selection = choose(&mut cells, &detail_view(&camera, bound(8.0)));
        let mut mesh = mesh::mesh(&cells, &selection);
        let of = |mesh: &DetailMesh| {
            let mut found = Cracks::default();
            found.add(mesh, terrain.extent());
            found
        };
        let whole = of(&mesh);
        let lost = mesh.triangles.pop().expect("many triangles");
        assert!(of(&mesh).open > whole.open);
        mesh.triangles.push([lost[0], lost[2], lost[1]]);
        assert_eq!(of(&mesh).turned, 1);
        mesh.vertices.push(mesh.vertices[0]);
        assert_eq!(of(&mesh).doubled, 1);
    }
}
