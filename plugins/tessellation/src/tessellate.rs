//! A whole patch at once.

use super::coordinate::coordinate;
use super::level::Levels;
use super::shape::{Shape, VertexRef};
use super::{Domain, Mode, Spacing, Winding};

/// A patch, tessellated.
#[derive(Clone, Debug, PartialEq)]
pub struct Tessellation {
    /// (u, v, w) of each vertex: corners first, then the sides' from `outer[0]` on, then the inner.
    pub coordinates: Vec<[f32; 3]>,
    /// What joins them.
    pub primitives: Primitives,
}

/// Indices of [`Tessellation::coordinates`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Primitives {
    /// Of triangles and quads.
    Triangles(Vec<[u32; 3]>),
    /// Segments of isolines, from u = 0 to u = 1, line by line.
    Segments(Vec<[u32; 2]>),
}

impl Primitives {
    /// How many there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        match self {
            Self::Triangles(triangles) => triangles.len(),
            Self::Segments(segments) => segments.len(),
        }
    }

    /// Whether the patch was discarded.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The triangles; none of isolines.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        match self {
            Self::Triangles(triangles) => triangles,
            Self::Segments(_) => &[],
        }
    }
}

/// What a tessellator is set to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Tessellator {
    /// Parameter space.
    pub domain: Domain,
    /// How levels become vertices along an edge.
    pub spacing: Spacing,
    /// Orientation of the triangles.
    pub winding: Winding,
    /// How coordinates are rounded.
    pub mode: Mode,
}

/// Tessellates one patch in [`Mode::Exact`], counter-clockwise.
///
/// A discarded patch has no vertices and no primitives.
#[must_use]
pub fn tessellate(domain: Domain, spacing: Spacing, levels: Levels) -> Tessellation {
    Tessellator {
        domain,
        spacing,
        ..Default::default()
    }
    .tessellate(&levels)
}

/// 2⁻²⁴: the unit of coordinates.
const STEP: f32 = 1.0 / super::place::UNIT as f32;

impl Tessellator {
    /// Tessellates one patch. A discarded patch has no vertices and no primitives.
    #[must_use]
    pub fn tessellate(&self, levels: &Levels) -> Tessellation {
        let fixed = self.tessellate_fixed(levels);
        Tessellation {
            coordinates: fixed
                .0
                .iter()
                // Exact: at most 2^24.
                .map(|c| c.map(|c| c as f32 * STEP))
                .collect(),
            primitives: fixed.1,
        }
    }

    /// As [`Self::tessellate`], with coordinates in units of 2⁻²⁴.
    #[must_use]
    pub fn tessellate_fixed(&self, levels: &Levels) -> (Vec<[u32; 3]>, Primitives) {
        let lines = self.domain == Domain::Isolines;
        let Some(shape) = Shape::new(levels, self.domain, self.spacing, self.mode) else {
            let none = if lines {
                Primitives::Segments(Vec::new())
            } else {
                Primitives::Triangles(Vec::new())
            };
            return (Vec::new(), none);
        };
        let corners = shape.corners();
        let mut vertices: Vec<VertexRef> = (0..corners).map(VertexRef::Corner).collect();
        for side in 0..corners {
            vertices.extend((1..shape.sides[side as usize]).map(|i| VertexRef::Side(side, i)));
        }
        vertices.extend((0..shape.inner_vertices()).map(VertexRef::Inner));
        let coordinates = vertices
            .iter()
            .map(|vertex| coordinate(&shape, *vertex, self.mode))
            .collect();
        let primitives = (0..shape.primitives()).map(|t| {
            let [a, b, c] = shape.primitive(t).map(|vertex| index(&shape, vertex));
            match self.winding {
                Winding::Ccw => [a, b, c],
                Winding::Cw => [a, c, b],
            }
        });
        let primitives = if lines {
            // The second and third vertex of a segment are the same.
            Primitives::Segments(primitives.map(|[a, b, _]| [a, b]).collect())
        } else {
            Primitives::Triangles(primitives.collect())
        };
        (coordinates, primitives)
    }
}

/// Place of a vertex among all of its patch: corners, sides, inner.
fn index(shape: &Shape, vertex: VertexRef) -> u32 {
    let inner = |side: u32| shape.sides[side as usize] - 1;
    match vertex {
        VertexRef::Corner(corner) => corner,
        // No single patch has a split side.
        VertexRef::Middle(_) => unreachable!("sides are split by a mesh alone"),
        VertexRef::Side(side, i) => shape.corners() + (0..side).map(inner).sum::<u32>() + i - 1,
        VertexRef::Inner(i) => shape.corners() + (0..shape.corners()).map(inner).sum::<u32>() + i,
    }
}
