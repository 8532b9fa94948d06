//! A whole mesh at once, in Rust: the CPU reference of the passes on the GPU (control, measure, plan, place,
//! emit), vertex for vertex and primitive for primitive.

use super::coordinate::{Coordinate, coordinate, corner_coordinate, side_coordinate};
use super::level::{self, Level, Levels, WHOLE_SHARE};
use super::patches::{REVERSED, Topology, WHOLE};
use super::place::Edge;
use super::shape::{Shape, VertexRef};
use super::{Domain, PatchMesh, Primitives, Spacing, Tessellator, Winding};

/// A vertex of a mesh, by the patch that owns it and evaluates it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshVertex {
    /// The patch.
    pub patch: u32,
    /// Where in its domain, in units of 2⁻²⁴.
    pub at: Coordinate,
}

/// A mesh, tessellated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshTessellation {
    /// Corners, then the vertices of edges, then those inside of patches; each is there once.
    pub vertices: Vec<MeshVertex>,
    /// What joins them, patch after patch.
    pub primitives: Primitives,
    /// Segments of each edge of the mesh's topology; 0 where no patch uses it.
    pub edge_segments: Vec<u32>,
    /// Patches that an outer level discarded.
    pub discarded: u32,
    /// How often all levels were lowered by a fifth to fit the pools.
    pub lowered: u32,
}

/// After so many steps of 4/5 every level is below 1; as `LOWERINGS` in `work.wgsl`.
const LOWERINGS: u32 = 19;

impl Tessellator {
    /// Tessellates the patches of `mesh` with the levels that `control` gives each. Where the result
    /// has more vertices or primitives than `pools`, all levels are lowered evenly until it fits;
    /// what does not fit at the least levels is cut off, as on the GPU.
    ///
    /// # Panics
    /// If the mesh has another domain than the tessellator.
    #[must_use]
    pub fn tessellate_mesh(
        &self,
        mesh: &PatchMesh,
        mut control: impl FnMut(u32) -> Levels,
        pools: [u32; 2],
    ) -> MeshTessellation {
        assert_eq!(
            mesh.layout().domain,
            self.domain,
            "a tessellator takes patches of its own domain"
        );
        let mut asked = Asked::new(mesh.topology());
        for patch in 0..mesh.patches() as u32 {
            asked.take(self, patch, &control(patch));
        }
        let fits =
            |sizes: [u64; 2]| sizes[0] <= u64::from(pools[0]) && sizes[1] <= u64::from(pools[1]);
        let mut lowered = 0;
        if !fits(asked.sizes(self, WHOLE_SHARE)) {
            let mut low = 1;
            lowered = LOWERINGS;
            while low < lowered {
                let middle = (low + lowered) / 2;
                if fits(asked.sizes(self, share_after(middle))) {
                    lowered = middle;
                } else {
                    low = middle + 1;
                }
            }
        }
        asked.emit(self, share_after(lowered), lowered, pools)
    }
}

/// What is left of a level after so many steps of 4/5, in 1/1024.
fn share_after(steps: u32) -> u32 {
    (0..steps).fold(WHOLE_SHARE, |share, _| share * 4 / 5)
}

/// What the control function asked for, by owner.
struct Asked<'a> {
    topology: &'a Topology,
    corners: Vec<bool>,
    /// The greater level of both sides, 0 where no patch uses the edge.
    edges: Vec<Level>,
    /// Inner levels, clamped, of isolines lines and segments; `None` where the patch is discarded.
    inner: Vec<Option<[Level; 2]>>,
}

impl<'a> Asked<'a> {
    fn new(topology: &'a Topology) -> Self {
        Self {
            topology,
            corners: vec![false; topology.corners.len()],
            edges: vec![Level(0); topology.edges.len()],
            inner: Vec::with_capacity(topology.patches.len()),
        }
    }

    fn middle(&self, patch: u32, side: usize) -> Option<(u32, u32)> {
        let halves = self.topology.halves.get(patch as usize)?;
        (halves[side] != WHOLE).then(|| (halves[side], halves[4 + side]))
    }

    fn take(&mut self, tessellator: &Tessellator, patch: u32, levels: &Levels) {
        let Tessellator {
            domain,
            spacing,
            mode,
            ..
        } = *tessellator;
        let Some(shape) = Shape::new(levels, domain, spacing, mode) else {
            self.inner.push(None);
            return;
        };
        if domain == Domain::Isolines {
            self.inner.push(Some([shape.outer[0], shape.outer[1]]));
            return;
        }
        self.inner.push(Some(level::clamp_inner(
            levels.inner,
            domain,
            spacing,
            mode,
        )));
        let own = self.topology.patches[patch as usize];
        for side in 0..domain.outer_levels() {
            let split = self.middle(patch, side);
            self.corners[own[side] as usize] = true;
            let mut raise = |edge: u32, level: Level| {
                let edge = &mut self.edges[(edge & !REVERSED) as usize];
                *edge = (*edge).max(level);
            };
            let Some((middle, second)) = split else {
                raise(own[4 + side], shape.outer[side]);
                continue;
            };
            // Positive, so never `None`.
            let half = level::outer(levels.outer[side] * 0.5, spacing, mode);
            let half = half.unwrap_or(shape.outer[side]);
            raise(own[4 + side], half);
            raise(second, half);
            self.corners[middle as usize] = true;
        }
    }

    fn edge(&self, tessellator: &Tessellator, word: u32, share: u32) -> Level {
        let level = self.edges[(word & !REVERSED) as usize];
        level::lower(level, share, tessellator.spacing, tessellator.mode)
    }

    fn shape(&self, tessellator: &Tessellator, patch: u32, share: u32) -> Option<Shape> {
        let Tessellator {
            domain,
            spacing,
            mode,
            ..
        } = *tessellator;
        let inner = self.inner[patch as usize]?;
        let one = Level(level::ONE);
        if domain == Domain::Isolines {
            let lines = level::lower(inner[0], share, Spacing::Equal, mode);
            let segments = level::lower(inner[1], share, spacing, mode);
            let outer = [lines, segments, one, one];
            return Some(Shape::from_levels(domain, spacing, outer, [one; 2]));
        }
        let own = self.topology.patches[patch as usize];
        let mut edges = [(one, None); 4];
        for (side, edge) in edges.iter_mut().enumerate().take(domain.outer_levels()) {
            let second = self.middle(patch, side);
            *edge = (
                self.edge(tessellator, own[4 + side], share),
                second.map(|(_, second)| self.edge(tessellator, second, share)),
            );
        }
        let inner = inner.map(|inner| level::lower(inner, share, spacing, mode));
        Some(Shape::from_edges(domain, spacing, mode, edges, inner))
    }

    fn edge_vertices(&self, tessellator: &Tessellator, edge: u32, share: u32) -> u32 {
        let level = self.edge(tessellator, edge, share);
        if level.0 == 0 {
            0
        } else {
            level.segments(tessellator.spacing) - 1
        }
    }

    /// Vertices and primitives with levels lowered to `share`.
    fn sizes(&self, tessellator: &Tessellator, share: u32) -> [u64; 2] {
        let corners = self.corners.iter().filter(|used| **used).count() as u64;
        let edges: u64 = (0..self.edges.len() as u32)
            .map(|edge| u64::from(self.edge_vertices(tessellator, edge, share)))
            .sum();
        let mut sizes = [corners + edges, 0];
        for patch in 0..self.inner.len() as u32 {
            if let Some(shape) = self.shape(tessellator, patch, share) {
                sizes[0] += u64::from(shape.inner_vertices());
                sizes[1] += u64::from(shape.primitives());
            }
        }
        sizes
    }

    fn emit(
        &self,
        tessellator: &Tessellator,
        share: u32,
        lowered: u32,
        pools: [u32; 2],
    ) -> MeshTessellation {
        let Tessellator {
            domain,
            spacing,
            winding,
            mode,
        } = *tessellator;
        let mut vertices = Vec::new();
        let mut corner_at = Vec::with_capacity(self.corners.len());
        for (owner, used) in self.topology.corners.iter().zip(&self.corners) {
            corner_at.push(vertices.len() as u32);
            if *used {
                vertices.push(MeshVertex {
                    patch: owner >> 2,
                    at: corner_coordinate(domain, owner & 3),
                });
            }
        }
        let mut edge_at = Vec::with_capacity(self.edges.len());
        let mut edge_segments = Vec::with_capacity(self.edges.len());
        for (edge, owner) in (0_u32..).zip(&self.topology.edges) {
            edge_at.push(vertices.len() as u32);
            let count = self.edge_vertices(tessellator, edge, share);
            let used = self.edges[edge as usize].0 > 0;
            edge_segments.push(count + u32::from(used));
            let places = Edge::new(
                self.edge(tessellator, edge, share).max(Level(level::ONE)),
                spacing,
            );
            vertices.extend((1..=count).map(|i| MeshVertex {
                patch: owner >> 2,
                at: side_coordinate(domain, owner & 3, places.place(i, mode)),
            }));
        }
        let shapes: Vec<Option<Shape>> = (0..self.inner.len() as u32)
            .map(|patch| self.shape(tessellator, patch, share))
            .collect();
        let mut triangles = Vec::new();
        let mut segments = Vec::new();
        for (patch, shape) in (0_u32..).zip(&shapes) {
            let Some(shape) = shape else { continue };
            let inner_at = vertices.len() as u32;
            vertices.extend((0..shape.inner_vertices()).map(|index| MeshVertex {
                patch,
                at: coordinate(shape, VertexRef::Inner(index), mode),
            }));
            let index = |vertex| self.index(patch, shape, vertex, &corner_at, &edge_at, inner_at);
            for t in 0..shape.primitives() {
                let [a, b, c] = shape.primitive(t).map(index);
                match (domain, winding) {
                    (Domain::Isolines, _) => segments.push([a, b]),
                    (_, Winding::Ccw) => triangles.push([a, b, c]),
                    (_, Winding::Cw) => triangles.push([a, c, b]),
                }
            }
        }
        vertices.truncate(pools[0] as usize);
        let primitives = if domain == Domain::Isolines {
            segments.truncate(pools[1] as usize);
            Primitives::Segments(segments)
        } else {
            triangles.truncate(pools[1] as usize);
            for triangle in &mut triangles {
                // A triangle that the pool of vertices does not hold is drawn as a point.
                if triangle.iter().any(|index| *index >= pools[0]) {
                    *triangle = [0; 3];
                }
            }
            Primitives::Triangles(triangles)
        };
        MeshTessellation {
            vertices,
            primitives,
            edge_segments,
            discarded: self.inner.iter().filter(|inner| inner.is_none()).count() as u32,
            lowered,
        }
    }

    /// Place in the pool of a vertex of a patch.
    fn index(
        &self,
        patch: u32,
        shape: &Shape,
        vertex: VertexRef,
        corner_at: &[u32],
        edge_at: &[u32],
        inner_at: u32,
    ) -> u32 {
        let own = &self.topology.patches[patch as usize];
        let along = |word: u32, i: u32, count: u32| {
            let i = if word & REVERSED == 0 { i } else { count - i };
            edge_at[(word & !REVERSED) as usize] + i - 1
        };
        match vertex {
            VertexRef::Inner(index) => inner_at + index,
            VertexRef::Corner(corner) => corner_at[own[corner as usize] as usize],
            VertexRef::Middle(side) => {
                corner_at[self.topology.halves[patch as usize][side as usize] as usize]
            }
            VertexRef::Side(side, i) => {
                let s = side as usize;
                let (count, first) = (shape.sides[s], shape.first[s]);
                if first == 0 {
                    along(own[4 + s], i, count)
                } else if i < first {
                    along(own[4 + s], i, first)
                } else {
                    let second = self.topology.halves[patch as usize][4 + s];
                    along(second, i - first, count - first)
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::half_edge::check;
    use crate::{PatchLayout, shapes};

    #[test]
    fn one_patch_is_what_tessellate_makes_of_it() {
        for (layout, points) in [
            (PatchLayout::TRIANGLE, 3),
            (PatchLayout::QUAD, 4),
            (PatchLayout::lines(4), 4),
        ] {
            let indices = (0..points).collect();
            let mesh = PatchMesh::new(layout, vec![[0.0; 4]; points as usize], indices);
            let mesh = mesh.expect("one patch");
            for spacing in [
                Spacing::Equal,
                Spacing::FractionalEven,
                Spacing::FractionalOdd,
            ] {
                let tessellator = Tessellator {
                    domain: layout.domain,
                    spacing,
                    ..Tessellator::default()
                };
                let levels = Levels {
                    outer: [3.3, 7.0, 1.0, 12.5],
                    inner: [5.2, 9.9],
                };
                let whole = tessellator.tessellate_mesh(&mesh, |_| levels, [u32::MAX; 2]);
                let (coordinates, primitives) = tessellator.tessellate_fixed(&levels);
                let found: Vec<_> = whole.vertices.iter().map(|vertex| vertex.at).collect();
                assert_eq!(found, coordinates, "{layout:?} {spacing:?}");
                assert_eq!(whole.primitives, primitives, "{layout:?} {spacing:?}");
            }
        }
    }

    #[test]
    fn pools_lower_levels_and_are_never_overrun() {
        let mesh = shapes::octahedron(2);
        let tessellator = Tessellator::default();
        let run = |pools| tessellator.tessellate_mesh(&mesh, |_| Levels::uniform(20.0), pools);
        let full = run([u32::MAX; 2]);
        assert_eq!(full.lowered, 0);
        let size = full.vertices.len() as u32;
        let less = run([size / 3, u32::MAX]);
        assert!(less.lowered > 0 && less.vertices.len() as u32 <= size / 3);
        check(less.primitives.triangles(), less.vertices.len()).expect("still closed");
        let least = run([7, 5]);
        assert_eq!((least.vertices.len(), least.primitives.len()), (7, 5));
    }
}
