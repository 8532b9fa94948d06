//! .glb, and .gltf with files.

use super::document::{Pictures, document};
use crate::conversion::Conversion;
use crate::error::FbxError;
use std::path::{Path, PathBuf};

/// A .gltf document and the files that it refers to, by name.
#[derive(Debug, Clone, PartialEq)]
pub struct GltfFiles {
    /// The JSON text.
    pub json: Vec<u8>,
    /// Names and contents: the buffer, then pictures.
    pub files: Vec<(String, Vec<u8>)>,
}

/// What was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Output {
    /// The files, the document first.
    pub files: Vec<PathBuf>,
    /// Their bytes together.
    pub bytes: u64,
}

impl Conversion {
    /// The result as one .glb file: the same bytes for the same input and options.
    ///
    /// # Errors
    /// [`FbxError::TooLarge`] from 4 GiB on.
    pub fn to_glb(&self) -> Result<Vec<u8>, FbxError> {
        let made = document(&self.model, &Pictures::Inside, self.report.compression);
        let (mut json, buffer) = (made.text(), made.bytes);
        json.resize(json.len().next_multiple_of(4), b' ');
        let chunks = match buffer.is_empty() {
            true => 1,
            false => 2,
        };
        let total = 12 + 8 * chunks + json.len() + buffer.len();
        let Ok(length) = u32::try_from(total) else {
            return Err(FbxError::TooLarge {
                file: String::new(),
                bytes: total as u64,
            });
        };
        let mut out = Vec::with_capacity(total);
        let word = |out: &mut Vec<u8>, word: u32| out.extend(word.to_le_bytes());
        out.extend(b"glTF");
        word(&mut out, 2);
        word(&mut out, length);
        word(&mut out, json.len() as u32);
        out.extend(b"JSON");
        out.extend(json);
        if !buffer.is_empty() {
            word(&mut out, buffer.len() as u32);
            out.extend(b"BIN\0");
            out.extend(buffer);
        }
        Ok(out)
    }

    /// The result as a .gltf document and files beside it, whose names begin with `stem`.
    pub fn to_gltf(&self, stem: &str) -> GltfFiles {
        let names: Vec<String> = self
            .model
            .images
            .iter()
            .enumerate()
            .map(|(number, image)| {
                let ending = if image.mime == "image/png" {
                    "png"
                } else {
                    "jpg"
                };
                format!("{}_{number}.{ending}", plain(stem))
            })
            .collect();
        let bin = format!("{}.bin", plain(stem));
        let pictures = Pictures::Files {
            names: &names,
            buffer: &bin,
        };
        let made = document(&self.model, &pictures, self.report.compression);
        let json = made.text();
        let mut files = Vec::new();
        if !made.bytes.is_empty() {
            files.push((bin, made.bytes));
        }
        let pictures = self.model.images.iter().map(|image| image.bytes.clone());
        files.extend(names.into_iter().zip(pictures));
        GltfFiles { json, files }
    }

    /// Writes to `path`: a .gltf with files where it ends so, else a .glb.
    ///
    /// # Errors
    /// [`FbxError::Write`] and [`FbxError::TooLarge`].
    pub fn write(&self, path: &Path) -> Result<Output, FbxError> {
        let mut output = Output {
            files: Vec::new(),
            bytes: 0,
        };
        let mut write = |path: PathBuf, bytes: &[u8]| {
            output.bytes += bytes.len() as u64;
            std::fs::write(&path, bytes).map_err(|source| FbxError::Write {
                path: path.clone(),
                source,
            })?;
            output.files.push(path);
            Ok(())
        };
        if path
            .extension()
            .is_some_and(|ending| ending.eq_ignore_ascii_case("gltf"))
        {
            let stem = path
                .file_stem()
                .map_or("model".into(), |stem| stem.to_string_lossy());
            let made = self.to_gltf(&stem);
            write(path.to_owned(), &made.json)?;
            for (name, bytes) in &made.files {
                write(path.with_file_name(name), bytes)?;
            }
        } else {
            let glb = self.to_glb().map_err(|error| match error {
                FbxError::TooLarge { bytes, .. } => FbxError::TooLarge {
                    file: path.display().to_string(),
                    bytes,
                },
                other => other,
            })?;
            write(path.to_owned(), &glb)?;
        }
        Ok(output)
    }
}

/// A name that needs no escape in a URI.
fn plain(stem: &str) -> String {
    let fit = |c: char| {
        if c.is_ascii_alphanumeric() || "-_.".contains(c) {
            c
        } else {
            '_'
        }
    };
    stem.chars().map(fit).collect()
}
