//! Tests of the conversion, as one program, since each more would link Bevy once more.
//! `cargo nextest run -p dolomite_fbx NAME::` runs one module.

mod cameras;
mod carried;
#[cfg(feature = "meshopt")]
mod compress;
mod counted;
mod effort;
mod far;
mod inherit;
mod layers;
mod lights;
#[cfg(feature = "bevy")]
mod loader;
mod looks;
mod materials;
#[cfg(feature = "meshopt")]
mod never_larger;
mod own;
mod pictures;
mod reference;
mod smoothing;
mod support;
mod takes;
mod validator;
mod visibility;
