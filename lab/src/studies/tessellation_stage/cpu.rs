//! What the stage emits for a pair of patches, on the CPU: edges and corners once, by the patch that
//! owns them, as the passes of emission do.

use super::pairs::{Pair, layout};
use super::seam::{Bits, Seam, Seams};
use dolomite_tessellation::coordinate::{Coordinate, corner_coordinate, side_coordinate};
use dolomite_tessellation::patches::REVERSED;
use dolomite_tessellation::place::UNIT;
use dolomite_tessellation::shape::Shape;
use dolomite_tessellation::{Domain, Levels, PatchMesh, Tessellator};

/// Whether the patches of a pair share their common side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sharing {
    /// One edge: the greater level, vertices evaluated once.
    Shared,
    /// Each patch has its own control points: each evaluates its side for itself.
    Apart,
}

/// What was found along the common side of a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Found {
    /// By bits of positions.
    pub seam: Seam,
    /// Whether both patches put their vertices at the same places of the side, each by its own
    /// coordinates, to the bit.
    pub places: bool,
}

/// The mesh of a pair; `None` if it is refused, which a pair of whole patches is not.
fn mesh(pair: &Pair, domain: Domain, sharing: Sharing) -> Option<PatchMesh> {
    let layout = layout(domain);
    let count = layout.points;
    let mut indices: Vec<u32> = (0..2 * count).collect();
    if sharing == Sharing::Shared {
        let [a, b] = [0, 1].map(|which| layout.sides[pair.sides[which]]);
        let ends = if pair.along {
            [a[0], a[1]]
        } else {
            [a[1], a[0]]
        };
        for (own, other) in b.iter().zip(ends) {
            indices[(count + own) as usize] = other;
        }
    }
    PatchMesh::new(layout, pair.points.concat(), indices).ok()
}

/// Emits both patches and compares what they use along their common side.
///
/// `None` if a level discards a patch, which levels above 0 do not.
#[must_use]
pub fn compare(tessellator: Tessellator, pair: &Pair, sharing: Sharing) -> Option<Found> {
    let domain = tessellator.domain;
    let mesh = mesh(pair, domain, sharing)?;
    let topology = mesh.topology();
    let edge_of = |patch: usize, side: usize| topology.patches[patch][4 + side];
    let mut wanted = vec![0.0_f32; topology.edges.len()];
    let corners = layout(domain).sides.len();
    for (patch, levels) in pair.levels.iter().enumerate() {
        for side in 0..corners {
            let edge = (edge_of(patch, side) & !REVERSED) as usize;
            wanted[edge] = wanted[edge].max(levels.outer[side]);
        }
    }
    let mut seams = Seams::default();
    let mut places = Vec::new();
    for (patch, own) in pair.levels.iter().enumerate() {
        let mut levels = Levels {
            outer: [1.0; 4],
            inner: own.inner,
        };
        for (side, level) in levels.outer.iter_mut().enumerate().take(corners) {
            *level = wanted[(edge_of(patch, side) & !REVERSED) as usize];
        }
        let shape = Shape::new(&levels, domain, tessellator.spacing, tessellator.mode)?;
        let (coordinates, primitives) = tessellator.tessellate_fixed(&levels);
        let common = pair.sides[patch];
        // Corners first, then the sides' vertices, then the inner ones.
        // A vertex of the next side may lie where the common side ends, to the unit of coordinates,
        // and is none of the common side's: what it is counts, not where it lies.
        let mut positions: Vec<Bits> = Vec::with_capacity(coordinates.len());
        let mut on = vec![false; coordinates.len()];
        for (corner, number) in (0_u32..).zip(&topology.patches[patch][..corners]) {
            let owner = topology.corners[*number as usize];
            let at = corner_coordinate(domain, owner & 3);
            on[positions.len()] =
                [common, (common + corners - 1) % corners].contains(&(corner as usize));
            positions.push(position(domain, &pair.points[(owner >> 2) as usize], at));
            debug_assert_eq!(
                corner_coordinate(domain, corner),
                coordinates[corner as usize]
            );
        }
        for side in 0..corners {
            let edge = edge_of(patch, side);
            let owner = topology.edges[(edge & !REVERSED) as usize];
            let segments = shape.sides[side];
            for i in 1..segments {
                let number = if edge & REVERSED == 0 {
                    i
                } else {
                    segments - i
                };
                // The owner places the vertex along its own side.
                let along =
                    dolomite_tessellation::place::Edge::new(shape.outer[side], tessellator.spacing)
                        .place(number, tessellator.mode);
                let at = side_coordinate(domain, owner & 3, along);
                on[positions.len()] = side == common;
                positions.push(position(domain, &pair.points[(owner >> 2) as usize], at));
            }
        }
        for at in &coordinates[positions.len()..] {
            positions.push(position(domain, &pair.points[patch], *at));
        }
        let mut used = vec![false; positions.len()];
        for triangle in primitives.triangles() {
            let corner = |k: usize| {
                let vertex = triangle[k] as usize;
                (positions[vertex], on[vertex])
            };
            for vertex in triangle {
                used[*vertex as usize] = true;
            }
            seams.add(0, [corner(0), corner(1), corner(2)]);
        }
        let mut along: Vec<u32> = (0..positions.len())
            .filter(|vertex| on[*vertex] && used[*vertex])
            .map(|vertex| {
                let place = place_on(domain, common, &coordinates[vertex]);
                if patch == 1 && !pair.along {
                    UNIT - place
                } else {
                    place
                }
            })
            .collect();
        along.sort_unstable();
        along.dedup();
        places.push(along);
    }
    Some(Found {
        seam: seams.found(1)[0],
        places: places[0] == places[1],
    })
}

/// How far along a side a coordinate on it lies, in units of 2⁻²⁴.
const fn place_on(domain: Domain, side: usize, at: &Coordinate) -> u32 {
    match (domain, side) {
        (Domain::Triangles, 0) => at[2],
        (Domain::Triangles, 1) => at[0],
        (Domain::Triangles, _) => at[1],
        (_, 0) => UNIT - at[1],
        (_, 1) => at[0],
        (_, 2) => at[1],
        _ => UNIT - at[0],
    }
}

/// The flat patch's vertex, as `functions/plane.wgsl` evaluates it.
fn position(domain: Domain, points: &[[f32; 4]], at: Coordinate) -> Bits {
    let [u, v] = [at[0], at[1]].map(|x| x as f32 / UNIT as f32);
    let [a, b, c] = [points[0], points[1], points[2]];
    std::array::from_fn(|k| {
        let place = if domain == Domain::Triangles {
            c[k] + (a[k] - c[k]) * u + (b[k] - c[k]) * v
        } else {
            let d = points[3];
            a[k] + (b[k] - a[k]) * u + (d[k] - a[k]) * v + (a[k] - b[k] + c[k] - d[k]) * (u * v)
        };
        // Both zeros are one place.
        (place + 0.0).to_bits()
    })
}

#[cfg(test)]
mod tests {
    use super::super::pairs::{TESSELLATORS, pair, tessellator};
    use super::*;
    use dolomite_testkit::random::Random;

    #[test]
    fn shared_sides_are_closed_and_others_are_not() {
        let mut random = Random::new(9);
        let (mut apart, mut equal) = (0, 0);
        for k in 0..20 * TESSELLATORS {
            let tessellator = tessellator(k);
            let pair = pair(&mut random, tessellator.domain);
            let found = compare(tessellator, &pair, Sharing::Shared).unwrap();
            assert_eq!(
                (found.seam.open, found.places),
                (0, true),
                "{tessellator:?} {pair:?}"
            );
            assert!(found.seam.vertices >= 2);
            let other = compare(tessellator, &pair, Sharing::Apart).unwrap();
            apart += usize::from(other.seam.open > 0);
            let pair = pair.with_equal_levels();
            let other = compare(tessellator, &pair, Sharing::Apart).unwrap();
            equal += usize::from(other.seam.open > 0);
            assert!(other.places);
        }
        // Sides next to the common one whose first vertex lies at its end, but has other bits.
        for k in 0..20 * TESSELLATORS {
            let tessellator = tessellator(k);
            let mut pair = pair(&mut random, tessellator.domain);
            for which in 0..2 {
                for (side, level) in pair.levels[which].outer.iter_mut().enumerate() {
                    if side != pair.sides[which] {
                        *level = 1.0_f32.next_up();
                    }
                }
            }
            let found = compare(tessellator, &pair, Sharing::Shared).unwrap();
            assert_eq!(
                (found.seam.open, found.places),
                (0, true),
                "{tessellator:?} {pair:?}"
            );
        }
        // Of 240: where levels differ, and where they do not but the rounding of positions does.
        assert!(apart > 150, "{apart}");
        assert!(equal > 50, "{equal}");
    }
}
