//! From the chosen vertices to heights and triangles.
//!
//! **Height of a vertex that is geomorphing.** Let S(θ) be the mesh of all vertices whose share
//! s = (error ratio − a) / (1 − a), a = [`APPEARS`], is above θ: each is a mesh as the selection could have made
//! it for a tolerance between a times the asked one and all of it, so its error is at most the asked tolerance. The drawn height is the mean
//! of S(θ) over θ from 0 to 1, so its error is at most that too; it is continuous in the error ratios, 0 to 1;
//! and a vertex lies in the plane of its triangle where it appears. In S(θ) a vertex with s ≤ θ lies in the
//! middle of the edge that it would cut; so the mean is found by putting the ends of that edge in the
//! place of the vertices one after the other, the least error ratio first.

use bevy::math::{UVec2, Vec2};
use dolomite_terrain::{GroundPoint, Height};

use super::APPEARS;
use super::cell::DetailCells;
use super::lattice::{CellPlace, cells_of_mid, ends};
use super::select::{Selection, ViewCell};

/// A vertex of the drawn ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetailVertex {
    /// Where it stands.
    pub point: GroundPoint,
    /// Height of the drawn surface, metres.
    pub height: f32,
    /// Height of the ground below it, metres: less where there is water.
    pub bed: f32,
    /// Gradient of the ground.
    pub gradient: Vec2,
}

/// What a view draws.
#[derive(Clone, Debug, Default)]
pub struct DetailMesh {
    /// Each vertex once.
    pub vertices: Vec<DetailVertex>,
    /// Counter-clockwise seen from above.
    pub triangles: Vec<[u32; 3]>,
}

/// Share of the way to the ground of a vertex with this error ratio.
#[must_use]
pub fn morph_share(error_ratio: f32) -> f32 {
    ((error_ratio - APPEARS) / (1.0 - APPEARS)).clamp(0.0, 1.0)
}

/// A vertex as the others see it.
#[derive(Clone, Copy)]
pub(super) struct Placed {
    share: f32,
    pub ground: Height,
}

/// What is needed to find vertices.
pub(super) struct Finder<'a> {
    pub cells: &'a DetailCells,
    pub selection: &'a Selection,
}

impl Finder<'_> {
    pub fn cell(&self, place: CellPlace) -> Option<&ViewCell> {
        self.selection.find(&self.cells.lattice, place)
    }

    pub fn vertex(&self, at: UVec2) -> Placed {
        if self.cells.lattice.is_root_corner(at) {
            return Placed {
                share: 1.0,
                ground: self.cells.root_corner(at),
            };
        }
        if at.x.trailing_zeros() == at.y.trailing_zeros() {
            let cell = self
                .cell(CellPlace::of_centre(at))
                .expect("whatever a vertex needs is there");
            return Placed {
                share: morph_share(cell.centre),
                ground: self.cells.cell(cell.number).centre(),
            };
        }
        let (cell, side) = self.owner(at).expect("whatever a vertex needs is there");
        Placed {
            share: morph_share(cell.sides[side]),
            ground: self.cells.cell(cell.number).mid(side),
        }
    }

    /// The cell that owns a side's middle.
    fn owner(&self, mid: UVec2) -> Option<(&ViewCell, usize)> {
        cells_of_mid(mid)
            .into_iter()
            .find_map(|(place, side)| Some((self.cell(place)?, side)))
    }

    /// Height of the drawn surface at a vertex.
    pub fn height(&self, at: UVec2) -> f32 {
        let sea = self.cells.sea();
        let mut terms: Vec<(UVec2, f32, Placed)> = vec![(at, 1.0, self.vertex(at))];
        let (mut from, mut height) = (0.0, 0.0);
        loop {
            let least = (0..terms.len())
                .min_by(|&a, &b| terms[a].2.share.total_cmp(&terms[b].2.share))
                .expect("never empty");
            let until = terms[least].2.share.max(from);
            let surface: f32 = terms
                .iter()
                .map(|(_, weight, placed)| weight * placed.ground.value.max(sea))
                .sum();
            if until >= 1.0 && from == 0.0 {
                // No sum where nothing moves: the very bits of the height.
                return surface;
            }
            height += (until - from) * surface;
            if until >= 1.0 {
                return height;
            }
            from = until;
            let (vertex, weight, _) = terms.swap_remove(least);
            for end in ends(vertex) {
                match terms.iter_mut().find(|term| term.0 == end) {
                    Some(term) => term.1 += 0.5 * weight,
                    None => terms.push((end, 0.5 * weight, self.vertex(end))),
                }
            }
        }
    }
}

/// The mesh of a selection.
#[must_use]
pub fn mesh(cells: &DetailCells, selection: &Selection) -> DetailMesh {
    let finder = Finder { cells, selection };
    let lattice = &cells.lattice;
    let mut out = DetailMesh::default();
    let mut numbers = bevy::platform::collections::HashMap::<UVec2, u32>::default();
    let mut number = |out: &mut DetailMesh, at: UVec2| {
        *numbers.entry(at).or_insert_with(|| {
            let ground = finder.vertex(at).ground;
            out.vertices.push(DetailVertex {
                point: lattice.point(at),
                height: finder.height(at),
                bed: ground.value,
                gradient: ground.gradient,
            });
            out.vertices.len() as u32 - 1
        })
    };
    for &(root, seen) in &selection.whole_roots {
        if seen {
            let outer = root.quarter();
            let at = |k: usize| root.corner(outer + k);
            for corners in [[at(2), at(1), at(0)], [at(0), at(3), at(2)]] {
                let triangle = corners.map(|corner| number(&mut out, corner));
                out.triangles.push(triangle);
            }
        }
    }
    for cell in selection.cells().filter(|cell| cell.seen) {
        let place = cell.place;
        for side in 0..4 {
            let (before, after) = (place.corner(side + 3), place.corner(side));
            let corners = [place.centre, after, before];
            if cell.sides[side] <= APPEARS {
                let triangle = corners.map(|corner| number(&mut out, corner));
                out.triangles.push(triangle);
                continue;
            }
            let mid = place.mid(side);
            // Each half of the side belongs to a quarter of the cell.
            for (quarter, corners) in [
                (side, [place.centre, after, mid]),
                ((side + 3) & 3, [place.centre, mid, before]),
            ] {
                let own = place
                    .child(quarter)
                    .is_some_and(|child| finder.cell(child).is_some());
                if !own {
                    let triangle = corners.map(|corner| number(&mut out, corner));
                    out.triangles.push(triangle);
                }
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;
    use crate::detail::settings::{Metric, TerrainLod};
    use crate::detail::view::tests::perspective;
    use crate::detail::{DetailView, select};
    use bevy::math::{DVec2, EulerRot, Quat, Vec3};
    use dolomite_terrain::{Fractal, GroundRect, Layer, Source, Terrain, TerrainData};

    fn terrain() -> Terrain {
        Terrain::new(TerrainData {
            extent: GroundRect::square(DVec2::ZERO, 4096.0),
            layers: vec![Layer {
                source: Source::Fractal(Fractal {
                    octaves: 12,
                    amplitude: 400.0,
                    ..Fractal::default()
                }),
                mask: None,
            }],
            base: 0.0,
            sea_level: None,
        })
        .expect("valid")
    }

    fn view(cells: &DetailCells, xz: DVec2, above: f32, yaw: f32, pixels: f32) -> DetailView {
        let ground = cells.terrain().sample_f64(xz).height as f32;
        let eye = Vec3::new(xz.x as f32, ground + above, xz.y as f32);
        let rotation = Quat::from_euler(EulerRot::YXZ, yaw, -0.1, 0.0);
        let mut view = perspective(eye, rotation, 1.0, 0.1);
        view.set_metric(&TerrainLod {
            metric: Metric::ErrorBound { pixels },
            ..TerrainLod::default()
        });
        view
    }

    /// How often each directed edge occurs.
    fn edges(mesh: &DetailMesh) -> HashMap<(u32, u32), u32> {
        let mut edges = HashMap::new();
        for &[a, b, c] in &mesh.triangles {
            for edge in [(a, b), (b, c), (c, a)] {
                *edges.entry(edge).or_default() += 1;
            }
        }
        edges
    }

    #[test]
    fn the_mesh_of_a_view_that_sees_all_is_closed_and_covers_the_extent() {
        let mut cells = DetailCells::new(terrain(), 0.5);
        let mut view = view(&cells, DVec2::new(100.0, 50.0), 2.0, 0.3, 8.0);
        // No frustum: all is seen, so that the border of the mesh is that of the extent.
        view.planes = [[0.0, 0.0, 0.0, 1.0]; 6];
        let selection = select(&mut cells, &view, 1 << 20);
        let mesh = mesh(&cells, &selection);
        assert!(mesh.triangles.len() > 10_000, "{}", mesh.triangles.len());
        let edges = edges(&mesh);
        let mut border = 0.0;
        for (&(a, b), &count) in &edges {
            assert_eq!(count, 1);
            if !edges.contains_key(&(b, a)) {
                let [a, b] = [a, b].map(|k| mesh.vertices[k as usize].point.to_dvec2());
                assert!(
                    a.x.abs() == 2048.0 && a.x == b.x || a.y.abs() == 2048.0 && a.y == b.y,
                    "a gap at {a} {b}"
                );
                border += a.distance(b);
            }
        }
        assert_eq!(border, 4.0 * 4096.0);
        let mut area = 0.0;
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|k| mesh.vertices[k as usize].point.to_dvec2());
            // (b − a) × (c − a) upwards: z before x.
            let twice = (b.y - a.y) * (c.x - a.x) - (b.x - a.x) * (c.y - a.y);
            assert!(twice > 0.0, "every triangle faces up");
            area += twice / 2.0;
        }
        assert_eq!(area, 4096.0 * 4096.0);
    }

    #[test]
    fn looking_away_and_back_gives_the_same_bits() {
        let mut cells = DetailCells::new(terrain(), 0.25);
        let look = |cells: &mut DetailCells, yaw: f32| {
            let view = view(cells, DVec2::new(-300.0, 700.0), 1.7, yaw, 8.0);
            let selection = select(cells, &view, 1 << 20);
            mesh(cells, &selection)
        };
        let first = look(&mut cells, 0.0);
        let other = look(&mut cells, 2.0);
        let again = look(&mut cells, 0.0);
        assert!(first.triangles == again.triangles && first.vertices == again.vertices);
        assert!(first.triangles != other.triangles);
        // And without anything kept.
        let fresh = look(&mut DetailCells::new(terrain(), 0.25), 0.0);
        assert!(first.triangles == fresh.triangles && first.vertices == fresh.vertices);
    }

    #[test]
    fn flat_ground_is_two_triangles_however_near() {
        let flat = Terrain::new(TerrainData {
            extent: GroundRect::square(DVec2::ZERO, 16_384.0),
            layers: Vec::new(),
            base: 12.0,
            sea_level: None,
        })
        .expect("valid");
        let mut cells = DetailCells::new(flat, 0.125);
        let view = view(&cells, DVec2::new(3.0, 4.0), 1.0, 0.0, 1.0);
        let selection = select(&mut cells, &view, 1 << 20);
        assert_eq!(mesh(&cells, &selection).triangles.len(), 2);
    }

    #[test]
    fn a_view_that_asks_for_too_much_gets_what_fits_and_says_so() {
        let mut cells = DetailCells::new(terrain(), 0.125);
        let view = view(&cells, DVec2::new(100.0, 50.0), 1.7, 0.3, 4.0);
        let all = select(&mut cells, &view, 1 << 22);
        let wanted = mesh(&cells, &all).vertices.len();
        let few = select(&mut cells, &view, 2000);
        let got = mesh(&cells, &few).vertices.len();
        // On the way down the tolerance is raised by what is known by then: a quarter may stay unused.
        assert!(
            wanted > 10_000 && got <= 2000 && got > 500,
            "{wanted} {got}"
        );
        assert!(
            few.coarsening > 1.5 && few.held >= few.coarsening,
            "{few:?}"
        );
        assert_eq!(all.coarsening, 1.0);
    }
}
