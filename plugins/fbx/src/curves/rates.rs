//! Majorants of the file's curves over a span between keys.

use super::curve::{Curve, reach, solve};
use super::layers::{Mode, Weight};
use super::majorant::{Majorant, Number, ORDERS, Over, cubic, cubic_over_time, part};
use super::pose::{BlendWeight, NodeCurves, Turn};
use super::value::{Part, Value, angles, turn};
use crate::model::Trs;
use crate::read::convert::vec3;
use glam::{DQuat, DVec3};
use ufbx::{ExtrapolationMode, Interpolation, RotationOrder};

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

impl Curve<'_> {
    /// Over a span on the file's clock.
    pub(crate) fn over(&mut self, over: Over) -> Number {
        let middle = over.middle();
        let value = self.at(middle);
        let (Some(first), Some(last)) = (self.keys.first(), self.keys.last()) else {
            return Number::still(0.0);
        };
        if self.keys.len() == 1 {
            return Number::still(value);
        }
        if middle >= first.time && middle <= last.time {
            return self.between(over, value);
        }
        let is_before = middle < first.time;
        let is_beyond = match is_before {
            true => over.to <= first.time + over.slack,
            false => over.from >= last.time - over.slack,
        };
        if !is_beyond {
            return self.anywhere(over, value);
        }
        let (how, key) = match is_before {
            true => (self.before, first),
            false => (self.after, last),
        };
        match how.mode {
            ExtrapolationMode::Constant => return Number::still(value),
            ExtrapolationMode::Slope => {
                let slope = (value - key.value) / (middle - key.time);
                return line(value, slope * (over.to - over.from));
            }
            _ => {}
        }
        let Some((inner, _)) = self.folded(middle) else {
            return Number::still(value);
        };
        // Seams are keys, so that a span lies within one repetition.
        let half = (over.to - over.from) / 2.0;
        let inner = Over {
            from: inner - half,
            to: inner + half,
            slack: over.slack + 1e-9 * (1.0 + middle.abs()),
        };
        self.between(inner, value)
    }

    fn between(&mut self, over: Over, value: f64) -> Number {
        let at = self.segment(over.middle());
        let (Some(key), Some(next)) = (self.keys.get(at), self.keys.get(at + 1)) else {
            return Number::still(value);
        };
        if over.from < key.time - over.slack || over.to > next.time + over.slack {
            return self.anywhere(over, value);
        }
        let length = next.time - key.time;
        let share = |time: f64| ((time - key.time) / length).clamp(0.0, 1.0);
        let (s, e) = (share(over.from), share(over.to));
        match key.interpolation {
            Interpolation::ConstantPrev | Interpolation::ConstantNext => Number::still(value),
            Interpolation::Linear => line(value, (next.value - key.value) * (e - s)),
            Interpolation::Cubic => {
                let piece = self.piece(at, key, next);
                let values = piece.values;
                let moves = match piece.is_even() {
                    true => cubic(part(values, s, e)),
                    false => {
                        let (a, b) = (piece.out, 1.0 - piece.into);
                        let (p, q) = (solve(a, b, s), solve(a, b, e));
                        let time = part([0.0, a, b, 1.0], p, q);
                        let time = time.map(|x| (x - time[0]) / (time[3] - time[0]));
                        cubic_over_time(time, part(values, p, q))
                    }
                };
                Number::of(value, moves)
            }
        }
    }
}

impl Curve<'_> {
    /// Over a span with keys in it: between the least and the greatest point of all that it touches.
    fn anywhere(&mut self, over: Over, value: f64) -> Number {
        let (Some(first), Some(last)) = (self.keys.first(), self.keys.last()) else {
            return Number::still(value);
        };
        let (begin, end) = (first.time, last.time);
        let is_inside = over.from >= begin && over.to <= end;
        let touched = match is_inside {
            true => self.segment(over.from)..self.segment(over.to) + 1,
            false => 0..self.keys.len(),
        };
        let mut all = (value, value);
        let mut take = |x: f64| all = (all.0.min(x), all.1.max(x));
        for at in touched {
            let Some(key) = self.keys.get(at) else { break };
            take(key.value);
            let Some(next) = self.keys.get(at + 1) else {
                break;
            };
            take(next.value);
            if key.interpolation == Interpolation::Cubic {
                let length = next.time - key.time;
                let (out, out_slope) = reach(key.right, length);
                let (into, into_slope) = reach(next.left, length);
                take(key.value + out_slope * out);
                take(next.value - into_slope * into);
            }
        }
        if !is_inside {
            // Repetitions that climb, and lines, go beyond all keys: by no more than they do at the ends, and one climb.
            let climb = (last.value - first.value).abs();
            let ends = [over.from, over.to].map(|time| self.at(time));
            for end in ends {
                take(end - climb);
                take(end + climb);
            }
            let modes = [self.before.mode, self.after.mode];
            if modes.contains(&ExtrapolationMode::RepeatRelative) {
                let whole = all.1 - all.0;
                all = (all.0 - whole, all.1 + whole);
            }
        }
        let (low, high) = all;
        Number::within(value, low, high)
    }
}

/// A number that goes `way` along a line, at `value` in the middle.
fn line(value: f64, way: f64) -> Number {
    let most = value.abs() + way.abs() / 2.0;
    Number::of(value, Majorant::moving(most, way))
}

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

    /// Of the sum of its three angles, radians, where these are those of one layer and no mixture: turning about one axis after
    /// the other has the majorant of turning by their sum, since products of exponentials are those of sums.
    fn sum_over(&mut self, over: Over) -> Option<Majorant> {
        let own = match &mut self.parts[..] {
            [] => return Some(Majorant::ZERO),
            [part] if matches!(part.mode, Mode::Base | Mode::Override) => part.own_over(over),
            _ => return None,
        };
        let [x, y, z] = own.map(|number| number.moves);
        Some(x.plus(&y).plus(&z).scaled(DEGREE))
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

impl Turn<'_> {
    fn over(&mut self, over: Over) -> Majorant {
        match self.angles.moves() {
            false => Majorant::still(1.0),
            true => self.angles.turned_over(over, RotationOrder::Xyz),
        }
    }
}

/// Majorants of what places a node below its parent: of the translation's length, and of the sizes of the matrices that
/// turn it and that scale it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rates {
    pub(crate) translation: Majorant,
    pub(crate) turn: Majorant,
    pub(crate) scale: Majorant,
}

impl Rates {
    pub(crate) const UNKNOWN: Self = Self {
        translation: Majorant::UNKNOWN,
        turn: Majorant::UNKNOWN,
        scale: Majorant::UNKNOWN,
    };

    /// Of what stands still.
    pub(crate) fn still(pose: &Trs) -> Self {
        Self {
            translation: Majorant::still(pose.translation.length()),
            turn: Majorant::still(1.0),
            scale: Majorant::still(pose.scale.abs().max_element()),
        }
    }
}

/// Of the largest of three.
fn largest(parts: &[Number; 3]) -> Majorant {
    parts[0].moves.max(&parts[1].moves).max(&parts[2].moves)
}

impl NodeCurves<'_> {
    /// Over a span between keys. Mirrored axes and turned cameras change no length.
    pub(crate) fn over(&mut self, over: Over) -> Rates {
        let node = self.node;
        let order = self.rotation_order(over.middle());
        // Between two whole numbers the order is the lower one's.
        let changes = self.order.moves() && {
            let [number, ..] = self.order.over(over, false);
            number.low().trunc() != number.high().trunc()
        };
        let mut helped = [Number::still(1.0); 3];
        let above = self.helpers.len() - usize::from(self.parent_helps);
        let by = |a: &[Number; 3], b: &[Number; 3]| [0, 1, 2].map(|i| a[i].product(&b[i]));
        for helper in &mut self.helpers[..above] {
            helped = by(&helped, &helper.over(over, true));
        }
        let own = self.scale.over(over, true);
        let spin = self.spin_over(over, order, changes);
        let lengths = |parts: &[Number; 3]| Majorant::length(&parts.map(|number| number.moves));
        let translation = self.translation.over(over, false);
        let mut places = match self.has_pivots {
            false => lengths(&translation),
            true => {
                let about = match &mut self.taken {
                    Some(taken) => taken.over(over, true),
                    None => own,
                };
                let pivot = self.scale_pivot.over(over, false);
                let turned_at = self.rotation_pivot.over(over, false);
                let offset = self.scale_offset.over(over, false);
                let place = [0, 1, 2].map(|i| {
                    pivot[i]
                        .minus(&pivot[i].product(&about[i]))
                        .plus(&offset[i])
                        .minus(&turned_at[i])
                });
                let swung = spin.product(&lengths(&place));
                let around = self.rotation_offset.over(over, false);
                let shift = [0, 1, 2].map(|i| turned_at[i].plus(&around[i]).plus(&translation[i]));
                swung.plus(&lengths(&shift))
            }
        };
        if let Some(helper) = self.helpers.get_mut(above) {
            let all = by(&helped, &helper.over(over, true));
            places = places.product(&largest(&all));
        }
        let mut sizes = largest(&own);
        if node.has_adjust_transform {
            places.0[0] += vec3(node.adjust_pre_translation).length();
            places = places.scaled(node.adjust_pre_scale * node.adjust_translation_scale);
            sizes = sizes.scaled(node.adjust_pre_scale * node.adjust_post_scale);
        }
        if node.is_scale_helper {
            sizes = sizes.product(&largest(&helped));
        }
        Rates {
            translation: places,
            turn: spin,
            scale: sizes,
        }
    }
}

impl NodeCurves<'_> {
    /// The majorant of the matrix that turns it; `changes` says that its order does.
    fn spin_over(&mut self, over: Over, order: RotationOrder, changes: bool) -> Majorant {
        let around = self.node.use_rotation_space;
        let stands = !around || !self.before.angles.moves() && !self.after.angles.moves();
        if stands
            && !changes
            && order != RotationOrder::Spheric
            && let Some(sum) = self.rotation.sum_over(over)
        {
            return sum.rotation();
        }
        let turned = match around {
            true if changes => Majorant::within(1.0, 2.0),
            true => self.rotation.turned_over(over, order),
            false => self.rotation.turned_over(over, RotationOrder::Xyz),
        };
        let spin = match around {
            true => {
                let before = self.before.over(over).product(&turned);
                before.product(&self.after.over(over)).near(2.0)
            }
            false => turned,
        };
        // A quaternion turns a vector from both sides.
        spin.product(&spin).near(2.0)
    }
}

impl BlendWeight<'_> {
    /// As a share.
    pub(crate) fn over(&mut self, over: Over) -> Number {
        let percent = self.percent.over(over, false)[0];
        Number::of(percent.middle / 100.0, percent.moves.scaled(0.01))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::majorant::holds;
    use ufbx::{Keyframe, Tangent};

    #[test]
    fn weighted_tangents_hold() {
        for (out, into) in [(0.2, 0.4), (0.05, 0.9), (0.333, 0.1)] {
            let key = |time: f64, value: f64, dx: f32| Keyframe {
                time,
                value,
                interpolation: Interpolation::Cubic,
                left: Tangent { dx, dy: 3.0 * dx },
                right: Tangent { dx, dy: -7.0 * dx },
            };
            let keys = [key(1.0, 2.0, 2.0 * out), key(3.0, 5.0, 2.0 * into)];
            let mut curve = Curve::with_keys(&keys);
            for (from, to) in [(1.0, 3.0), (1.0, 1.4), (1.9, 2.3), (2.9, 3.0)] {
                let over = Over {
                    from,
                    to,
                    slack: 0.0,
                };
                let number = curve.over(over);
                let other = curve.clone();
                assert!(
                    number.moves.0[1].is_finite() || to - from > 1.0,
                    "{number:?}"
                );
                holds(&number.moves, over, |time| [other.clone().at(time)]);
            }
        }
    }

    #[test]
    fn what_lies_on_both_sides_of_keys_stays_within() {
        let key = |time: f64, value: f64| Keyframe {
            time,
            value,
            interpolation: Interpolation::Cubic,
            left: Tangent { dx: 0.333, dy: 2.0 },
            right: Tangent {
                dx: 0.333,
                dy: -1.0,
            },
        };
        let keys = [key(1.0, 2.0), key(2.0, -1.0), key(3.0, 5.0)];
        let mut curve = Curve::with_keys(&keys);
        curve.after.mode = ExtrapolationMode::RepeatRelative;
        for (from, to) in [(1.5, 2.2), (0.0, 1.8), (1.1, 2.9), (2.5, 3.2), (3.5, 8.0)] {
            let over = Over {
                from,
                to,
                slack: 0.0,
            };
            let number = curve.over(over);
            assert!(number.moves.0[1].is_infinite() && number.moves.1 < 60.0);
            let other = curve.clone();
            holds(&number.moves, over, |time| [other.clone().at(time)]);
        }
    }

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
