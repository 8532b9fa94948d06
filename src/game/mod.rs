//! The game: a mountain to fly and walk over. One file a concern.
//!
//! | file | concern |
//! |---|---|
//! | [`simulation`] | the half that needs no renderer: scene, figure, camera, switches |
//! | [`input`], [`keys`] | from devices to [`input::PlayerInput`]; the table of keys |
//! | [`camera`], [`player`], [`jump`] | the camera, free or following; the walking figure; its leaps |
//! | [`hero`] | what the figure looks like |
//! | [`scenes`], [`scene_file`], [`hot_reload`] | from a name or file to a terrain; taking over changes |
//! | [`settings`], [`paths`] | what the player may set; where files lie |
//! | [`view`], [`textures`], [`hud`] | what is drawn |
//! | [`methods`], [`classic_view`] | the classic scene: ways to make its triangles; how it is drawn |
//! | [`sky`], [`scattering`], [`sky_maps`], [`twilight`] | the sky by day and at dusk; exposure |
//! | [`night`], [`galaxy`], [`stars`], [`star_catalogue`], [`moon`] | the sky by night |
//! | [`device`], [`setup`] | is there a device; what every run needs, and all errors |
//! | [`play`], [`shot`], [`mod@bench`] | the three ways to run it; [`offscreen`] is under the last two |
//! | [`matrix`] | the bench over all ways to make triangles |

pub mod bench;
pub mod bench_path;
pub mod camera;
pub mod classic_view;
pub mod device;
pub mod galaxy;
pub mod hero;
pub mod hot_reload;
pub mod hud;
pub mod input;
pub mod jump;
pub mod keys;
pub mod matrix;
pub mod methods;
pub mod moon;
pub mod night;
pub mod offscreen;
pub mod passes;
pub mod paths;
pub mod play;
pub mod player;
pub mod scattering;
mod scene_build;
pub mod scene_file;
pub mod scenes;
pub mod settings;
pub mod setup;
pub mod shot;
pub mod simulation;
pub mod sky;
pub mod sky_maps;
pub mod star_catalogue;
pub mod stars;
pub mod textures;
pub mod twilight;
pub mod view;
