//! The crates inside Bevy, and below it, with the features that the workspace gives them.
//!
//! `.ci/run` compiles each plugin by itself, with the features of `bevy` that its manifest asks for, as it is compiled
//! in an app that adds nothing else. Cargo would compile most of Bevy anew for each of them: not because the plugin
//! asks for another `bevy_ecs`, but because a crate far below, such as `serde`, has one feature less. Selected together
//! with a plugin (`-p dolomite_sky -p dolomite_bevy_parts`), this crate gives those crates their usual features, so
//! that the ones which are there serve. `bevy` and `bevy_internal` are left out: what a plugin may name of Bevy
//! (`bevy::pbr` where it asked for `bevy_pbr`) stays what its own manifest says, and these two are compiled anew for it
//! in seconds.
