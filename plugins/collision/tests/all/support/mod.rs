//! What the tests share.

pub mod convex;
pub mod meshes;
pub mod random;
