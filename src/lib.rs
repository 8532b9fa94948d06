//! The game that is made with Dolomite, and what the command `dolomite` does: a mountain to fly and walk
//! over. A folder a concern; arrows run down only.
//!
//! | folder | concern | uses |
//! |---|---|---|
//! | [`mod@bench`] | flies fixed paths and writes what frames cost; the scene `classic` | all below |
//! | [`run`] | the ways to run the game: in a window, or without one | all below |
//! | [`view`] | what is drawn: camera, materials, figure, panels | play, scene, input, settings |
//! | [`play`] | the half that needs no renderer: camera, figure, switches | scene, input, settings |
//! | [`scene`] | from a name or file to a terrain; taking over changes | settings |
//! | [`input`] | what the player wants: keys, mouse, gamepad | settings |
//! | [`settings`] | what the player may set; where files lie | — |

pub mod bench;
pub mod input;
pub mod play;
pub mod run;
pub mod scene;
pub mod settings;
pub mod view;
