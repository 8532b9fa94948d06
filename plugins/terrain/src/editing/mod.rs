//! Editing: brushes, undo and files for the layer of [`crate::edits`]. No renderer, no system: whoever has a
//! [`TerrainEdits`] beside its [`Terrain`](crate::Terrain) calls it.

mod brush;
mod error;
mod file;
mod history;

pub use brush::{Edit, EditKind, Edited, MAX_SAMPLES, MAX_TILES, edit, lattice_of};
pub use error::{EditError, EditFileError};
pub use file::{FILE_NAME, load, save};
pub use history::TerrainEdits;
