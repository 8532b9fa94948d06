//! Spans between keys, and whether functions keep to majorants over them.

#[cfg(test)]
use super::majorant::Majorant;

/// A span between keys, seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Over {
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// Keys that are so near to an end are taken to be that end.
    pub(crate) slack: f64,
}

impl Over {
    pub(crate) fn middle(&self) -> f64 {
        f64::midpoint(self.from, self.to)
    }

    /// The same on a clock that begins at `begin`.
    pub(crate) fn since(&self, begin: f64) -> Self {
        Self {
            from: self.from - begin,
            to: self.to - begin,
            ..*self
        }
    }
}

#[cfg(test)]
impl Over {
    /// From 0 to 1.
    pub(crate) const WHOLE: Self = Self {
        from: 0.0,
        to: 1.0,
        slack: 0.0,
    };
}

/// Whether divided differences of a function over a span keep to a majorant: each is a mean of Taylor coefficients there
/// (Hermite and Genocchi).
#[cfg(test)]
pub(crate) fn holds<const N: usize>(moves: &Majorant, over: Over, of: impl Fn(f64) -> [f64; N]) {
    let size = (0..=8)
        .map(|i| of(over.from + (over.to - over.from) * f64::from(i) / 8.0))
        .fold(1.0_f64, |most, v| {
            v.iter().fold(most, |most, x| most.max(x.abs()))
        });
    let middle = of(over.middle());
    for i in 0..=32 {
        let value = of(over.from + (over.to - over.from) * f64::from(i) / 32.0);
        let apart = value.iter().zip(&middle).map(|(a, b)| (a - b) * (a - b));
        let way = apart.sum::<f64>().sqrt();
        assert!(
            way <= moves.1 * (1.0 + 1e-9) + 1e-13 * size,
            "{way} of {moves:?}"
        );
    }
    for order in 0..7 {
        // Evenly spread, away from the ends.
        let share = |i: usize| (i as f64 + 0.5) / (order + 1) as f64;
        let mut table: Vec<[f64; N]> = (0..=order)
            .map(|i| of(over.from + (over.to - over.from) * share(i)))
            .collect();
        for level in 1..=order {
            for i in 0..=order - level {
                let way = share(i + level) - share(i);
                table[i] = std::array::from_fn(|axis| (table[i + 1][axis] - table[i][axis]) / way);
            }
        }
        let length = table[0].iter().map(|x| x * x).sum::<f64>().sqrt();
        let crowd = 2.0 * (order + 1) as f64;
        let rounding = (0..order).fold(1e-13 * size, |all, _| all * crowd);
        assert!(
            length <= moves.0[order] * (1.0 + 1e-9) + rounding,
            "order {order}: {length} of {moves:?}"
        );
    }
}
