//! Linear RGB and its sRGB encoding (IEC 61966-2-1), without `powf`.

use std::sync::LazyLock;

/// Linear RGB with the primaries of sRGB, each 0..=1.
pub type Rgb = [f32; 3];

/// Linear value of a non-linear sRGB value, both 0..=1.
///
/// `x^2.4` is `x^2` times the fifth root of `x^2`, and the fifth root is found
/// by Newton's method: only arithmetic that IEEE 754 rounds exactly, so the
/// tables are the same bits on every machine.
#[must_use]
pub fn decode(encoded: f64) -> f64 {
    if encoded <= 0.04045 {
        return encoded / 12.92;
    }
    let x = (encoded + 0.055) / 1.055;
    let square = x * x;
    let mut root = 1.0_f64;
    // From 1 the error shrinks by 4/5 a step until it falls quadratically;
    // square >= 0.008, so 24 steps reach the last bit.
    for _ in 0..24 {
        let fourth = root * root * root * root;
        root -= (fourth * root - square) / (5.0 * fourth);
    }
    square * root
}

/// Linear values of the 256 codes, and the borders between their nearest
/// neighbourhoods (halfway between codes in the encoded scale).
static TABLES: LazyLock<([f32; 256], [f32; 255])> = LazyLock::new(|| {
    let mut codes = [0.0; 256];
    let mut borders = [0.0; 255];
    for i in 0..256 {
        codes[i] = decode(i as f64 / 255.0) as f32;
        if i < 255 {
            borders[i] = decode((i as f64 + 0.5) / 255.0) as f32;
        }
    }
    (codes, borders)
});

/// The sRGB byte nearest to a linear value; values outside 0..=1 are clamped.
#[must_use]
pub fn encode_byte(linear: f32) -> u8 {
    TABLES.1.partition_point(|&border| border < linear) as u8
}

/// Linear value of an sRGB byte.
#[must_use]
pub fn decode_byte(code: u8) -> f32 {
    TABLES.0[usize::from(code)]
}

/// Linear colour of an sRGB colour written 0xRRGGBB.
#[must_use]
pub fn srgb(code: u32) -> Rgb {
    let [_, r, g, b] = code.to_be_bytes();
    [decode_byte(r), decode_byte(g), decode_byte(b)]
}

/// Interpolates linearly, `a` at 0 and `b` at 1.
#[must_use]
pub fn blend(a: Rgb, b: Rgb, t: f32) -> Rgb {
    [
        a[0] + (b[0] - a[0]) * t,
        a[1] + (b[1] - a[1]) * t,
        a[2] + (b[2] - a[2]) * t,
    ]
}

/// Every component times `factor`.
#[must_use]
pub fn scale(colour: Rgb, factor: f32) -> Rgb {
    colour.map(|c| c * factor)
}

/// Component by component product.
#[must_use]
pub fn tint(a: Rgb, b: Rgb) -> Rgb {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

/// Relative luminance of a linear colour (Rec. 709 weights).
#[must_use]
pub fn luminance(colour: Rgb) -> f32 {
    0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[expect(clippy::disallowed_methods, reason = "the oracle of this test")]
    fn decoding_matches_the_power_function() {
        for i in 0..=1000_u16 {
            let x = f64::from(i) / 1000.0;
            let expected = if x <= 0.04045 {
                x / 12.92
            } else {
                ((x + 0.055) / 1.055).powf(2.4)
            };
            assert!((decode(x) - expected).abs() < 1e-14, "{x}");
        }
    }

    #[test]
    fn every_byte_survives_the_round_trip() {
        for code in 0..=255_u8 {
            assert_eq!(encode_byte(decode_byte(code)), code);
        }
        assert_eq!(encode_byte(-1.0), 0);
        assert_eq!(encode_byte(2.0), 255);
    }

    #[test]
    fn grey_has_the_luminance_of_its_value() {
        assert!((luminance([0.3; 3]) - 0.3).abs() < 1e-6);
    }
}
