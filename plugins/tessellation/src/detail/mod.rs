//! How finely the ground is drawn: what decides it, and within which bounds.

pub mod budget;
