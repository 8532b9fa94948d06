//! From ufbx's scene to [`Model`]: everything but the clips.

pub(crate) mod convert;
pub(crate) mod devices;
mod finder;
mod frame;
pub(crate) mod keyed;
mod lost;
mod materials;
mod mesh;
pub(crate) mod names;
mod nodes;
mod normals;
mod opacity;
mod packing;
pub(crate) mod pictures;
pub(crate) mod place;
pub(crate) mod shapes;
mod skin;
mod tangents;
mod text;
pub(crate) mod textures;
mod tga;
mod unsaid;
pub(crate) mod user;
mod uv_sets;
mod uv_transform;
pub(crate) mod visibility;

pub(crate) use lost::report_lost;
pub(crate) use materials::read_materials;
pub(crate) use mesh::Meshes;
pub(crate) use nodes::{read_nodes, rest_of};
pub(crate) use shapes::{ShapeKey, Shapes};
pub(crate) use skin::{Influence, SkinSource, read_skin};
pub(crate) use uv_sets::UvOrder;
