//! The filters, and what comes back from them.

/// Decoders compute in f32, some in another order and with another rounding of halves than others. So far from a
/// half, in steps of 1/32767, all of them come to the same integer.
const CLEAR: f64 = 0.01;

/// A quaternion as the filter keeps it in so many bits, 4 to 15, and the 16-bit integers that come back from every
/// decoder. Where they would not agree, one next to it is taken.
pub(crate) fn quaternion_of_bits(q: [f64; 4], bits: u32) -> ([i16; 4], [i16; 4]) {
    let mut largest = 0;
    for i in 1..4 {
        if q[i].abs() > q[largest].abs() {
            largest = i;
        }
    }
    let sign = if q[largest] < 0.0 { -1.0 } else { 1.0 };
    let most = (1_i32 << (bits - 1)) - 1;
    let aim = [1, 2, 3].map(|next| {
        let x = q[(largest + next) & 3] * sign * std::f64::consts::SQRT_2;
        x.clamp(-1.0, 1.0) * f64::from(most)
    });
    let last = (most as i16 & !3) | largest as i16;
    let stored = |aside: [f64; 3]| {
        let whole = |i: usize| (aim[i].round() + aside[i]).clamp(f64::from(-most), f64::from(most));
        [whole(0) as i16, whole(1) as i16, whole(2) as i16, last]
    };
    // The next integer on the other side of each number, nearest first.
    let other = [0, 1, 2].map(|i| if aim[i] < aim[i].round() { -1.0 } else { 1.0 });
    let mut asides = vec![[0.0; 3]];
    for pick in 1..8 {
        asides.push([0, 1, 2].map(|i| if pick >> i & 1 == 1 { other[i] } else { 0.0 }));
    }
    let far = |aside: &[f64; 3]| -> f64 {
        let off = |i: usize| aim[i].round() + aside[i] - aim[i];
        off(0) * off(0) + off(1) * off(1) + off(2) * off(2)
    };
    asides.sort_by(|a, b| far(a).total_cmp(&far(b)));
    let clear = asides.into_iter().map(stored).find_map(|stored| {
        let (back, clear) = quaternion_of_stored(stored);
        clear.then_some((stored, back))
    });
    clear.unwrap_or_else(|| {
        let stored = stored([0.0; 3]);
        (stored, quaternion_of_stored(stored).0)
    })
}

/// What the filter makes of four stored integers, and whether every decoder does.
fn quaternion_of_stored(stored: [i16; 4]) -> ([i16; 4], bool) {
    let s = f64::from(stored[3] | 3);
    let [x, y, z] = [stored[0], stored[1], stored[2]].map(f64::from);
    let w = (s * s * 2.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let factor = 32767.0 / std::f64::consts::SQRT_2 / s;
    let largest = (stored[3] & 3) as usize;
    let mut out = [0; 4];
    let mut clear = true;
    for (next, value) in [(1, x), (2, y), (3, z), (0, w)] {
        let value = value * factor;
        clear &= (value.abs().fract() - 0.5).abs() > CLEAR;
        out[(largest + next) & 3] = value.round() as i16;
    }
    (out, clear)
}

/// A power of two, exactly, on every machine; `exponent` is held to -1000..=1000.
pub(crate) fn power(exponent: i32) -> f64 {
    f64::from_bits(((exponent.clamp(-1000, 1000) + 1023) as u64) << 52)
}

/// The exponent of the power of two at or below `x`; -1000 where there is none.
pub(crate) fn exponent_below(x: f64) -> i32 {
    match x.is_normal() && x > 0.0 {
        true => ((x.to_bits() >> 52) as i32 & 0x7ff) - 1023,
        false => -1000,
    }
}

/// Exponents and integers that are exactly `values`, for each of `width` components; `None` where there
/// are none of 24 bits.
pub(crate) fn exponential(values: &[f32], width: usize) -> Option<Vec<u32>> {
    let mut out = vec![0; values.len()];
    for component in 0..width {
        let own = || values.iter().skip(component).step_by(width);
        let exponent = own().filter(|x| **x != 0.0).map(lowest_bit).min();
        let exponent = exponent.unwrap_or(0);
        if !(-120..=100).contains(&exponent) || !own().all(|x| x.is_finite()) {
            return None;
        }
        let step = power(exponent);
        for (x, out) in own().zip(out.iter_mut().skip(component).step_by(width)) {
            let whole = f64::from(*x) / step;
            if whole.abs() >= f64::from(1 << 23) {
                return None;
            }
            *out = (whole as i32 as u32 & 0x00ff_ffff) | (exponent as u32) << 24;
        }
    }
    Some(out)
}

/// The power of two of the lowest bit that is set in a float.
fn lowest_bit(x: &f32) -> i32 {
    let bits = x.to_bits();
    let (mantissa, exponent) = (bits & 0x007f_ffff, (bits >> 23 & 0xff) as i32);
    let mantissa = if exponent == 0 {
        mantissa
    } else {
        mantissa | 0x0080_0000
    };
    mantissa.trailing_zeros() as i32 + exponent.max(1) - 150
}
