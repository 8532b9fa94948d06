//! The level of detail in blocks on the GPU: what [`crate::blocks`] does, in compute passes.

pub mod record;
