//! What keys hold, and how it is mixed.

use glam::{DQuat, DVec3};

/// A value of a channel.
pub(crate) trait Value: Clone + PartialEq {
    /// Between two keys of a linear channel.
    fn mix(from: &Self, to: &Self, share: f64) -> Self;
    /// `sum += value * factor`, component by component.
    fn add(sum: &mut Self, value: &Self, factor: f64);
    /// Nothing, in the shape of `self`.
    fn zero(&self) -> Self;
    /// What a player makes of a cubic's sum.
    fn finish(self) -> Self;
    /// Its numbers.
    fn numbers(&self, out: &mut Vec<f64>);
    /// From numbers.
    fn from_numbers(numbers: &[f64]) -> Self;
}

impl Value for DVec3 {
    fn mix(from: &Self, to: &Self, share: f64) -> Self {
        from.lerp(*to, share)
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

    fn from_numbers(numbers: &[f64]) -> Self {
        Self::from_slice(numbers)
    }
}

impl Value for DQuat {
    fn mix(from: &Self, to: &Self, share: f64) -> Self {
        // Below an angle of 2e-3 the chord is the arc within 1e-13.
        if from.dot(*to) > 1.0 - 1e-6 {
            from.lerp(*to, share)
        } else {
            from.slerp(*to, share)
        }
    }

    fn add(sum: &mut Self, value: &Self, factor: f64) {
        *sum = *sum + *value * factor;
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

    fn from_numbers(numbers: &[f64]) -> Self {
        Self::from_slice(numbers)
    }
}

impl Value for Vec<f64> {
    fn mix(from: &Self, to: &Self, share: f64) -> Self {
        from.iter().zip(to).map(|(a, b)| a + (b - a) * share).collect()
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

    fn from_numbers(numbers: &[f64]) -> Self {
        numbers.to_vec()
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
