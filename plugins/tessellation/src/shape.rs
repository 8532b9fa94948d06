//! How many vertices and primitives a patch has, and which vertices each primitive joins; any
//! primitive by its number, without the ones before it. The CPU reference of `shaders/src/stage/shape.wgsl`.

use super::level::{self, Level, Levels};
use super::ruler::{Step, half_strip, regular, transition};
use super::{Domain, Mode, Spacing};

/// A patch whose levels are clamped and rounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Parameter space.
    pub domain: Domain,
    /// Of all its levels, but for the number of isolines, which is always equal.
    pub spacing: Spacing,
    /// Levels of the sides; isolines: of the lines' count, then of their segments.
    pub outer: [Level; 4],
    /// Levels along u and v.
    pub inner: [Level; 2],
    /// Levels of the second halves of sides that are split (`PatchLayout::split`); `outer` holds those of their first halves.
    pub second: [Level; 4],
    /// Segments of the sides; isolines: lines, then segments of each.
    pub sides: [u32; 4],
    /// Segments of the first halves of sides that are split; 0 for those that are not.
    pub first: [u32; 4],
    /// Segments along u and v. (1, 1) only where every side has one segment.
    pub rows: [u32; 2],
}

/// A vertex of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VertexRef {
    /// A corner of the patch.
    Corner(u32),
    /// Vertex 1 to n − 1 of side 0 to 3, counted counter-clockwise.
    Side(u32, u32),
    /// The corner in the middle of a side that is split.
    Middle(u32),
    /// An inner vertex; of isolines: any vertex.
    Inner(u32),
}

impl Shape {
    /// The shape of a patch; `None` where an outer level discards it.
    #[must_use]
    pub fn new(levels: &Levels, domain: Domain, spacing: Spacing, mode: Mode) -> Option<Self> {
        let mut outer = [Level(level::ONE); 4];
        for (side, level) in outer.iter_mut().enumerate().take(domain.outer_levels()) {
            let lines = domain == Domain::Isolines && side == 0;
            let spacing = if lines { Spacing::Equal } else { spacing };
            *level = level::outer(levels.outer[side], spacing, mode)?;
        }
        let inner = level::inner(levels.inner, &outer, domain, spacing, mode);
        Some(Self::from_levels(domain, spacing, outer, inner))
    }

    /// The shape of levels that are clamped and rounded already.
    #[must_use]
    pub fn from_levels(
        domain: Domain,
        spacing: Spacing,
        outer: [Level; 4],
        inner: [Level; 2],
    ) -> Self {
        let mut sides = outer.map(|level| level.segments(spacing));
        if domain == Domain::Isolines {
            sides[0] = outer[0].segments(Spacing::Equal);
        }
        let rows = inner.map(|level| level.segments(spacing));
        Self {
            domain,
            spacing,
            outer,
            inner,
            second: [Level(0); 4],
            sides,
            first: [0; 4],
            rows,
        }
    }

    /// The shape of a patch of triangles or quads whose sides lie along one edge or two: the levels
    /// of those edges, clamped and rounded, and the inner levels, clamped but not yet lifted.
    #[must_use]
    pub fn from_edges(
        domain: Domain,
        spacing: Spacing,
        mode: Mode,
        edges: [(Level, Option<Level>); 4],
        inner: [Level; 2],
    ) -> Self {
        let count = domain.outer_levels();
        // A split side has two segments at least.
        let whole = edges.map(|(level, second)| {
            if second.is_some() {
                level.max(Level(2 * level::ONE))
            } else {
                level
            }
        });
        let inner = level::lift_inner(inner, &whole[..count], spacing, mode);
        let mut shape = Self::from_levels(domain, spacing, edges.map(|(level, _)| level), inner);
        for (side, (level, second)) in edges.into_iter().enumerate().take(count) {
            if let Some(second) = second {
                shape.second[side] = second;
                shape.first[side] = level.segments(spacing);
                shape.sides[side] = shape.first[side] + second.segments(spacing);
            }
        }
        shape
    }

    /// Corners and sides: 3 or 4; isolines have none.
    #[must_use]
    pub const fn corners(&self) -> u32 {
        match self.domain {
            Domain::Triangles => 3,
            Domain::Quads => 4,
            Domain::Isolines => 0,
        }
    }

    /// Vertices off the outline; of isolines: all.
    #[must_use]
    pub const fn inner_vertices(&self) -> u32 {
        let [a, b] = self.rows;
        match self.domain {
            // Rings of 3 (a - 2 k) vertices, the last one a single vertex where a is even.
            Domain::Triangles => {
                let rings = a / 2;
                let sum = 3 * rings * (a - 1 - rings);
                if a.is_multiple_of(2) { sum + 1 } else { sum }
            }
            Domain::Quads => (a - 1) * (b - 1),
            Domain::Isolines => self.sides[0] * (self.sides[1] + 1),
        }
    }

    /// All vertices.
    #[must_use]
    pub fn vertices(&self) -> u32 {
        let sides = &self.sides[..self.corners() as usize];
        self.inner_vertices() + sides.iter().sum::<u32>()
    }

    /// Triangles, or segments of isolines.
    #[must_use]
    pub fn primitives(&self) -> u32 {
        let [a, b] = self.rows;
        match self.domain {
            Domain::Isolines => self.sides[0] * self.sides[1],
            _ if self.is_plain() => self.corners() - 2,
            _ => {
                self.grid()
                    + self.sides[..self.corners() as usize].iter().sum::<u32>()
                    + if self.domain == Domain::Triangles {
                        3 * (a - 2)
                    } else {
                        2 * (a - 2) + 2 * (b - 2)
                    }
            }
        }
    }

    /// Whether the patch is its outline: one triangle, or two.
    #[must_use]
    pub const fn is_plain(&self) -> bool {
        self.rows[0] == 1
    }

    /// Triangles inside the strips that meet the sides.
    const fn grid(&self) -> u32 {
        let [a, b] = self.rows;
        match self.domain {
            Domain::Triangles => {
                // Strips of 3 (2 m - 2) triangles, m = a - 2 k, and a last triangle where a is odd.
                let strips = a / 2 - 1;
                6 * strips * (a - 2 - strips) + a % 2
            }
            Domain::Quads => 2 * (a - 2) * (b - 2),
            Domain::Isolines => 0,
        }
    }

    /// The vertices of primitive `t` of [`Self::primitives`], counter-clockwise; the segments of
    /// isolines have two, of which the second is repeated.
    #[must_use]
    pub fn primitive(&self, t: u32) -> [VertexRef; 3] {
        let [a, b] = self.rows;
        match self.domain {
            Domain::Isolines => {
                let start = t + t / self.sides[1];
                [start, start + 1, start + 1].map(VertexRef::Inner)
            }
            _ if self.is_plain() => {
                // Of a quad: (0, 1, 3) and (1, 2, 3).
                [t, t + 1, if self.domain == Domain::Quads { 3 } else { 2 }].map(VertexRef::Corner)
            }
            Domain::Triangles => {
                let grid = self.grid();
                if t < grid {
                    self.ring_triangle(t)
                } else {
                    self.side_triangle(t - grid)
                }
            }
            Domain::Quads => {
                let grid = self.grid();
                if t < grid {
                    let (cell, second) = (t / 2, t % 2 == 1);
                    let (i, j) = (1 + cell % (a - 2), 1 + cell / (a - 2));
                    self.cell_triangle(i, j, 2 * i < a, 2 * j < b, second)
                } else {
                    self.side_triangle(t - grid)
                }
            }
        }
    }

    /// A half of the cell whose least corner is (i, j), split along the diagonal that points to the
    /// middle of the patch.
    fn cell_triangle(&self, i: u32, j: u32, left: bool, low: bool, second: bool) -> [VertexRef; 3] {
        let corners = match (left == low, second) {
            (true, false) => [(i, j), (i + 1, j), (i + 1, j + 1)],
            (true, true) => [(i, j), (i + 1, j + 1), (i, j + 1)],
            (false, false) => [(i, j), (i + 1, j), (i, j + 1)],
            (false, true) => [(i + 1, j), (i + 1, j + 1), (i, j + 1)],
        };
        corners.map(|(i, j)| VertexRef::Inner((j - 1) * (self.rows[0] - 1) + i - 1))
    }

    /// Triangle `t` of the strips that meet the sides, side 0 first.
    fn side_triangle(&self, mut t: u32) -> [VertexRef; 3] {
        let mut side = 0;
        loop {
            let along = self.along(side);
            let count = self.sides[side as usize] + along - 2;
            if t < count || side + 1 == self.corners() {
                let step = self.side_step(side, along, t);
                let outer = |i| self.side_vertex(side, i);
                let inner = |i| self.row_vertex(side, i);
                return strip_triangle(step, outer, inner);
            }
            t -= count;
            side += 1;
        }
    }

    /// Step `t` of the strip along a side. Each half of a split side has its half of the inner row.
    fn side_step(&self, side: u32, along: u32, t: u32) -> Step {
        let (total, first) = (self.sides[side as usize], self.first[side as usize]);
        if first == 0 {
            return transition(total, along, t);
        }
        let (row, half) = (along - 2, (along - 2) / 2);
        if t < first + half {
            return half_strip(first, half, t);
        }
        let step = half_strip(total - first, row - half, t - first - half);
        Step {
            outer: step.outer + first,
            inner: step.inner + half,
            ..step
        }
    }

    /// Inner segments parallel to a side.
    const fn along(&self, side: u32) -> u32 {
        match self.domain {
            // Sides 1 and 3 of a quad run along u.
            Domain::Quads => self.rows[1 - side as usize % 2],
            _ => self.rows[0],
        }
    }

    /// Vertex `i` of 0 to n of a side, counter-clockwise.
    fn side_vertex(&self, side: u32, i: u32) -> VertexRef {
        let corners = self.corners();
        if i == 0 {
            VertexRef::Corner((side + corners - 1) % corners)
        } else if i == self.sides[side as usize] {
            VertexRef::Corner(side)
        } else if i == self.first[side as usize] {
            VertexRef::Middle(side)
        } else {
            VertexRef::Side(side, i)
        }
    }

    /// Vertex `i` of 0 to n − 2 of the outline of the inner vertices along a side.
    fn row_vertex(&self, side: u32, i: u32) -> VertexRef {
        let [a, b] = self.rows;
        VertexRef::Inner(match self.domain {
            Domain::Quads => {
                let columns = a - 1;
                match side {
                    0 => (b - 2 - i) * columns,
                    1 => i,
                    2 => i * columns + columns - 1,
                    _ => (b - 2) * columns + columns - 1 - i,
                }
            }
            _ => ring_vertex(a, 1, side, i),
        })
    }

    /// Triangle `t` of the strips between rings, from the outermost inwards.
    fn ring_triangle(&self, t: u32) -> [VertexRef; 3] {
        let a = self.rows[0];
        if a % 2 == 1 && t + 1 == self.grid() {
            let base = ring_start(a, a / 2);
            return [base, base + 1, base + 2].map(VertexRef::Inner);
        }
        // The strip inside ring k starts at 6 (k - 1) (a - 1 - k).
        let k = ring_of(a - 1, t / 6, a / 2 - 1);
        let m = a - 2 * k;
        let place = t - 6 * (k - 1) * (a - 1 - k);
        let (side, place) = (place / (2 * m - 2), place % (2 * m - 2));
        let outer = |i| VertexRef::Inner(ring_vertex(a, k, side, i));
        let inner = |i| VertexRef::Inner(ring_vertex(a, k + 1, side, i));
        strip_triangle(regular(m, place), outer, inner)
    }
}

/// First vertex of ring `k` ≥ 1 of a triangle with `a` inner segments: the rings before have
/// 3 (a − 2 r) vertices each.
#[must_use]
pub const fn ring_start(a: u32, k: u32) -> u32 {
    3 * (k - 1) * (a - k)
}

/// Vertex `i` of side `side` of ring `k`; the last one of a side is the first of the next.
const fn ring_vertex(a: u32, k: u32, side: u32, i: u32) -> u32 {
    let m = a - 2 * k;
    if m == 0 {
        return ring_start(a, k);
    }
    ring_start(a, k) + (side * m + i) % (3 * m)
}

/// The greatest k from 1 to `last` with (k − 1) (s − k) ≤ `place`.
#[must_use]
pub const fn ring_of(s: u32, place: u32, last: u32) -> u32 {
    // At most 32 rings: five halvings find it.
    let mut low = 1;
    let mut high = last;
    while low < high {
        let middle = (low + high).div_ceil(2);
        if (middle - 1) * (s - middle) <= place {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    low
}

fn strip_triangle(
    step: Step,
    outer: impl Fn(u32) -> VertexRef,
    inner: impl Fn(u32) -> VertexRef,
) -> [VertexRef; 3] {
    let (i, j) = (step.outer, step.inner);
    if step.advances_outer {
        [outer(i), outer(i + 1), inner(j)]
    } else {
        [outer(i), inner(j + 1), inner(j)]
    }
}
