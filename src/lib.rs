//! The game that is made with Dolomite, and what the command `dolomite` does.

pub mod game;
