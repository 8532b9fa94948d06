//! What several modules of tests share.

pub mod adapter;
pub mod app;
pub mod camera;
pub mod display;
pub mod game;
pub mod hills;
pub mod picture;
pub mod rest;
pub mod views;
