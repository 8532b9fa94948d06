//! FBX to glTF with a stated error.
//!
//! Reads binary and ASCII FBX of version 3000 to 7700 (through [ufbx](https://github.com/ufbx/ufbx)) and
//! writes .glb, or .gltf with files: nodes, meshes, materials and pictures, skins, blend shapes, clips,
//! lights and cameras. Each result says how far it is from the file and what of the file it cannot hold.
//!
//! ```
//! use dolomite_fbx::{Options, Origin, convert};
//!
//! # fn example() -> Result<(), dolomite_fbx::FbxError> {
//! let bytes = std::fs::read("hero.fbx").expect("there is a hero");
//! let origin = Origin { name: "hero.fbx".into(), folder: Some(".".into()), ..Origin::default() };
//! let made = convert(&bytes, &origin, &Options { max_error: 1e-4, ..Options::default() })?;
//! println!("{:.1e} m, {} of {} keys", made.report.error(), made.report.keys(), made.report.baked());
//! made.write("hero.glb".as_ref())?;
//! # Ok(())
//! # }
//! ```
//!
//! With the feature `bevy` (a default) `FbxPlugin` lets a Bevy app `load("hero.fbx")`. Without it nothing
//! of Bevy is compiled.
//!
//! # How exact
//!
//! **Places.** Everything is computed in f64 and rounded to f32 once. The file's axes become Y up, its unit
//! the metre, in the geometry and not by a scale on the root. Helper nodes stand in where glTF cannot say
//! it: `NAME.geometry` for transforms that children do not inherit and for meshes so far from their origin
//! that f32 would spoil them, `NAME.scale` for the two modes in which FBX inherits scale otherwise. Skinned meshes stand beside the tree, as glTF wants them.
//!
//! **Keys.** Every stack is a clip that begins at 0; the file's own time is kept in its `extras`. Clips are
//! looked at on every key and wherever they bend between keys, and the fewest keys are taken, as steps, lines
//! or cubics, that keep the skin within `max_error` of that: in the world, 3 cm around each joint, or out to
//! the farthest vertex that follows it, with what all joints above do wrong. The error in the report
//! is bounded afterwards at all times, by playing the keys against the file's own curves at times that were not looked at
//! before. Where a file has a key in every frame, what its three angles do within a frame is not followed,
//! but for nodes that spin, unless asked for ([`Options::within_frames`]); [`ClipReport::error`] counts it all
//! the same, [`ClipReport::keyed_error`] does not and is what is held to the bound. By
//! default channels are looked at one by one, as fast as the file is read; [`Effort::Thorough`] takes all
//! of a clip together and its time, for fewer bytes.
//!
//! **Weights.** Vertices that follow more than four joints get the four, and the weights, that come
//! nearest to what all of them do over the clips; or up to eight.
//!
//! **Blend shapes.** In-betweens are morph targets of their own, whose weights bend where the file's
//! channel passes them.
//!
//! **Looks.** Opacity is that of the material's own model, emission above one is
//! `KHR_materials_emissive_strength`, each texture is laid on as the file says (`KHR_texture_transform`), and
//! UV sets are found by name in each mesh. PNG and JPEG are kept as they are, TGA and BMP become PNG.
//!
//! **What users say.** Properties that users gave to nodes, meshes, materials, lights and cameras are
//! `extras`. Nodes that are hidden have KHR_node_visibility. Names that are not UTF-8 keep their bytes, as
//! `\xHH`, and the second clip of a name is called `NAME.2`.
//!
//! What is lost (dual quaternions, constraints, caches, keyed visibility and other keyed properties, ...)
//! is listed in [`Report::lost`], with metres where it moves vertices.
//!
//! # How few bytes
//!
//! With [`Compression::Meshopt`] meshes and clips are written under `EXT_meshopt_compression`, for readers that
//! know it (three.js and Babylon.js do, Bevy's loader does not). Values are rounded for its codec before the
//! error is measured, and what is written comes back bit for bit: the stated error is that of the decoded
//! numbers. Whatever would be no smaller for it is written plainly, view by view, and so is a whole file
//! ([`Report::plain_is_smaller`]).
//!
//! # How safe
//!
//! Nothing in a file makes it panic. Memory and work have [`Limits`], which follow what a file unpacks to,
//! not what it claims; other files are read only below the folders that [`Origin`] names, and links do not
//! lead out of them.
//!
//! | module | what |
//! |---|---|
//! | [`model`] | what lies between FBX and glTF: plain data |
//! | [`check`] | a result read back, played on the CPU in f64 and held against the file |

pub mod check;
mod clips;
mod codec;
mod conversion;
mod convert;
mod curves;
mod error;
mod load;
mod mesh_rounding;
pub mod model;
mod options;
#[cfg(feature = "bevy")]
mod plugin;
mod position_error;
mod read;
mod report;
mod skinning;
mod smaller;
mod syntax;
mod verify;
mod weight_error;
mod weight_groups;
mod weights;
mod write;

pub use conversion::Conversion;
pub use convert::convert;
pub use error::FbxError;
pub use options::{Compression, Effort, Limits, Options, Origin, Progress, Weights};
#[cfg(feature = "bevy")]
pub use plugin::{FbxConversion, FbxLoader, FbxLoaderError, FbxLoaderSettings, FbxPlugin};
pub use report::{ClipReport, Lost, Report};
pub use write::{GltfFiles, Output};
