//! What is asked of a tessellated patch: the counts and coordinates of a capture, an exact cover of
//! its domain, one winding.

use super::cases::Case;
use super::rational::D3D_RING_REACH;
use dolomite_tessellation::half_edge;
use dolomite_tessellation::place::UNIT;
use dolomite_tessellation::shape::Shape;
use dolomite_tessellation::{Domain, Levels, Mode, Primitives, Tessellator, Winding};
use serde::Serialize;

/// Coordinates in units of 2⁻²⁴, and what joins them.
pub type Patch = (Vec<[u32; 3]>, Primitives);

/// Farthest that a coordinate may lie from the capture's: its own fixed point is off by up to
/// 1.9e-4 along an edge in equal spacing. See `reach` for what lies inside of triangles.
pub const COORDINATE_REACH: f64 = 2e-4;

/// Farthest that a vertex may lie from its partner. The captures' fixed point moves what is inside of
/// a triangle by more than what is on an edge, at most by [`D3D_RING_REACH`] (at level 53 by 2.5e-4),
/// so that much the exact coordinate may be off from theirs; mode `D3d` has their rounding itself.
fn reach(domain: Domain, mode: Mode, vertex: &[f64; 3]) -> f64 {
    let inside = domain == Domain::Triangles && vertex.iter().all(|c| *c > 0.0);
    if mode == Mode::Exact && inside {
        D3D_RING_REACH
    } else {
        COORDINATE_REACH
    }
}

/// What was found wrong, summed over cases.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Faults {
    /// Cases with another number of primitives.
    pub count_mismatches: usize,
    /// Vertices without a partner within 2e-4 (2.8e-4 inside of triangles in mode `exact`), on either
    /// side.
    pub coordinate_mismatches: usize,
    /// Farthest distance of a vertex to its nearest partner, in the worst coordinate.
    pub max_coordinate_error: f64,
    /// Cases whose primitives do not cover their domain once.
    pub cover_failures: usize,
    /// Cases with a primitive of the wrong orientation.
    pub winding_failures: usize,
}

impl Faults {
    /// Adds what was found elsewhere.
    pub fn add(&mut self, other: &Self) {
        self.count_mismatches += other.count_mismatches;
        self.coordinate_mismatches += other.coordinate_mismatches;
        self.max_coordinate_error = self.max_coordinate_error.max(other.max_coordinate_error);
        self.cover_failures += other.cover_failures;
        self.winding_failures += other.winding_failures;
    }

    /// Whether nothing is wrong.
    pub const fn none(&self) -> bool {
        self.count_mismatches + self.coordinate_mismatches == 0
            && self.cover_failures + self.winding_failures == 0
    }
}

/// Compares a patch with its capture.
pub fn against_capture(case: &Case, mode: Mode, patch: &Patch) -> Faults {
    let tessellator = Tessellator {
        mode,
        ..case.tessellator
    };
    let ours: Vec<[f64; 3]> = patch
        .0
        .iter()
        .map(|vertex| vertex.map(|c| f64::from(c) / f64::from(UNIT)))
        .collect();
    let (mut mismatches, mut error) = (0, 0.0_f64);
    for (from, to) in [(&ours, &case.vertices), (&case.vertices, &ours)] {
        let sorted = Sorted::new(to);
        for vertex in from {
            let distance = sorted.nearest(vertex);
            // `inf` of an empty patch is a mismatch and no error that could be plotted.
            let reach = reach(tessellator.domain, mode, vertex);
            mismatches += usize::from(distance > reach);
            if distance.is_finite() {
                error = error.max(distance);
            }
        }
    }
    Faults {
        count_mismatches: usize::from(patch.1.len() != case.primitives.len()),
        coordinate_mismatches: mismatches,
        max_coordinate_error: error,
        cover_failures: usize::from(!covers(&tessellator, &case.levels, patch)),
        winding_failures: usize::from(!is_wound(&tessellator, patch)),
    }
}

/// Points in the order of u, to find the nearest.
struct Sorted(Vec<[f64; 3]>);

impl Sorted {
    fn new(points: &[[f64; 3]]) -> Self {
        let mut points = points.to_vec();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Self(points)
    }

    /// Distance to the nearest point, in the coordinate where it is greatest.
    fn nearest(&self, point: &[f64; 3]) -> f64 {
        let start = self.0.partition_point(|other| other[0] < point[0]);
        let mut best = f64::INFINITY;
        let mut see = |other: &[f64; 3]| {
            let apart = (0..3)
                .map(|k| (other[k] - point[k]).abs())
                .fold(0.0, f64::max);
            best = best.min(apart);
            (other[0] - point[0]).abs() <= best
        };
        let _ = self.0[start..].iter().all(&mut see);
        let _ = self.0[..start].iter().rev().all(&mut see);
        best
    }
}

/// Whether the patch covers its domain once: a disc whose border passes the vertices of the sides in
/// order, whose areas sum to the domain's to the bit. (Areas of one sign, which [`is_wound`] asks
/// for, then leave no overlap.) Isolines: lines from u = 0 to u = 1, at v = k / lines.
pub fn covers(tessellator: &Tessellator, levels: &Levels, patch: &Patch) -> bool {
    let (coordinates, primitives) = patch;
    let shape = Shape::new(
        levels,
        tessellator.domain,
        tessellator.spacing,
        tessellator.mode,
    );
    let Some(shape) = shape else {
        return coordinates.is_empty() && primitives.is_empty();
    };
    let triangles = match primitives {
        Primitives::Segments(segments) => return lines_cover(&shape, coordinates, segments),
        Primitives::Triangles(triangles) => triangles,
    };
    let Ok(manifold) = half_edge::check(triangles, coordinates.len()) else {
        return false;
    };
    if manifold.euler != 1 || manifold.borders.len() != 1 {
        return false;
    }
    let border = &manifold.borders[0];
    let sides = &shape.sides[..shape.corners() as usize];
    // The border runs along the outline of the domain: each vertex on it, in order, turned once.
    let mut around: Vec<u64> = border
        .iter()
        .filter_map(|vertex| along_outline(tessellator.domain, coordinates[*vertex as usize]))
        .collect();
    if tessellator.winding == Winding::Cw {
        around.reverse();
    }
    if around.len() != border.len() || around.len() != sides.iter().sum::<u32>() as usize {
        return false;
    }
    let falls = (0..around.len())
        .filter(|k| around[(k + 1) % around.len()] < around[*k])
        .count();
    let whole: i64 = triangles
        .iter()
        .map(|triangle| double_area(coordinates, triangle))
        .sum();
    let unit = i64::from(UNIT);
    let expected = if tessellator.domain == Domain::Quads {
        2 * unit * unit
    } else {
        unit * unit
    };
    falls == 1 && whole.abs() == expected
}

/// Distance along the outline, counter-clockwise from corner 0; `None` off it.
fn along_outline(domain: Domain, [u, v, w]: [u32; 3]) -> Option<u64> {
    let unit = u64::from(UNIT);
    let (u, v, w) = (u64::from(u), u64::from(v), u64::from(w));
    match domain {
        // Corners w, u, v.
        _ if v == 0 && (domain == Domain::Quads || u + w == unit) => Some(u),
        Domain::Triangles if w == 0 && u + v == unit => Some(unit + v),
        Domain::Triangles if u == 0 && v + w == unit => Some(2 * unit + w),
        Domain::Quads if u == unit => Some(unit + v),
        Domain::Quads if v == unit => Some(3 * unit - u),
        Domain::Quads if u == 0 => Some(4 * unit - v),
        _ => None,
    }
}

fn lines_cover(shape: &Shape, coordinates: &[[u32; 3]], segments: &[[u32; 2]]) -> bool {
    let [lines, detail, ..] = shape.sides;
    if segments.len() != (lines * detail) as usize {
        return false;
    }
    let mut last = None;
    for line in segments.chunks(detail as usize) {
        let at = |index: u32| coordinates.get(index as usize).copied();
        let (Some(first), Some(end)) = (at(line[0][0]), at(line[line.len() - 1][1])) else {
            return false;
        };
        let joined = line.windows(2).all(|pair| pair[0][1] == pair[1][0]);
        let rising = line.iter().all(|[from, to]| {
            let (Some(from), Some(to)) = (at(*from), at(*to)) else {
                return false;
            };
            from[0] <= to[0] && from[1] == first[1] && to[1] == first[1]
        });
        let higher = last.is_none_or(|last| last < first[1]) && first[1] < UNIT;
        if !(joined && rising && higher && first[0] == 0 && end[0] == UNIT) {
            return false;
        }
        last = Some(first[1]);
    }
    true
}

/// Twice the area of a triangle in the (u, v) plane, in units of 2⁻⁴⁸.
fn double_area(coordinates: &[[u32; 3]], triangle: &[u32; 3]) -> i64 {
    let [a, b, c] = triangle.map(|vertex| coordinates[vertex as usize].map(i64::from));
    (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
}

/// Whether no triangle is turned over. Slivers of vertices that have only begun to grow out of
/// their neighbours are narrower than a coordinate's rounding (two units): those may lie flat or turn
/// by it.
pub fn is_wound(tessellator: &Tessellator, patch: &Patch) -> bool {
    let (coordinates, primitives) = patch;
    let rounding = match tessellator.mode {
        Mode::Exact => 2,
        Mode::D3d => 2 << 8,
    };
    primitives.triangles().iter().all(|triangle| {
        let area = double_area(coordinates, triangle);
        let area = if tessellator.winding == Winding::Cw {
            -area
        } else {
            area
        };
        let corners = triangle.map(|vertex| coordinates[vertex as usize].map(i64::from));
        let longest = (0..3)
            .flat_map(|k| {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                [(a[0] - b[0]).abs(), (a[1] - b[1]).abs()]
            })
            .max();
        area >= -rounding * longest.unwrap_or(0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use dolomite_tessellation::Spacing;

    /// A capture as the reference makes it: 16.16 fixed point.
    fn capture(level: f32) -> Case {
        let tessellator = Tessellator {
            spacing: Spacing::Equal,
            mode: Mode::D3d,
            ..Default::default()
        };
        let levels = Levels::uniform(level);
        let (vertices, primitives) = tessellator.tessellate_fixed(&levels);
        Case {
            tessellator,
            levels,
            vertices: vertices
                .iter()
                .map(|vertex| vertex.map(|c| f64::from(c) / f64::from(UNIT)))
                .collect(),
            primitives: primitives
                .triangles()
                .iter()
                .map(|triangle| triangle.to_vec())
                .collect(),
        }
    }

    fn exact(case: &Case) -> Faults {
        let tessellator = Tessellator {
            mode: Mode::Exact,
            ..case.tessellator
        };
        let patch = tessellator.tessellate_fixed(&case.levels);
        against_capture(case, Mode::Exact, &patch)
    }

    #[test]
    fn the_reference_is_farther_off_inside_of_triangles() {
        for level in [7.0, 44.0, 49.0, 53.0, 61.0, 64.0] {
            let faults = exact(&capture(level));
            assert!(faults.none(), "{level}: {faults:?}");
        }
        // Farther than an edge's vertex may be, so that the wider reach is needed.
        assert!(exact(&capture(53.0)).max_coordinate_error > COORDINATE_REACH);
    }

    #[test]
    fn what_is_farther_than_the_references_rounding_is_seen() {
        let mut case = capture(16.0);
        let inside = case
            .vertices
            .iter()
            .position(|vertex| vertex.iter().all(|c| *c > 0.1))
            .expect("an inner vertex");
        case.vertices[inside][0] += 3e-4;
        assert_eq!(exact(&case).coordinate_mismatches, 2, "from both sides");
        let mut case = capture(16.0);
        let side = case
            .vertices
            .iter()
            .position(|vertex| vertex[0] == 0.0 && vertex[1] > 0.1 && vertex[2] > 0.1)
            .expect("a vertex of a side");
        case.vertices[side][1] += 2.3e-4;
        assert_eq!(exact(&case).coordinate_mismatches, 2, "from both sides");
    }
}
