//! Files that are whole or refused: saved games and recordings of input.
//!
//! A file is `DOLOMITE`, four letters of its kind, its version and the length of its content (little-endian, 32 and
//! 64 bits), the CRC-32 of all that and of the content (ISO 3309, the polynomial of Ethernet), and the content. It is
//! written beside the old one, brought to the disk, and renamed; the one before is kept. So whenever the machine stops,
//! a whole file is there. What this program cannot judge is set aside under a name of its own: a file of another
//! version or kind, and one that cannot be read.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use thiserror::Error;

const MAGIC: &[u8; 8] = b"DOLOMITE";

/// Bytes before the content.
pub const HEAD: usize = 8 + 4 + 4 + 8 + 4;

/// Largest file that is read, bytes: some hours of recorded input.
const MOST: u64 = 256 << 20;

/// Why a file was refused.
#[derive(Debug, Error)]
pub enum SealedError {
    /// It is not there, or cannot be read.
    #[error("{}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// It cannot be written. What was there before is there still.
    #[error("{}: it cannot be written: {source}", .path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Something else.
    #[error("{}: this is no {kind} of Dolomite", .path.display())]
    Kind {
        /// The file.
        path: PathBuf,
        /// What it should be.
        kind: &'static str,
    },
    /// Of another version.
    #[error("{}: it has version {found}, and this program reads version {known}", .path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
        /// Ours.
        known: u32,
    },
    /// Cut off, or longer than it says.
    #[error("{}: it is {found} bytes long and should be {expected}", .path.display())]
    Length {
        /// The file.
        path: PathBuf,
        /// Bytes.
        found: u64,
        /// Bytes.
        expected: u64,
    },
    /// A byte is not what it was.
    #[error("{}: its checksum is wrong: the file is damaged", .path.display())]
    Checksum {
        /// The file.
        path: PathBuf,
    },
    /// The content makes no sense.
    #[error("{}: {reason}", .path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
}

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// In the file.
    pub letters: &'static [u8; 4],
    /// In messages.
    pub name: &'static str,
    /// That is written and read.
    pub version: u32,
}

/// CRC-32, a bit at a time: a saved game is a few kilobytes.
pub fn crc32(parts: &[&[u8]]) -> u32 {
    let mut crc = u32::MAX;
    for &byte in parts.iter().copied().flatten() {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            let mask = (crc & 1).wrapping_neg();
            crc = crc >> 1 ^ (0xedb8_8320 & mask);
        }
    }
    !crc
}

/// The bytes of a file.
pub fn seal(kind: Kind, content: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEAD + content.len());
    bytes.extend(MAGIC);
    bytes.extend(kind.letters);
    bytes.extend(kind.version.to_le_bytes());
    bytes.extend((content.len() as u64).to_le_bytes());
    let crc = crc32(&[&bytes, content]);
    bytes.extend(crc.to_le_bytes());
    bytes.extend(content);
    bytes
}

/// The content of a file's bytes; `path` is named in errors.
///
/// # Errors
/// [`SealedError`] for everything that is not what [`seal`] made.
pub fn open(kind: Kind, bytes: &[u8], path: &Path) -> Result<Vec<u8>, SealedError> {
    let path = || path.to_owned();
    let length = |expected| SealedError::Length {
        path: path(),
        found: bytes.len() as u64,
        expected,
    };
    // Also of a file that is shorter than a head: a cut one of ours begins as ours do.
    let begins = MAGIC.iter().chain(kind.letters);
    if bytes.iter().zip(begins).any(|(byte, ours)| byte != ours) {
        return Err(SealedError::Kind {
            path: path(),
            kind: kind.name,
        });
    }
    let head: &[u8; HEAD] = bytes.first_chunk().ok_or_else(|| length(HEAD as u64))?;
    let word = |at: usize| u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
    let found = word(12);
    if found != kind.version {
        return Err(SealedError::Version {
            path: path(),
            found,
            known: kind.version,
        });
    }
    let said = u64::from(word(16)) | u64::from(word(20)) << 32;
    let content = &bytes[HEAD..];
    if content.len() as u64 != said {
        return Err(length(said.saturating_add(HEAD as u64)));
    }
    if crc32(&[&bytes[..HEAD - 4], content]) != word(24) {
        return Err(SealedError::Checksum { path: path() });
    }
    Ok(content.to_owned())
}

fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(ending);
    path.with_file_name(name)
}

/// Where the file before this one is kept.
pub fn before(path: &Path) -> PathBuf {
    beside(path, ".before")
}

/// Where a file is written before it takes its place.
pub fn unfinished(path: &Path) -> PathBuf {
    beside(path, ".new")
}

/// Gives a file that is not ours to judge a name of its own, so that nothing is written over it.
fn set_aside(kind: Kind, path: &Path) -> io::Result<()> {
    let why = match read(kind, path) {
        Err(SealedError::Version { found, .. }) => format!("version-{found}"),
        Err(SealedError::Kind { .. }) => "other".to_owned(),
        Err(SealedError::Length { found, .. }) if found > MOST => "other".to_owned(),
        // A folder is in the way of every file.
        Err(SealedError::Read { source, .. })
            if source.kind() != io::ErrorKind::NotFound && !path.is_dir() =>
        {
            "unread".to_owned()
        }
        _ => return Ok(()),
    };
    let mut names = (0_u32..).map(|n| beside(path, &format!(".{why}.{n}")));
    match names.find(|name| !name.exists()) {
        Some(name) => fs::rename(path, name),
        None => Ok(()),
    }
}

/// Writes a file, and keeps the one before if that is whole. One of another version or kind, or that cannot be read, is
/// set aside, beside it: `game.save.version-9.0`, `game.save.other.0`, `game.save.unread.0`.
///
/// # Errors
/// [`SealedError::Write`]; what was there is there still, under its name or one of these.
pub fn write(kind: Kind, path: &Path, content: &[u8]) -> Result<(), SealedError> {
    let put = || -> io::Result<()> {
        let folder = path
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty());
        if let Some(folder) = folder {
            fs::create_dir_all(folder)?;
        }
        let new = unfinished(path);
        let mut file = File::create(&new)?;
        file.write_all(&seal(kind, content))?;
        file.sync_all()?;
        drop(file);
        set_aside(kind, path)?;
        // A damaged file never takes the place of the last whole one.
        if read(kind, path).is_ok() {
            set_aside(kind, &before(path))?;
            fs::rename(path, before(path))?;
        }
        fs::rename(&new, path)?;
        // Names are brought to the disk too, where the system can do that.
        if let Some(folder) = folder
            && let Ok(folder) = File::open(folder)
        {
            let _ = folder.sync_all();
        }
        Ok(())
    };
    put().map_err(|source| SealedError::Write {
        path: path.to_owned(),
        source,
    })
}

/// Reads a file.
///
/// # Errors
/// [`SealedError`].
pub fn read(kind: Kind, path: &Path) -> Result<Vec<u8>, SealedError> {
    let refuse = |source| SealedError::Read {
        path: path.to_owned(),
        source,
    };
    let length = fs::metadata(path).map_err(refuse)?.len();
    if length > MOST {
        return Err(SealedError::Length {
            path: path.to_owned(),
            found: length,
            expected: MOST,
        });
    }
    open(kind, &fs::read(path).map_err(refuse)?, path)
}

/// Reads a file, or the one before it where it is not whole; then also what is wrong with it.
///
/// # Errors
/// [`SealedError`] of the file where the one before it is not whole either.
pub fn read_last(kind: Kind, path: &Path) -> Result<(Vec<u8>, Option<SealedError>), SealedError> {
    match read(kind, path) {
        Ok(content) => Ok((content, None)),
        Err(error) => match read(kind, &before(path)) {
            Ok(content) => Ok((content, Some(error))),
            Err(_) => Err(error),
        },
    }
}

#[cfg(test)]
mod tests;
