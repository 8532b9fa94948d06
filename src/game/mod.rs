//! Sky, sun, moon and stars of the game.

pub mod galaxy;
pub mod moon;
pub mod night;
pub mod scattering;
pub mod sky;
pub mod sky_maps;
pub mod star_catalogue;
pub mod stars;
pub mod twilight;

// What these files call the rest of the game.
use crate::play::camera;
use crate::scene::{self as scenes, file as scene_file};
use crate::{settings, view};
