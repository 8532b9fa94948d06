//! The invariance rules of OpenGL 4.6 core, A.4, and Vulkan 1.3, "Tessellation Invariance".
//!
//! Each rule compares a patch with another one whose levels differ where the rule says that they do
//! not matter. The stage is a parameter, so that tests can break it. Vertices are told apart by their
//! place in the list (corners, sides, inner) and compared by their coordinates, to the bit.

use super::check::Patch;
use super::expected::expected;
use super::outline::{Outline, sorted};
use super::random::Tuple;
use dolomite_tessellation::place::UNIT;
use dolomite_tessellation::{Domain, Levels, Primitives, Tessellator, Winding};

/// Number of rules.
pub const RULES: usize = 8;

/// What each rule asks, from rule 1 on.
pub const ASKED: [&str; RULES] = [
    "same input, same output; levels that the domain does not have are no input",
    "vertices of a side depend on that side's level and the spacing alone",
    "vertices of a side are symmetric to the bit",
    "vertices of a side do not depend on which side it is",
    "the winding changes the order of corners alone",
    "triangles off the outline depend on the inner levels alone",
    "triangles at a side depend on its level and the inner levels alone",
    "coordinates are in [0, 1], 1 - x is exact, u + v + w is 1",
];

/// What came of each rule, from rule 1 on; `None` where it says nothing about the patch.
pub type Verdicts = [Option<bool>; RULES];

/// Tries every rule on `patch`, which `stage` made of the tuple.
pub fn verdicts(
    tuple: &Tuple,
    patch: &Patch,
    stage: impl Fn(&Tessellator, &Levels) -> Patch,
) -> Verdicts {
    let Tuple {
        tessellator,
        levels,
        others,
        side,
        other_side,
    } = *tuple;
    let domain = tessellator.domain;
    let again = &stage(&tessellator, &with_other_unused(domain, &levels, &others));
    let turned = Tessellator {
        winding: match tessellator.winding {
            Winding::Ccw => Winding::Cw,
            Winding::Cw => Winding::Ccw,
        },
        ..tessellator
    };
    let mut verdicts = [None; RULES];
    verdicts[0] = Some(again == patch);
    verdicts[4] = Some(is_turned(patch, &stage(&turned, &levels)));
    verdicts[7] = Some(holds_rule_8(domain, &patch.0));
    let Some(outline) = Outline::of(&tessellator, &levels, patch) else {
        // Discarded, or of wrong counts, which is a fault of its own.
        return verdicts;
    };
    if domain == Domain::Isolines {
        verdicts[2] = Some(lines_are_symmetric(&patch.0));
        return verdicts;
    }
    let with = |levels: &Levels| {
        let other = stage(&tessellator, levels);
        let outline = Outline::of(&tessellator, levels, &other);
        (other, outline)
    };
    // Of a patch whose counts are wrong nothing holds.
    let judged = |outline: Option<&Outline>, judge: &dyn Fn(&Outline) -> bool| {
        Some(outline.is_some_and(judge))
    };

    let mut all_but_side = others;
    all_but_side.outer[side] = levels.outer[side];
    let (other, other_outline) = with(&all_but_side);
    verdicts[1] = judged(other_outline.as_ref(), &|other_outline| {
        sorted(outline.side(patch, side)) == sorted(other_outline.side(&other, side))
    });

    verdicts[2] = Some(
        (0..domain.outer_levels())
            .all(|side| side_is_symmetric(domain, side, outline.side(patch, side))),
    );

    let mut moved = levels;
    moved.outer[other_side] = levels.outer[side];
    let (other, other_outline) = with(&moved);
    verdicts[3] = judged(other_outline.as_ref(), &|other_outline| {
        along(domain, side, outline.side(patch, side))
            == along(domain, other_side, other_outline.side(&other, other_side))
    });

    // Inner levels of 1 are lifted where an outer one is above 1: the rule asks for the same ones.
    let same_inner = |levels: &Levels| {
        expected(&tessellator, levels).is_some_and(|e| e.inner == outline.expected.inner)
    };
    let all_outer = Levels {
        outer: others.outer,
        ..levels
    };
    if same_inner(&all_outer) {
        let (other, other_outline) = with(&all_outer);
        verdicts[5] = judged(other_outline.as_ref(), &|other_outline| {
            outline.interior(patch) == other_outline.interior(&other)
        });
    }
    let mut outer_but_side = all_outer;
    outer_but_side.outer[side] = levels.outer[side];
    if same_inner(&outer_but_side) && !outline.expected.is_plain() {
        let (other, other_outline) = with(&outer_but_side);
        verdicts[6] = judged(other_outline.as_ref(), &|other_outline| {
            let mode = tessellator.mode;
            let strip = outline.strip(patch, side, mode);
            strip.is_some() && strip == other_outline.strip(&other, side, mode)
        });
    }
    verdicts
}

/// The same levels where the domain has them, others elsewhere.
fn with_other_unused(domain: Domain, levels: &Levels, others: &Levels) -> Levels {
    let mut mixed = *others;
    let (outer, inner) = (domain.outer_levels(), domain.inner_levels());
    mixed.outer[..outer].copy_from_slice(&levels.outer[..outer]);
    mixed.inner[..inner].copy_from_slice(&levels.inner[..inner]);
    mixed
}

/// Rule 8.
fn holds_rule_8(domain: Domain, coordinates: &[[u32; 3]]) -> bool {
    coordinates.iter().all(|vertex| {
        let [u, v, w] = vertex.map(|c| c as f32 / UNIT as f32);
        let fits = [u, v, w]
            .iter()
            .all(|x| (0.0..=1.0).contains(x) && f64::from(1.0_f32 - x) == 1.0_f64 - f64::from(*x));
        fits && (domain != Domain::Triangles || (u + v) + w == 1.0)
    })
}

/// Rule 5: the same vertices, the same triangles, each turned.
fn is_turned(patch: &Patch, turned: &Patch) -> bool {
    if patch.0 != turned.0 {
        return false;
    }
    let (Primitives::Triangles(one), Primitives::Triangles(other)) = (&patch.1, &turned.1) else {
        return patch.1 == turned.1;
    };
    // The least corner first leaves the orientation as it is.
    let from_least = |[a, b, c]: [u32; 3]| {
        let least = a.min(b).min(c);
        if least == a {
            [a, b, c]
        } else if least == b {
            [b, c, a]
        } else {
            [c, a, b]
        }
    };
    let one = one.iter().map(|t| from_least(*t)).collect();
    let other = other.iter().map(|[a, b, c]| from_least([*a, *c, *b]));
    sorted(one) == sorted(other.collect())
}

/// Rule 3 of isolines: beside each line at v ≠ 0 there is one at exactly 1 − v.
fn lines_are_symmetric(coordinates: &[[u32; 3]]) -> bool {
    let lines: Vec<[u32; 3]> = coordinates
        .iter()
        .filter(|vertex| vertex[1] != 0 && (vertex[0] == 0 || vertex[0] == UNIT))
        .copied()
        .collect();
    let mirrored = lines.iter().map(|[u, v, w]| [*u, UNIT - v, *w]).collect();
    sorted(lines.clone()) == sorted(mirrored)
}

/// Rule 3 of one side.
fn side_is_symmetric(domain: Domain, side: usize, vertices: Vec<[u32; 3]>) -> bool {
    let mirror = |vertex: &[u32; 3]| {
        let mut mirrored = *vertex;
        match domain {
            Domain::Triangles => mirrored.swap((side + 1) % 3, (side + 2) % 3),
            _ => mirrored[1 - side % 2] = UNIT.wrapping_sub(vertex[1 - side % 2]),
        }
        mirrored
    };
    let mirrored = vertices.iter().map(mirror).collect();
    sorted(vertices) == sorted(mirrored)
}

/// Distances of a side's vertices from its start, counter-clockwise, sorted; none if one of them lies
/// off the side.
fn along(domain: Domain, side: usize, vertices: Vec<[u32; 3]>) -> Option<Vec<u32>> {
    let distances = vertices.iter().map(|[u, v, w]| match (domain, side) {
        (Domain::Triangles, 0) => (*u == 0).then_some(*w),
        (Domain::Triangles, 1) => (*v == 0).then_some(*u),
        (Domain::Triangles, _) => (*w == 0).then_some(*v),
        (_, 0) => (*u == 0).then_some(UNIT.wrapping_sub(*v)),
        (_, 1) => (*v == 0).then_some(*u),
        (_, 2) => (*u == UNIT).then_some(*v),
        _ => (*v == UNIT).then_some(UNIT.wrapping_sub(*u)),
    });
    distances.collect::<Option<Vec<u32>>>().map(sorted)
}

#[cfg(test)]
mod tests {
    use super::super::study::violations_of;
    use super::*;

    /// Patches that break each rule, where `change` has changed the answers about triangles that are
    /// not plain.
    fn broken(change: impl Fn(&Outline, &Tessellator, &Levels, &mut Patch)) -> [usize; RULES] {
        violations_of(360, |tessellator, levels| {
            let mut patch = tessellator.tessellate_fixed(levels);
            if tessellator.domain == Domain::Triangles
                && let Some(outline) = Outline::of(tessellator, levels, &patch)
                && !outline.expected.is_plain()
            {
                change(&outline, tessellator, levels, &mut patch);
            }
            patch
        })
    }

    /// Moves the vertices next to both ends of side 0 towards the middle, by one unit.
    fn nudge(outline: &Outline, patch: &mut Patch) {
        let side = &mut patch.0[outline.starts[0] as usize..outline.starts[1] as usize];
        if let [first, .., last] = side {
            first[1] -= 1;
            first[2] += 1;
            last[1] += 1;
            last[2] -= 1;
        }
    }

    #[test]
    fn nothing_is_broken_unless_it_is() {
        assert_eq!(broken(|_, _, _, _| ()), [0; RULES]);
    }

    #[test]
    fn rule_1_sees_levels_that_do_not_count() {
        let found = broken(|_, _, levels, patch| {
            if levels.outer[3] > 10.0 {
                patch.0[0][0] += 1;
            }
        });
        assert!(found[0] > 0, "{found:?}");
    }

    #[test]
    fn rule_2_sees_a_side_that_follows_the_inner_level() {
        let found = broken(|outline, _, levels, patch| {
            if levels.inner[0] > 20.0 {
                nudge(outline, patch);
            }
        });
        assert!(found[1] > 0, "{found:?}");
        assert_eq!(found[2], 0, "symmetric all the same");
    }

    #[test]
    fn rule_3_sees_one_unit() {
        let found = broken(|outline, _, _, patch| {
            let [first, second] = [outline.starts[0], outline.starts[1]];
            if second > first + 1 {
                patch.0[first as usize][1] -= 1;
                patch.0[first as usize][2] += 1;
            }
        });
        assert!(found[2] > 0, "{found:?}");
        assert_eq!(found[1], 0, "always the same all the same");
        let mut lines = Tessellator {
            domain: Domain::Isolines,
            ..Default::default()
        }
        .tessellate_fixed(&Levels::uniform(3.0));
        assert!(lines_are_symmetric(&lines.0));
        for vertex in lines.0.iter_mut().skip(8) {
            vertex[1] += 1;
        }
        assert!(!lines_are_symmetric(&lines.0));
    }

    #[test]
    fn rule_4_sees_a_side_that_is_special() {
        let found = broken(|outline, _, _, patch| nudge(outline, patch));
        assert!(found[3] > 0, "{found:?}");
        assert_eq!([found[1], found[2]], [0, 0]);
    }

    #[test]
    fn rule_5_sees_triangles_that_are_not_turned() {
        let found = broken(|_, tessellator, _, patch| {
            if let (Winding::Cw, Primitives::Triangles(triangles)) =
                (tessellator.winding, &mut patch.1)
            {
                triangles[0].swap(0, 1);
            }
        });
        assert!(found[4] > 0, "{found:?}");
    }

    #[test]
    fn rules_6_and_7_see_inner_vertices_that_follow_the_sides() {
        let found = broken(|_, _, levels, patch| {
            let last = patch.0.len() - 1;
            if levels.outer[1] > 20.0 {
                patch.0[last][0] ^= 1;
            }
        });
        assert!(found[5] > 0 && found[6] > 0, "{found:?}");
    }

    #[test]
    fn rule_7_sees_another_diagonal() {
        // The first two triangles at side 0 that share an edge exchange it, if side 1 says so.
        let found = broken(|outline, _, levels, patch| {
            let inner = |vertex: u32| outline.is_inner(vertex);
            let Primitives::Triangles(triangles) = &mut patch.1 else {
                return;
            };
            let at_side = triangles.iter().position(|t| {
                t.iter()
                    .any(|vertex| !inner(*vertex) && outline.sides_of(*vertex) == 1)
            });
            if let Some(at) = at_side
                && levels.outer[1] > 20.0
            {
                triangles[at].rotate_left(1);
                triangles[at][0] = triangles[at][1];
            }
        });
        assert!(found[6] > 0, "{found:?}");
        assert_eq!(found[5], 0, "nothing off the outline is touched");
    }

    #[test]
    fn rule_8_sees_a_sum_and_a_range() {
        let found = broken(|_, _, _, patch| patch.0[0][2] -= 1);
        assert!(found[7] > 0, "{found:?}");
        assert!(!holds_rule_8(Domain::Quads, &[[UNIT + 2, 0, 0]]));
        assert!(holds_rule_8(Domain::Quads, &[[UNIT, 1, 0]]));
    }
}
