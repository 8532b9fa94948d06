//! Extremes of samples and of their differences, in steps: exact.

/// What the samples of a part stay within. Nothing edited: all 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Extremes {
    pub low: i32,
    pub high: i32,
    /// Largest |first difference| along x, z.
    pub step: [i32; 2],
    /// Largest |second difference| along x, z, and mixed.
    pub bend: [i32; 3],
}

impl Extremes {
    /// Of rows of `side` samples.
    pub(crate) fn of(samples: &[i32], side: usize) -> Self {
        let first = samples.first().copied().unwrap_or(0);
        let mut found = Self {
            low: first,
            high: first,
            ..Self::default()
        };
        let most = |kept: &mut i32, found: i32| *kept = (*kept).max(found.abs());
        for (number, &here) in samples.iter().enumerate() {
            let (x, z) = (number % side, number / side);
            found.low = found.low.min(here);
            found.high = found.high.max(here);
            let at = |dx: usize, dz: usize| samples[(z + dz) * side + x + dx];
            let rows = samples.len() / side;
            if x + 1 < side {
                most(&mut found.step[0], at(1, 0) - here);
            }
            if z + 1 < rows {
                most(&mut found.step[1], at(0, 1) - here);
            }
            if x + 2 < side {
                most(&mut found.bend[0], at(2, 0) - 2 * at(1, 0) + here);
            }
            if z + 2 < rows {
                most(&mut found.bend[1], at(0, 2) - 2 * at(0, 1) + here);
            }
            if x + 1 < side && z + 1 < rows {
                most(&mut found.bend[2], at(1, 1) - at(1, 0) - at(0, 1) + here);
            }
        }
        found
    }

    /// Of both parts.
    pub(crate) fn join(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            step: std::array::from_fn(|k| self.step[k].max(other.step[k])),
            bend: std::array::from_fn(|k| self.bend[k].max(other.bend[k])),
        }
    }
}
