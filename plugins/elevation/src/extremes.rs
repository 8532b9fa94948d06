//! Lowest and highest of samples, and numbers that people write where there is no data.

/// Whether people write this number where there is no data: runs of nines, the ends of integers, the largest
/// floats.
pub(crate) fn is_customary(value: f32) -> bool {
    let size = value.abs();
    let nines = [9999.0, 99_999.0, 999_999.0, 9_999_999.0];
    let ends = [
        32_767.0,
        32_768.0,
        65_535.0,
        2_147_483_647.0,
        4_294_967_295.0,
        100_000.0,
    ];
    nines.contains(&size) || ends.contains(&size) || size >= 1e19
}

/// Lowest and highest number, and how many are NaN.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extremes {
    pub low: f32,
    pub high: f32,
    pub nan: u64,
}

impl Extremes {
    pub const NONE: Self = Self {
        low: f32::INFINITY,
        high: f32::NEG_INFINITY,
        nan: 0,
    };

    pub fn of(samples: &[f32]) -> Self {
        let mut all = Self::NONE;
        for part in samples.chunks(1 << 12) {
            // Eight lanes, so that it runs in vectors.
            let (mut low, mut high) = ([f32::INFINITY; 8], [f32::NEG_INFINITY; 8]);
            let mut nan = [0_u32; 8];
            let (eights, rest) = part.as_chunks::<8>();
            for eight in eights {
                for k in 0..8 {
                    low[k] = if eight[k] < low[k] { eight[k] } else { low[k] };
                    high[k] = if eight[k] > high[k] {
                        eight[k]
                    } else {
                        high[k]
                    };
                    nan[k] += u32::from(eight[k].is_nan());
                }
            }
            let mut part = Self {
                low: low.into_iter().fold(f32::INFINITY, f32::min),
                high: high.into_iter().fold(f32::NEG_INFINITY, f32::max),
                nan: nan.into_iter().map(u64::from).sum(),
            };
            for &sample in rest {
                part.low = part.low.min(sample);
                part.high = part.high.max(sample);
                part.nan += u64::from(sample.is_nan());
            }
            all.join(part);
        }
        all
    }

    pub fn join(&mut self, other: Self) {
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
        self.nan += other.nan;
    }
}
