//! What an app spawns: the place of the [`Sun`], and the [`Sky`] of a camera.

use bevy::math::ops;
use bevy::prelude::*;

/// The sun, in the sky by its place. Degrees, as almanacs and scene files have them.
///
/// With the `render` feature the entity has a `DirectionalLight` that casts shadows. Its direction,
/// colour and illuminance follow the place: the sun's by day, the moon's (opposite to it, and full)
/// as soon as that gives more. Give the entity a `CascadeShadowConfig` of your own where shadows have
/// to reach farther than Bevy's 150 m. It should have no parent: the place is that in the world.
///
/// Of several suns each lights the ground by its own light, and the one of the lowest entity (as a rule
/// that spawned first) the sky; a warning says so, once. A place that is not finite is passed over,
/// with a warning: all stays as it was.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serialize",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
#[require(Transform)]
#[cfg_attr(
    feature = "render",
    require(bevy::light::DirectionalLight = bevy::light::DirectionalLight {
        shadow_maps_enabled: true,
        ..Default::default()
    })
)]
pub struct Sun {
    /// Clockwise from north (−Z), degrees: 90 is east (+X), 180 south.
    pub azimuth: f32,
    /// Above the horizon, degrees; below it where negative. Beyond ±90 it goes on over the zenith.
    pub elevation: f32,
}

impl Default for Sun {
    /// A forenoon: in the south-east, 30 degrees up.
    fn default() -> Self {
        Self {
            azimuth: 130.0,
            elevation: 30.0,
        }
    }
}

impl Sun {
    /// The unit vector towards it; `None` where its place is not finite.
    #[must_use]
    pub fn towards(&self) -> Option<Vec3> {
        let (sin_azimuth, cos_azimuth) = ops::sin_cos(self.azimuth.to_radians());
        let (sin_elevation, cos_elevation) = ops::sin_cos(self.elevation.to_radians());
        let towards = Vec3::new(
            sin_azimuth * cos_elevation,
            sin_elevation,
            -cos_azimuth * cos_elevation,
        );
        towards.is_finite().then_some(towards)
    }
}

/// The sun that lights the sky: of those whose place is finite, the one of the lowest entity.
pub(crate) fn the_sun<'a>(suns: impl Iterator<Item = (Entity, &'a Sun)>) -> Option<(Entity, Sun)> {
    suns.filter(|(_, sun)| sun.towards().is_some())
        .min_by_key(|(entity, _)| entity.index_u32())
        .map(|(entity, sun)| (entity, *sun))
}

/// The sky that a camera sees: by day, at dusk and by night, from the place of the [`Sun`].
///
/// With the `render` feature the camera gets `Exposure`, `Skybox`, `EnvironmentMapLight`,
/// `AmbientLight` (none: all light comes from sun and sky) and `DistanceFog`, and is `Hdr`; at night
/// also a `GeometryCamera`, which draws stars and moon. Those are
/// drawn with one sample a pixel: give the camera `Msaa::Off`, else there are none, and a warning.
/// Taken away, the component takes with it what it brought, but for the exposure, and but for the
/// `GeometryCamera` where another component of the camera requires it by then; and Bevy 0.19 draws
/// without ambient light until the camera has an `AmbientLight` again.
///
/// Numbers that are not finite count as the defaults, others as the nearest in their range.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serialize",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[cfg_attr(feature = "render", require(bevy::camera::Hdr))]
pub struct Sky {
    /// Whether the sea lies below the horizon, which as the sun sinks mirrors the sky; else land.
    /// The maps of dusk and night then cost a second ray for each texel below the horizon.
    pub sea: bool,
    /// Dust in the air against that of a very clear day, 0 to 100. The turbidity, as in the sky
    /// models of the literature, is about 1 + 0.05 · `dust`: 20 is a usual day, 100 a hazy one.
    pub dust: f32,
    /// Thickness of the haze between the camera and what it sees, against that of very clear air,
    /// 0 to 10 000; 0: no fog, and a pixel of every surface costs a few operations less.
    pub haze: f32,
    /// Whether the camera's exposure follows the light. If not, its own `Exposure` holds.
    pub expose: bool,
    /// Exposure by day, EV at ISO 100, −20 to 30.
    pub day_ev100: f32,
    /// Exposure of a night, EV at ISO 100, −20 to 30; not above `day_ev100`.
    pub night_ev100: f32,
    /// Whether the sky lights what the camera sees, by an environment map. Costs two look-ups a
    /// pixel; the maps for it, 70 kB, are made all the same.
    pub light: bool,
    /// Brightness of the stars against the true one, 0 to 1000; at 0 there is none. A full moon
    /// leaves a tenth of them to the eye; 3 gives back those of the fifth magnitude. Costs 6000
    /// octahedra, of which those in view are made anew where the camera turns: 1.3 MB a camera, by
    /// night alone.
    pub stars: f32,
    /// Brightness of the Milky Way, 0 to 1000; at 1 it is six times the true one, since under a full
    /// moon nothing would be left of it.
    pub milky_way: f32,
    /// Size of the moon against the true one, 0 to 20; at 0 there is none. The light that it gives
    /// stays. At its own half degree it fills six pixels of 720: paintings have it twice as large.
    /// Costs 1 MB a camera, by night alone.
    pub moon_size: f32,
    /// Side of a face of the cube map that is seen, texels, 8 to 1024. Costs 48 · `side`² bytes, and
    /// time to make it, on all cores: at 128, 0.1 s of one core by day and several times that at
    /// dusk.
    pub side: u32,
    /// How far the sun goes before the maps are made anew, degrees, 0 to 10. Light and exposure
    /// follow at once; as soon as the sun rests the maps are exact.
    pub map_step: f32,
}

impl Default for Sky {
    fn default() -> Self {
        Self {
            sea: false,
            dust: 1.0,
            haze: 1.25,
            expose: true,
            day_ev100: crate::twilight::DAY_EV100,
            night_ev100: crate::twilight::NIGHT_EV100,
            light: true,
            stars: 3.0,
            milky_way: 1.0,
            moon_size: 2.0,
            side: 128,
            map_step: 0.25,
        }
    }
}

impl Sky {
    /// The same with every number in its range.
    #[must_use]
    pub fn clamped(&self) -> Self {
        let usual = Self::default();
        let within = |value: f32, usual: f32, least: f32, most: f32| {
            if value.is_finite() {
                value.clamp(least, most)
            } else {
                usual
            }
        };
        let day_ev100 = within(self.day_ev100, usual.day_ev100, -20.0, 30.0);
        let night_ev100 = within(self.night_ev100, usual.night_ev100, -20.0, 30.0);
        Self {
            dust: within(self.dust, usual.dust, 0.0, 100.0),
            haze: within(self.haze, usual.haze, 0.0, 1e4),
            day_ev100,
            night_ev100: night_ev100.min(day_ev100),
            stars: within(self.stars, usual.stars, 0.0, 1e3),
            milky_way: within(self.milky_way, usual.milky_way, 0.0, 1e3),
            moon_size: within(self.moon_size, usual.moon_size, 0.0, 20.0),
            side: self.side.clamp(8, 1024),
            map_step: within(self.map_step, usual.map_step, 0.0, 10.0),
            ..*self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(azimuth: f32, elevation: f32) -> Option<Vec3> {
        Sun { azimuth, elevation }.towards()
    }

    #[test]
    fn azimuth_is_clockwise_from_north_and_elevation_up() {
        for (azimuth, elevation, direction) in [
            (0.0, 0.0, Vec3::NEG_Z),
            (90.0, 0.0, Vec3::X),
            (180.0, 0.0, Vec3::Z),
            (45.0, 90.0, Vec3::Y),
            (45.0, -90.0, Vec3::NEG_Y),
            (0.0, 135.0, Vec3::new(0.0, 0.5_f32.sqrt(), 0.5_f32.sqrt())),
        ] {
            let found = at(azimuth, elevation).expect("finite");
            // One rounding of sine or cosine of a right angle.
            assert!(
                found.distance(direction) < 1e-6,
                "{azimuth} {elevation}: {found}"
            );
        }
    }

    #[test]
    fn a_place_that_is_none_is_none() {
        for wrong in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!((at(wrong, 0.0), at(0.0, wrong)), (None, None));
        }
        // Many turns are a place all the same.
        assert!(at(1e30, -1e30).is_some_and(Vec3::is_normalized));
    }

    #[test]
    fn wrong_numbers_become_right_ones_and_right_ones_stay() {
        let usual = Sky::default();
        assert_eq!(usual.clamped(), usual);
        for wrong in [f32::NAN, f32::INFINITY] {
            let sky = Sky {
                dust: wrong,
                haze: wrong,
                day_ev100: wrong,
                night_ev100: wrong,
                stars: wrong,
                milky_way: wrong,
                moon_size: wrong,
                map_step: wrong,
                ..usual
            };
            assert_eq!(sky.clamped(), usual, "{wrong}");
        }
        let far = Sky {
            dust: -1.0,
            day_ev100: 3.0,
            night_ev100: 8.0,
            side: 1 << 20,
            map_step: 90.0,
            ..usual
        }
        .clamped();
        assert_eq!(
            (far.dust, far.night_ev100, far.side, far.map_step),
            (0.0, 3.0, 1024, 10.0)
        );
    }

    #[cfg(feature = "serialize")]
    #[test]
    fn files_name_both_angles_and_no_field_that_is_none() {
        let read = |text| ron::from_str::<Sun>(text);
        let sun = Sun {
            azimuth: 90.0,
            elevation: -3.0,
        };
        assert_eq!(
            read("(azimuth: 90.0, elevation: -3.0)").expect("a sun"),
            sun
        );
        assert!(read("(azimuth: 90.0)").is_err());
        assert!(read("(azimuth: 90.0, elevation: -3.0, colour: 1.0)").is_err());
        let sky = ron::from_str::<Sky>("(dust: 20.0)").expect("a sky");
        assert_eq!(
            sky,
            Sky {
                dust: 20.0,
                ..Sky::default()
            }
        );
        assert!(ron::from_str::<Sky>("(fog: 1.0)").is_err());
    }
}
