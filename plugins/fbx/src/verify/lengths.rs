//! Majorants of how long the axes of nodes are in the world.
//!
//! Turning changes no length, but where axes above are uneven: of axes `A` the squares of lengths are the diagonal of `A^T A`.
//! Let that be `g I + H` above a node, with `g` a number and `H` small where axes are about as long and at right angles. Below a
//! turn `R` and scales `S` it is `S (g I + R^T H R) S`, and with `S^2 = s I + U` that is `g s I + (g U + S R^T H R S)`. So what is
//! turned counts only as far as axes are uneven: many files have scales that are off 1 by the rounding of f32, or keyed so.

use crate::curves::{Majorant, Rates, Squares};
use glam::{DMat3, DVec3};

/// By how large a share of their length axes are uneven where what is known of all together may say more.
const UNEVEN: f64 = 0.05;

/// Majorants of the squares of how long a node's axes are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lengths {
    /// Of each axis.
    pub(super) squares: [Majorant; 3],
    /// What they are in the middle of the span, and by how large a share of them they may be off that.
    pub(super) middles: [f64; 3],
    pub(super) off: f64,
    /// What `g` is there.
    middle: f64,
    /// Of `g`, and of the size of `H`.
    even: Majorant,
    uneven: Majorant,
}

impl Lengths {
    /// Of axes that keep their lengths and the angles between them.
    pub(super) fn still(axes: &DMat3) -> Self {
        let mut product = axes.transpose() * *axes;
        let squares = product.diagonal();
        let mean = squares.element_sum() / 3.0;
        product -= DMat3::from_diagonal(DVec3::splat(mean));
        let columns = [product.x_axis, product.y_axis, product.z_axis];
        let apart = columns.map(DVec3::length_squared).iter().sum::<f64>();
        Self {
            squares: squares.to_array().map(Majorant::still),
            middles: squares.to_array(),
            off: 0.0,
            middle: mean,
            even: Majorant::still(mean),
            uneven: Majorant::still(apart.sqrt()),
        }
    }

    /// Below axes of the majorant `axes`, by what places a node there.
    pub(super) fn below(&self, axes: &Majorant, own: &Rates, scales: &Squares) -> Self {
        let turn = own.turn.whole();
        let turned = turn.product(&turn).product(&self.uneven);
        let mut about = self.even.plus(&turned);
        if self.uneven.0[0] > UNEVEN * self.even.0[0] {
            // However uneven, they are no longer than all axes are.
            let all = axes.product(&turn);
            about = about.min(&all.product(&all));
        }
        let scale = own.scale.product(&own.scale);
        let off = match scales.middles {
            Some(_) => self.uneven.0[0] / self.middle,
            None => f64::INFINITY,
        };
        let middles = scales.middles.unwrap_or_default();
        Self {
            squares: scales.each.map(|square| square.product(&about)),
            middles: middles.map(|square| square * self.middle),
            off: if off.is_nan() { f64::INFINITY } else { off },
            middle: self.middle * scales.middle,
            even: self.even.product(&scales.mean),
            uneven: self
                .even
                .product(&scales.apart)
                .plus(&scale.product(&turned)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::{Number, Over, Turning, holds};
    use glam::DQuat;

    fn line(middle: f64, way: f64) -> Number {
        let most = middle.abs() + way.abs() / 2.0;
        Number::of(middle, Majorant::moving(most, way))
    }

    #[test]
    fn turning_counts_as_far_as_axes_are_uneven() {
        let middles = DVec3::new(1.5, 1.5, 1.4);
        let ways = DVec3::new(0.2, -0.1, 0.2);
        let scales = [0, 1, 2].map(|i| line(middles[i], ways[i]));
        let [x, y, z] = scales.map(|number| number.moves);
        let own = Rates {
            translation: Majorant::ZERO,
            turn: Turning::By(Majorant::moving(0.0, 0.7)),
            scale: x.max(&y).max(&z),
        };
        let below = |above: &Lengths, axes: f64| {
            above.below(&Majorant::still(axes), &own, &Squares::of(&scales))
        };
        let even = below(&Lengths::still(&(2.0 * DMat3::IDENTITY)), 2.0);
        for uneven in [0.0, 1e-9, 1e-3, 0.5, 1.9] {
            let above = DMat3::from_diagonal(DVec3::new(2.0 + uneven, 2.0, 2.0 - uneven));
            // A turn and a scale that moves, twice.
            let turned = |t: f64| {
                let scale = middles + ways * (t - 0.5);
                DMat3::from_quat(DQuat::from_rotation_y(0.7 * t)) * DMat3::from_diagonal(scale)
            };
            let once = below(&Lengths::still(&above), 2.0 + uneven);
            let axes = Majorant::still(2.0 + uneven)
                .product(&own.turn.whole())
                .product(&own.scale);
            let twice = once.below(&axes, &own, &Squares::of(&scales));
            for axis in 0..3 {
                holds(&once.squares[axis], Over::WHOLE, |t| {
                    [(above * turned(t)).col(axis).length_squared()]
                });
                holds(&twice.squares[axis], Over::WHOLE, |t| {
                    let axes = above * turned(t) * turned(t);
                    [axes.col(axis).length_squared()]
                });
                // Twice 2 uneven is how far squares are apart there, and they are turned from both sides.
                let more = once.squares[axis].0[1] - even.squares[axis].0[1];
                assert!(more <= 50.0 * uneven, "{uneven}: {more}");
            }
        }
    }
}
