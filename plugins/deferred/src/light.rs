//! Point and spot lights as the GPU reads them.
//!
//! A light of zero, negative or infinite intensity, of a place, range or cone that is no number, is not listed for
//! any pixel; [`LightRefusal`] names why. What can be clamped is clamped: an infinite range, a negative radius.

use bevy::math::{Vec3, ops};
use bytemuck::{Pod, Zeroable};
use thiserror::Error;

/// Ranges and places beyond it would overflow when squared in f32.
const FARTHEST: f32 = 1e18;

/// Lux from which on the light of a sun on a surface would overflow; `directional_lights` in
/// `shaders/src/deferred/light.wgsl` leaves it out.
const BRIGHTEST: f32 = 1e30;

/// What a light is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSource {
    /// Metres, in the world.
    pub position: Vec3,
    /// Where the light ends, metres.
    pub range: f32,
    /// Luminous intensity of each channel, candela.
    pub intensity: Vec3,
    /// Of the sphere that shines, metres.
    pub radius: f32,
    /// Of a spot light.
    pub cone: Option<Cone>,
    /// What it casts.
    pub shadows: Shadows,
}

/// The shadows of a light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shadows {
    /// From a map of its own.
    pub map: bool,
    /// Of what is near on the screen.
    pub contact: bool,
}

/// A bit of [`LightRow::kind`]: it is a spot light.
pub const SPOT: u32 = 1;
/// A bit of [`LightRow::kind`]: it has a shadow map.
pub const CASTS: u32 = 2;
/// A bit of [`LightRow::kind`]: it casts contact shadows.
pub const CONTACT: u32 = 4;

/// Where a spot light shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Away from the light, of length 1.
    pub direction: Vec3,
    /// Angle from the axis up to which it is full, radians.
    pub inner: f32,
    /// Angle from the axis at which it ends, radians.
    pub outer: f32,
}

/// Why a light is not drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Error)]
pub enum LightRefusal {
    /// Coordinates that are no numbers, or farther than 1e18 m.
    #[error("its place is not a number, or is farther than 1e18 m")]
    Place,
    /// Negative, infinite, or no number.
    #[error("its intensity is negative, infinite or not a number")]
    Intensity,
    /// Negative, or no number.
    #[error("its range is negative or not a number")]
    Range,
    /// Angles or a direction that are no numbers.
    #[error("its cone has an angle or a direction that is not a number")]
    Cone,
    /// Of a directional light: negative, 1e30 lx or more, or no number.
    #[error("its illuminance is negative, 1e30 lx or more, or not a number")]
    Illuminance,
    /// Of a directional light: a turn that is no number, or a scale of 0.
    #[error("its direction is not a number")]
    Direction,
}

/// Whether a directional light can be drawn; `illuminance` is that of each channel, lux.
///
/// # Errors
/// For a light that no picture can be made of.
pub fn check_sun(illuminance: Vec3, to_light: Vec3) -> Result<(), LightRefusal> {
    // Comparisons with NaN are false.
    let bright = illuminance.cmplt(Vec3::splat(BRIGHTEST)).all();
    if !(bright && illuminance.cmpge(Vec3::ZERO).all()) {
        return Err(LightRefusal::Illuminance);
    }
    if to_light.length_squared() > 0.5 {
        Ok(())
    } else {
        Err(LightRefusal::Direction)
    }
}

/// A light in the buffer: `Light` in `shaders/src/deferred/types.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct LightRow {
    /// Metres, in the world.
    pub position: [f32; 3],
    /// Metres.
    pub range: f32,
    /// Candela.
    pub color: [f32; 3],
    /// Metres.
    pub radius: f32,
    /// Of the cone's axis; 0 for a point light.
    pub direction: [f32; 3],
    /// −2 for a point light.
    pub cos_outer: f32,
    /// One over the difference of the cosines.
    pub cone_scale: f32,
    /// Of the outer angle.
    pub sin_outer: f32,
    /// [`SPOT`], [`CASTS`], [`CONTACT`].
    pub kind: u32,
    /// To 64 bytes.
    pub pad: u32,
}

impl LightRow {
    /// The row of a light.
    ///
    /// # Errors
    /// For a light that no picture can be made of.
    pub fn new(source: &LightSource) -> Result<Self, LightRefusal> {
        let place = source.position;
        if !(place.is_finite() && place.abs().max_element() <= FARTHEST) {
            return Err(LightRefusal::Place);
        }
        if !(source.intensity.is_finite() && source.intensity.min_element() >= 0.0) {
            return Err(LightRefusal::Intensity);
        }
        // NaN too.
        if source.range.is_nan() || source.range < 0.0 {
            return Err(LightRefusal::Range);
        }
        // `max` of NaN and 0 is 0.
        let radius = source.radius.max(0.0).min(source.range).min(FARTHEST);
        let mut row = Self {
            position: place.to_array(),
            range: source.range.min(FARTHEST),
            color: source.intensity.to_array(),
            radius,
            cos_outer: -2.0,
            cone_scale: 1.0,
            ..Self::zeroed()
        };
        for (has, bit) in [
            (source.shadows.map, CASTS),
            (source.shadows.contact, CONTACT),
        ] {
            row.kind |= if has { bit } else { 0 };
        }
        if let Some(cone) = source.cone {
            let finite = cone.inner.is_finite() && cone.outer.is_finite();
            if !(finite && cone.direction.is_finite() && cone.direction.length_squared() > 0.5) {
                return Err(LightRefusal::Cone);
            }
            row.kind |= SPOT;
            let outer = cone.outer.clamp(0.0, std::f32::consts::FRAC_PI_2);
            let inner = cone.inner.clamp(0.0, outer);
            row.direction = cone.direction.normalize().to_array();
            row.cos_outer = ops::cos(outer).max(0.0);
            row.sin_outer = ops::sin(outer);
            // As Bevy limits it: a cone without a fading rim still has one of a ten thousandth.
            row.cone_scale = 1.0 / (ops::cos(inner) - row.cos_outer).max(1e-4);
        }
        Ok(row)
    }

    /// Whether any light leaves it.
    #[must_use]
    pub fn shines(&self) -> bool {
        self.range > 0.0 && self.color.iter().any(|channel| *channel > 0.0)
    }

    /// Whether it is a point light.
    #[must_use]
    pub const fn is_point(&self) -> bool {
        self.kind & SPOT == 0
    }

    /// Whether it casts shadows of any sort.
    #[must_use]
    pub const fn casts(&self) -> bool {
        self.kind & (CASTS | CONTACT) != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lamp() -> LightSource {
        LightSource {
            position: Vec3::new(1.0, 2.0, 3.0),
            range: 10.0,
            intensity: Vec3::ONE,
            radius: 0.0,
            cone: None,
            shadows: Shadows::default(),
        }
    }

    #[test]
    fn hostile_suns_are_refused_by_name() {
        for bad in [f32::NAN, f32::INFINITY, -1.0, 1e30] {
            let no = Err(LightRefusal::Illuminance);
            assert_eq!(check_sun(Vec3::new(1.0, bad, 1.0), Vec3::Y), no);
        }
        for bad in [f32::NAN, 0.0] {
            let no = Err(LightRefusal::Direction);
            assert_eq!(check_sun(Vec3::ONE, Vec3::splat(bad)), no);
        }
        assert_eq!(check_sun(Vec3::new(0.0, 1e5, 1.0), Vec3::Y), Ok(()));
    }

    #[test]
    fn hostile_lights_are_refused_by_name_or_clamped() {
        let with = |change: &dyn Fn(&mut LightSource)| {
            let mut light = lamp();
            change(&mut light);
            LightRow::new(&light)
        };
        for bad in [f32::NAN, f32::INFINITY, -1.0] {
            assert_eq!(with(&|l| l.intensity.y = bad), Err(LightRefusal::Intensity));
        }
        for bad in [f32::NAN, f32::INFINITY, 1e19] {
            assert_eq!(with(&|l| l.position.z = bad), Err(LightRefusal::Place));
        }
        for bad in [f32::NAN, -1.0, f32::NEG_INFINITY] {
            assert_eq!(with(&|l| l.range = bad), Err(LightRefusal::Range));
        }
        let cone = |inner, outer, direction| {
            move |l: &mut LightSource| {
                l.cone = Some(Cone {
                    direction,
                    inner,
                    outer,
                });
            }
        };
        for bad in [f32::NAN, f32::INFINITY] {
            let no = Err(LightRefusal::Cone);
            assert_eq!(with(&cone(bad, 1.0, Vec3::X)), no);
            assert_eq!(with(&cone(0.1, bad, Vec3::X)), no);
            assert_eq!(with(&cone(0.1, 0.2, Vec3::splat(bad))), no);
        }
        assert_eq!(with(&cone(0.1, 0.2, Vec3::ZERO)), Err(LightRefusal::Cone));
        let forever = with(&|l| l.range = f32::INFINITY).expect("clamped");
        assert!((forever.range * forever.range).is_finite());
        assert_eq!(with(&|l| l.radius = f32::NAN).expect("clamped").radius, 0.0);
        assert_eq!(with(&|l| l.radius = -3.0).expect("clamped").radius, 0.0);
        assert_eq!(with(&|l| l.radius = 1e30).expect("clamped").radius, 10.0);
        let wide = with(&cone(9.0, 9.0, Vec3::X)).expect("clamped");
        assert!(wide.cos_outer == 0.0 && wide.cone_scale == 1e4);
        assert!(!with(&|l| l.intensity = Vec3::ZERO).expect("dark").shines());
        assert!(!with(&|l| l.range = 0.0).expect("dark").shines());
        assert!(with(&|_| {}).expect("a lamp").shines());
        let casting = with(&|l| l.shadows.map = true).expect("a lamp");
        assert!(casting.casts() && casting.is_point() && !wide.is_point() && !wide.casts());
    }
}
