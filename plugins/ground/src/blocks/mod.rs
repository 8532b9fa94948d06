//! Level of detail of the ground in blocks.
//!
//! The vertex stays the unit of triangles, the **block** of 16 × 16 cells becomes the unit of memory, of
//! dispatch and of culling. Each vertex keeps an error and an interval of heights that hold for all that needs
//! it; then a vertex is there if its error in the picture exceeds [`record::WINDOW`] of the tolerance: a
//! function of the vertex and the view alone. No neighbour is asked, and nothing is passed up (P. Lindstrom, V.
//! Pascucci 2002, with boxes of an interval in place of spheres).
//!
//! What is asked of it, and on which lattice it stands, is in [`detail`](crate::detail). What is here is the reference of the
//! passes in `shaders/src/blocks`, which [`layout`] lists.
//!
//! | part | what it does |
//! |---|---|
//! | [`layout`] | the same on the GPU: buffers and passes |
//! | [`place`] | blocks, their vertices and what these need, in integers |
//! | [`record`] | what is kept of a block, and in which order it is computed |
//! | [`between`] | what the ground may do between samples |
//! | [`triangle`] | how far a triangle is from the samples |
//! | [`errors`] | that of vertices, nested |
//! | [`mod@make`] | a block from its samples and its parent |
//! | [`gate`] | which can be made of a map that is read by tiles |
//! | [`kept`] | the blocks of a terrain |
//! | [`changed`] | which of them are reached where the ground changed |
//! | [`others`] | what follows for the quarters of one that has become another |
//! | [`remade`] | blocks of ground that changed, made anew in their slots |
//! | [`ratio`] | errors in a view |
//! | [`mod@choose`] | which blocks a view draws, how coarsely, and what it wants |
//! | [`leaves`] | which vertices of a block are there, and its triangles |
//! | [`mod@mesh`] | where they stand: the mesh of a view |
//! | [`mod@locate`] | the triangle under a place: height queries |

pub mod between;
pub mod changed;
pub mod choose;
pub mod errors;
pub mod gate;
pub mod kept;
pub mod layout;
pub mod leaves;
pub mod locate;
pub mod make;
pub mod mesh;
pub mod others;
pub mod place;
pub mod ratio;
pub mod record;
pub mod remade;
pub mod triangle;

#[cfg(test)]
pub(crate) mod tests;
