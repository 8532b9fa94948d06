//! Capsules: runs of compute passes in files, for implementations of WebGPU that know no Rust.
//!
//! A capsule holds everything that a run needs and everything that must come out of it: composed WGSL,
//! pipelines, bindings, buffers, commands in order, and what the CPU reference says the buffers hold then.
//! `dolomite_lab capsule NAME --out FILE` writes one, `web/src/capsule` plays it. The format is documented at
//! [`mod@format`], and for readers of the files in `web/CAPSULE.md`.
//!
//! | module | what |
//! |---|---|
//! | [`mod@format`] | the file: header and data |
//! | [`builder`] | puts one together |
//! | [`stage`] | the passes of the tessellation stage, recorded as an app records them |
//! | [`flat`], [`globe`] | CPU references of the control and evaluate functions that stage capsules use |
//! | [`patches`] | whole patches from their levels: captures and random tuples |
//! | [`functions`] | WGSL's own functions, one after the other |
//! | [`heights`] | heights and slopes of a terrain |
//! | [`blocks`] | the ground's choice in blocks and its answers |
//! | [`plants`] | roots on triangles |
//! | [`tiles`] | lights that reach the tiles of a picture |
//! | [`skinning`] | crowds from their palettes |
//! | [`native`] | the passes by wgpu, timed |
//! | [`list`], [`command`] | what capsules there are, and the command line |

pub mod blocks;
pub mod builder;
pub mod command;
mod field;
pub mod flat;
pub mod format;
pub mod functions;
pub mod globe;
pub mod heights;
pub mod list;
mod meshes;
pub mod native;
pub mod patches;
pub mod plants;
pub mod skinning;
pub mod stage;
pub mod tiles;

use thiserror::Error;

/// Why there is no capsule.
#[derive(Debug, Error)]
pub enum CapsuleError {
    /// A shader could not be put together.
    #[error("a shader could not be composed: {0}")]
    Shader(#[from] dolomite_shaders::ComposeError),
    /// naga does not write a module as WGSL.
    #[error("{module} could not be written as WGSL: {reason}")]
    Written {
        /// Which module.
        module: String,
        /// What naga said.
        reason: String,
    },
    /// Patches that make no tables.
    #[error("the patches need {0} bytes in one buffer, more than WebGPU promises")]
    TooLarge(u64),
    /// The adapter on which passes are timed.
    #[error(transparent)]
    Gpu(#[from] dolomite_testkit::gpu::GpuError),
    /// Random inputs of which none is decided the same by every implementation.
    #[error(
        "{name}: with the seed {seed} roundings decide in every input that was tried; take another seed (--seed)"
    )]
    Undecided {
        /// Which capsule.
        name: String,
        /// Of which seed.
        seed: u32,
    },
    /// Captures that cannot be read.
    #[error(transparent)]
    Cases(#[from] crate::studies::tessellation::cases::CaseError),
    /// A name that no capsule has.
    #[error("there is no capsule named {0}; `dolomite_lab capsule --list` names them")]
    Unknown(String),
    /// A file that is no capsule.
    #[error("not a capsule: {0}")]
    Format(String),
    /// A file.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: std::path::PathBuf,
        /// Why.
        source: std::io::Error,
    },
}
