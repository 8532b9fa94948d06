//! Scenes of the light oracle in an app without a window, and what its camera sees in 32-bit floats.

mod app;
mod gbuffer;
pub mod occlusion;
mod scene;
mod unlit;

pub use app::{
    Picture, Target, WAYS, app, app_by, app_with, camera, frames, keep, lit_by, picture,
};
pub use gbuffer::{GBufferPlugin, Pixel, pixels};
pub use scene::{Spawned, decoded, spawn};
pub use unlit::{Unlit, UnlitPlugin};
