//! A vertex as it is stored, five words: the CPU reference of `shaders/src/geometry/vertex.wgsl`.

use bevy::math::{Vec2, Vec3};

/// The octahedron unfolded onto the square [−1, 1] (Meyer et al. 2010; Cigolla et al. 2014).
fn octahedral(n: Vec3) -> Vec2 {
    let p = n.truncate() / (n.x.abs() + n.y.abs() + n.z.abs());
    if n.z >= 0.0 {
        return p;
    }
    let sign = |x: f32| if x >= 0.0 { 1.0 } else { -1.0 };
    Vec2::new((1.0 - p.y.abs()) * sign(p.x), (1.0 - p.x.abs()) * sign(p.y))
}

/// Normal (12 bits a coordinate) and material (8 bits).
#[must_use]
pub fn pack_normal(normal: Vec3, material: u32) -> u32 {
    // Ties to even, as `round` in WGSL.
    let part = |x: f32| ((x * 0.5 + 0.5) * 4095.0).round_ties_even() as u32;
    let p = octahedral(normal);
    part(p.x) | (part(p.y) << 12) | (material.min(255) << 24)
}

/// Two numbers within ±1, 16 bits each, as `pack2x16snorm` in WGSL.
#[must_use]
pub fn pack_uv(uv: Vec2) -> u32 {
    let part = |x: f32| {
        let steps = (0.5 + 32767.0 * x.clamp(-1.0, 1.0)).floor() as i32;
        (steps as u32) & 0xffff
    };
    part(uv.x) | (part(uv.y) << 16)
}

/// The stored words of a vertex at a place relative to the view's anchor; `uv` in units of the greatest that
/// the producer stores.
#[must_use]
pub fn pack(position: Vec3, normal: Vec3, uv: Vec2, material: u32) -> [u32; 5] {
    let [x, y, z] = position.to_array().map(f32::to_bits);
    [x, y, z, pack_normal(normal, material), pack_uv(uv)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_hold_what_they_say() {
        // The pole is the middle of the square, the other pole a corner.
        assert_eq!(pack_normal(Vec3::Z, 0), 2048 | (2048 << 12));
        assert_eq!(
            pack_normal(Vec3::NEG_Z, 300),
            4095 | (4095 << 12) | (255 << 24)
        );
        assert_eq!(pack_normal(Vec3::NEG_X, 1), (2048 << 12) | (1 << 24));
        assert_eq!(pack_uv(Vec2::new(1.0, -1.0)), 0x8001_7fff);
        assert_eq!(pack_uv(Vec2::new(9.0, 0.0)), 0x7fff);
        let words = pack(Vec3::new(1.0, 0.0, -2.0), Vec3::Y, Vec2::ZERO, 0);
        assert_eq!(words[..3], [0x3f80_0000, 0, 0xc000_0000]);
    }
}
