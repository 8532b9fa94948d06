//! Life on the ground for Bevy: grass, flowers, kelp, trees and rocks, whose roots are a function of the place.
//!
//! ```
//! use dolomite_vegetation::{Growth, Kinds};
//! use dolomite_terrain::GroundPoint;
//!
//! let text = "(kinds: [(name: \"grass\", density: 40.0, shape: Blade((
//!     length: (0.2, 0.5), width: 0.01,
//!     look: (root: (0.05, 0.1, 0.02), tip: (0.2, 0.35, 0.05), dry: (0.4, 0.35, 0.15)))))])";
//! let kinds = Kinds::parse(text, "my.ron".as_ref())?;
//! let growth = Growth::new(&kinds.kinds[0], 1);
//! let metre = [GroundPoint::from_fixed([0; 2]), GroundPoint::from_fixed([u32::MAX.into(); 2])];
//! let cells = growth.lattice.cells(metre[0], metre[1]);
//! let roots = cells.map(|cell| growth.lattice.root(cell));
//! let standing = roots.filter(|root| growth.stands(*root, 10.0, 0.1)).count();
//! assert!((20..=64).contains(&standing));
//! # Ok::<(), dolomite_vegetation::KindError>(())
//! ```
//!
//! | part | what it does |
//! |---|---|
//! | [`place`] | candidates on a lattice: place, rank, hash, clump; integers |
//! | [`kind`], [`kind_file`], [`band`] | what grows, as data |
//! | [`density`] | how densely a kind grows at a place |
//! | [`law`] | how many are drawn at a distance, and how wide |
//! | [`blade`], [`blossom`], [`chain`] | the geometry of a blade, of the head of a flower, and of kelp |
//! | [`straight`] | what a blade of three vertices makes up for |
//! | [`colour`] | colours before light |
//! | [`wind`], [`bend`] | what moves it |
//! | [`mod@reference`], [`shade`] | what a field of blades looks like from afar: by brute force, and as a table |
//! | [`instances`] | trees and rocks around a point |
//! | `render` | all of it in the picture (feature `render`, on by default) |
//!
//! Metres, +Y up, −Z north; the ground plane is (x, z).

pub mod band;
pub mod bend;
pub mod blade;
pub mod blossom;
pub mod chain;
pub mod colour;
mod components;
pub mod density;
pub mod instances;
pub mod kind;
mod kind_error;
pub mod kind_file;
pub mod law;
pub mod place;
mod plugin;
pub mod reference;
#[cfg(feature = "render")]
pub mod render;
mod sets;
pub mod shade;
pub mod straight;
pub mod wind;

pub use band::Band;
pub use bend::{Press, Presses, PressesGrass};
pub use blade::{BladeShape, BladeVertex, Own};
pub use chain::ChainShape;
pub use components::{Vegetation, VegetationRanks, VegetationState, VegetationView};
pub use density::Growth;
pub use instances::Instance;
pub use kind::{Kind, Kinds, Shape};
pub use kind_error::KindError;
pub use law::Law;
pub use place::{Clump, Lattice, Root};
pub use plugin::VegetationPlugin;
pub use sets::VegetationSystems;
pub use wind::{Wind, WindField};
