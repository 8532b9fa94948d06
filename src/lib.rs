//! The game that is made with Dolomite, and what the command `dolomite` does: a mountain to fly and walk
//! over. A folder a concern; arrows run down only.
//!
//! | folder | concern | uses |
//! |---|---|---|
//! | [`mod@bench`] | flies fixed paths and writes what frames cost; the scene `classic` | all below |
//! | [`run`] | the ways to run the game: in a window, or without one | all below |
//! | [`mod@console`] | inspector and console: commands, scripts | view, play, scene, input, settings |
//! | [`bot`] | plays levels to their end, by input alone | level, play, scene, input, settings |
//! | [`view`] | what is drawn: camera, materials, figure, panels, menus | level, play, scene, input, settings |
//! | [`mod@sound`] | what is heard: steps, wind, sea, shots, calls, lifts | level, play, scene, settings |
//! | [`level`] | what makes a scene a game that is won or lost; saved games | play, scene, input, settings |
//! | [`play`] | the half that needs no renderer: camera, figure, switches | scene, input, settings |
//! | [`scene`] | from a name or file to a terrain; taking over changes | settings |
//! | [`input`] | what the player wants: keys, mouse, gamepad | settings |
//! | [`settings`] | what the player may set; where files lie | — |

pub mod bench;
pub mod bot;
pub mod console;
pub mod input;
pub mod level;
pub mod play;
pub mod run;
pub mod scene;
pub mod settings;
pub mod sound;
pub mod view;
