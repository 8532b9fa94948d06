//! What keys hold, and how it is mixed.

use glam::{DQuat, DVec2, DVec3};

/// A value of a channel.
pub(crate) trait Value: Clone + PartialEq {
    /// What two keys of a linear channel have in common for all places between them.
    type Line;
    /// The way between two keys of a linear channel.
    fn line(from: &Self, to: &Self) -> Self::Line;
    /// A place on the way, at `share` from 0 to 1.
    fn on_line(line: &Self::Line, share: f64) -> Self;
    /// `sum += value * factor`, component by component.
    fn add(sum: &mut Self, value: &Self, factor: f64);
    /// Nothing, in the shape of `self`.
    fn zero(&self) -> Self;
    /// What a player makes of a cubic's sum.
    fn finish(self) -> Self;
    /// Its numbers.
    fn numbers(&self, out: &mut Vec<f64>);
}

impl Value for DVec3 {
    type Line = (Self, Self);

    fn line(from: &Self, to: &Self) -> Self::Line {
        (*from, *to - *from)
    }

    fn on_line((from, way): &Self::Line, share: f64) -> Self {
        *from + *way * share
    }

    fn add(sum: &mut Self, value: &Self, factor: f64) {
        *sum += *value * factor;
    }

    fn zero(&self) -> Self {
        Self::ZERO
    }

    fn finish(self) -> Self {
        self
    }

    fn numbers(&self, out: &mut Vec<f64>) {
        out.extend(self.to_array());
    }
}

/// A slerp between two unit quaternions.
pub(crate) struct Arc {
    from: DQuat,
    /// The unit quaternion at right angles to `from`, towards the other end.
    aside: DQuat,
    /// Angle of the arc in four dimensions: half of the rotation's.
    angle: f64,
}

impl Arc {
    /// In four dimensions: half of the rotation's.
    pub(crate) fn angle(&self) -> f64 {
        self.angle
    }
}

impl Value for DQuat {
    type Line = Arc;

    fn line(from: &Self, to: &Self) -> Arc {
        let to = if from.dot(*to) < 0.0 { -*to } else { *to };
        let cosine = from.dot(to);
        let aside = to - *from * cosine;
        let sine = aside.length();
        if sine < 1e-12 {
            return Arc {
                from: *from,
                aside: DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0),
                angle: 0.0,
            };
        }
        Arc {
            from: *from,
            aside: aside * (1.0 / sine),
            angle: DVec2::new(cosine, sine).to_angle(),
        }
    }

    fn on_line(arc: &Arc, share: f64) -> Self {
        let (sine, cosine) = sin_cos(arc.angle * share);
        arc.from * cosine + arc.aside * sine
    }

    fn add(sum: &mut Self, value: &Self, factor: f64) {
        *sum += *value * factor;
    }

    fn zero(&self) -> Self {
        Self::from_xyzw(0.0, 0.0, 0.0, 0.0)
    }

    fn finish(self) -> Self {
        match self.length_squared() > 1e-24 {
            true => self.normalize(),
            false => Self::IDENTITY,
        }
    }

    fn numbers(&self, out: &mut Vec<f64>) {
        out.extend(self.to_array());
    }
}

/// 1 over n (n + 1) and over n (n - 1), for n = 14, 12 and so on: each term of both series over the one before it.
const FACTORS: [(f64, f64); 7] = {
    let mut out = [(0.0, 0.0); 7];
    let mut i = 0;
    while i < 7 {
        let n = 14.0 - 2.0 * i as f64;
        out[i] = (1.0 / (n * (n + 1.0)), 1.0 / (n * (n - 1.0)));
        i += 1;
    }
    out
};

/// Sine and cosine of 0 to a quarter turn: their series to the 15th and 14th power, off by less than
/// 1e-13 up to 0.8 and by 1e-9 at the end. Arcs between keys are short.
fn sin_cos(x: f64) -> (f64, f64) {
    let x2 = x * x;
    let mut sine = 1.0;
    let mut cosine = 1.0;
    for (of_sine, of_cosine) in FACTORS {
        sine = 1.0 - sine * x2 * of_sine;
        cosine = 1.0 - cosine * x2 * of_cosine;
    }
    (x * sine, cosine)
}

impl Value for Vec<f64> {
    type Line = (Self, Self);

    fn line(from: &Self, to: &Self) -> Self::Line {
        (
            from.clone(),
            to.iter().zip(from).map(|(b, a)| b - a).collect(),
        )
    }

    fn on_line((from, way): &Self::Line, share: f64) -> Self {
        from.iter().zip(way).map(|(a, b)| a + b * share).collect()
    }

    fn add(sum: &mut Self, value: &Self, factor: f64) {
        for (sum, value) in sum.iter_mut().zip(value) {
            *sum += value * factor;
        }
    }

    fn zero(&self) -> Self {
        vec![0.0; self.len()]
    }

    fn finish(self) -> Self {
        self
    }

    fn numbers(&self, out: &mut Vec<f64>) {
        out.extend_from_slice(self);
    }
}

/// Weights of two values and two tangents in a cubic Hermite curve; tangents are per unit of `share`.
pub(crate) fn hermite(share: f64) -> [f64; 4] {
    let (s, s2) = (share, share * share);
    let s3 = s2 * s;
    [
        2.0 * s3 - 3.0 * s2 + 1.0,
        s3 - 2.0 * s2 + s,
        -2.0 * s3 + 3.0 * s2,
        s3 - s2,
    ]
}

/// A place on a cubic Hermite curve.
pub(crate) fn cubic<V: Value>(from: &V, out: &V, to: &V, into: &V, share: f64) -> V {
    let [a, b, c, d] = hermite(share);
    let mut sum = from.zero();
    V::add(&mut sum, from, a);
    V::add(&mut sum, out, b);
    V::add(&mut sum, to, c);
    V::add(&mut sum, into, d);
    sum.finish()
}

/// The angle between two rotations, radians, by their chord: right to first order, and a bound from
/// below above that which keys of a tenth of a millimetre never come to.
pub(crate) fn angle(a: DQuat, b: DQuat) -> f64 {
    let same = if a.dot(b) < 0.0 { a + b } else { a - b };
    2.0 * same.length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arcs_are_those_of_slerp() {
        let from = DQuat::from_rotation_x(0.3) * DQuat::from_rotation_y(1.0);
        for angle in [1e-9, 1e-3, 0.5, 1.5, 3.0] {
            let to = from * DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -1.0).normalize(), angle);
            let arc = DQuat::line(&from, &-to);
            for share in [0.0, 0.25, 0.5, 1.0] {
                let off = self::angle(DQuat::on_line(&arc, share), from.slerp(to, share));
                assert!(off < 4e-9, "{angle} {share}: {off}");
            }
        }
    }

    #[test]
    fn hermite_is_right_at_its_ends() {
        assert_eq!(hermite(0.0), [1.0, 0.0, 0.0, 0.0]);
        assert_eq!(hermite(1.0), [0.0, 0.0, 1.0, 0.0]);
    }
}
