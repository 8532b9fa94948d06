//! Who is in range and in the field of an eye, eight at once.

use bevy::math::Vec3;

/// Places that are looked at at once.
const WIDE: usize = 8;

/// Whether somebody at `to` is in range and field of an eye.
#[must_use]
pub fn in_field(eye: Vec3, forward: Vec3, range: f32, cos_field: f32, to: Vec3) -> bool {
    let way = to - eye;
    let square = way.length_squared();
    // Nobody sees out of themselves. Also refuses NaN.
    square > 0.0 && square <= range * range && way.dot(forward) >= cos_field * square.sqrt()
}

/// Places by axes.
#[derive(Default)]
pub(super) struct Places {
    axes: [Vec<f32>; 3],
    count: usize,
}

impl Places {
    /// Puts others in place of them.
    pub fn fill(&mut self, places: impl ExactSizeIterator<Item = Vec3>) {
        self.count = places.len();
        for axis in &mut self.axes {
            axis.clear();
        }
        let nowhere = std::iter::repeat_n(Vec3::NAN, WIDE);
        for place in places.chain(nowhere) {
            for (axis, at) in self.axes.iter_mut().zip(place.to_array()) {
                axis.push(at);
            }
        }
    }

    /// Calls `each` with the number and the squared distance of those of a span whom [`in_field`] says yes of, in
    /// their order.
    #[inline]
    pub fn in_field(
        &self,
        span: std::ops::Range<usize>,
        eye: Vec3,
        forward: Vec3,
        range: f32,
        cos_field: f32,
        mut each: impl FnMut(usize, f32),
    ) {
        let end = span.end.min(self.count);
        let mut first = span.start;
        while first < end {
            let [x, y, z] = self.axes.each_ref().map(|axis| &axis[first..first + WIDE]);
            let (mut squares, mut found) = ([0.0; WIDE], 0_u32);
            let mut ahead = [0.0; WIDE];
            for lane in 0..WIDE {
                let (x, y, z) = (x[lane] - eye.x, y[lane] - eye.y, z[lane] - eye.z);
                squares[lane] = x * x + y * y + z * z;
                ahead[lane] = x * forward.x + y * forward.y + z * forward.z;
            }
            for lane in 0..WIDE {
                let square: f32 = squares[lane];
                let is_in = (square > 0.0)
                    & (square <= range * range)
                    & (ahead[lane] >= cos_field * square.sqrt());
                found |= u32::from(is_in) << lane;
            }
            if end - first < WIDE {
                found &= (1 << (end - first)) - 1;
            }
            while found != 0 {
                let lane = found.trailing_zeros() as usize;
                found &= found - 1;
                each(first + lane, squares[lane]);
            }
            first += WIDE;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn eight_at_once_are_those_that_are_in_the_field_one_by_one() {
        let mut random = Random::new(11);
        let mut place = || Vec3::new(random.signed(50.0), random.signed(5.0), random.signed(50.0));
        let mut all: Vec<Vec3> = (0..1003).map(|_| place()).collect();
        let eye = place();
        all[17] = eye;
        all[40] = Vec3::NAN;
        all[41] = Vec3::INFINITY;
        let forward = Vec3::new(0.6, 0.0, -0.8);
        let mut places = Places::default();
        places.fill(all.iter().copied());
        for (span, range, cos) in [
            (0..1003, 40.0, 0.5),
            (3..29, 60.0, -1.0),
            (995..1003, 60.0, -0.5),
            (7..7, 9.0, 0.0),
        ] {
            let mut found = Vec::new();
            places.in_field(span.clone(), eye, forward, range, cos, |at, square| {
                assert_eq!(square.to_bits(), all[at].distance_squared(eye).to_bits());
                found.push(at);
            });
            let one_by_one: Vec<usize> = span
                .clone()
                .filter(|&at| in_field(eye, forward, range, cos, all[at]))
                .collect();
            assert_eq!(found, one_by_one, "{span:?}");
            assert!(span.is_empty() || !found.is_empty());
        }
    }
}
