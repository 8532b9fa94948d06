//! The triangles of a patch: a manifold whose border is the patch's outline, an exact cover,
//! counter-clockwise; for every kind of side.

use std::collections::HashMap;

use dolomite_tessellation::pattern::{
    PatchVertex, Side, inner_levels, inner_vertices, triangle, triangle_count,
};

/// A small generator (PCG, O'Neill 2014): tests need no more.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: u32) -> u32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as u32) % limit
    }
}

fn side_position(side: Side, i: u32) -> f64 {
    if side.second == 0 {
        f64::from(i) / f64::from(side.first)
    } else if i <= side.first {
        0.5 * f64::from(i) / f64::from(side.first)
    } else {
        0.5 + 0.5 * f64::from(i - side.first) / f64::from(side.second)
    }
}

/// (x, z) in the unit square.
fn position(sides: [Side; 4], [a, b]: [u32; 2], vertex: PatchVertex) -> [f64; 2] {
    match vertex {
        PatchVertex::Inner(i, j) => [f64::from(i) / f64::from(a), f64::from(j) / f64::from(b)],
        PatchVertex::Outer(s, i) => {
            let t = side_position(sides[s as usize], i);
            match s {
                0 => [t, 0.0],
                1 => [t, 1.0],
                2 => [0.0, t],
                _ => [1.0, t],
            }
        }
    }
}

/// Corners are ends of two sides: give each one name.
fn canonical(sides: [Side; 4], vertex: PatchVertex) -> PatchVertex {
    match vertex {
        PatchVertex::Outer(2, 0) => PatchVertex::Outer(0, 0),
        PatchVertex::Outer(2, i) if i == sides[2].level() => PatchVertex::Outer(1, 0),
        PatchVertex::Outer(3, 0) => PatchVertex::Outer(0, sides[0].level()),
        PatchVertex::Outer(3, i) if i == sides[3].level() => {
            PatchVertex::Outer(1, sides[1].level())
        }
        other => other,
    }
}

fn key(vertex: PatchVertex) -> [u32; 3] {
    match vertex {
        PatchVertex::Inner(i, j) => [4, i, j],
        PatchVertex::Outer(s, i) => [s, i, 0],
    }
}

/// What is wrong with the patch, if anything.
fn check(sides: [Side; 4], drop_last: bool) -> Result<(), String> {
    let inner = inner_levels(sides);
    let count = triangle_count(sides, inner) - u32::from(drop_last);
    let mut half_edges: HashMap<([u32; 3], [u32; 3]), u32> = HashMap::new();
    let mut area = 0.0;
    let mut used = std::collections::HashSet::new();
    for t in 0..count {
        let corners = triangle(sides, inner, t).map(|corner| canonical(sides, corner));
        let [p, q, r] = corners.map(|corner| position(sides, inner, corner));
        // Twice the area seen from +Y, positive for counter-clockwise: (q - p) x (r - p), y part.
        let twice = (q[1] - p[1]) * (r[0] - p[0]) - (q[0] - p[0]) * (r[1] - p[1]);
        if twice <= 0.0 {
            return Err(format!("triangle {t} {corners:?} has area {}", twice / 2.0));
        }
        area += twice / 2.0;
        for k in 0..3 {
            used.insert(key(corners[k]));
            let edge = (key(corners[k]), key(corners[(k + 1) % 3]));
            *half_edges.entry(edge).or_default() += 1;
        }
    }
    // A sum of up to 2·10⁴ terms, each rounded to 2⁻⁵³ of at most 1.
    if (area - 1.0).abs() > 1e-11 {
        return Err(format!("covers {area} of the patch"));
    }
    if half_edges.values().any(|&count| count != 1) {
        return Err("a directed edge belongs to two triangles".into());
    }
    let border: Vec<_> = half_edges
        .keys()
        .filter(|(a, b)| !half_edges.contains_key(&(*b, *a)))
        .collect();
    let outline: u32 = sides.iter().map(|side| side.level()).sum();
    if border.len() as u32 != outline {
        return Err(format!(
            "border of {} edges, outline of {outline}",
            border.len()
        ));
    }
    if border.iter().any(|(a, b)| a[0] == 4 || b[0] == 4) {
        return Err("an inner vertex lies on the border".into());
    }
    let vertices = outline
        + if inner[0] == 1 {
            0
        } else {
            inner_vertices(inner)
        };
    if used.len() as u32 != vertices {
        return Err(format!("{} of {vertices} vertices are used", used.len()));
    }
    Ok(())
}

#[test]
fn every_small_patch_is_an_exact_cover() {
    let kinds: Vec<Side> = (1..=5)
        .map(|first| Side { first, second: 0 })
        .chain([(1, 1), (1, 3), (4, 2)].map(|(first, second)| Side { first, second }))
        .collect();
    for &s0 in &kinds {
        for &s1 in &kinds {
            for &s2 in &kinds {
                for &s3 in &kinds {
                    let sides = [s0, s1, s2, s3];
                    check(sides, false).unwrap_or_else(|error| panic!("{sides:?}: {error}"));
                }
            }
        }
    }
}

#[test]
fn random_large_patches_are_exact_covers() {
    let mut random = Random(7);
    for _ in 0..60 {
        let sides = [(); 4].map(|()| Side {
            first: 1 + random.below(64),
            second: if random.below(2) == 0 {
                0
            } else {
                1 + random.below(64)
            },
        });
        check(sides, false).unwrap_or_else(|error| panic!("{sides:?}: {error}"));
    }
}

#[test]
fn the_check_sees_a_missing_triangle() {
    let sides = [Side {
        first: 5,
        second: 0,
    }; 4];
    assert!(check(sides, true).is_err());
}

#[test]
fn counts_at_the_highest_level_are_those_of_opengl() {
    let sides = [Side {
        first: 64,
        second: 0,
    }; 4];
    assert_eq!(triangle_count(sides, inner_levels(sides)), 8192);
}
