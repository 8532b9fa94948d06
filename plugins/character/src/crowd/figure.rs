//! A figure of a crowd in 16 bytes. The CPU reference of `character/figure.wgsl`.

use super::palette::PaletteFrame;
use bevy::math::Vec3;
use bevy::reflect::Reflect;
use bytemuck::{Pod, Zeroable};
use std::f32::consts::TAU;

/// A figure: all that is uploaded for it in a frame. `Figure` in `character/types.wgsl`.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CrowdFigure {
    /// Metres from the crowd's anchor.
    pub x: f32,
    /// Metres from the crowd's anchor.
    pub z: f32,
    /// Height in 20 bits, turn in 12.
    pub place: u32,
    /// Frame in 16 bits, part of the way to the next in 8, the user's own in 8.
    pub pose: u32,
}

/// Steps of height in a metre.
const HEIGHT: f32 = 1024.0;
/// Steps of a whole turn.
const TURN: f32 = 4096.0;

impl CrowdFigure {
    /// A figure `offset` metres from the anchor (height is taken to ±512 m, in steps of 1 mm), turned by
    /// `yaw` radians about +y (in steps of 0.09°).
    #[must_use]
    pub fn new(offset: Vec3, yaw: f32, frame: PaletteFrame, own: u8) -> Self {
        let most = (1 << 19) - 1;
        // A cast from f32 stops at the ends and takes a NaN as 0.
        let height = ((offset.y * HEIGHT).round() as i32).clamp(-most - 1, most);
        let turn = ((yaw * (TURN / TAU)).round().rem_euclid(TURN)) as u32 & 0xfff;
        Self {
            x: offset.x,
            z: offset.z,
            place: ((height as u32) << 12) | turn,
            pose: (u32::from(frame.frame) << 16) | (u32::from(frame.part) << 8) | u32::from(own),
        }
    }

    /// Where it stands, as the GPU takes it.
    #[must_use]
    pub fn offset(&self) -> Vec3 {
        Vec3::new(self.x, ((self.place as i32) >> 12) as f32 / HEIGHT, self.z)
    }

    /// Sine and cosine of its turn.
    #[must_use]
    pub fn turn(&self) -> [f32; 2] {
        let step = self.place & 1023;
        let (s, c) = (quarter_sine(step), quarter_sine(1024 - step));
        match (self.place >> 10) & 3 {
            0 => [s, c],
            1 => [c, -s],
            2 => [-s, -c],
            _ => [-c, s],
        }
    }

    /// A direction of the model in the world.
    #[must_use]
    pub fn turned(&self, d: Vec3) -> Vec3 {
        let [s, c] = self.turn();
        Vec3::new(d.x * c + d.z * s, d.y, d.z * c - d.x * s)
    }

    /// A place of the model, metres from the anchor.
    #[must_use]
    pub fn placed(&self, position: Vec3) -> Vec3 {
        self.turned(position) + self.offset()
    }
}

/// The sine of `step` 1024ths of a right angle. The polynomial is that of sampling's slerp: sin(x)/x
/// in x², relative error 1e-7.
fn quarter_sine(step: u32) -> f32 {
    let x = step as f32 * 0.001_533_980_8;
    let square = x * x;
    let coefficients = [-0.000_198_090_14, 0.008_333_05, -0.166_666_58, 1.0];
    let sum = coefficients
        .iter()
        .fold(2.605_101_8e-6, |sum, c| sum * square + c);
    x * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::Vec2Swizzles;

    #[test]
    fn sixteen_bytes_hold_what_they_are_given() {
        assert_eq!(size_of::<CrowdFigure>(), 16);
        let frame = PaletteFrame {
            frame: 65_534,
            part: 200,
        };
        for (y, yaw) in [
            (0.0, 0.0),
            (-3.25, 1.0),
            (511.9, -2.0),
            (-512.0, 6.0),
            (1e9, 100.0),
            (f32::NAN, f32::NAN),
        ] {
            let figure = CrowdFigure::new(Vec3::new(1.5, y, -2.5), yaw, frame, 77);
            assert_eq!(figure.pose, (65_534 << 16) | (200 << 8) | 77);
            let offset = figure.offset();
            assert_eq!((offset.x, offset.z), (1.5, -2.5));
            if y.is_finite() {
                assert!(
                    (offset.y - y.clamp(-512.0, 512.0)).abs() <= 0.001,
                    "{y}: {offset}"
                );
                // Half a step of a turn.
                let (sin, cos) = bevy::math::ops::sin_cos(yaw);
                let [s, c] = figure.turn();
                assert!((s - sin).abs() < 8e-4 && (c - cos).abs() < 8e-4, "{yaw}");
            }
        }
    }

    #[test]
    fn turns_are_rotations() {
        for step in 0..4096_u32 {
            let figure = CrowdFigure {
                place: step,
                ..Default::default()
            };
            let [s, c] = figure.turn().map(f64::from);
            let angle = f64::from(step) * std::f64::consts::TAU / 4096.0;
            let (sin, cos) = bevy::math::DVec2::from_angle(angle).yx().into();
            assert!((s - sin).abs() < 2e-7 && (c - cos).abs() < 2e-7, "{step}");
        }
    }
}
