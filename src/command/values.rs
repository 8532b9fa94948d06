//! Values of the command line that are more than a number: sizes, angles, cameras.

use std::str::FromStr;

use bevy::math::{DVec3, UVec2};
use dolomite_game::scene::{PITCH_LIMIT, Pose};
use dolomite_game::settings::MAX_SIDE;

/// Width and height in pixels: `1280x720`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size(pub UVec2);

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("write WIDTHxHEIGHT, each 1 to {MAX_SIDE}, for example 1280x720");
        let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
        let side = |text: &str| {
            text.parse::<u32>()
                .ok()
                .filter(|side| (1..=MAX_SIDE).contains(side))
                .ok_or_else(wrong)
        };
        Ok(Self(UVec2::new(side(width)?, side(height)?)))
    }
}

/// Two angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Degrees2(pub f32, pub f32);

impl FromStr for Degrees2 {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let [azimuth, elevation] = numbers(text)?;
        Ok(Self(azimuth as f32, elevation as f32))
    }
}

/// A place on the ground, (x, z), metres, and a way to look, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand(pub (f32, f32, f32));

impl FromStr for Stand {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let [x, z, yaw] = numbers(text)?;
        Ok(Self((x as f32, z as f32, yaw as f32)))
    }
}

/// Position in metres, yaw and pitch in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera(pub Pose);

impl FromStr for Camera {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let [x, y, z, yaw, pitch] = numbers(text)?;
        let limit = f64::from(PITCH_LIMIT.to_degrees());
        if pitch.abs() > limit {
            return Err(format!(
                "the pitch must be -{limit:.0} to {limit:.0} degrees"
            ));
        }
        // What f32 view matrices can still hold to a metre.
        if [x, y, z].iter().any(|metres| metres.abs() > 1e7) {
            return Err("the position must be within 10000 km of the origin".to_owned());
        }
        Ok(Self(Pose {
            position: DVec3::new(x, y, z),
            yaw: (yaw as f32).to_radians(),
            pitch: (pitch as f32).to_radians(),
        }))
    }
}

/// `N` finite numbers between commas.
fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map(|part| {
            part.trim()
                .parse()
                .ok()
                .filter(|number: &f64| number.is_finite())
        })
        .collect::<Option<_>>()
        .ok_or_else(|| format!("write {N} numbers with commas between them"))?;
    numbers
        .try_into()
        .map_err(|numbers: Vec<f64>| format!("write {N} numbers, not {}", numbers.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_cameras_are_checked() {
        assert_eq!("64x32".parse(), Ok(Size(UVec2::new(64, 32))));
        for wrong in ["0x10", "10x0", "10", "10x", "-4x4", "99999x4", "4x4x4"] {
            assert!(wrong.parse::<Size>().is_err(), "{wrong} was accepted");
        }
        let Camera(pose) = "1,2,-3,90,-45".parse().unwrap();
        assert_eq!(pose.position, DVec3::new(1.0, 2.0, -3.0));
        assert!((pose.yaw - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
        for wrong in [
            "1,2,3,4",
            "1,2,3,4,5,6",
            "1,2,3,4,90",
            "1,2,x,4,5",
            "NaN,0,0,0,0",
        ] {
            assert!(wrong.parse::<Camera>().is_err(), "{wrong} was accepted");
        }
    }
}
