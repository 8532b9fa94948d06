//! Random FBX files and what they mean, to hold the stated error of `dolomite_fbx` against.
//!
//! ```text
//! seed -> generate -> Scene -> file::document -> bytes -> dolomite_fbx -> .glb + report
//!                       |                                                  |
//!                       +-> truth (f64) ------------- hold ---------------- play (f64)
//! ```
//!
//! The truth is computed from the description and not from the file, so that reading is checked too. What fails is made
//! small ([`shrink`]) and written down as text. [`run`](mod@run) does so for thousands of seeds; the test `random` for a thousand,
//! `./scripts/soak fbx` for a million.
//!
//! | module | what |
//! |---|---|
//! | [`scene`] | what a file says: plain data |
//! | [`generate`](mod@generate) | a random one for each seed |
//! | [`file`](mod@file) | FBX as text and as bytes |
//! | [`truth`] | what it means, from the format's definition |
//! | [`play`] | a .glb played |
//! | [`hold`](mod@hold) | the property |
//! | [`looks`] | the property for materials, cameras, lights and what is lost |
//! | [`shrink`](mod@shrink) | small failures |
//! | [`run`](mod@run) | many files |
//! | [`total`] | more, in pieces that can be ended between |

#![expect(clippy::disallowed_methods, reason = "f64 oracles of tests")]

pub mod beside;
pub mod field;
pub mod file;
pub mod generate;
pub mod hold;
pub mod looks;
pub mod play;
pub mod random;
pub mod run;
pub mod scene;
pub mod shrink;
pub mod total;
pub mod truth;

pub use beside::beside;
pub use generate::generate;
pub use hold::{Failure, Seen, hold};
pub use run::{Outcome, run, run_by};
pub use scene::Scene;
pub use total::{Total, run_in_pieces};
