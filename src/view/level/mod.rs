//! What a level looks like.
//!
//! | file | concern |
//! |---|---|
//! | [`beacons`] | beacons, bandages, bolts, and the hour's sun |
//! | [`circuits`], [`town`], [`dusk`] | lamps in a city; its walls, lifts, roofs and gate; the camera between them |
//! | [`soldiers`] | the figures of soldiers |
//! | [`hud`], [`map`] | what is said over the picture |
//! | [`screens`] | menus |
//! | [`look`] | their letters and colours |

pub mod beacons;
pub mod circuits;
pub mod dusk;
pub mod hud;
pub mod look;
pub mod map;
pub mod screens;
pub mod soldiers;
pub mod town;

use bevy::prelude::*;

use beacons::BeaconsPlugin;
use circuits::CircuitsPlugin;
use dusk::DuskPlugin;
use hud::HudPlugin;
use map::MapPlugin;
use screens::ScreensPlugin;
use soldiers::SoldiersPlugin;
use town::TownPlugin;

/// Shows the level that is played, and its menus. Add beside `LevelPlugin` and `MenuPlugin`.
pub struct LevelViewPlugin;

impl Plugin for LevelViewPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((
            BeaconsPlugin,
            CircuitsPlugin,
            DuskPlugin,
            TownPlugin,
            SoldiersPlugin,
            HudPlugin,
            MapPlugin,
            ScreensPlugin,
        ));
    }
}
