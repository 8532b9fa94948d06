//! What the tests share: files that are made for them, and where the larger ones are.

pub mod ascii;
#[expect(dead_code, reason = "its false claims are of the tests of memory")]
pub mod binary;
pub mod chain;
pub mod held;
pub mod looks;
pub mod made;
#[cfg(feature = "meshopt")]
pub mod motions;
pub mod scene;
mod shared;
pub mod takes;

pub use shared::{files_below, shared_fbx};
