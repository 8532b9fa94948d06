//! What a field of blades looks like from afar, by brute force: every blade, many samples, no level of detail.
//!
//! A square of the plane repeats without end, and is seen under parallel rays. A ray meets a blade where its *shadow*
//! along the rays, on the ground, holds the ray's foot; the nearest to the eye is the highest. So blades are drawn as
//! shadows into a square of samples that is a torus, with their height as depth: any elevation of the view is one
//! picture, and no blade is missing for being beyond a border.
//!
//! Shapes, widths and colours are those that are drawn on the GPU, by the same functions; no wind blows, the ground is
//! level, and the smooth noise of colours is its mean. Colours are those before light.

use bevy::math::{Vec2, Vec3, Vec4};

use crate::blade::{BladeShape, LEAST_SEEN, Own, widened};
use crate::colour::{blade_colour, shade_at};
use crate::density::{Growth, NO_CLUMPS};
use crate::kind::Blade;
use crate::place::threshold;

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
    let mut depths = vec![0.0_f32; field.samples * field.samples];
    let mut colours = vec![Vec3::ZERO; field.samples * field.samples];
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
        let part = |k: u32| k as f32 / 65_536.0 * growth.lattice.pitch();
        let place = Vec2::new(
            (k % field.cells) as f32 * growth.lattice.pitch() + part(root.at >> 16),
            (k / field.cells) as f32 * growth.lattice.pitch() + part(root.at & 0xFFFF),
        );
        let curve = shape.curve(shape.lean);
        let corners: Vec<(Vec3, Vec4)> = (0..=2 * manner.segments)
            .map(|k| {
                let vertex = shape.vertex(curve, manner.segments, k);
                let along = vertex.along;
                let (on_curve, tangent) = curve.at(along);
                let least = LEAST_SEEN * shape.width_at(along, manner.segments);
                let off = vertex.place - on_curve;
                let at = vertex.place + widened(off, tangent.normalize(), to_eye, least);
                // On the ground along the rays, x away from the eye; the height is the depth.
                let shadow = Vec3::new(
                    (place.x + at.x + at.y * slope) * scale,
                    (place.y + at.z) * scale,
                    at.y.max(1e-6),
                );
                let noise = Vec2::splat(0.5);
                let colour = blade_colour(&blade.look, own, noise, manner.calm, along);
                (shadow, colour.extend(along))
            })
            .collect();
        for triangle in corners.windows(3) {
            fill(
                &mut depths,
                &mut colours,
                field.samples,
                [triangle[0], triangle[1], triangle[2]],
            );
        }
    }
    let mut seen = Seen::default();
    let mut covered = 0_u64;
    for (depth, colour) in depths.iter().zip(&colours) {
        if *depth > 0.0 {
            covered += 1;
            for (sum, part) in seen.colour.iter_mut().zip(colour.to_array()) {
                *sum += f64::from(part);
            }
        }
    }
    seen.cover = covered as f64 / depths.len() as f64;
    seen.colour = seen.colour.map(|sum| sum / covered.max(1) as f64);
    seen
}

/// One triangle, row by row, around the torus.
fn fill(depths: &mut [f32], colours: &mut [Vec3], samples: usize, corners: [(Vec3, Vec4); 3]) {
    let [a, b, c] = corners.map(|(place, _)| place);
    let area = (b - a).truncate().perp_dot((c - a).truncate());
    if area == 0.0 || !area.is_finite() {
        return;
    }
    let lowest = a.y.min(b.y).min(c.y);
    let highest = a.y.max(b.y).max(c.y);
    // Samples are at halves.
    let mut row = (lowest - 0.5).ceil();
    while row + 0.5 <= highest {
        let y = row + 0.5;
        let (mut from, mut to) = (f32::MAX, f32::MIN);
        for (p, q) in [(a, b), (b, c), (c, a)] {
            if (p.y <= y) != (q.y <= y) {
                let x = p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y));
                from = from.min(x);
                to = to.max(x);
            }
        }
        let mut column = (from - 0.5).ceil();
        while column + 0.5 < to {
            let at = Vec2::new(column + 0.5, y);
            let weight = |p: Vec3, q: Vec3| (q - p).truncate().perp_dot(at - p.truncate()) / area;
            let (u, v) = (weight(b, c), weight(c, a));
            let w = 1.0 - u - v;
            let depth = u * a.z + v * b.z + w * c.z;
            let k = (row as i64).rem_euclid(samples as i64) as usize * samples
                + (column as i64).rem_euclid(samples as i64) as usize;
            if depth > depths[k] {
                depths[k] = depth;
                // As it is drawn: colours at the corners, the shade by how far along a sample is.
                let seen = u * corners[0].1 + v * corners[1].1 + w * corners[2].1;
                colours[k] = seen.truncate() * shade_at(seen.w);
            }
            column += 1.0;
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
            let mut depths = vec![0.0; samples * samples];
            let mut colours = vec![Vec3::ZERO; samples * samples];
            let corner = |x: f32, y: f32| (Vec3::new(x + shift, y - shift, 1.0), Vec4::ONE);
            let triangle = [corner(0.0, 0.0), corner(100.0, 0.0), corner(0.0, 100.0)];
            fill(&mut depths, &mut colours, samples, triangle);
            let covered = depths.iter().filter(|d| **d > 0.0).count();
            assert!((covered as f64 / 5000.0 - 1.0).abs() < 0.02, "{covered}");
        }
    }
}
