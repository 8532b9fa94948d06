//! What was edited: steps of height on a lattice of samples, added to whatever a terrain is made of.
//!
//! height = base + edits, everywhere: [`Edits`] is the last layer of a terrain, in f64, f32 and WGSL alike
//! (`shaders/src/terrain/edits.wgsl`). Values are whole numbers of [`STEP`], so that they are exact in f32 and what is
//! taken back is back to the bit. They lie in tiles of 32 × 32 cells, kept where something was edited only, in a
//! quadtree whose nodes never change: an edit makes new tiles and the nodes above them, and shares all others with what
//! was before. So a copy costs nothing, undoing is going back to one, and what two of them differ in is found by
//! going down where they do not share. Each node knows the extremes below it (`extremes.rs`): bounds of height, slope
//! and bend come from there.

mod bounds;
mod extremes;
mod lattice;
mod layer;
mod table;
mod tile;
mod tree;

pub use lattice::EditLattice;
pub use layer::Edits;
pub use table::{EditRoom, EditTable, EditWrite};
pub use tile::{LIMIT, STEP};

pub(crate) use tile::{CELLS, SAMPLES, SIDE, Tile};
