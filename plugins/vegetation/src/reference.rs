//! What a field of blades looks like from afar, by brute force: every blade, many samples, no level of detail.
//!
//! A square of the plane repeats without end, and is seen under parallel rays. A ray meets a blade where its *shadow*
//! along the rays, on the ground, holds the ray's foot; the nearest to the eye is the highest. So blades are drawn as
//! shadows into a square of samples that is a torus, with their height as depth: any elevation of the view is one
//! picture, and no blade is missing for being beyond a border.
//!
//! Shapes, widths and colours are those that are drawn on the GPU, by the same functions; no wind blows, the ground is
//! level, and the smooth noise of colours is its mean. Colours are those before light.

use bevy::math::{Vec2, Vec3};

use crate::blade::{BladeShape, LEAST_SEEN, Own, widened};
use crate::colour::{Tint, blade_colour, blade_tint, shade_at};
use crate::density::{Growth, NO_CLUMPS};
use crate::kind::Blade;
use crate::place::threshold;
use crate::straight;

/// A square of ground and how finely it is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Side in cells of the lattice: a power of two.
    pub cells: i32,
    /// Samples along a side.
    pub samples: usize,
    /// First cell.
    pub first: [i32; 2],
}

/// What a picture says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// Share of the ground that is covered.
    pub cover: f64,
    /// Mean linear colour of what covers it.
    pub colour: [f64; 3],
}

/// The mean over `count` fields beside each other. Under a low elevation a line of samples meets few blades of one
/// field, and what it covers differs from field to field by some percent.
#[must_use]
pub fn mean(field: Field, count: i32, draw: impl Fn(Field) -> Seen) -> Seen {
    let mut sum = Seen::default();
    for k in 0..count {
        let [x, z] = field.first;
        let seen = draw(Field {
            first: [x + k * field.cells, z],
            ..field
        });
        sum.cover += seen.cover;
        for (sum, part) in sum.colour.iter_mut().zip(seen.colour) {
            *sum += part * seen.cover;
        }
    }
    let covered = if sum.cover > 0.0 { sum.cover } else { 1.0 };
    Seen {
        cover: sum.cover / f64::from(count.max(1)),
        colour: sum.colour.map(|part| part / covered),
    }
}

/// As what a field is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manner {
    /// Segments of a strip, as in [`crate::blade::SEGMENTS`].
    pub segments: u32,
    /// How much of what differs from blade to blade is drawn as its mean, 0 to 1: [`crate::colour::calm_at`].
    pub calm: f32,
}

impl Manner {
    /// The nearest level of detail.
    pub const FINEST: Self = Self {
        segments: 7,
        calm: 0.0,
    };
}

/// A field that holds `metres` of ground a side, or as little more as a power of two of cells is; at `first`.
#[must_use]
pub fn field_of(growth: &Growth, metres: f32, samples: usize, first: [i32; 2]) -> Field {
    let cells = (metres / growth.lattice.pitch()).max(1.0) as u32;
    Field {
        cells: cells.next_power_of_two().cast_signed(),
        samples,
        first,
    }
}

/// What a ray meets first: how high, how far along its blade, and which blade. Colours are found at the end, once a sample.
#[derive(Clone, Copy, Default)]
struct Sample {
    depth: f32,
    place: f32,
    blade: u32,
}

/// After so many blades it is looked which heights are still seen.
const OFTEN: usize = 512;

/// Vertices of the finest strip.
const MOST_CORNERS: usize = 15;

/// Draws a field of one kind under an elevation of the view, whose sine is `sine`, above 0. `width_of` says for a rank,
/// as a share of those that stand, how wide a blade is as a multiple of its own; 0: it is not drawn.
#[must_use]
pub fn draw(
    field: Field,
    blade: &Blade,
    growth: &Growth,
    sine: f32,
    width_of: impl Fn(f32) -> f32,
    manner: Manner,
) -> Seen {
    let side = field.cells as f32 * growth.lattice.pitch();
    let scale = field.samples as f32 / side;
    let cosine = (1.0 - sine * sine).max(0.0).sqrt();
    let slope = cosine / sine;
    // Rays go down towards +x.
    let to_eye = Vec3::new(-cosine, sine, 0.0);
    let uneven = if growth.clump_size == NO_CLUMPS {
        0.0
    } else {
        growth.uneven
    };
    let mut samples = vec![Sample::default(); field.samples * field.samples];
    let mut tints: Vec<(Tint, f32)> = Vec::new();
    // Of each row the lowest that is seen: what is below is not looked at.
    let mut floors = vec![0.0_f32; field.samples];
    let depth = depth_of(blade, growth);
    let limit = threshold(growth.full);
    for k in 0..field.cells * field.cells {
        let cell = [
            field.first[0] + k % field.cells,
            field.first[1] + k / field.cells,
        ];
        let root = growth.lattice.root(cell);
        if root.rank >= limit {
            continue;
        }
        let wide = width_of(root.rank as f32 / limit as f32);
        if wide <= 0.0 {
            continue;
        }
        let own = Own::new(root, growth.clump(root));
        let mut shape = BladeShape::new(blade, own, uneven, Vec3::Y);
        shape.width *= wide;
        let mut bow = 0.0;
        if manner.segments == 1 {
            shape.width *= straight::wider(shape.droop, sine);
            bow = straight::bow(shape.droop, sine, depth);
        }
        let tint = blade_tint(&blade.look, own, Vec2::splat(0.5), manner.calm);
        tints.push((tint, bow));
        let part = |k: u32| k as f32 / 65_536.0 * growth.lattice.pitch();
        let place = Vec2::new(
            (k % field.cells) as f32 * growth.lattice.pitch() + part(root.at >> 16),
            (k / field.cells) as f32 * growth.lattice.pitch() + part(root.at & 0xFFFF),
        );
        let curve = shape.curve(shape.lean);
        let side = Vec3::new(shape.across.x, 0.0, shape.across.y);
        // On the ground along the rays, x away from the eye; the height is the depth.
        let shadow = |at: Vec3| {
            Vec3::new(
                (place.x + at.x + at.y * slope) * scale,
                (place.y + at.z) * scale,
                at.y.max(1e-6),
            )
        };
        let mut corners = [(Vec3::ZERO, 0.0); MOST_CORNERS];
        let corners = &mut corners[..=2 * manner.segments as usize];
        for (row, pair) in (0..).zip(corners.chunks_mut(2)) {
            let along = row as f32 / manner.segments as f32;
            let (on_curve, tangent) = curve.row(row, manner.segments);
            // As the draws have it: two a row, to both sides alike, and the tip.
            let width = shape.width_at(along, manner.segments);
            let mut off = side * (0.5 * width);
            off += widened(off, tangent.normalize(), to_eye, LEAST_SEEN * width);
            match pair {
                [left, right] => {
                    *left = (shadow(on_curve - off), along);
                    *right = (shadow(on_curve + off), along);
                }
                [tip] => *tip = (shadow(on_curve), along),
                _ => {}
            }
        }
        if tints.len().is_multiple_of(OFTEN) {
            for (floor, line) in floors.iter_mut().zip(samples.chunks(field.samples)) {
                *floor = line.iter().map(|s| s.depth).fold(f32::MAX, f32::min);
            }
        }
        for triangle in corners.windows(3) {
            fill(
                &mut samples,
                &floors,
                [triangle[0], triangle[1], triangle[2]],
                tints.len() as u32 - 1,
            );
        }
    }
    let mut seen = Seen::default();
    let mut covered = 0_u64;
    for sample in samples.iter().filter(|sample| sample.depth > 0.0) {
        covered += 1;
        let (tint, bow) = tints[sample.blade as usize];
        let along = straight::along(sample.place, bow);
        let colour = blade_colour(&blade.look, tint, along) * shade_at(along);
        for (sum, part) in seen.colour.iter_mut().zip(colour.to_array()) {
            *sum += f64::from(part);
        }
    }
    seen.cover = covered as f64 / samples.len() as f64;
    seen.colour = seen.colour.map(|sum| sum / covered.max(1) as f64);
    seen
}

/// The width of a blade in mean distances of roots: what [`crate::law::evened`] asks for.
#[must_use]
pub fn crowding_of(blade: &Blade, growth: &Growth) -> f32 {
    blade.width * (growth.full * growth.lattice.density()).sqrt()
}

/// The optical depth of all blades from the side.
#[must_use]
pub fn depth_of(blade: &Blade, growth: &Growth) -> f32 {
    let density = growth.full * growth.lattice.density();
    density * blade.width * 0.5 * (blade.length.0 + blade.length.1) * (2.0 / 3.0)
}

/// One triangle of a blade, row by row, around the torus: shadows of its corners, and how far along they are.
///
/// `floors` is for each row a height below which nothing of it is seen any more.
fn fill(samples: &mut [Sample], floors: &[f32], corners: [(Vec3, f32); 3], blade: u32) {
    let side = floors.len();
    let [a, b, c] = corners.map(|(place, _)| place);
    let (ab, ac) = (b - a, c - a);
    let area = ab.truncate().perp_dot(ac.truncate());
    if area == 0.0 || !area.is_finite() {
        return;
    }
    // What is linear over the triangle: its gradient by its differences to the first corner.
    let gradient = |to_b: f32, to_c: f32| {
        Vec2::new(to_b * ac.y - to_c * ab.y, to_c * ab.x - to_b * ac.x) / area
    };
    let first = corners[0].1;
    let deeper = gradient(ab.z, ac.z);
    let farther = gradient(corners[1].1 - first, corners[2].1 - first);
    let lowest = a.y.min(b.y).min(c.y);
    let highest = a.y.max(b.y).max(c.y);
    let tallest = a.z.max(b.z).max(c.z);
    let wrapped = |k: f32| (k as i64).rem_euclid(side as i64) as usize;
    // Samples are at halves.
    let mut row = (lowest - 0.5).ceil();
    while row + 0.5 <= highest {
        let y = row + 0.5;
        let number = wrapped(row);
        if tallest <= floors[number] {
            row += 1.0;
            continue;
        }
        let (mut from, mut to) = (f32::MAX, f32::MIN);
        for (p, q) in [(a, b), (b, c), (c, a)] {
            if (p.y <= y) != (q.y <= y) {
                let x = p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y));
                from = from.min(x);
                to = to.max(x);
            }
        }
        let mut column = (from - 0.5).ceil();
        let line = &mut samples[number * side..][..side];
        let mut k = wrapped(column);
        while column + 0.5 < to {
            let off = Vec2::new(column + 0.5, y) - a.truncate();
            let depth = a.z + deeper.dot(off);
            if depth > line[k].depth {
                line[k] = Sample {
                    depth,
                    place: first + farther.dot(off),
                    blade,
                };
            }
            column += 1.0;
            k += 1;
            if k == side {
                k = 0;
            }
        }
        row += 1.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Straight down on blades the ground is seen; from the side nearly everything is covered.
    #[test]
    fn cover_grows_towards_the_horizon() {
        let (blade, growth) = crate::kind::defaults::grass();
        let field = Field {
            cells: 32,
            samples: 512,
            first: [0, 0],
        };
        let covers: Vec<f64> = [1.0, 0.5, 0.2, 0.05, 0.02]
            .iter()
            .map(|sine| draw(field, &blade, &growth, *sine, |_| 1.0, Manner::FINEST).cover)
            .collect();
        assert!(
            covers.windows(2).all(|pair| pair[0] < pair[1]),
            "{covers:?}"
        );
        assert!(covers[0] < 0.5 && covers[4] > 0.9, "{covers:?}");
        // A width of 0 draws nothing.
        let nothing = draw(field, &blade, &growth, 0.5, |_| 0.0, Manner::FINEST);
        assert_eq!(nothing.cover, 0.0);
    }

    /// One triangle of half of the square covers half of it, wherever the torus is cut.
    #[test]
    fn areas_are_kept_around_the_torus() {
        for shift in [0.0, 3.3, 40.0, -77.7] {
            let samples = 128;
            let mut seen = vec![Sample::default(); samples * samples];
            let corner = |x: f32, y: f32| (Vec3::new(x + shift, y - shift, 1.0), 1.0);
            let triangle = [corner(0.0, 0.0), corner(100.0, 0.0), corner(0.0, 100.0)];
            fill(&mut seen, &vec![0.0; samples], triangle, 0);
            let covered = seen.iter().filter(|sample| sample.depth > 0.0).count();
            assert!((covered as f64 / 5000.0 - 1.0).abs() < 0.02, "{covered}");
        }
    }
}
