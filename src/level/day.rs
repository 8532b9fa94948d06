//! The hour, the sun, and how far one sees by it.

use bevy::math::ops;
use bevy::prelude::*;
use dolomite::logic::senses::Sight;
use dolomite::logic::{DayClock, Lamp};

use super::parts::{Beacon, Cast, Level, LevelState, Player};
use crate::play::Switches;

/// Latitude of the island and declination of the sun, degrees: the Alps in the middle of April.
const LATITUDE: f32 = 46.0;
const DECLINATION: f32 = 10.0;

/// Below the first elevation it is night, above the second day, degrees: the sun at the horizon, and between civil
/// and nautical dusk.
const NIGHT: f32 = -8.0;
const DAY: f32 = 6.0;

/// Where the sun stands at an hour, degrees: azimuth clockwise from north, and elevation. The equations of spherical
/// astronomy for hour angle and declination (J. Meeus, Astronomical Algorithms, 1998, 13.5 and 13.6).
pub fn sun(hour: f32) -> (f32, f32) {
    let angle = ((hour - 12.0) * 15.0).to_radians();
    let (sin_lat, cos_lat) = ops::sin_cos(LATITUDE.to_radians());
    let (sin_dec, cos_dec) = ops::sin_cos(DECLINATION.to_radians());
    let (sin_hour, cos_hour) = ops::sin_cos(angle);
    let height = sin_lat * sin_dec + cos_lat * cos_dec * cos_hour;
    let from_south = ops::atan2(sin_hour, cos_hour * sin_lat - sin_dec / cos_dec * cos_lat);
    let azimuth = (from_south.to_degrees() + 180.0).rem_euclid(360.0);
    (azimuth, ops::asin(height.clamp(-1.0, 1.0)).to_degrees())
}

/// How much of the day's light there is at an hour, 0 to 1.
pub fn light(hour: f32) -> f32 {
    let t = ((sun(hour).1 - NIGHT) / (DAY - NIGHT)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// How far soldiers see: by day far, by night less; whoever holds a torch, or stands by what burns, is seen by day and
/// by night alike.
pub(super) fn shine(
    level: Res<Level>,
    cast: Res<Cast>,
    switches: Option<Res<Switches>>,
    clocks: Query<&DayClock>,
    players: Query<&Transform, With<Player>>,
    lamps: Query<(&Lamp, &Transform), With<Beacon>>,
    mut state: ResMut<LevelState>,
    mut eyes: Query<&mut Sight>,
) {
    let Ok(clock) = clocks.get(cast.clock) else {
        return;
    };
    state.light = light(clock.hour);
    let s = &level.file.soldiers;
    let torch = switches.is_some_and(|switches| switches.torch);
    let glow = level.file.glow;
    let shone_on = |place: Vec3| {
        let mut near = lamps
            .iter()
            .filter(|(lamp, at)| lamp.lit && at.translation.distance(place) < glow);
        near.next().is_some()
    };
    let lit = glow > 0.0 && players.iter().any(|at| shone_on(at.translation));
    let seen = if torch || lit { 1.0 } else { state.light };
    let range = s.night + (s.day - s.night) * seen;
    for mut sight in &mut eyes {
        if sight.range != range {
            sight.range = range;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sun_goes_from_east_over_south_to_west() {
        let (noon, morning, evening) = (sun(12.0), sun(8.0), sun(16.0));
        // At noon it is as high as latitude and declination say.
        assert!(
            (noon.1 - 54.0).abs() < 0.01 && (noon.0 - 180.0).abs() < 0.01,
            "{noon:?}"
        );
        assert!((90.0..150.0).contains(&morning.0) && (210.0..270.0).contains(&evening.0));
        assert!((morning.1 - evening.1).abs() < 0.01);
        // sunrise where cos H = -tan φ tan δ: 6 h less 10.5° of hour angle.
        assert!(sun(12.0 - 100.52 / 15.0).1.abs() < 0.05);
        assert!(light(12.0) == 1.0 && light(0.0) == 0.0);
        assert!((0.1..0.9).contains(&light(18.6)), "{}", light(18.6));
    }
}
