//! One set of features for everything that this workspace builds.
//!
//! Cargo compiles a crate anew for each set of features that is asked of it, and asks for those of the selected
//! packages alone: the game, the lab and the tests of one plugin would each build a Bevy of their own.
//! Everything here therefore depends on this crate (plugins for their tests alone, so that an app which uses a
//! plugin asks for no more than that plugin does), and this crate asks for all features that any of them needs.
