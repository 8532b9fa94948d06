//! Why nothing came out. Every refusal names the file and says what to do.

use std::path::PathBuf;

/// Why a file was not converted.
#[derive(Debug, thiserror::Error)]
pub enum FbxError {
    /// The file could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file could not be written.
    #[error("{}: {source}; choose another place to write to", path.display())]
    Write {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The file is no FBX file: its first bytes are those of something else.
    #[error("{file}: no FBX file; give a binary or ASCII FBX file of version 3000 to 7700")]
    NotFbx {
        /// Name of the file.
        file: String,
    },
    /// The version of the format is not one that can be read.
    #[error("{file}: {detail}; save it again as FBX 7.4 or 7.5")]
    Version {
        /// Name of the file.
        file: String,
        /// The version found.
        detail: String,
    },
    /// The file ends too early, or its contents contradict themselves.
    #[error("{file}: broken: {detail}; export it again")]
    Broken {
        /// Name of the file.
        file: String,
        /// What is wrong, and where.
        detail: String,
    },
    /// The contents need more memory than [`Limits`](crate::Limits) allow.
    #[error(
        "{file}: {what} need more than {limit} bytes; raise the limit on memory (--max-memory, max_memory) if you trust it"
    )]
    Memory {
        /// Name of the file.
        file: String,
        /// What needs it.
        what: &'static str,
        /// The limit, bytes.
        limit: usize,
    },
    /// The contents need more work than [`Limits`](crate::Limits) allow.
    #[error(
        "{file}: {what} need more work than {limit} poses; raise the limit on work if you trust it"
    )]
    Work {
        /// Name of the file.
        file: String,
        /// What needs it.
        what: &'static str,
        /// The limit, in poses of nodes.
        limit: u64,
    },
    /// There is nothing in it that glTF could hold.
    #[error("{file}: holds no node; there is nothing to convert")]
    Empty {
        /// Name of the file.
        file: String,
    },
    /// An option has a value that makes no sense.
    #[error("{option}: {value} is out of range; give {range}")]
    Option {
        /// Which.
        option: &'static str,
        /// Its value.
        value: String,
        /// What is allowed.
        range: &'static str,
    },
    /// The result does not fit the container: a .glb holds less than 4 GiB.
    #[error("{file}: {bytes} bytes do not fit a .glb; write a .gltf with files")]
    TooLarge {
        /// Name of the file.
        file: String,
        /// How many came out.
        bytes: u64,
    },
}
