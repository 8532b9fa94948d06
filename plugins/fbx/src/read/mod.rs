//! From ufbx's scene to [`Model`]: everything but the clips.

pub(crate) mod convert;
pub(crate) mod devices;
mod lost;
mod materials;
mod mesh;
mod nodes;
pub(crate) mod shapes;
mod skin;
mod tangents;
pub(crate) mod textures;

pub(crate) use lost::report_lost;
pub(crate) use materials::read_materials;
pub(crate) use mesh::Meshes;
pub(crate) use nodes::{read_nodes, rest_of};
pub(crate) use shapes::{ShapeKey, Shapes};
pub(crate) use skin::{Influence, SkinSource, read_skin};
