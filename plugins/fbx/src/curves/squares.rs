//! Squares of a node's three scales.

use super::majorant::Majorant;
use super::number::Number;
use glam::DVec3;

/// Majorants of squares of three scales.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Squares {
    pub(crate) each: [Majorant; 3],
    /// Of their mean, and of how far any of them is from that.
    pub(crate) mean: Majorant,
    pub(crate) apart: Majorant,
    /// What they are in the middle of the span; `None` where it is not known which is which.
    pub(crate) middles: Option<[f64; 3]>,
    /// What their mean is there.
    pub(crate) middle: f64,
}

fn largest(parts: &[Majorant; 3]) -> Majorant {
    parts[0].max(&parts[1]).max(&parts[2])
}

impl Squares {
    /// Of scales that stand still.
    pub(crate) fn still(scale: DVec3) -> Self {
        let squares = scale * scale;
        let mean = squares.element_sum() / 3.0;
        Self {
            each: squares.to_array().map(Majorant::still),
            mean: Majorant::still(mean),
            apart: Majorant::still((squares - mean).abs().max_element()),
            middles: Some(squares.to_array()),
            middle: mean,
        }
    }

    /// Of three numbers that move.
    pub(crate) fn of(scale: &[Number; 3]) -> Self {
        let squares = scale.map(|number| number.product(&number));
        let [x, y, z] = &squares;
        let sum = x.plus(y).plus(z);
        let mean = Number::of(sum.middle / 3.0, sum.moves.scaled(1.0 / 3.0));
        Self {
            each: squares.map(|square| square.moves),
            mean: mean.moves,
            apart: largest(&squares.map(|square| square.minus(&mean).moves)),
            middles: Some(squares.map(|square| square.middle)),
            middle: mean.middle,
        }
    }

    /// The same, whichever scale is which axis'.
    pub(super) fn in_any_order(mut self) -> Self {
        self.each = [largest(&self.each); 3];
        self.middles = None;
        self
    }

    /// Where all scales are multiplied by a number.
    pub(super) fn scaled(&self, by: f64) -> Self {
        let by = by * by;
        Self {
            each: self.each.map(|square| square.scaled(by)),
            mean: self.mean.scaled(by),
            apart: self.apart.scaled(by),
            middles: self.middles.map(|each| each.map(|square| square * by)),
            middle: self.middle * by,
        }
    }
}
