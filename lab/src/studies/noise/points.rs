//! Where the noises are sampled.
//!
//! Every coordinate is a multiple of 2^-20 m, and so exact in f64 (to 10^9 m) and in the 32.32 fixed
//! point of [`GroundPoint`]: what a method loses of a position, it loses by itself.

use bevy::math::{DVec2, Vec2};
use dolomite_terrain::GroundPoint;
use dolomite_testkit::random::Random;

/// Sample positions in every form that a method may take. All of them are in metres.
#[derive(Debug, Clone)]
pub struct Points {
    /// Exact.
    pub exact: Vec<DVec2>,
    /// Exact, in fixed point.
    pub fixed: Vec<GroundPoint>,
    /// Rounded to f32, as methods that take f32 positions are called.
    pub rounded: Vec<Vec2>,
    /// Set where the points are a square lattice, row by row.
    pub lattice: Option<Lattice>,
}

/// A square lattice of points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice {
    /// The first point, metres.
    pub origin: DVec2,
    /// Distance of neighbours, metres.
    pub spacing: f64,
    /// Points along each side.
    pub side: u32,
}

/// Steps of a coordinate per metre: 2^20.
const STEPS: f64 = 1_048_576.0;

impl Points {
    fn new(exact: Vec<DVec2>, lattice: Option<Lattice>) -> Self {
        let fixed = exact.iter().map(|p| GroundPoint::from(*p)).collect();
        let rounded = exact.iter().map(|p| p.as_vec2()).collect();
        Self {
            exact,
            fixed,
            rounded,
            lattice,
        }
    }

    /// `count` points in no order, uniform where the larger coordinate is from half of `distance` to
    /// `distance` metres away from the origin.
    pub fn scattered(count: usize, distance: f64, seed: u32) -> Self {
        let mut random = Random::new(seed);
        let exact = (0..count).map(|_| {
            let far = distance * (0.5 + 0.5 * random.unit());
            let far = if random.next_u32() & 1 == 0 {
                far
            } else {
                -far
            };
            let side = far.abs() * random.signed_unit();
            let p = if random.next_u32() & 1 == 0 {
                DVec2::new(far, side)
            } else {
                DVec2::new(side, far)
            };
            (p * STEPS).round() / STEPS
        });
        Self::new(exact.collect(), None)
    }

    /// A square lattice of the largest side whose square is at most `count`, `spacing` metres (a
    /// multiple of 2^-20) apart, in rows along x, from a random place in the kilometre around the
    /// origin.
    pub fn tile(count: usize, spacing: f64, seed: u32) -> Self {
        let mut random = Random::new(seed);
        let place = DVec2::new(random.signed_unit(), random.signed_unit()) * 1000.0;
        let origin = (place * STEPS).round() / STEPS;
        let side = count.isqrt() as u32;
        let exact = (0..side).flat_map(|row| {
            (0..side)
                .map(move |column| origin + DVec2::new(f64::from(column), f64::from(row)) * spacing)
        });
        Self::new(
            exact.collect(),
            Some(Lattice {
                origin,
                spacing,
                side,
            }),
        )
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.exact.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.exact.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scattered_points_are_exact_and_as_far_away_as_asked() {
        for distance in [1.0, 1e4, 1e7] {
            let points = Points::scattered(1000, distance, 3);
            for (exact, fixed) in points.exact.iter().zip(&points.fixed) {
                let far = exact.abs().max_element();
                assert!((0.5 * distance..=distance).contains(&far), "{exact}");
                assert_eq!(fixed.to_dvec2(), *exact);
            }
        }
        assert_eq!(
            Points::scattered(9, 5.0, 1).exact,
            Points::scattered(9, 5.0, 1).exact
        );
        assert_ne!(
            Points::scattered(9, 5.0, 1).exact,
            Points::scattered(9, 5.0, 2).exact
        );
    }

    #[test]
    fn a_tile_is_a_lattice_in_rows() {
        let points = Points::tile(1000, 0.5, 1);
        let lattice = points.lattice.unwrap();
        assert_eq!((lattice.side, points.len()), (31, 961));
        assert_eq!(points.exact[1] - points.exact[0], DVec2::new(0.5, 0.0));
        assert_eq!(points.exact[31] - points.exact[0], DVec2::new(0.0, 0.5));
        assert_eq!(points.exact[0], lattice.origin);
        for (exact, fixed) in points.exact.iter().zip(&points.fixed) {
            assert_eq!(fixed.to_dvec2(), *exact);
        }
    }
}
