//! What is asked of the drawn ground, by whom, and where its vertices stand; [`blocks`](crate::blocks) chooses it.
//!
//! The ground is refined by **longest edge bisection** over a quadtree of square cells. A cell is two
//! triangles; its **centre** vertex cuts their common diagonal and makes four; the **mid** vertex of a
//! side cuts the two triangles that meet there; with the centre and both of its mids a quarter of the
//! cell can become a cell of its own. Every vertex stands on a fixed lattice, so that heights and errors
//! are made once and kept.
//!
//! Each vertex has a **normalized screen-space error**, or error ratio: by how much the surface that is
//! drawn without it, or without any vertex that needs it, misses the metric's tolerance (1: just reached).
//! A vertex never asks for more than those that it needs; hence the vertices above any threshold make a mesh
//! without gaps (P. Lindstrom and V. Pascucci 2002). Nothing else decides: the choice depends on view, ground and
//! settings, never on what was drawn before.
//!
//! | part | what it does |
//! |---|---|
//! | [`budget`] | holds a time by the tolerance |
//! | [`settings`] | metrics and their knobs |
//! | [`lattice`] | places, cells and their neighbours, in integers |
//! | [`aligned`] | a lattice on the samples of a height map |
//! | [`ground`] | a terrain on its lattice |
//! | [`view`] | what a vertical metre is in pixels, at most |
//! | `cull` | which triangles a view shows nothing of |
//! | `horizon` | how a view looks for those that other ground hides |
//! | [`layout`] | what the passes are told of all this |
//! | [`work`] | what a view asks for at every tolerance: the work curve of its budget |
//! | [`probe`] | which height queries are answered from what is drawn |
//!
//! What only the passes, their tests and studies use is not in the pages: `cull`, `horizon`.

pub mod aligned;
pub mod budget;
#[doc(hidden)]
pub mod cull;
pub mod ground;
#[doc(hidden)]
pub mod horizon;
pub mod lattice;
pub mod layout;
pub mod probe;
pub mod settings;
pub mod view;
pub mod work;

#[doc(hidden)]
pub use cull::CullView;
pub use ground::DetailGround;
#[doc(hidden)]
pub use horizon::HorizonView;
pub use lattice::{CellPlace, DetailLattice};
pub use probe::DrawnProbes;
pub use settings::{MakingBudget, Metric, TerrainLod};
pub use view::{DetailView, Lens};
