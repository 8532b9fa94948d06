//! From day to night: how much light there is for a place of the sun, what the camera makes of it,
//! and how much of the stars is seen. Pure functions of the sun's elevation, in degrees.

use bevy::math::ops;

use crate::math::smooth;

/// (elevation of the sun in degrees, decimal logarithm of the lux on level ground): clear sky, no
/// moon; after Janiczek and DeYoung, "Computer programs for sun and moon illuminance" (1987), at the
/// ends and in the middle of their pieces.
const LUX: [(f32, f32); 13] = [
    (-18.0, -3.19),
    (-15.0, -2.70),
    (-12.0, -2.09),
    (-10.0, -1.38),
    (-8.0, -0.46),
    (-6.0, 0.53),
    (-4.0, 1.48),
    (-2.0, 2.28),
    (0.0, 2.88),
    (2.0, 3.28),
    (5.0, 3.65),
    (20.0, 4.44),
    (60.0, 5.01),
];

/// Exposure by day, EV at ISO 100. Sunlit ground is metered at 15; some two stops more light open the
/// shadows and let snow come near white without burning out under AgX.
pub const DAY_EV100: f32 = 12.9;

/// Exposure of a night of full moon, EV at ISO 100. Moonlit snow then stands two stops and a half
/// below sunlit snow by day: it is night, and every ridge reads.
pub const NIGHT_EV100: f32 = -3.2;

/// Elevation of the sun from which down the exposure follows the light, degrees.
pub const DUSK: f32 = 5.0;

/// Stops that the exposure opens for each stop of light that goes: less than one, so that dusk is
/// darker than day, and night is reached as the last stars come out.
const FOLLOWS: f32 = 0.85;

/// Elevations of the sun at which the first stars come out, and at which all are seen, degrees.
const FIRST_STAR: f32 = -2.0;
const LAST_STAR: f32 = -12.0;

/// Illuminance of level ground by sun and sky, lux, for the sun at `elevation` degrees; what it is
/// at −18 below, at 60 above.
pub fn illuminance(elevation: f32) -> f32 {
    let above = LUX.partition_point(|(at, _)| *at < elevation);
    let log = match (
        above.checked_sub(1).and_then(|k| LUX.get(k)),
        LUX.get(above),
    ) {
        (Some(low), Some(high)) => {
            low.1 + (high.1 - low.1) * (elevation - low.0) / (high.0 - low.0)
        }
        (Some(end), None) | (None, Some(end)) => end.1,
        (None, None) => 0.0,
    };
    ops::powf(10.0, log)
}

/// Exposure of the camera for the sun at `elevation` degrees, EV at ISO 100: `day` down to
/// 5 degrees, then 0.85 stops less for each stop of light that goes, down to `night`.
pub fn ev100(elevation: f32, day: f32, night: f32) -> f32 {
    let gone = ops::log2(illuminance(DUSK) / illuminance(elevation)).max(0.0);
    (day - FOLLOWS * gone).max(night.min(day))
}

/// Factor from cd/m² to what the picture holds, as Bevy has it.
pub fn exposure(ev100: f32) -> f32 {
    1.0 / (1.2 * ops::exp2(ev100))
}

/// Share of the stars' light that is seen for the sun at `elevation` degrees: 0 by day and until 2
/// degrees below the horizon, 1 from 12 on.
pub fn stars(elevation: f32) -> f32 {
    1.0 - smooth(LAST_STAR, FIRST_STAR, elevation)
}

#[cfg(test)]
mod tests {
    use super::{DAY_EV100, DUSK, NIGHT_EV100, illuminance, stars};

    /// Every hundredth of a degree from the nadir to the zenith.
    fn elevations() -> impl Iterator<Item = f32> {
        (-9_000..=9_000_i16).map(|hundredth| f32::from(hundredth) / 100.0)
    }

    #[test]
    fn there_is_as_much_light_as_is_measured() {
        // Full daylight, the end of civil twilight (3.4 lux), a night without moon (0.6 mlx).
        for (elevation, low, high) in [(60.0, 9e4, 1.2e5), (-6.0, 3.0, 4.0), (-30.0, 5e-4, 1e-3)] {
            let lux = illuminance(elevation);
            assert!((low..high).contains(&lux), "{elevation}: {lux} lux");
        }
        for value in [f32::NEG_INFINITY, f32::INFINITY, f32::NAN] {
            assert!(illuminance(value).is_finite());
        }
    }

    fn ev100(elevation: f32) -> f32 {
        super::ev100(elevation, DAY_EV100, NIGHT_EV100)
    }

    #[test]
    fn the_exposure_follows_the_sun_without_a_jump_and_never_back() {
        let mut before = ev100(-90.0);
        assert_eq!(before, NIGHT_EV100);
        for elevation in elevations() {
            let now = ev100(elevation);
            // Light falls by 1.6 stops a degree at most, the exposure by 0.85 of it.
            assert!(
                (0.0..0.015).contains(&(now - before)),
                "{elevation}: {before} {now}"
            );
            before = now;
        }
        assert_eq!(before, DAY_EV100);
    }

    #[test]
    fn by_day_it_is_that_of_the_day() {
        for elevation in [DUSK, 10.0, 24.0, 90.0] {
            assert_eq!((ev100(elevation), stars(elevation)), (DAY_EV100, 0.0));
        }
    }

    #[test]
    fn stars_come_out_between_2_and_12_degrees_below_the_horizon() {
        assert_eq!((stars(-2.0), stars(-12.0), stars(-90.0)), (0.0, 1.0, 1.0));
        let mut before = 1.0;
        for elevation in elevations() {
            let now = stars(elevation);
            assert!((0.0..0.002).contains(&(before - now)), "{elevation}");
            before = now;
        }
        assert!((0.4..0.6).contains(&stars(-7.0)));
    }
}
