//! Files that other software wrote, and files that are broken.

mod damage;
mod kinds;
mod made;
mod masks;
mod places;
mod sidecars;
mod sidecars_damaged;
mod sidecars_numbers;
mod tiled;
mod written;

use dolomite_elevation::{Elevation, ElevationError, Options};
use std::path::{Path, PathBuf};

/// The files, with the script that made them.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files")
}

/// Reads one of them.
pub fn read(name: &str, options: &Options) -> Result<Elevation, ElevationError> {
    Elevation::read(&folder().join(name), options)
}

/// The numbers of a ground, as NumPy wrote them.
pub fn ground(name: &str) -> Vec<f32> {
    let bytes = std::fs::read(folder().join(format!("{name}.f32"))).expect("it is there");
    let (quads, _) = bytes.as_chunks::<4>();
    quads.iter().map(|b| f32::from_le_bytes(*b)).collect()
}

/// Equal to the bit; where there is no data, NaN of any kind.
pub fn same(a: &[f32], b: &[f32]) -> bool {
    let equal = |(a, b): (&f32, &f32)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    a.len() == b.len() && a.iter().zip(b).all(equal)
}
