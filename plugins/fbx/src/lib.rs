//! FBX to glTF with a stated error.

pub mod check;
mod clips;
mod convert;
mod error;
mod load;
pub mod model;
mod options;
mod read;
mod report;
mod skinning;
mod weights;
mod write;

pub use convert::{Conversion, convert};
pub use error::FbxError;
pub use options::{Limits, Options, Origin, Progress, Weights};
pub use report::{ClipReport, Lost, Report};
pub use write::{GltfFiles, Output};
