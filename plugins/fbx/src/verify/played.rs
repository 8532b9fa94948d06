//! Majorants of keys as they are played, over a span between keys.

use crate::clips::Player;
use crate::curves::{Majorant, ORDERS, Over, Turning, cubic, part};
use crate::model::{Channel, Interpolation, Property};
use glam::DVec4;

/// Numbers of a value.
fn width(channel: &Channel) -> usize {
    let values = match channel.interpolation {
        Interpolation::Cubic => 3,
        _ => 1,
    };
    channel.values.len() / (channel.times.len() * values).max(1)
}

/// What a channel does over a span.
enum Stretch {
    Still(usize),
    /// From one key to the next: shares at which the span begins and ends.
    Moves(usize, f64, f64),
    /// The span goes across a key.
    Across,
}

fn stretch(channel: &Channel, player: &mut Player, over: Over) -> Stretch {
    let times = &channel.times;
    let middle = over.middle();
    let last = player.seek(middle);
    if f64::from(times[last]) > middle
        || last + 1 == times.len()
        || channel.interpolation == Interpolation::Step
    {
        return Stretch::Still(last);
    }
    let (begin, end) = (f64::from(times[last]), f64::from(times[last + 1]));
    if over.from < begin - over.slack || over.to > end + over.slack {
        return Stretch::Across;
    }
    let share = |time: f64| ((time - begin) / (end - begin)).clamp(0.0, 1.0);
    Stretch::Moves(last, share(over.from), share(over.to))
}

/// The majorants of each number of a channel, and of its player; seconds from the clip's begin.
pub(super) fn numbers(channel: &Channel, player: &mut Player, over: Over, out: &mut Vec<Majorant>) {
    let stretch = stretch(channel, player, over);
    let each = (0..width(channel)).map(|number| each(channel, &stretch, over, number));
    out.extend(each);
}

fn each(channel: &Channel, stretch: &Stretch, over: Over, number: usize) -> Majorant {
    let width = width(channel);
    let cubics = channel.interpolation == Interpolation::Cubic;
    // A cubic's key has a tangent on each side of its value.
    let (values, middle) = if cubics { (3, 1) } else { (1, 0) };
    let value = |key: usize, which: usize| {
        f64::from(channel.values[(key * values + which) * width + number])
    };
    match *stretch {
        Stretch::Across => {
            let key = |time: f64| channel.times.partition_point(|&key| f64::from(key) <= time);
            let touched =
                key(over.from).saturating_sub(1)..(key(over.to) + 1).min(channel.times.len());
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            let mut take = |x: f64| (low, high) = (low.min(x), high.max(x));
            for at in touched {
                let here = value(at, middle);
                take(here);
                if !cubics {
                    continue;
                }
                // Tangents reach over a third of the time to the next key, or less.
                let time = |at: usize| f64::from(channel.times[at.min(channel.times.len() - 1)]);
                take(here + value(at, 2) * (time(at + 1) - time(at)) / 3.0);
                take(here - value(at, 0) * (time(at) - time(at.saturating_sub(1))) / 3.0);
            }
            Majorant::within(low.abs().max(high.abs()), high - low)
        }
        Stretch::Still(key) => Majorant::still(value(key, middle)),
        Stretch::Moves(key, begin, end) => {
            let (a, d) = (value(key, middle), value(key + 1, middle));
            if !cubics {
                return Majorant::moving(a.abs().max(d.abs()), (d - a) * (end - begin));
            }
            let length = f64::from(channel.times[key + 1]) - f64::from(channel.times[key]);
            let (leave, arrive) = (value(key, 2) * length, value(key + 1, 0) * length);
            let points = [a, a + leave / 3.0, d - arrive / 3.0, d];
            cubic(part(points, begin, end))
        }
    }
}

/// The majorant of the matrix of a channel of rotations, and of its player.
pub(super) fn turn(channel: &Channel, player: &mut Player, over: Over) -> Turning {
    match stretch(channel, player, over) {
        Stretch::Across => Turning::Whole(Majorant::within(1.0, 2.0)),
        Stretch::Still(_) => Turning::STILL,
        Stretch::Moves(key, begin, end) => match channel.interpolation {
            Interpolation::Cubic => {
                let quat = |key: usize, which: usize| {
                    let at = (key * 3 + which) * 4;
                    DVec4::from_array([0, 1, 2, 3].map(|i| f64::from(channel.values[at + i])))
                };
                let length = f64::from(channel.times[key + 1]) - f64::from(channel.times[key]);
                let (a, d) = (quat(key, 1), quat(key + 1, 1));
                let (leave, arrive) = (quat(key, 2) * length, quat(key + 1, 0) * length);
                let points = [a, a + leave / 3.0, d - arrive / 3.0, d];
                let axes = points.map(|point| point.to_array());
                let axis = |i: usize| part(axes.map(|point| point[i]), begin, end);
                let parts = [axis(0), axis(1), axis(2), axis(3)];
                let points = [0, 1, 2, 3].map(|i| DVec4::from_array(parts.map(|part| part[i])));
                Turning::Whole(sphere(points))
            }
            _ => {
                let half = player.arc(key).angle();
                Turning::By(Majorant::moving(0.0, 2.0 * half * (end - begin)))
            }
        },
    }
}

/// Of the matrix of a quaternion that is made one long: q x / |q|^2, from both sides. The length of keys' curves is
/// hardly off 1, so that it is worked out as the polynomial that it is.
fn sphere(points: [DVec4; 4]) -> Majorant {
    let [p, q, r, s] = points;
    // Around the middle of the span.
    let a = [
        (p + 3.0 * (q + r) + s) / 8.0,
        0.75 * (s + r - q - p),
        1.5 * (s - r - q + p),
        s - 3.0 * (r - q) - p,
    ];
    let mut squares = [0.0; ORDERS];
    for (i, x) in a.iter().enumerate() {
        for (k, y) in a.iter().enumerate() {
            squares[i + k] += x.dot(*y);
        }
    }
    // Taylor coefficients of a polynomial half a span away from the middle at most.
    let around = |coefficients: &[f64], order: usize| {
        let mut sum = 0.0;
        let mut factor = 1.0;
        for (k, x) in coefficients.iter().enumerate().skip(order) {
            sum += factor * x.abs();
            factor *= 0.5 * (k + 1) as f64 / (k + 1 - order) as f64;
        }
        sum
    };
    let squared = Majorant::by_orders(std::array::from_fn(|k| around(&squares, k)));
    let least = squares[0] - (squared.0[0] - squares[0].abs());
    let sizes = a.map(DVec4::length);
    let orders = std::array::from_fn(|k| if k < 4 { around(&sizes, k) } else { 0.0 });
    let long = Majorant::by_orders(orders);
    let mut out = long.product(&long).product(&squared.reciprocal(least));
    out.0[0] = 1.0;
    // Directions of two ways of four numbers are apart by at most twice what they are, over the length of one.
    let way = a[1].length() / 2.0 + a[2].length() / 4.0 + a[3].length() / 8.0;
    out.1 = 4.0 * way / a[0].length();
    if out.1.is_nan() {
        out.1 = 2.0;
    }
    out.near(2.0)
}

/// Majorants of the length of a channel of three numbers and its player, and of the largest of them.
pub(super) fn vector(channel: &Channel, player: &mut Player, over: Over) -> (Majorant, Majorant) {
    debug_assert!(channel.property != Property::Rotation);
    if width(channel) != 3 {
        return (Majorant::UNKNOWN, Majorant::UNKNOWN);
    }
    let stretch = stretch(channel, player, over);
    let parts @ [x, y, z] = [0, 1, 2].map(|number| each(channel, &stretch, over, number));
    (Majorant::length(&parts), x.max(&y).max(&z))
}
