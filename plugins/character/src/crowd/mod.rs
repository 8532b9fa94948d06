//! Crowds: figures that repeat baked clips, skinned on the GPU from a palette of matrices.
//!
//! A [`Palette`] holds, for each frame of each baked clip, the matrix of every joint of a skin. It is
//! uploaded once. A figure of the crowd is 16 bytes ([`CrowdFigure`]): where it stands, how it is turned,
//! which frame it shows and how far it is on the way to the next one. Nothing else is uploaded for it.
//! [`skin`] is the CPU reference of the shaders in `dolomite_shaders`, folder `character`.

pub mod figure;
mod palette;
pub mod skin;

pub use figure::CrowdFigure;
pub use palette::{Palette, PaletteClip, PaletteError, PaletteFrame};
