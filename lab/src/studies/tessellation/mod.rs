//! Study `tessellation`: is the stage what OpenGL and Vulkan specify, on the CPU and on the adapter?

pub mod captures;
pub mod cases;
pub mod check;
pub mod wgsl;
