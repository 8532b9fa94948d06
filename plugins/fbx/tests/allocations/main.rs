//! Tests that look at memory, as a program of their own, since its allocator counts every byte.
//! `cargo nextest run -p dolomite_fbx --test allocations` runs them.

#[path = "../all/support/binary.rs"]
mod binary;
mod broken;
mod counting;
mod memory;
#[path = "../all/support/shared.rs"]
mod support;
