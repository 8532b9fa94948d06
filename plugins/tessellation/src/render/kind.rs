//! What a user implements to tessellate a kind of patches.

use std::sync::Arc;

use bevy::prelude::*;
use bevy::render::render_resource::AsBindGroup;
use dolomite_geometry::render::{GeometryMaterial, GeometryPool, Viewpoint};

use crate::{Drawing, HostFunctions, Mode, PatchLayout, Spacing, Winding};

/// Where the functions of a kind stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PatchShader {
    /// In a file, by its path among the app's assets. Loaded again when it changes, if the app
    /// watches files. It has no import path of its own.
    File(&'static str),
    /// In a shader library that the app has loaded, by its import path. For kinds that come with a
    /// crate.
    Library(&'static str),
}

/// A kind of patches: its layout, its functions in WGSL, and the data that they read.
///
/// The type is a resource of the main world. Its fields are bound as [`AsBindGroup`] derives them, at
/// `@group(1)` of every shader of the kind; textures and buffers that `control` or `evaluate` read
/// need `visibility(compute, vertex, fragment)`, as they run in compute shaders.
///
/// The shader imports `dolomite::stage::api` and holds
/// ```wgsl
/// fn control(input: Patch, view: StageView) -> PatchLevels
/// fn evaluate(input: Patch, at: vec3<f32>) -> Vertex
/// ```
/// and where the constants below say so `amplify`, `material` and `bounds` too. A field of a struct must not bear
/// the name of an imported function.
pub trait PatchKind: AsBindGroup + Resource + Clone {
    /// Domain, control points, corners.
    const LAYOUT: PatchLayout;
    /// How levels become vertices along an edge. The fractional ones change without a pop.
    const SPACING: Spacing = Spacing::FractionalOdd;
    /// Orientation of the triangles in the (u, v) plane; counter-clockwise ones face the viewer where
    /// `evaluate` keeps their orientation.
    const WINDING: Winding = Winding::Ccw;
    /// How coordinates are rounded.
    const MODE: Mode = Mode::Exact;
    /// Where vertices are evaluated. Kinds with an amplify function are always stored.
    const DRAWING: Drawing = Drawing::Stored;
    /// Whether the functions read `time`. If vertices are stored, the kind is tessellated in every
    /// frame; if the draws evaluate them, only `control` may not follow the time, and nothing is
    /// dispatched for it.
    const ANIMATED: bool = false;
    /// Whether `evaluate` gives a previous position of its own: 12 bytes a vertex, for motion
    /// vectors.
    const MOVES: bool = false;
    /// Greatest |u| or |v| of a vertex; texture coordinates are stored in 1/32767 of it.
    const UV_RANGE: f32 = 1.0;
    /// Whether, in a view without G-buffer, `material` runs at the vertices (with normals of either
    /// side as they are) and colours between them are interpolated: small triangles cost less then.
    const VERTEX_SHADED: bool = false;
    /// Above 0: the shader file has a function
    /// `amplify(a, b, c: StoredVertex, number: u32) -> StoredVertex`, which gives so many vertices,
    /// three a triangle, in place of each primitive (a, b, c); for a segment c is b.
    const AMPLIFIED: u32 = 0;
    /// Whether the shader file has a function `material(surface: Surface) -> Shaded`; else
    /// [`Self::materials`] is the material.
    const CUSTOM_MATERIAL: bool = false;
    /// Whether the shader has a function `bounds(input: Patch, view: StageView) -> vec4<f32>`: a sphere
    /// in stage space, centre and radius, that holds the patch's surface. Shadow views then draw the
    /// patches alone that they may see. Not used with an amplify function.
    const BOUNDED: bool = false;
    /// Whether back faces are drawn.
    const DOUBLE_SIDED: bool = false;
    /// Whether it is drawn into shadow maps.
    const SHADOWS: bool = true;

    /// Where its functions stand.
    fn shader() -> PatchShader;

    /// Materials that vertices choose from; at most 16 count.
    fn materials(&self) -> Vec<GeometryMaterial> {
        vec![GeometryMaterial::default()]
    }

    /// Numbers that depend on the view, which `material` reads as `geometry_draw.numbers`: made anew in
    /// each frame, in f64 where it matters.
    fn view_numbers(&self, _view: &Viewpoint) -> [Vec4; 4] {
        [Vec4::ZERO; 4]
    }

    /// Control and evaluate functions in Rust that take the place of those in WGSL: the kind is then
    /// tessellated on the CPU, vertices and indices are uploaded, and nothing is dispatched. Not used
    /// by kinds with an amplify function, with `MOVES`, or whose draws evaluate.
    fn host(&self) -> Option<Arc<dyn HostFunctions>> {
        None
    }

    /// Whether levels and vertices are the same in every view: the kind is then tessellated once, not
    /// again as the camera moves (but where that is 4 km from where it was, so that positions stay
    /// exact to a quarter of a millimetre).
    fn still(&self) -> bool {
        false
    }

    /// Most that one view keeps of this kind.
    fn pool(&self) -> PatchPool {
        PatchPool::default()
    }
}

/// Room for what one view emits of one kind. Beyond it all levels are lowered evenly, and
/// [`GeometryStats`](super::GeometryStats) says so; never more room is taken than the patches can fill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PatchPool {
    /// Vertices: 20 bytes each, 32 with `MOVES`, 12 where the draws evaluate them.
    pub vertices: u32,
    /// Triangles of 12 bytes, or segments of 8.
    pub primitives: u32,
}

impl PatchPool {
    /// The greatest pool that fits into so many bytes, two primitives a vertex.
    #[must_use]
    pub const fn bytes(bytes: u32) -> Self {
        // 20 for a vertex and 24 for two triangles.
        let vertices = bytes / 44;
        Self {
            vertices,
            primitives: 2 * vertices,
        }
    }
}

impl Default for PatchPool {
    /// 23 MB: half a million vertices, a million triangles.
    fn default() -> Self {
        Self {
            vertices: 1 << 19,
            primitives: 1 << 20,
        }
    }
}

impl From<PatchPool> for GeometryPool {
    fn from(pool: PatchPool) -> Self {
        Self {
            vertices: pool.vertices,
            primitives: pool.primitives,
        }
    }
}
