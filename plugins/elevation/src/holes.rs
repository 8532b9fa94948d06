//! Samples without data, filled from the border of their hole.
//!
//! The surface of a hole is that of a membrane held at its border: each sample is the mean of its four
//! neighbours (Laplace's equation; at the map's own edge only of those that there are). It is found from coarse to fine: means of known
//! samples over ever larger squares give the coarsest answer, each finer level begins with the bilinear one of the level
//! above and is then relaxed by Gauss-Seidel, forwards and backwards by turns.
//!
//! **Bound**: every step is a mean with positive weights, and the beginning of the finest level is clamped to the range of the
//! hole's own border. No filled sample is below the lowest or above the highest sample beside its hole, to the bit.
//! Relaxation is ended after a fixed number of rounds; what is left of the harmonic surface is a test's to say
//! (1 % of the border's range for holes of 200 samples across).

/// Rounds of relaxation a level.
const ROUNDS: usize = 24;

/// What was filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Filled {
    /// Samples that were filled.
    pub samples: u64,
    /// Separate holes.
    pub holes: u64,
}

/// Fills the samples that are NaN, in rows of `columns`. `None`, and nothing changed, where all are NaN.
#[must_use]
pub fn fill_holes(samples: &mut [f32], columns: usize) -> Option<Filled> {
    if columns == 0 || samples.is_empty() {
        return None;
    }
    let mut runs = Runs::new(samples, columns);
    if runs.list.is_empty() {
        return Some(Filled::default());
    }
    if runs.list.iter().map(Run::len).sum::<usize>() == samples.len() {
        return None;
    }
    runs.join(samples);
    let coarse = Level::above(samples, columns);
    let coarse = coarse.filled();
    for run in &runs.list {
        let range = runs.ranges[run.root as usize];
        for column in run.from..run.to {
            let value = coarse.between(column as usize, run.row as usize);
            samples[run.row as usize * columns + column as usize] = value.clamp(range[0], range[1]);
        }
    }
    relax(samples, columns, &runs.list, ROUNDS);
    Some(Filled {
        samples: runs.list.iter().map(|run| run.len() as u64).sum(),
        holes: runs.holes,
    })
}

/// Samples without data that follow each other in a row.
#[derive(Clone, Copy, Debug)]
struct Run {
    row: u32,
    from: u32,
    to: u32,
    /// A run of the same hole; in the end its number.
    root: u32,
}

impl Run {
    fn len(&self) -> usize {
        (self.to - self.from) as usize
    }
}

/// All runs of a level, row by row.
struct Runs {
    columns: usize,
    list: Vec<Run>,
    /// Lowest and highest sample beside each hole, by the number of its root.
    ranges: Vec<[f32; 2]>,
    holes: u64,
}

impl Runs {
    fn new(samples: &[f32], columns: usize) -> Self {
        let mut list: Vec<Run> = Vec::new();
        for (row, line) in samples.chunks(columns).enumerate() {
            let mut column = 0;
            while let Some(from) = line[column..].iter().position(|s| s.is_nan()) {
                let from = column + from;
                let to = line[from..]
                    .iter()
                    .position(|s| !s.is_nan())
                    .map_or(columns, |n| from + n);
                list.push(Run {
                    row: row as u32,
                    from: from as u32,
                    to: to as u32,
                    root: list.len() as u32,
                });
                column = to;
                if column == columns {
                    break;
                }
            }
        }
        Self {
            columns,
            list,
            ranges: Vec::new(),
            holes: 0,
        }
    }

    fn root(&mut self, mut run: u32) -> u32 {
        while self.list[run as usize].root != run {
            let up = self.list[run as usize].root;
            self.list[run as usize].root = self.list[up as usize].root;
            run = up;
        }
        run
    }

    /// Joins runs that touch to holes, and looks at each hole's border.
    fn join(&mut self, samples: &[f32]) {
        let mut above = 0;
        for k in 0..self.list.len() {
            let run = self.list[k];
            // Runs of the row above that end before this one begins meet none of the next either.
            while above < k {
                let other = self.list[above];
                if other.row + 1 < run.row || (other.row + 1 == run.row && other.to <= run.from) {
                    above += 1;
                } else {
                    break;
                }
            }
            let mut at = above;
            while at < k && self.list[at].row + 1 == run.row && self.list[at].from < run.to {
                let (a, b) = (self.root(at as u32), self.root(k as u32));
                let (low, high) = (a.min(b), a.max(b));
                self.list[high as usize].root = low;
                at += 1;
            }
        }
        self.ranges = vec![[f32::INFINITY, f32::NEG_INFINITY]; self.list.len()];
        for k in 0..self.list.len() {
            let root = self.root(k as u32);
            self.list[k].root = root;
            self.holes += u64::from(root == k as u32);
            let run = self.list[k];
            let row = run.row as usize * self.columns;
            let (from, to) = (row + run.from as usize, row + run.to as usize);
            let mut look = |sample: f32| {
                let range = &mut self.ranges[root as usize];
                // The minimum of a number and NaN is the number.
                *range = [range[0].min(sample), range[1].max(sample)];
            };
            if run.from > 0 {
                look(samples[from - 1]);
            }
            if (run.to as usize) < self.columns {
                look(samples[to]);
            }
            for at in from..to {
                if at >= self.columns {
                    look(samples[at - self.columns]);
                }
                if let Some(&below) = samples.get(at + self.columns) {
                    look(below);
                }
            }
        }
    }
}

/// Gauss-Seidel over the runs.
fn relax(samples: &mut [f32], columns: usize, runs: &[Run], rounds: usize) {
    let mut one = |row: usize, column: usize| {
        let at = row * columns + column;
        let (mut sum, mut count) = (0.0_f64, 0.0_f64);
        let mut add = |sample: f32| {
            sum += f64::from(sample);
            count += 1.0;
        };
        if column > 0 {
            add(samples[at - 1]);
        }
        if column + 1 < columns {
            add(samples[at + 1]);
        }
        if row > 0 {
            add(samples[at - columns]);
        }
        if at + columns < samples.len() {
            add(samples[at + columns]);
        }
        if count > 0.0 {
            // Rounding is monotonic: the mean of numbers of a range is in it.
            samples[at] = (sum / count) as f32;
        }
    };
    for round in 0..rounds {
        if round % 2 == 0 {
            for run in runs {
                (run.from..run.to).for_each(|column| one(run.row as usize, column as usize));
            }
        } else {
            for run in runs.iter().rev() {
                let columns = (run.from..run.to).rev();
                columns.for_each(|column| one(run.row as usize, column as usize));
            }
        }
    }
}

/// Means of known samples over squares of 2ᵏ a side.
struct Level {
    columns: usize,
    samples: Vec<f32>,
}

impl Level {
    /// The level above samples in rows of `columns`.
    fn above(samples: &[f32], columns: usize) -> Self {
        let rows = samples.len() / columns;
        let (wide, high) = (columns.div_ceil(2), rows.div_ceil(2));
        let mut above = Vec::with_capacity(wide * high);
        for row in 0..high {
            for column in 0..wide {
                let (mut sum, mut count) = (0.0_f64, 0.0_f64);
                for z in 2 * row..(2 * row + 2).min(rows) {
                    for x in 2 * column..(2 * column + 2).min(columns) {
                        let sample = samples[z * columns + x];
                        if !sample.is_nan() {
                            sum += f64::from(sample);
                            count += 1.0;
                        }
                    }
                }
                above.push(if count > 0.0 {
                    (sum / count) as f32
                } else {
                    f32::NAN
                });
            }
        }
        Self {
            columns: wide,
            samples: above,
        }
    }

    /// The same without holes.
    fn filled(mut self) -> Self {
        let runs = Runs::new(&self.samples, self.columns);
        if runs.list.is_empty() {
            return self;
        }
        let coarse = Self::above(&self.samples, self.columns).filled();
        for run in &runs.list {
            for column in run.from..run.to {
                let value = coarse.between(column as usize, run.row as usize);
                self.samples[run.row as usize * self.columns + column as usize] = value;
            }
        }
        // Coarser levels cost less: more rounds there bring the far border nearer.
        relax(&mut self.samples, self.columns, &runs.list, 2 * ROUNDS);
        self
    }

    /// Bilinear at the middle of a sample of the level below.
    fn between(&self, column: usize, row: usize) -> f32 {
        let rows = self.samples.len() / self.columns;
        // The two squares whose middles lie around it; the nearer counts three quarters.
        let near = |at: usize, count: usize| {
            let other = if at.is_multiple_of(2) {
                (at / 2).saturating_sub(1)
            } else {
                (at / 2 + 1).min(count - 1)
            };
            [(at / 2, 0.75), (other, 0.25)]
        };
        let mut sum = 0.0_f64;
        for (z, by_z) in near(row, rows) {
            for (x, by_x) in near(column, self.columns) {
                sum += by_x * by_z * f64::from(self.samples[z * self.columns + x]);
            }
        }
        sum as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Saddle and plane are harmonic: so is what fills them.
    #[test]
    fn harmonic_ground_is_found_again() {
        let (columns, rows) = (300, 260);
        let ground = |x: usize, z: usize| {
            let (x, z) = (x as f64 / 30.0, z as f64 / 30.0);
            (x * x - z * z + 3.0 * x - 2.0 * z) as f32
        };
        let whole: Vec<f32> = (0..columns * rows)
            .map(|k| ground(k % columns, k / columns))
            .collect();
        let mut holed = whole.clone();
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for (k, sample) in holed.iter_mut().enumerate() {
            let (x, z) = ((k % columns) as f64 - 150.0, (k / columns) as f64 - 130.0);
            if x * x + z * z < 1e4 {
                (low, high) = (low.min(*sample), high.max(*sample));
                *sample = f32::NAN;
            }
        }
        let filled = fill_holes(&mut holed, columns).unwrap();
        assert_eq!(filled.holes, 1);
        let off = whole.iter().zip(&holed).map(|(a, b)| (a - b).abs());
        let off = off.fold(0.0, f32::max) / (high - low);
        println!("off by {off} of the border's range");
        assert!(off < 0.01, "{off}");
    }

    /// Every filled sample lies in the range of the samples beside its own hole, found here by hand.
    #[test]
    fn nothing_leaves_the_range_of_the_border() {
        let (columns, rows) = (97, 61);
        let mut seed = 7_u32;
        let mut random = || {
            seed = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            (seed >> 9) as f32 / (1 << 23) as f32
        };
        for share in [0.02, 0.3, 0.6, 0.9] {
            let mut samples: Vec<f32> = (0..columns * rows)
                .map(|_| {
                    if random() < share {
                        f32::NAN
                    } else {
                        1e4 * random() - 3e3
                    }
                })
                .collect();
            let before = samples.clone();
            fill_holes(&mut samples, columns).unwrap();
            let mut seen = vec![false; samples.len()];
            for start in 0..samples.len() {
                if !before[start].is_nan() || seen[start] {
                    continue;
                }
                let (mut todo, mut hole) = (vec![start], Vec::new());
                seen[start] = true;
                let mut border = [f32::INFINITY, f32::NEG_INFINITY];
                while let Some(at) = todo.pop() {
                    hole.push(at);
                    let (x, z) = (at % columns, at / columns);
                    let around = [
                        (x > 0).then(|| at - 1),
                        (x + 1 < columns).then_some(at + 1),
                        (z > 0).then(|| at - columns),
                        (z + 1 < rows).then_some(at + columns),
                    ];
                    for next in around.into_iter().flatten() {
                        if !before[next].is_nan() {
                            border = [border[0].min(before[next]), border[1].max(before[next])];
                        } else if !seen[next] {
                            seen[next] = true;
                            todo.push(next);
                        }
                    }
                }
                for at in hole {
                    let inside = (border[0]..=border[1]).contains(&samples[at]);
                    assert!(inside, "{} not in {border:?}", samples[at]);
                }
            }
            for (a, b) in before.iter().zip(&samples) {
                assert!(a.is_nan() || a.to_bits() == b.to_bits());
            }
        }
    }

    #[test]
    fn all_and_nothing() {
        let mut none = vec![f32::NAN; 12];
        assert_eq!(fill_holes(&mut none, 4), None);
        let mut whole = vec![1.0; 12];
        assert_eq!(fill_holes(&mut whole, 4), Some(Filled::default()));
        let mut one = vec![f32::NAN; 12];
        one[5] = 3.0;
        assert_eq!(
            fill_holes(&mut one, 4),
            Some(Filled {
                samples: 11,
                holes: 1
            })
        );
        assert_eq!(one, [3.0; 12]);
    }
}
