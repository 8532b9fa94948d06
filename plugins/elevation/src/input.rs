//! What every reader of a kind is given.

use crate::error::{ElevationError, read_error};
use crate::grid::Feed;
use crate::options::Options;
use crate::sidecars::Sidecars;
use std::fs::File;
use std::io::{Cursor, Read, Seek};
use std::path::Path;

/// What is read: a file, or bytes.
pub(crate) trait Source: Read + Seek + Send {
    /// The same once more, for another thread, where that is cheap.
    fn again(&self) -> Option<Box<dyn Source>> {
        None
    }
}

impl Source for File {}
impl Source for Cursor<&[u8]> {}

impl<S: Source + ?Sized> Source for &mut S {
    fn again(&self) -> Option<Box<dyn Source>> {
        (**self).again()
    }
}

/// What every reader gets.
pub(crate) struct Input<'a> {
    /// What errors call the file.
    pub file: &'a str,
    /// Its bytes.
    pub source: &'a mut (dyn Source + 'a),
    /// How many bytes.
    pub bytes: u64,
    /// How it is read.
    pub options: &'a Options,
    /// What stands beside it and counts for it.
    pub sidecars: Sidecars,
    /// Where rows go.
    pub feed: Feed<'a>,
}

impl Input<'_> {
    /// An error of the system while reading.
    pub fn failed(&self, error: &std::io::Error) -> ElevationError {
        read_error(self.file, error)
    }
}

/// The ending of a file's name, in small letters.
pub(crate) fn ending(file: &str) -> String {
    let ending = Path::new(file).extension().unwrap_or_default();
    ending.to_string_lossy().to_lowercase()
}
