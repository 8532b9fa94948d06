//! The words of a pixel of Bevy's deferred target: the functions of `shaders/src/deferred/gbuffer.wgsl`, in Rust.
//!
//! | word | bytes, lowest first |
//! |---|---|
//! | 0 | base colour (gamma 2.2), a byte of the model (standard: perceptual roughness) |
//! | 1 | emitted radiance, RGB9E5 |
//! | 2 | four bytes of the model (standard: reflectance, metallic, occlusion, clearcoat in 4 + 4 bits) |
//! | 3 | normal, octahedral, 12 + 12 bits; flags |

use bevy::math::{BVec2, Vec2, Vec3, ops};

/// The material is not lit: word 1 holds its colour.
pub const UNLIT: u32 = 1;
/// Fog lies over it.
pub const FOG: u32 = 2;
/// Shadows fall on it.
pub const SHADOW_RECEIVER: u32 = 4;
/// Of the Blinn-Phong model: the highlight is Phong's.
pub const PHONG: u32 = 8;

/// Four numbers in `0..=1` as bytes; others are clamped, NaN is 0. Off by 1 / 510.
#[must_use]
pub fn pack_bytes(values: [f32; 4]) -> u32 {
    let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u32;
    let [a, b, c, d] = values.map(byte);
    a | (b << 8) | (c << 16) | (d << 24)
}

/// The inverse of [`pack_bytes`].
#[must_use]
pub fn unpack_bytes(word: u32) -> [f32; 4] {
    word.to_le_bytes().map(|byte| f32::from(byte) / 255.0)
}

/// The power of two with an exponent from −126 to 127.
const fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent + 127) as u32) << 23)
}

/// Radiance as RGB9E5 (EXT_texture_shared_exponent): off by 1 / 512 of the greatest channel (2⁻²⁵ where that is
/// below 2⁻¹⁶). Channels are clamped to `0..=65408`, NaN is 0.
#[must_use]
pub fn pack_emissive(radiance: Vec3) -> u32 {
    let rgb = radiance.to_array().map(|channel| {
        if channel.is_nan() {
            0.0
        } else {
            channel.clamp(0.0, 65408.0)
        }
    });
    let most = rgb[0].max(rgb[1]).max(rgb[2]);
    let floor_log2 = ((most.to_bits() & 0x7f80_0000) >> 23).cast_signed() - 127;
    let mut exponent = floor_log2.max(-16) + 16;
    let mut scale = power_of_two(24 - exponent);
    if (most * scale + 0.5).floor() == 512.0 {
        scale *= 0.5;
        exponent += 1;
    }
    let [r, g, b] = rgb.map(|channel| (channel * scale + 0.5).floor() as u32);
    r | (g << 9) | (b << 18) | (exponent.cast_unsigned() << 27)
}

/// The inverse of [`pack_emissive`]; exact.
#[must_use]
pub fn unpack_emissive(word: u32) -> Vec3 {
    let mantissa = |shift: u32| ((word >> shift) & 511) as f32;
    Vec3::new(mantissa(0), mantissa(9), mantissa(18))
        * power_of_two((word >> 27).cast_signed() - 24)
}

/// A normal of any length but 0, and flags. Off by 0.059 degrees at most.
#[must_use]
pub fn pack_normal(normal: Vec3, flags: u32) -> u32 {
    let n = normal / (normal.x.abs() + normal.y.abs() + normal.z.abs());
    let sign = |is: bool| if is { 1.0 } else { -1.0 };
    let folded = Vec2::new(
        (1.0 - n.y.abs()) * sign(n.x > 0.0),
        (1.0 - n.x.abs()) * sign(n.y > 0.0),
    );
    let octahedral = if n.z >= 0.0 { n.truncate() } else { folded } * 0.5 + 0.5;
    let bits = |value: f32| (value.clamp(0.0, 1.0) * 4095.0 + 0.5) as u32;
    bits(octahedral.x) | (bits(octahedral.y) << 12) | (flags << 24)
}

/// The normal of [`pack_normal`], of length 1.
#[must_use]
pub fn unpack_normal(word: u32) -> Vec3 {
    let bits = Vec2::new((word & 4095) as f32, ((word >> 12) & 4095) as f32);
    let octahedral = bits / 4095.0 * 2.0 - 1.0;
    let z = 1.0 - octahedral.x.abs() - octahedral.y.abs();
    let t = (-z).clamp(0.0, 1.0);
    let positive: BVec2 = octahedral.cmpge(Vec2::ZERO);
    let folded = Vec2::select(positive, Vec2::splat(-t), Vec2::splat(t));
    (octahedral + folded).extend(z).normalize()
}

/// The flags of [`pack_normal`].
#[must_use]
pub const fn unpack_flags(word: u32) -> u32 {
    word >> 24
}

/// A linear channel with the gamma of the base colour.
#[must_use]
pub fn encode_color(linear: f32) -> f32 {
    ops::powf(linear, 1.0 / 2.2)
}

/// The inverse of [`encode_color`].
#[must_use]
pub fn decode_color(encoded: f32) -> f32 {
    ops::powf(encoded, 2.2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_of_a_normal_decodes_to_length_one_and_encodes_to_itself() {
        // The whole circle of the first coordinate against a part of the second.
        for x in 0..4096_u32 {
            for y in (0..4096_u32).step_by(63) {
                let word = x | (y << 12);
                let normal = unpack_normal(word);
                assert!((normal.length() - 1.0).abs() < 1e-6, "{word:#x}");
                let again = unpack_normal(pack_normal(normal, 0));
                // Seams of the octahedron have two codes for the same direction.
                assert!(again.distance(normal) < 1e-6, "{word:#x}: {normal} {again}");
            }
        }
    }

    #[test]
    fn a_normal_is_off_by_less_than_the_stated_angle() {
        let mut worst = 0.0_f64;
        let mut state = 1_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 40) as f32 / 8_388_608.0 - 1.0
        };
        for _ in 0..200_000 {
            let v = Vec3::new(random(), random(), random());
            if v.length() > 1.0 || v.length() < 0.1 {
                continue;
            }
            let (a, b) = (v.as_dvec3().normalize(), unpack_normal(pack_normal(v, 7)));
            worst = worst.max(a.cross(b.as_dvec3()).length());
        }
        assert!(worst < 0.059_f64.to_radians(), "{}", worst.to_degrees());
        assert!(worst > 0.04_f64.to_radians(), "the bound can be reached");
        assert_eq!(unpack_flags(pack_normal(Vec3::Y, 7)), 7);
    }

    #[test]
    fn radiance_keeps_nine_bits_of_its_greatest_channel() {
        for scale in -14..16 {
            for step in 0..1000 {
                let value = power_of_two(scale) * (1.0 + step as f32 / 1000.0);
                let rgb = Vec3::new(value, 0.37 * value, 0.001 * value).min(Vec3::splat(65408.0));
                let off = (unpack_emissive(pack_emissive(rgb)) - rgb)
                    .abs()
                    .max_element();
                // Half of the last of nine bits, when the greatest channel has just become one more.
                assert!(off <= rgb.x / 510.0, "{rgb}: {off}");
            }
        }
        assert_eq!(unpack_emissive(pack_emissive(Vec3::ZERO)), Vec3::ZERO);
        let hostile = unpack_emissive(pack_emissive(Vec3::new(f32::NAN, -1.0, f32::INFINITY)));
        assert_eq!(hostile, Vec3::new(0.0, 0.0, 65408.0));
    }

    #[test]
    fn bytes_come_back() {
        for byte in 0..=255_u8 {
            let word = u32::from_le_bytes([byte, 0, 255 - byte, 255]);
            assert_eq!(pack_bytes(unpack_bytes(word)), word);
        }
        assert_eq!(
            pack_bytes([f32::NAN, -1.0, 2.0, 0.5]),
            u32::from_le_bytes([0, 0, 255, 128])
        );
    }
}
