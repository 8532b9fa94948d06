//! Tests of the shell scripts under `scripts/` on systems that this machine is not: one without the libraries,
//! one whose `apt-get` fails, one of another family.
//!
//! All of it is in `tests/`; this crate has no dependencies, so that its tests are there in seconds.
