//! The ground as a kind of patches of the [stage](dolomite_tessellation): a quadtree around the focus, whose
//! leaves are refined where the view asks for it.
//!
//! | part | what it does |
//! |---|---|
//! | [`lattice`] | the quadtree: stateless, balanced |
//! | [`patches`] | its leaves as quads, of which a side may be split between two finer neighbours |
//! | [`functions`] | levels and vertices of a patch, in Rust |

pub mod functions;
pub mod lattice;
pub mod patches;
mod plugin;
mod settings;

pub use patches::{GROUND_LAYOUT, GroundPatches};
pub(crate) use plugin::{PatchBounds, update_covers};
pub use plugin::{TerrainCover, TerrainCoverSystems};
pub use settings::{PatchDetail, TerrainView};
