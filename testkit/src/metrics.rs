//! Errors, medians and hashes: what every study measures, computed in one place.

/// What a set of errors comes to. Errors are absolute, in whatever unit the caller names.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorStats {
    /// Largest error.
    pub max: f64,
    /// Root of the mean square error.
    pub rms: f64,
    /// The error that 99 % of the samples stay at or below.
    pub p99: f64,
    /// How many errors went in.
    pub samples: usize,
}

impl ErrorStats {
    /// Of absolute errors. One that is not a number counts as infinite, so that it is never lost in
    /// a comparison; no errors at all are `None`.
    pub fn of(errors: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = errors
            .into_iter()
            .map(|e| if e.is_nan() { f64::INFINITY } else { e.abs() })
            .collect();
        sorted.sort_by(f64::total_cmp);
        let max = *sorted.last()?;
        let squares: f64 = sorted.iter().map(|e| e * e).sum();
        let rank = (sorted.len() * 99).div_ceil(100) - 1;
        Some(Self {
            max,
            rms: (squares / sorted.len() as f64).sqrt(),
            p99: sorted[rank],
            samples: sorted.len(),
        })
    }
}

/// The middle of `numbers`: of an even count, the mean of the two in the middle. `None` of nothing.
pub fn median(mut numbers: Vec<f64>) -> Option<f64> {
    numbers.sort_by(f64::total_cmp);
    let middle = numbers.len() / 2;
    match numbers.len() {
        0 => None,
        n if n % 2 == 1 => Some(numbers[middle]),
        _ => Some((numbers[middle - 1] + numbers[middle]) / 2.0),
    }
}

/// FNV-1a (Fowler, Noll, Vo; 64 bits) over the bits of the results: equal hashes, equal results.
#[derive(Debug, Clone, Copy)]
pub struct Hash64(u64);

impl Default for Hash64 {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Hash64 {
    /// Adds eight bytes, the lowest first.
    pub fn add(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// The hash of everything added so far.
    pub fn finish(self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stats_of_known_errors() {
        let stats = ErrorStats::of((1..=200).map(|i| -f64::from(i))).unwrap();
        assert_eq!((stats.max, stats.p99, stats.samples), (200.0, 198.0, 200));
        // Sum of squares of 1..=n is n (n + 1) (2 n + 1) / 6.
        assert_eq!(stats.rms, (200.0 * 201.0 * 401.0 / 6.0 / 200.0_f64).sqrt());
        assert_eq!(ErrorStats::of([]), None);
    }

    #[test]
    fn an_error_that_is_no_number_is_the_largest() {
        let stats = ErrorStats::of([0.0, f64::NAN, 1.0]).unwrap();
        assert_eq!((stats.max, stats.rms), (f64::INFINITY, f64::INFINITY));
    }

    #[test]
    fn median_of_odd_and_even_counts() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), Some(2.5));
        assert_eq!(median(vec![]), None);
    }

    #[test]
    fn hash_of_known_bytes() {
        // FNV-1a of eight zero bytes: the offset basis times the prime, eight times.
        let mut hash = Hash64::default();
        hash.add(0);
        let expected = (0..8).fold(0xcbf2_9ce4_8422_2325_u64, |h, _| {
            h.wrapping_mul(0x100_0000_01b3)
        });
        assert_eq!(hash.finish(), expected);
        let mut other = Hash64::default();
        other.add(1);
        assert_ne!(hash.finish(), other.finish());
    }
}
