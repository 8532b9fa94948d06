//! Optimal reciprocal collision avoidance over arrays.
//!
//! J. van den Berg, S. Guy, M. Lin, D. Manocha, Reciprocal n-body collision avoidance, ISRR 2011: each neighbour
//! leaves a half plane of velocities with which both, each taking half of the change, do not meet within a time. The
//! velocity taken is the one nearest to the wish in all of them and within the greatest speed, by linear programs in
//! two and, where there is none, three dimensions (section 5.3). Places are x and z.

use bevy::math::Vec2;

/// Most neighbours that count: the nearest.
pub const NEIGHBOURS: usize = 6;

/// Velocities to the left of a line are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Line {
    /// On it.
    pub point: Vec2,
    /// Along it, of length 1.
    pub way: Vec2,
}

/// One that others avoid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Disc {
    /// Where.
    pub place: Vec2,
    /// Metres a second.
    pub velocity: Vec2,
    /// Metres.
    pub radius: f32,
}

/// |a b|: above 0 if b lies to the left of a.
#[inline]
fn cross(a: Vec2, b: Vec2) -> f32 {
    a.x * b.y - a.y * b.x
}

/// The half plane that `other` leaves to `own`, for `time` seconds; of two that overlap, one that parts them within
/// `step` seconds. Of two in one place, `tie` says who goes where.
#[inline]
#[must_use]
pub fn half_plane(own: &Disc, other: &Disc, time: f32, step: f32, tie: bool) -> Line {
    let mut apart = other.place - own.place;
    let relative = own.velocity - other.velocity;
    let radius = own.radius + other.radius;
    let mut square = apart.length_squared();
    if square < 1e-8 {
        // Nearer than a tenth of a millimetre a difference says nothing: along x, one to each side.
        apart = Vec2::new(if tie { 1e-4 } else { -1e-4 }, 0.0);
        square = 1e-8;
    }
    let (way, change);
    if square > radius * radius {
        // From the centre of the small circle that cuts the cone off.
        let w = relative - apart / time;
        let length = w.length_squared();
        let along = w.dot(apart);
        if along < 0.0 && along * along > radius * radius * length {
            // Nearest to the circle.
            let w_length = length.sqrt();
            let unit = w / w_length;
            way = Vec2::new(unit.y, -unit.x);
            change = unit * (radius / time - w_length);
        } else {
            // Nearest to a leg.
            let leg = (square - radius * radius).sqrt();
            way = if cross(apart, w) > 0.0 {
                Vec2::new(
                    apart.x * leg - apart.y * radius,
                    apart.x * radius + apart.y * leg,
                ) / square
            } else {
                -Vec2::new(
                    apart.x * leg + apart.y * radius,
                    -apart.x * radius + apart.y * leg,
                ) / square
            };
            change = way * relative.dot(way) - relative;
        }
    } else {
        let w = relative - apart / step;
        let length = w.length();
        let unit = if length > 0.0 {
            w / length
        } else {
            -apart / square.sqrt()
        };
        way = Vec2::new(unit.y, -unit.x);
        change = unit * (radius / step - length);
    }
    Line {
        point: own.velocity + change / 2.0,
        way,
    }
}

/// On line `number`, within all lines before it and the circle of `speed`, the point nearest to `wish`, or the
/// farthest along it if `along`.
fn on_line(lines: &[Line], number: usize, speed: f32, wish: Vec2, along: bool) -> Option<Vec2> {
    let line = lines[number];
    let dot = line.point.dot(line.way);
    let over = dot * dot + speed * speed - line.point.length_squared();
    if over < 0.0 {
        return None;
    }
    let root = over.sqrt();
    let (mut left, mut right) = (-dot - root, -dot + root);
    for other in &lines[..number] {
        let below = cross(line.way, other.way);
        let above = cross(other.way, line.point - other.point);
        // Parallel but for the rounding of two products of unit vectors.
        if below.abs() <= 1e-5 {
            if above < 0.0 {
                return None;
            }
            continue;
        }
        let at = above / below;
        if below >= 0.0 {
            right = right.min(at);
        } else {
            left = left.max(at);
        }
        if left > right {
            return None;
        }
    }
    let at = if along {
        if wish.dot(line.way) > 0.0 {
            right
        } else {
            left
        }
    } else {
        line.way.dot(wish - line.point).clamp(left, right)
    };
    Some(line.point + line.way * at)
}

/// The velocity within all lines; and the first line that could not be kept, or their count.
fn in_plane(lines: &[Line], speed: f32, wish: Vec2, along: bool) -> (Vec2, usize) {
    let mut result = if along {
        wish * speed
    } else if wish.length_squared() > speed * speed {
        wish.normalize_or_zero() * speed
    } else {
        wish
    };
    for number in 0..lines.len() {
        let line = lines[number];
        if cross(line.way, line.point - result) > 0.0 {
            match on_line(lines, number, speed, wish, along) {
                Some(better) => result = better,
                None => return (result, number),
            }
        }
    }
    (result, lines.len())
}

/// The velocity nearest to `wish` that keeps to all lines; where none does, the one that breaks them least.
#[must_use]
pub fn velocity(lines: &[Line], speed: f32, wish: Vec2) -> Vec2 {
    let (mut result, first) = in_plane(lines, speed, wish, false);
    let mut worst = 0.0;
    for number in first..lines.len() {
        let line = lines[number];
        if cross(line.way, line.point - result) <= worst {
            continue;
        }
        let mut edges = [Line::default(); NEIGHBOURS];
        let mut count = 0;
        for other in lines[..number].iter().take(NEIGHBOURS) {
            let turn = cross(line.way, other.way);
            let point = if turn.abs() <= 1e-5 {
                if line.way.dot(other.way) > 0.0 {
                    continue;
                }
                (line.point + other.point) / 2.0
            } else {
                line.point + line.way * (cross(other.way, line.point - other.point) / turn)
            };
            edges[count] = Line {
                point,
                way: (other.way - line.way).normalize_or_zero(),
            };
            count += 1;
        }
        let toward = Vec2::new(-line.way.y, line.way.x);
        let (better, kept) = in_plane(&edges[..count], speed, toward, true);
        if kept == count {
            result = better;
        }
        worst = cross(line.way, line.point - result);
    }
    result
}
