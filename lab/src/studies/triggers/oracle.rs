//! When an upright ellipsoid that flies straight is in an upright box.
//!
//! Where the ellipsoid is a unit sphere the box is still upright: its distance from the centre is known in closed form,
//! and, since the box is convex, a convex function of time. What is below 1 of it is found by thirds and by halves.

use bevy::math::DVec3;

/// Halvings of a bracket of some hundred steps: to the last bit.
const HALVINGS: u32 = 64;

/// Thirds of the same.
const THIRDS: u32 = 100;

/// A flight past a box at the origin.
#[derive(Clone, Copy, Debug)]
pub struct Flight {
    /// Where the centre is at time 0, from the middle of the box, metres.
    pub from: DVec3,
    /// The way of one step, metres.
    pub way: DVec3,
    /// Of the ellipsoid, metres.
    pub radii: DVec3,
    /// Half of the size of the box, metres.
    pub half: DVec3,
}

/// Where it is in the box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Within {
    /// The least distance of the centre from the box, in radii.
    pub least: f64,
    /// First and last time of touching, in steps; none if it stays away.
    pub times: Option<[f64; 2]>,
}

impl Flight {
    /// Of the centre from the box, in radii, at a time in steps.
    pub fn distance(&self, time: f64) -> f64 {
        let beside = (self.from + self.way * time).abs() - self.half;
        (beside.max(DVec3::ZERO) / self.radii).length()
    }

    /// The part of the first `steps` steps in which it touches the box. It must be apart at both ends.
    pub fn within(&self, steps: f64) -> Within {
        let (mut low, mut high) = (0.0, steps);
        let mut inside = None;
        for _ in 0..THIRDS {
            let third = (high - low) / 3.0;
            let (one, two) = (low + third, high - third);
            let (at_one, at_two) = (self.distance(one), self.distance(two));
            if at_one <= 1.0 || at_two <= 1.0 {
                inside = Some(if at_one <= at_two { one } else { two });
                break;
            }
            if at_one <= at_two {
                high = two;
            } else {
                low = one;
            }
        }
        let middle = inside.unwrap_or((low + high) * 0.5);
        let least = self.distance(middle);
        if least > 1.0 {
            return Within { least, times: None };
        }
        let border = |mut out: f64, mut within: f64| {
            for _ in 0..HALVINGS {
                let half = (out + within) * 0.5;
                if self.distance(half) <= 1.0 {
                    within = half;
                } else {
                    out = half;
                }
            }
            within
        };
        Within {
            least,
            times: Some([border(0.0, middle), border(steps, middle)]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_through_and_past() {
        let flight = Flight {
            from: DVec3::new(-5.0, 0.5, 0.0),
            way: DVec3::X,
            radii: DVec3::new(0.5, 1.0, 1.0),
            half: DVec3::ONE,
        };
        // Its side is 0.5 m ahead of its centre, that of the box 1 m from its middle.
        let found = flight.within(10.0).times.unwrap();
        assert!((found[0] - 3.5).abs() < 1e-14 && (found[1] - 6.5).abs() < 1e-14);
        let above = Flight {
            from: DVec3::new(-5.0, 2.5, 0.0),
            ..flight
        };
        let past = above.within(10.0);
        assert!(past.times.is_none() && (past.least - 1.5).abs() < 1e-12);
        // Over the edge of the box: a quarter of an ellipse, (x / 0.5)² + (0.6 / 1)² = 1.
        let edge = Flight {
            from: DVec3::new(-5.0, 1.6, 0.0),
            ..flight
        };
        let found = edge.within(10.0).times.unwrap();
        assert!((found[0] - (5.0 - 1.0 - 0.4)).abs() < 1e-14, "{found:?}");
    }
}
