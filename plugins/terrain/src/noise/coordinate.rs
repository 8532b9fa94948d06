//! From metres to lattice cells, in integers.
//!
//! Conventions: positions are 32.32 fixed-point metres (`i64`), lattice coordinates are 32.32
//! fixed-point cells (`i64`). A frequency is mantissa × 2^−shift cells a metre. Their product is
//! taken exactly (96 bits), shifted down and cut to 64 bits: the only error is the cut below
//! 2⁻³² cell, at any distance, and coordinates repeat after 2³² cells without a seam. The same
//! integers are computed by `shaders/src/terrain/fixed.wgsl`, bit for bit.

/// Cells a metre, as mantissa × 2^−shift with the mantissa in [2³¹, 2³²).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frequency {
    /// The leading 32 bits; bit 31 is always set.
    pub mantissa: u32,
    /// Power of two below, in [[`Frequency::SHIFT_MIN`], [`Frequency::SHIFT_MAX`]].
    pub shift: u32,
}

impl Frequency {
    /// Smallest shift: 2¹¹ cells a metre is out of reach, so a cell is never below 0.49 mm.
    /// There 2⁻³² m of the position is still 2⁻²¹ of a cell.
    pub const SHIFT_MIN: u32 = 21;
    /// Largest shift: a cell is never wider than 2³¹ m, the whole range of positions.
    pub const SHIFT_MAX: u32 = 62;

    /// The frequency nearest to 1 / `wavelength` (metres), relative error at most 2⁻³²; `None` if
    /// it is not a number above 0 or the shift leaves its range.
    #[must_use]
    pub fn from_wavelength(wavelength: f64) -> Option<Self> {
        Self::new(1.0 / wavelength)
    }

    /// The frequency nearest to `cells_per_metre`; `None` as above.
    #[must_use]
    pub fn new(cells_per_metre: f64) -> Option<Self> {
        if !cells_per_metre.is_normal() || cells_per_metre < 0.0 {
            return None;
        }
        // A normal f64 is 1.m × 2^e: the biased exponent is in bits 52 to 62, the 52 bits of m
        // below, of which the upper 31 (rounded) go with the leading 1.
        let bits = cells_per_metre.to_bits();
        let exponent = ((bits >> 52) & 0x7ff) as i64 - 1023;
        let significand = (bits & ((1 << 52) - 1)) | (1 << 52);
        let rounded = (significand + (1 << 20)) >> 21;
        let (mantissa, shift) = if rounded == 1 << 32 {
            (1 << 31, 30 - exponent)
        } else {
            (rounded as u32, 31 - exponent)
        };
        Self::checked(mantissa, u32::try_from(shift).ok()?)
    }

    fn checked(mantissa: u32, shift: u32) -> Option<Self> {
        (Self::SHIFT_MIN..=Self::SHIFT_MAX)
            .contains(&shift)
            .then_some(Self { mantissa, shift })
    }

    /// This frequency times a lacunarity given as 2.30 fixed point (bits 30 or 31 set), cut to 32
    /// bits of mantissa: relative error at most 2⁻³¹, none for 2.0, which only lowers the shift.
    /// `None` where the shift leaves its range.
    #[must_use]
    pub fn times(self, lacunarity: u32) -> Option<Self> {
        let product = u64::from(self.mantissa) * u64::from(lacunarity);
        let zeros = product.leading_zeros();
        let mantissa = ((product << zeros) >> 32) as u32;
        // product = mantissa × 2^(32 − zeros), and the lacunarity carries 2⁻³⁰.
        Self::checked(mantissa, (self.shift + zeros).checked_sub(2)?)
    }

    /// Cells a metre, exactly.
    #[must_use]
    pub fn value(self) -> f64 {
        // Shifts stay in 21..=62, so 2^−shift is a normal f64 that its exponent field spells out.
        f64::from(self.mantissa) * f64::from_bits((1023 - u64::from(self.shift)) << 52)
    }

    /// Lattice coordinate of a position: 32.32 cells, rounded down, wrapping at 2³² cells.
    #[must_use]
    #[inline]
    pub fn coordinate(self, position: i64) -> i64 {
        ((i128::from(position) * i128::from(self.mantissa)) >> self.shift) as i64
    }

    /// Cells and fractions of the [coordinates](Self::coordinate) of many positions plus `offset`: products
    /// of 32 bits alone, which compilers put into vectors where they may use them.
    #[inline(always)]
    pub(crate) fn coordinates<const N: usize>(
        self,
        positions: &[i64; N],
        offset: i64,
        cells: &mut [u32; N],
        fractions: &mut [f32; N],
    ) {
        const LOW: u64 = u32::MAX as u64;
        let mantissa = u64::from(self.mantissa);
        // The product is high × 2³² + low with 0 ≤ low < 2³²; `high` fits an i64.
        let product = |position: i64| {
            let position = position as u64;
            let low = (position & LOW) * mantissa;
            let high = (position >> 32) * mantissa;
            // The upper word is signed: what its sign bit counts too much.
            let sign = ((position as i64 >> 63) as u64 & mantissa) << 32;
            (high.wrapping_sub(sign).wrapping_add(low >> 32), low & LOW)
        };
        let mut set = |i: usize, coordinate: u64| {
            let at = coordinate.wrapping_add(offset as u64);
            cells[i] = (at >> 32) as u32;
            // Below 2²⁴: the same number as a signed one, which vectors convert at once.
            fractions[i] = ((at as u32) >> 8) as i32 as f32 * FRACTION_STEP;
        };
        if self.shift >= 32 {
            let shift = self.shift - 32;
            for (i, &position) in positions.iter().enumerate() {
                let (high, _) = product(position);
                set(i, (high as i64 >> shift) as u64);
            }
        } else {
            let shift = self.shift;
            for (i, &position) in positions.iter().enumerate() {
                let (high, low) = product(position);
                set(i, (high << (32 - shift)) | (low >> shift));
            }
        }
    }

    /// The same coordinate as (cell, fraction) in `f64` for the oracle, from a position in `f64`
    /// metres. Whole metres are multiplied in integers, so the error is about 2⁻⁵² × frequency
    /// cells at any distance (plus what the caller lost in making the position an `f64`).
    #[must_use]
    pub fn coordinate_f64(self, metres: f64, offset: i64) -> (i32, f64) {
        let whole = metres.floor();
        let product = i128::from(whole as i64) * i128::from(self.mantissa);
        let cells = product >> self.shift;
        let rest = product - (cells << self.shift);
        let part = rest as f64 * f64::from_bits((1023 - u64::from(self.shift)) << 52)
            + (metres - whole) * self.value()
            + f64::from(offset as u32) / 4_294_967_296.0;
        let carry = part.floor();
        let cell = (cells as i64)
            .wrapping_add(carry as i64)
            .wrapping_add(offset >> 32);
        (cell as i32, part - carry)
    }
}

/// A lacunarity or other factor in [1, 4) as 2.30 fixed point, rounded to nearest: exact for
/// every `f32` in [1, 2), and to 2⁻³¹ relative above (also exact: an `f32` has 24 bits).
/// `None` outside the range and for NaN.
#[must_use]
pub fn lacunarity_fixed(lacunarity: f32) -> Option<u32> {
    (1.0..4.0)
        .contains(&lacunarity)
        .then(|| (f64::from(lacunarity) * f64::from(1_u32 << 30)) as u32)
}

/// The cell of a coordinate.
#[inline]
#[must_use]
pub const fn cell(coordinate: i64) -> u32 {
    (coordinate >> 32) as u32
}

/// The fraction of a coordinate, cut to 24 bits so that it is exact in `f32`: [0, 1 − 2⁻²⁴].
#[inline]
#[must_use]
pub const fn fraction(coordinate: i64) -> f32 {
    ((coordinate as u32) >> 8) as f32 * FRACTION_STEP
}

/// 2⁻²⁴, the step of [`fraction`].
pub const FRACTION_STEP: f32 = 1.0 / 16_777_216.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequency_is_the_nearest() {
        for wavelength in [0.001, 0.3, 1.0, 7.0, 200.0, 1e4 / 3.0, 1e9] {
            let frequency = Frequency::from_wavelength(wavelength).expect("in range");
            let error = (frequency.value() * wavelength - 1.0).abs();
            assert!(error <= 1.0 / 4_294_967_296.0, "{wavelength}: {error:e}");
            assert!(frequency.mantissa >= 1 << 31);
        }
        // Rounds up into the next power of two.
        let carried = Frequency::new(2.0 - f64::EPSILON).expect("in range");
        assert_eq!(carried, Frequency::new(2.0).expect("in range"));
    }

    #[test]
    fn many_coordinates_are_those_of_each() {
        let mut state = 1_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state ^ (state >> 29)) as i64
        };
        let ends = [i64::MIN, -1, 0, 1, i64::MAX, 1 << 32, -(1 << 32), 12_345];
        for shift in Frequency::SHIFT_MIN..=Frequency::SHIFT_MAX {
            for mantissa in [1 << 31, u32::MAX, (random() as u32) | 1 << 31] {
                let frequency = Frequency { mantissa, shift };
                let positions: [i64; 64] =
                    core::array::from_fn(|k| *ends.get(k).unwrap_or(&random()));
                let offset = random();
                let (mut cells, mut fractions) = ([0; 64], [0.0; 64]);
                frequency.coordinates(&positions, offset, &mut cells, &mut fractions);
                for (k, &position) in positions.iter().enumerate() {
                    let at = frequency.coordinate(position).wrapping_add(offset);
                    assert_eq!(cells[k], cell(at), "{frequency:?} {position}");
                    assert_eq!(fractions[k], fraction(at), "{frequency:?} {position}");
                }
            }
        }
    }

    #[test]
    fn out_of_range_frequencies_are_refused() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-5, 1e12] {
            assert_eq!(Frequency::from_wavelength(bad), None, "{bad}");
        }
        for bad in [f32::NAN, 0.5, 4.0, -2.0] {
            assert_eq!(lacunarity_fixed(bad), None, "{bad}");
        }
    }

    #[test]
    fn lacunarity_two_is_a_shift_and_others_are_close() {
        let first = Frequency::from_wavelength(300.0).expect("in range");
        let double = first
            .times(lacunarity_fixed(2.0).expect("in range"))
            .expect("in range");
        assert_eq!(
            (double.mantissa, double.shift),
            (first.mantissa, first.shift - 1)
        );
        for lacunarity in [1.0, 1.3, 1.999, 2.17, 3.99] {
            let next = first
                .times(lacunarity_fixed(lacunarity).expect("in range"))
                .expect("in range");
            let error = next.value() / (first.value() * f64::from(lacunarity)) - 1.0;
            assert!(
                error.abs() <= 1.0 / 2_147_483_648.0,
                "{lacunarity}: {error:e}"
            );
        }
    }

    #[test]
    fn coordinates_agree_with_exact_arithmetic() {
        let frequency = Frequency::from_wavelength(0.7).expect("in range");
        for metres in [-1e7 - 0.375, -0.25, 0.0, 0.625, 123_456.75, 1e7 + 0.5] {
            let coordinate = frequency.coordinate((metres * 4_294_967_296.0) as i64);
            let offset = 0x1234_5678_9abc_def0_i64;
            let (cell_f64, frac_f64) = frequency.coordinate_f64(metres, offset);
            let moved = coordinate.wrapping_add(offset);
            assert_eq!(cell(moved) as i32, cell_f64);
            // The cut to 2^-24 is the whole difference.
            let error = frac_f64 - f64::from(fraction(moved));
            assert!(
                (0.0..=1.01 * f64::from(FRACTION_STEP)).contains(&error),
                "{metres}: {error:e}"
            );
        }
    }
}
