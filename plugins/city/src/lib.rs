//! Cities for Bevy from a seed and a rule file: streets, blocks, roofs, hedges and lamps, displaced without a crack.
//!
//! ```
//! use dolomite_city::{Block, CityRules};
//!
//! let rules = CityRules::default();
//! let block = Block::new(&rules, [3, -7]);
//! assert!(block.buildings(&rules).all(|building| building.top > 6.0));
//! ```
//!
//! | part | what it does |
//! |---|---|
//! | [`hash`] | random numbers by place |
//! | [`rules`] | the rule file |
//! | [`streets`] | which part of the ground is street, crossing or lawn |
//! | [`lamp`], [`block`] | what stands in a cell of the grid, as records |
//! | [`windows`] | which windows are lit at an hour |
//! | [`part`] | records of many cells, by any number of threads |
//! | [`around`] | what comes and goes around an eye |
//! | [`map`], [`maps`] | displacement maps, their bounds, those that come with the crate |
//! | [`relief`] | displacement of a patch, which fades to nothing at borders |
//! | [`faces`] | the patches of a block |
//! | [`bounds`] | boxes that hold them, triangles |
//! | [`levels`] | levels of detail, by distance or by a bound of the error |
//! | [`tube`] | posts and globes of lamps |
//! | `render` | all of it in the picture (feature `render`, on by default) |
//!
//! Metres, +Y up, −Z north. A record depends on the rules and its cell alone: the same bits in any order and for any
//! number of threads.

pub mod around;
pub mod block;
pub mod bounds;
mod components;
pub mod faces;
pub mod hash;
pub mod lamp;
pub mod levels;
pub mod map;
pub mod maps;
pub mod part;
mod plugin;
pub mod relief;
#[cfg(feature = "render")]
pub mod render;
pub mod rules;
mod rules_error;
mod sets;
pub mod streets;
pub mod surface;
pub mod tube;
pub mod windows;

pub use around::{Around, Change};
pub use block::{Block, Building, Hedge};
pub use bounds::{CityBox, triangles};
pub use components::{City, CityBlocks, CityView};
pub use faces::Faces;
pub use lamp::Lamp;
pub use levels::{CityDetail, Classic, ErrorBound};
pub use map::{DisplacementMap, MapError};
pub use part::{Cells, CityPart};
pub use plugin::CityPlugin;
pub use relief::{CityPatch, PatchData};
pub use rules::CityRules;
pub use rules_error::RulesError;
pub use sets::CitySystems;
pub use surface::Surface;
