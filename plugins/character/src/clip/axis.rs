//! Time axes: which two keys a moment lies between.
//!
//! Channels whose keys stand at the same times share an axis, so that a clip that was baked at one rate
//! looks each moment up once. The lookup keeps no state: a table of as many buckets as there are keys
//! says where to begin, and few steps lead on. Any order of moments gives the same answers.

/// Key times, increasing strictly, and their table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axis {
    times: Vec<f32>,
    /// For each bucket of equal length, the last key that lies in an earlier one (or key 0).
    first: Vec<u32>,
    /// Buckets a second.
    scale: f32,
}

/// Where a moment lies on an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    /// The key at or before; never the last.
    pub key: u32,
    /// Part of the way to the next key, in [0, 1].
    pub part: f32,
    /// Seconds between both keys.
    pub length: f32,
}

/// More steps than this to go, and halving is faster.
const STEPS: u32 = 8;

impl Axis {
    /// An axis of at least two finite times that increase strictly.
    pub(crate) fn new(times: &[f32]) -> Self {
        debug_assert!(times.len() >= 2 && times.is_sorted_by(|a, b| a < b));
        let buckets = times.len();
        let scale = buckets as f32 / (times[buckets - 1] - times[0]);
        let mut axis = Self {
            times: times.to_vec(),
            first: vec![0; buckets + 1],
            // Two keys so close that the quotient is infinite share one bucket.
            scale: if scale.is_finite() { scale } else { 0.0 },
        };
        let mut key = 0;
        for bucket in 0..=buckets {
            while key < buckets && axis.bucket(times[key]) < bucket {
                key += 1;
            }
            axis.first[bucket] = key.saturating_sub(1) as u32;
        }
        axis
    }

    pub(crate) fn times(&self) -> &[f32] {
        &self.times
    }

    /// Rounding cannot lead past a key: a later time is never in an earlier bucket, as every operation
    /// here is monotonic.
    #[inline]
    fn bucket(&self, time: f32) -> usize {
        (((time - self.times[0]) * self.scale) as usize).min(self.times.len())
    }

    /// The keys about a moment. Before the first key it is the first, after the last the last; what is
    /// no number counts as before.
    #[inline]
    pub(crate) fn find(&self, time: f32) -> Span {
        let times = &self.times[..];
        let last = times.len() as u32 - 2;
        let key = if time > times[0] {
            let bucket = self.bucket(time);
            let mut low = self.first[bucket];
            let high = self
                .first
                .get(bucket + 1)
                .map_or(last, |key| *key + 1)
                .min(last);
            if high > low + STEPS {
                low += (times[low as usize..=high as usize].partition_point(|key| *key <= time)
                    as u32)
                    .saturating_sub(1);
            }
            while low < last && times[low as usize + 1] <= time {
                low += 1;
            }
            low.min(last)
        } else {
            0
        };
        let (start, end) = (times[key as usize], times[key as usize + 1]);
        let length = end - start;
        let part = (time - start) / length;
        Span {
            key,
            // Not `clamp`: a NaN has to become 0.
            part: if part >= 1.0 {
                1.0
            } else if part > 0.0 {
                part
            } else {
                0.0
            },
            length,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_mt::Mt;

    /// By walking from the first key.
    fn walk(times: &[f32], time: f32) -> u32 {
        let mut key = 0;
        while key + 2 < times.len() && times[key + 1] <= time {
            key += 1;
        }
        key as u32
    }

    #[test]
    fn the_table_finds_what_a_walk_finds() {
        let mut random = Mt::new(7);
        let mut unit = move || random.next_u32() as f32 / u32::MAX as f32;
        for round in 0..200 {
            // Evenly spaced, clustered, and with gaps of very different lengths.
            let count = 2 + (unit() * 60.0) as usize;
            let mut times = vec![unit() * 4.0 - 2.0];
            while times.len() < count {
                let last = times[times.len() - 1];
                let step = match round % 3 {
                    0 => 1.0 / 30.0,
                    1 => unit() * unit() * unit() * unit() * 2.0 + 1e-6,
                    _ if unit() < 0.05 => 10.0,
                    _ => 1e-4,
                };
                times.push((last + step).max(last.next_up()));
            }
            let axis = Axis::new(&times);
            let (begin, end) = (times[0], times[count - 1]);
            for _ in 0..300 {
                let time = begin - 0.2 + unit() * (end - begin + 0.4);
                assert_eq!(
                    axis.find(time).key,
                    walk(&times, time),
                    "{times:?} at {time}"
                );
            }
            for time in &times {
                let span = axis.find(*time);
                assert_eq!(span.key, walk(&times, *time));
                assert!(span.part == 0.0 || (span.part == 1.0 && *time == end));
            }
        }
    }

    #[test]
    fn moments_outside_and_no_moments() {
        let axis = Axis::new(&[1.0, 2.0, 4.0]);
        for (time, key, part) in [
            (f32::NEG_INFINITY, 0, 0.0),
            (f32::NAN, 0, 0.0),
            (0.0, 0, 0.0),
            (3.0, 1, 0.5),
            (9.0, 1, 1.0),
            (f32::INFINITY, 1, 1.0),
        ] {
            let span = axis.find(time);
            assert_eq!((span.key, span.part), (key, part), "{time}");
        }
        // So close that a quotient of their distance is infinite.
        let close = Axis::new(&[0.0, f32::from_bits(1), f32::from_bits(2)]);
        assert_eq!(close.find(f32::from_bits(1)).key, 1);
        let far = Axis::new(&[f32::MIN, 0.0, f32::MAX]);
        assert_eq!(far.find(1.0).key, 1);
    }
}
