//! A square, periodic plane of numbers and the filters on it.

/// A square image of one channel that wraps round at its borders.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    size: usize,
    values: Vec<f32>,
}

impl Plane {
    /// A plane of `size` x `size` values (row by row, downwards), each given by
    /// its index.
    #[must_use]
    pub fn from_index(size: usize, value: impl FnMut(usize) -> f32) -> Self {
        Self {
            size,
            values: (0..size * size).map(value).collect(),
        }
    }

    /// Texels along a side.
    #[must_use]
    pub const fn size(&self) -> usize {
        self.size
    }

    /// Row by row, downwards.
    #[must_use]
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Row by row, downwards.
    pub fn values_mut(&mut self) -> &mut [f32] {
        &mut self.values
    }

    /// The value at (x, y), each wrapped round.
    #[must_use]
    pub fn wrapped(&self, x: isize, y: isize) -> f32 {
        let n = self.size.cast_signed();
        let (x, y) = (x.rem_euclid(n), y.rem_euclid(n));
        self.values[(y * n + x).cast_unsigned()]
    }

    /// Mean of all values.
    #[must_use]
    pub fn mean(&self) -> f32 {
        let sum: f64 = self.values.iter().map(|&v| f64::from(v)).sum();
        (sum / self.values.len() as f64) as f32
    }

    /// Values below which the fractions `low` and `high` (0..=1) of all lie.
    #[must_use]
    pub fn quantiles(&self, low: f64, high: f64) -> [f32; 2] {
        let mut sorted = self.values.clone();
        sorted.sort_unstable_by(f32::total_cmp);
        let last = (sorted.len() - 1) as f64;
        [low, high].map(|q| sorted[(q * last).round() as usize])
    }

    /// Low-pass of about a Gaussian of standard deviation `sigma` texels:
    /// three periodic box filters, one after another.
    #[must_use]
    pub fn blurred(&self, sigma: f32) -> Self {
        // A box of 2r+1 texels has variance r(r+1)/3; three of them add up.
        let radius = (((4.0 * sigma * sigma + 1.0).sqrt() - 1.0) / 2.0).round() as usize;
        let radius = radius.min((self.size - 1) / 2);
        let mut plane = self.clone();
        for _ in 0..3 {
            plane = plane.box_rows(radius).transposed();
            plane = plane.box_rows(radius).transposed();
        }
        plane
    }

    /// Half the size, each value the mean of 2x2.
    #[must_use]
    pub fn halved(&self) -> Self {
        let (n, half) = (self.size, self.size / 2);
        Self::from_index(half, |i| {
            let at = 2 * (i / half) * n + 2 * (i % half);
            let v = &self.values;
            0.25 * (v[at] + v[at + 1] + v[at + n] + v[at + n + 1])
        })
    }

    /// Mean over `radius` texels to each side along rows; running sums in f64,
    /// so that rounding does not drift along the row.
    fn box_rows(&self, radius: usize) -> Self {
        let n = self.size;
        let weight = 1.0 / (2 * radius + 1) as f64;
        let mut values = Vec::with_capacity(self.values.len());
        for row in self.values.chunks_exact(n) {
            let at = |x: usize| f64::from(row[x % n]);
            let mut sum: f64 = (0..=2 * radius).map(|x| at(x + n - radius)).sum();
            for x in 0..n {
                values.push((sum * weight) as f32);
                sum += at(x + radius + 1) - at(x + n - radius);
            }
        }
        Self { size: n, values }
    }

    fn transposed(&self) -> Self {
        let n = self.size;
        Self::from_index(n, |i| self.values[(i % n) * n + i / n])
    }
}

/// Calls `row(y)` for every row, on as many threads as the machine has, and
/// returns the rows in order: the result does not depend on their number.
pub fn rows<T: Send>(count: usize, row: impl Fn(usize) -> Vec<T> + Sync) -> Vec<T> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let each = count.div_ceil(threads).max(1);
    let mut out = Vec::new();
    std::thread::scope(|scope| {
        let row = &row;
        let handles: Vec<_> = (0..count)
            .step_by(each)
            .map(|start| {
                scope.spawn(move || {
                    (start..(start + each).min(count))
                        .flat_map(row)
                        .collect::<Vec<T>>()
                })
            })
            .collect();
        for handle in handles {
            match handle.join() {
                Ok(part) => out.extend(part),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
    });
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blur_keeps_the_mean_and_spreads_as_its_sigma_says() {
        let n = 128;
        let plane = Plane::from_index(n, |i| if i == 5 * n + 3 { 1.0 } else { 0.0 });
        let blurred = plane.blurred(6.0);
        assert!((blurred.mean() - plane.mean()).abs() < 1e-7);
        // Variance along x about the wrapped impulse.
        let mut variance = 0.0_f64;
        for y in 0..n.cast_signed() {
            for dx in -64..64_isize {
                variance += (dx * dx) as f64 * f64::from(blurred.wrapped(3 + dx, y));
            }
        }
        // The radius is a whole number of texels: sigma is right to 0.5.
        assert!((variance.sqrt() - 6.0).abs() < 0.5, "{}", variance.sqrt());
    }

    #[test]
    fn halving_takes_means() {
        let plane = Plane::from_index(4, |i| i as f32);
        assert_eq!(plane.halved().values(), &[2.5, 4.5, 10.5, 12.5]);
    }

    #[test]
    fn rows_come_in_order() {
        let all = rows(37, |y| vec![2 * y, 2 * y + 1]);
        assert_eq!(all, (0..74).collect::<Vec<_>>());
    }

    #[test]
    fn quantiles_are_those_of_the_sorted_values() {
        let plane = Plane::from_index(10, |i| (99 - i) as f32);
        assert_eq!(plane.quantiles(0.0, 1.0), [0.0, 99.0]);
    }
}
