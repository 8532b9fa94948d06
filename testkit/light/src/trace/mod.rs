//! Rays.

mod bounds;
mod build;
mod primitive;
mod ray;
mod tracer;

pub use ray::Ray;
pub use tracer::{Hit, Sides, Surface, Tracer};
