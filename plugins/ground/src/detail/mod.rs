//! Level of detail of the ground: how much geometry, where, for whom.
//!
//! The ground is refined by **longest edge bisection** over a quadtree of square cells. A cell is two
//! triangles; its **centre** vertex cuts their common diagonal and makes four; the **mid** vertex of a
//! side cuts the two triangles that meet there; with the centre and both of its mids a quarter of the
//! cell can become a cell of its own. Every vertex stands on a fixed lattice, so that heights and errors
//! are made once and kept.
//!
//! Each vertex has a **normalized screen-space error**, or error ratio: by how much the surface that is
//! drawn without it, or without any vertex that needs it, misses the metric's tolerance (1: just reached).
//! Error ratios are raised so that a vertex
//! never asks for more than those that it needs; hence the vertices above any threshold make a mesh
//! without gaps (as P. Lindstrom and V. Pascucci 2002 have it by nested spheres; here the maximum is
//! taken in the picture, for this view alone). Nothing else decides: the choice depends on view, ground and
//! settings, never on what was drawn before.
//!
//! A vertex whose error ratio is 1 or more stands on the ground. At [`APPEARS`] it lies in the triangle that
//! it cuts; between the two it moves vertically in proportion, so that nothing pops.
//!
//! | part | what it does |
//! |---|---|
//! | [`budget`] | holds a time by the tolerance |
//! | [`settings`] | metrics and their knobs |
//! | [`lattice`] | places, cells and their neighbours, in integers |
//! | [`aligned`] | a lattice on the samples of a height map |
//! | [`mod@cell`] | heights and error bounds of a cell, from a few samples |
//! | [`ground`] | a ground on its lattice |
//! | [`errors`] | how far the meshes of a cell are from its samples |
//! | [`view`] | what a vertical metre is in pixels, at most |
//! | `select` | which vertices a view gets |
//! | `mesh` | their heights, and the triangles |
//! | `cull` | which of these a view shows nothing of |
//! | `horizon` | which of these other ground hides |
//! | [`layout`] | the same on the GPU: records and passes |
//! | [`work`] | what a view asks for at every tolerance: the work curve of its budget |
//! | [`probe`] | the triangle under a place: height queries |
//!
//! What only the passes, their tests and studies use is not in the pages: `select`, `mesh`, `cull`, `horizon`.

pub mod aligned;
pub mod budget;
pub mod cell;
#[doc(hidden)]
pub mod cull;
pub mod errors;
pub mod ground;
#[doc(hidden)]
pub mod horizon;
pub mod lattice;
pub mod layout;
#[doc(hidden)]
pub mod mesh;
#[cfg(test)]
mod near;
pub mod probe;
#[doc(hidden)]
pub mod select;
pub mod settings;
pub mod view;
pub mod work;

pub use cell::{Cell, DetailCells};
#[doc(hidden)]
pub use cull::CullView;
pub use ground::DetailGround;
#[doc(hidden)]
pub use horizon::{Horizon, HorizonView};
pub use lattice::{CellPlace, DetailLattice};
#[doc(hidden)]
pub use mesh::{DetailMesh, DetailVertex};
pub use probe::DrawnProbes;
#[doc(hidden)]
pub use select::{Selection, select};
pub use settings::{Choice, MakingBudget, Metric, TerrainLod};
pub use view::{DetailView, Lens};

/// The error ratio at which a vertex appears, still in the plane of the triangle that it cuts; at 1 it has
/// reached the ground. Nearer 1 fewer vertices stand between, and each moves faster: the error of what
/// is drawn is that of a tolerance between this share of the asked one and all of it, while a vertex
/// crosses its way as the eye comes nearer by a quarter of the distance. The lab's study `lod` shows both.
pub const APPEARS: f32 = 0.75;
