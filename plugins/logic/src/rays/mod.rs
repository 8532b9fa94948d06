//! What hides and what stops shots: a trait that ground, blocks and meshes answer.

mod answer;
mod boxes;
mod ground;
mod set;

pub use answer::{RayWorld, Rays, Stop};
pub use boxes::{BoxRays, enter_box};
pub use ground::GroundRays;
pub use set::RaySet;
