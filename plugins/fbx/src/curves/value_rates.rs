//! Majorants of a property over a span between keys, as its layers have it.

use super::layers::{Mode, Weight};
use super::majorant::{Majorant, ORDERS};
use super::number::Number;
use super::over::Over;
use super::value::{Part, Value, angles, turn};
use glam::{DQuat, DVec3};
use ufbx::RotationOrder;

/// Largest sizes of sin(w a) / sin(a) and cos(w a), a function of cos(a) and w, for cos(a) from 0 to 1 and w from 0 to 1
/// and complex ones within [`AROUND`] of them: by the maximum principle they are on that border, where they are
/// 2.0413 and 3.6743.
const SIDES: [f64; 2] = [2.05, 3.68];

/// Half of 1 + cos(a), which is half of the way to where they are not analytic; and as far around w.
const AROUND: f64 = 0.5;

/// A degree, as half of an angle in radians.
const HALF_DEGREE: f64 = std::f64::consts::PI / 360.0;

/// A degree in radians.
const DEGREE: f64 = std::f64::consts::PI / 180.0;

impl Weight<'_> {
    fn over(&mut self, over: Over) -> Number {
        match self {
            Self::Fixed(weight) => Number::still(*weight),
            Self::Keyed(curve) => {
                let percent = curve.over(over);
                Number::of(percent.middle / 100.0, percent.moves.scaled(0.01)).clamped(0.0, 1.0)
            }
        }
    }
}

impl Part<'_> {
    fn own_over(&mut self, over: Over) -> [Number; 3] {
        [0, 1, 2].map(|axis| match &mut self.curves[axis] {
            Some(curve) => curve.over(over),
            None => Number::still(self.default[axis]),
        })
    }
}

/// Angles, or a rotation that came of them.
enum Turned {
    Angles([Number; 3]),
    /// In the middle, and the majorant of its quaternion.
    Whole(DQuat, Majorant),
}

impl Turned {
    fn whole(&self, order: RotationOrder) -> (DQuat, Majorant) {
        match self {
            Self::Whole(middle, moves) => (*middle, *moves),
            Self::Angles(angles) => {
                let each = |number: &Number| number.moves.scaled(HALF_DEGREE).rotation();
                let moves = each(&angles[0])
                    .product(&each(&angles[1]))
                    .product(&each(&angles[2]))
                    .near(2.0);
                let middle = DVec3::from_array([0, 1, 2].map(|i| angles[i].middle));
                (turn(middle, order), moves)
            }
        }
    }
}

/// Part of the shorter way from no rotation to `own`.
fn share_of(own: (DQuat, Majorant), weight: &Number) -> Majorant {
    let (middle, moves) = own;
    if weight.high() <= 0.0 || moves.is_still() && weight.is_still() {
        return Majorant::still(1.0);
    }
    if weight.low() >= 1.0 {
        return moves;
    }
    // The cosine of half of the angle, on the side of the shorter way: where it may be 0 the way may jump.
    let cosine = middle.w.abs() - moves.1;
    if cosine.is_nan() || cosine < 0.0 {
        return Majorant::within(1.0, 2.0);
    }
    let around = moves
        .geometric(AROUND * (1.0 + cosine))
        .product(&weight.moves.geometric(AROUND));
    let mut out = moves
        .product(&around.scaled(SIDES[0]))
        .plus(&around.scaled(SIDES[1]));
    out.0[0] = 1.0;
    out.1 = 2.0;
    out.near(2.0)
}

impl Value<'_> {
    /// Over a span, where it is no rotation.
    pub(crate) fn over(&mut self, over: Over, scale: bool) -> [Number; 3] {
        let scale = scale && !self.plain;
        let mut sum = self.fixed.to_array().map(Number::still);
        for part in &mut self.parts {
            let own = part.own_over(over);
            if matches!(part.mode, Mode::Base | Mode::Override) {
                sum = own;
                continue;
            }
            let weight = part.weight.over(over);
            let rest = match part.mode {
                Mode::Additive => Number::still(1.0),
                _ => Number::still(1.0).minus(&weight),
            };
            sum = [0, 1, 2].map(|i| match scale && part.multiplies {
                true => sum[i].power(&rest).product(&own[i].power(&weight)),
                false => sum[i].product(&rest).plus(&own[i].product(&weight)),
            });
        }
        sum
    }

    /// Of the sum of its three angles, radians, but for how large it is itself, where these are those of one layer and no mixture: turning about one axis after
    /// the other has the majorant of turning by their sum, since products of exponentials are those of sums.
    pub(super) fn sum_over(&mut self, over: Over) -> Option<Majorant> {
        let part = match &mut self.parts[..] {
            [] => return Some(Majorant::ZERO),
            [part] if matches!(part.mode, Mode::Base | Mode::Override) => part,
            _ => return None,
        };
        let curves = part.curves.iter_mut().flatten();
        let moves = curves.map(|curve| curve.moves_over(over));
        let sum = moves.fold(Majorant::ZERO, |sum, moves| sum.plus(&moves));
        Some(sum.scaled(DEGREE))
    }

    /// The majorant of the unit quaternion that its angles come to.
    pub(crate) fn turned_over(&mut self, over: Over, order: RotationOrder) -> Majorant {
        let mut sum = Turned::Angles(self.fixed.to_array().map(Number::still));
        // The last part that mixes angles with those below it, for which it matters how many turns these are.
        let mixes = |part: &Part| part.mode == Mode::Through && !part.whole_rotations;
        let last = self.parts.iter().rposition(mixes);
        for (number, part) in self.parts.iter_mut().enumerate() {
            let whole_rotations = part.whole_rotations && !self.plain;
            let jumps_matter = last.is_some_and(|last| number <= last);
            let own = part.own_over(over);
            if matches!(part.mode, Mode::Base | Mode::Override) {
                sum = Turned::Angles(own);
                continue;
            }
            let weight = part.weight.over(over);
            let adds = part.mode == Mode::Additive;
            sum = match (sum, whole_rotations) {
                (sum, true) => {
                    let below = sum.whole(order);
                    let own = Turned::Angles(own).whole(order);
                    let upper = match adds {
                        true => own,
                        false => (below.0.conjugate() * own.0, below.1.product(&own.1)),
                    };
                    let middle = part_of(upper.0, weight.middle);
                    let moves = below.1.product(&share_of(upper, &weight));
                    Turned::Whole(below.0 * middle, moves)
                }
                (sum, false) => {
                    let below = match sum {
                        Turned::Angles(below) => below,
                        Turned::Whole(middle, moves) => {
                            angles_over(middle, &moves, order, jumps_matter)
                        }
                    };
                    let rest = match adds {
                        true => Number::still(1.0),
                        false => Number::still(1.0).minus(&weight),
                    };
                    Turned::Angles(
                        [0, 1, 2].map(|i| below[i].product(&rest).plus(&own[i].product(&weight))),
                    )
                }
            };
        }
        match order {
            RotationOrder::Spheric => Majorant::still(1.0),
            _ => sum.whole(order).1,
        }
    }
}

/// How far a rotation's angles are known: its second angle is less than this off a quarter turn as a cosine squared.
const POLE: f64 = 1e-5;

/// The three angles of a rotation. Near the poles of its axes nothing is known of them; where a jump from half a turn to the
/// other side matters, nothing is known there either.
fn angles_over(
    middle: DQuat,
    moves: &Majorant,
    order: RotationOrder,
    jumps_matter: bool,
) -> [Number; 3] {
    use RotationOrder::{Xyz, Xzy, Yxz, Yzx, Zxy, Zyx};
    let values = angles(middle, order);
    if moves.is_still() {
        return values.to_array().map(Number::still);
    }
    let any = |value: f64| Number::within(value, -180.0, 180.0);
    let second = match order {
        Yxz | Zxy => 0,
        Xyz | Zyx => 1,
        Xzy | Yzx => 2,
        _ => return values.to_array().map(any),
    };
    // Entries of the matrix: a sine s, and twos z whose length is its cosine.
    let mut entries = moves.product(moves);
    entries.0[0] = 1.0;
    let cosine = glam::DVec2::from_angle(values[second].to_radians()).x;
    let least = cosine * cosine - entries.0[1];
    if least.is_nan() || least < POLE {
        return values.to_array().map(any);
    }
    // The derivative of asin(s) is s' / cos, that of the angle of z at most |z'| / |z|.
    let squared = entries.product(&entries);
    let root = squared.logarithm(least, 1.0).scaled(0.5).exponential();
    let over = root
        .scaled(1.0 / least.sqrt())
        .max(&entries.reciprocal(least.sqrt()));
    let mut orders = [f64::INFINITY; ORDERS];
    for (k, order) in orders.iter_mut().enumerate().skip(1) {
        let terms = (1..=k).map(|i| i as f64 * entries.0[i] * over.0[k - i]);
        *order = terms.sum::<f64>() / k as f64;
    }
    let angle = Majorant(orders, orders[1] / 2.0).scaled(180.0 / std::f64::consts::PI);
    values.to_array().map(|value| {
        let number = Number::of(value, angle);
        match jumps_matter && number.low().abs().max(number.high().abs()) > 180.0 {
            true => any(value),
            false => number,
        }
    })
}

fn part_of(whole: DQuat, share: f64) -> DQuat {
    match share {
        s if s <= 0.0 => DQuat::IDENTITY,
        s if s >= 1.0 => whole,
        s => DQuat::IDENTITY.slerp(whole, s),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::curve_rates::line;
    use crate::curves::holds;

    #[test]
    fn angles_at_a_pole_stay_within() {
        let over = Over {
            from: 0.0,
            to: 1.0,
            slack: 0.0,
        };
        let order = RotationOrder::Xyz;
        let three = |t: f64| DVec3::new(20.0, 80.0 + 20.0 * t, 15.0 * t);
        let whole = Turned::Angles([Number::still(20.0), line(90.0, 20.0), line(7.5, 15.0)]);
        let own = whole.whole(order).1;
        let again = angles_over(turn(three(0.5), order), &own, order, false);
        for (axis, number) in again.iter().enumerate() {
            assert!(number.moves.0[1].is_infinite() && number.moves.1 <= 360.0);
            holds(&number.moves, over, |t| {
                [angles(turn(three(t), order), order)[axis]]
            });
        }
    }

    #[test]
    fn turning_about_three_axes_is_turning_by_their_sum() {
        let angles = [line(32.5, 10.0), line(-20.0, -16.0), line(65.0, -12.0)];
        let (_, quaternion) = Turned::Angles(angles).whole(RotationOrder::Xyz);
        let matrix = quaternion.product(&quaternion);
        let [x, y, z] = angles.map(|number| number.moves);
        let sum = x.plus(&y).plus(&z).scaled(DEGREE).rotation();
        for (order, (a, b)) in matrix.0.iter().zip(&sum.0).enumerate() {
            // Some forty roundings of f64.
            assert!((a - b).abs() <= 1e-14 * a, "order {order}: {a} and {b}");
        }
        assert!((matrix.1 - sum.1).abs() <= 1e-14);
    }

    #[test]
    fn parts_of_rotations_hold() {
        let over = Over {
            from: 0.0,
            to: 1.0,
            slack: 0.0,
        };
        let three = |t: f64| DVec3::new(27.5 + 10.0 * t, -12.0 - 16.0 * t, 71.0 - 12.0 * t);
        let order = RotationOrder::Xyz;
        let of = |middle: f64, way: f64| {
            Number::of(middle, Majorant::moving(middle.abs() + way.abs(), way))
        };
        let whole = Turned::Angles([of(32.5, 10.0), of(-20.0, -16.0), of(65.0, -12.0)]);
        let own = whole.whole(order);
        holds(&own.1, over, |t| turn(three(t), order).to_array());
        let again = angles_over(turn(three(0.5), order), &own.1, order, true);
        for (axis, number) in again.iter().enumerate() {
            assert!(number.moves.0[3].is_finite());
            holds(&number.moves, over, |t| {
                [angles(turn(three(t), order), order)[axis]]
            });
        }
        for (middle, way) in [(0.4, 0.0), (0.5, 0.6), (0.05, 0.1)] {
            let weight = of(middle, way);
            let moves = share_of(own, &weight);
            assert!(moves.0[4].is_finite());
            holds(&moves, over, |t| {
                part_of(turn(three(t), order), middle + way * (t - 0.5)).to_array()
            });
        }
    }
}
