//! Holding a result against the file that it came from, without anything that made it.
//!
//! [`Played`] reads the bytes of a .glb by the crate `gltf` and plays, morphs and skins on the CPU in
//! f64, as glTF's specification says, after taking it out of `EXT_meshopt_compression` where it is in it. [`Truth`] reads the FBX file in its own axes and unit and lets
//! ufbx deform it. [`Space`] goes from one to the other.

mod apart;
mod distance;
mod frames;
mod played;
mod truth;
mod unpack;

pub use distance::{hausdorff, vertex_error};
pub use frames::{CheckError, FileCheck, Frame, box_size, check_file, read_frames, read_obj};
pub use played::{Played, PlayedError, Shape};
pub use truth::{Body, Space, Truth};
