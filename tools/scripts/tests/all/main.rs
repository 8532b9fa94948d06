//! The scripts under `scripts/`, each on systems that are made for the test.

mod soak;
mod support;
mod system;
