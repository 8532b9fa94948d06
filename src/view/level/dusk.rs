//! The camera of a level between houses: it opens as the sun sinks.
//!
//! The sky's exposure holds that of the day until the sun stands at 5° ([`twilight`](dolomite::sky)), which suits open
//! ground that the sun still lights. Streets and courts have only the sky's light long before: from 20° to 5° the light
//! on level ground goes by 2.6 stops, and in a court it is a fifth of that besides.

use bevy::prelude::*;
use dolomite::sky::{Sky, Sun};

use super::circuits::in_town;

/// Elevations of the sun between which the camera opens, degrees.
const FROM: f32 = 22.0;
const TO: f32 = 4.0;

/// By how many stops.
const STOPS: f32 = 1.8;

/// Opens the camera.
pub struct DuskPlugin;

impl Plugin for DuskPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Update, open.run_if(in_town));
    }
}

/// Exposure of the day with the sun at this elevation, degrees; EV at ISO 100.
fn day_ev100(elevation: f32) -> f32 {
    let sunk = ((FROM - elevation) / (FROM - TO)).clamp(0.0, 1.0);
    Sky::default().day_ev100 - STOPS * sunk * sunk * (3.0 - 2.0 * sunk)
}

fn open(suns: Query<&Sun>, mut skies: Query<&mut Sky>) {
    let Some(sun) = suns.iter().next() else {
        return;
    };
    let ev100 = day_ev100(sun.elevation);
    for mut sky in &mut skies {
        if (sky.day_ev100 - ev100).abs() > 1e-3 {
            sky.day_ev100 = ev100;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_opens_evenly_and_by_day_not_at_all() {
        let usual = Sky::default().day_ev100;
        assert_eq!(day_ev100(60.0), usual);
        assert_eq!(day_ev100(-10.0), usual - STOPS);
        let all: Vec<f32> = (0..300).map(|i| day_ev100(i as f32 * 0.1)).collect();
        assert!(all.is_sorted());
        // No step of a tenth of a degree is seen: a hundredth of a stop.
        assert!(all.windows(2).all(|pair| pair[1] - pair[0] < 0.02));
    }
}
