//! Files that are read and written at a place, by several threads at once.
//!
//! Not by a memory map: where another program cuts a mapped file short, the reader of the map is ended by the system; and a map
//! would need `unsafe`. Reads at a place come from the same cache of the system, and an end that is missing is an error.

use std::fs::File;
use std::io;
use std::path::Path;
use std::time::SystemTime;

/// A file for several threads.
#[derive(Debug)]
pub(super) struct Placed {
    file: File,
    #[cfg(not(any(unix, windows)))]
    turn: std::sync::Mutex<()>,
}

/// What tells that a file has been changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stamp {
    pub bytes: u64,
    pub changed: Option<SystemTime>,
}

impl Placed {
    pub fn new(file: File) -> Self {
        Self {
            file,
            #[cfg(not(any(unix, windows)))]
            turn: std::sync::Mutex::new(()),
        }
    }

    pub fn open(path: &Path) -> io::Result<Self> {
        File::open(path).map(Self::new)
    }

    pub fn stamp(&self) -> io::Result<Stamp> {
        let data = self.file.metadata()?;
        Ok(Stamp {
            bytes: data.len(),
            changed: data.modified().ok(),
        })
    }

    pub fn set_bytes(&self, bytes: u64) -> io::Result<()> {
        self.file.set_len(bytes)
    }

    pub fn sync(&self) -> io::Result<()> {
        self.file.sync_all()
    }

    /// Fills the buffer from this byte on.
    #[cfg(unix)]
    pub fn read(&self, at: u64, buffer: &mut [u8]) -> io::Result<()> {
        std::os::unix::fs::FileExt::read_exact_at(&self.file, buffer, at)
    }

    /// Writes all bytes from this one on.
    #[cfg(unix)]
    pub fn write(&self, at: u64, bytes: &[u8]) -> io::Result<()> {
        std::os::unix::fs::FileExt::write_all_at(&self.file, bytes, at)
    }

    /// Fills the buffer from this byte on.
    #[cfg(windows)]
    pub fn read(&self, mut at: u64, mut buffer: &mut [u8]) -> io::Result<()> {
        while !buffer.is_empty() {
            let read = std::os::windows::fs::FileExt::seek_read(&self.file, buffer, at)?;
            if read == 0 {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            buffer = &mut buffer[read..];
            at += read as u64;
        }
        Ok(())
    }

    /// Writes all bytes from this one on.
    #[cfg(windows)]
    pub fn write(&self, mut at: u64, mut bytes: &[u8]) -> io::Result<()> {
        while !bytes.is_empty() {
            let written = std::os::windows::fs::FileExt::seek_write(&self.file, bytes, at)?;
            bytes = &bytes[written..];
            at += written as u64;
        }
        Ok(())
    }

    /// Fills the buffer from this byte on.
    #[cfg(not(any(unix, windows)))]
    pub fn read(&self, at: u64, buffer: &mut [u8]) -> io::Result<()> {
        use std::io::{Read, Seek, SeekFrom};
        let _turn = self.turn.lock();
        let mut file = &self.file;
        file.seek(SeekFrom::Start(at))?;
        file.read_exact(buffer)
    }

    /// Writes all bytes from this one on.
    #[cfg(not(any(unix, windows)))]
    pub fn write(&self, at: u64, bytes: &[u8]) -> io::Result<()> {
        use std::io::{Seek, SeekFrom, Write};
        let _turn = self.turn.lock();
        let mut file = &self.file;
        file.seek(SeekFrom::Start(at))?;
        file.write_all(bytes)
    }
}
