//! What the ground is made of, as data: layers of materials, each with the bands in which it lies.
//!
//! | part | what it holds |
//! |---|---|
//! | [`GroundMaterial`] | the layers of a terrain, from the uppermost to the lowest |
//! | [`Band`] | where a layer lies, by height, slope or the distance to the sea |
//! | [`MaterialBands`] | six numbers that stand for the usual five layers |
//! | [`GroundShading`] | how much is done for a pixel |
//! | [`Sea`] | how the water looks |
//! | [`GroundCanopy`] | what grows, from afar |

mod bands;
mod canopy;
mod layer;
mod sea;
mod shading;

pub use bands::MaterialBands;
pub use canopy::{Canopy, CanopyLayer, GroundCanopy};
pub use layer::{Band, GroundLayer, GroundMaterial, Measure, Surface};
pub use sea::Sea;
pub use shading::GroundShading;
