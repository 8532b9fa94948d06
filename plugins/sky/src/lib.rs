//! The sky for Bevy: sun, moon, stars, Milky Way, dusk, haze and exposure, from the place of the sun.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use dolomite_sky::{Sky, SkyPlugin, Sun};
//!
//! fn setup(mut commands: Commands) {
//!     commands.spawn((Camera3d::default(), Msaa::Off, Sky::default()));
//!     commands.spawn(Sun { azimuth: 130.0, elevation: -8.0 });
//! }
//!
//! # let mut app = App::new();
//! app.add_plugins(SkyPlugin).add_systems(Startup, setup);
//! ```
//!
//! [`Sun`] and [`Sky`] are components; [`SeenSky`], beside each [`Sky`], says what there is to be seen.
//! All of it is computed on the CPU when the sun or a setting changes, and nothing while they rest;
//! an app without these components pays nothing.
//!
//! | part | what it does |
//! |---|---|
//! | [`air`] | what the air is made of, how far light goes through it |
//! | [`twilight`] | from day to night: light, exposure, share of the stars, by the sun's elevation |
//! | [`scattering`] | sunlight and moonlight scattered by the air |
//! | [`galaxy`] | the Milky Way |
//! | [`heavens`] | all of these for a place of the sun |
//! | [`haze`] | the colour and thickness of what lies between a camera and the ground |
//! | [`star_catalogue`] | six thousand stars |
//! | `render` | all of it in the picture (feature `render`, on by default) |
//!
//! Without the feature `render` nothing of Bevy's renderer is built, and [`SeenSky`] is the result.
//! Each part knows those above it in the table alone. Units are metres, cd/m² and lux (linear sRGB),
//! degrees for places of the sun; +Y is up, −Z north.

pub mod air;
mod components;
pub mod galaxy;
pub mod haze;
pub mod heavens;
mod math;
mod plugin;
#[cfg(feature = "render")]
pub mod render;
pub mod scattering;
mod seen;
mod sets;
pub mod star_catalogue;
pub mod twilight;

pub use components::{Sky, Sun};
pub use heavens::{Heavens, KeyLight};
pub use plugin::SkyPlugin;
pub use seen::SeenSky;
pub use sets::SkySystems;
