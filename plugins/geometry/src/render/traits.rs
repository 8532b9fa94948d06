//! How a producer's primitives are drawn, and how much room they get.

use bevy::mesh::PrimitiveTopology;
use bevy::prelude::*;
use bevy::shader::{Shader, ShaderDefVal};

use crate::layout::{BINDING_LIMIT, EVALUATED_BYTES, VERTEX_BYTES};

/// How a producer's primitives are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawTraits {
    /// Triangles or segments, by indices.
    pub topology: PrimitiveTopology,
    /// Whether draws evaluate vertices of three words ([`EVALUATED_BYTES`]) by the producer's function
    /// `evaluated_vertex`; else vertices are stored.
    pub evaluated: bool,
    /// Whether a second pool holds where each vertex was in the last frame.
    pub moves: bool,
    /// Whether, without a G-buffer, `material` runs at the vertices.
    pub vertex_shaded: bool,
    /// Vertices, three a triangle, that the producer's function `amplify` gives in place of a primitive; 0
    /// without one.
    pub amplified: u32,
    /// Whether back faces are drawn.
    pub double_sided: bool,
    /// Whether it is drawn into shadow maps.
    pub shadows: bool,
    /// Whether a second list of indices holds what the camera does not see
    /// ([`GeometryHead::others`](crate::layout::GeometryHead::others)), which shadow maps are drawn too.
    pub others: bool,
    /// Whether shadow views draw ranges of the primitives; see [`ShadowRanges`](super::ShadowRanges).
    pub bounded: bool,
    /// Whether `material` runs once for each pixel that is seen, in a pass over the picture, in place of in the draw: where
    /// triangles are small most of what a draw shades is thrown away. In a view with a G-buffer that draws no lines; 16 bytes
    /// a pixel, once for all producers of a view. For triangles that do not move inside, and materials that read the
    /// surface's `dx` and `dy` in place of derivatives of their own.
    pub shaded_once: bool,
    /// Greatest |u| or |v| of a vertex.
    pub uv_range: f32,
}

impl Default for DrawTraits {
    fn default() -> Self {
        Self {
            topology: PrimitiveTopology::TriangleList,
            evaluated: false,
            moves: false,
            vertex_shaded: false,
            amplified: 0,
            double_sided: false,
            shadows: true,
            others: false,
            bounded: false,
            shaded_once: false,
            uv_range: 1.0,
        }
    }
}

impl DrawTraits {
    /// Bytes of a vertex in the pool, without its place in the last frame.
    #[must_use]
    pub const fn vertex_bytes(&self) -> u64 {
        if self.evaluated {
            EVALUATED_BYTES
        } else {
            VERTEX_BYTES
        }
    }

    /// Whether a draw fetches its vertices by itself. Segments are lines already.
    #[must_use]
    pub fn fetches(&self, lines: bool) -> bool {
        self.amplified > 0 || (lines && self.topology != PrimitiveTopology::LineList)
    }
}

/// `geometry/draw.wgsl` with a producer's own functions in it.
#[derive(Clone, Debug)]
pub struct DrawShader {
    /// The entry file, as an asset.
    pub handle: Handle<Shader>,
    /// Definitions of the producer's own functions.
    pub defs: Vec<ShaderDefVal>,
}

impl DrawShader {
    /// The text of the entry file with a producer's functions in it: import paths (with `::` at their ends) of
    /// the modules with `material` and `amplify`, and WGSL with the function `evaluated_vertex`.
    #[must_use]
    pub fn source(material: Option<&str>, amplify: Option<&str>, vertex: Option<&str>) -> String {
        let mut source = dolomite_shaders::find("geometry/draw.wgsl")
            .source
            .to_owned();
        for (stand_in, given) in [
            ("dolomite::geometry::user_material::", material),
            ("dolomite::geometry::user_amplify::", amplify),
            (
                "#import dolomite::geometry::user_vertex::evaluated_vertex",
                vertex,
            ),
        ] {
            if let Some(given) = given {
                source = source.replace(stand_in, given);
            }
        }
        source
    }
}

/// Room for what one view keeps of a producer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GeometryPool {
    /// Vertices.
    pub vertices: u32,
    /// Triangles of 12 bytes, or segments of 8.
    pub primitives: u32,
}

impl GeometryPool {
    /// The same, but not more than `greatest`, and no more than can be bound; room for one of each at least.
    #[must_use]
    pub fn bounded(self, greatest: [u64; 2], vertex_bytes: u64) -> Self {
        let size = |wanted: u32, greatest: u64, bytes: u64| {
            u64::from(wanted)
                .min(greatest)
                .min(BINDING_LIMIT / bytes)
                .max(1) as u32
        };
        Self {
            vertices: size(self.vertices, greatest[0], vertex_bytes),
            primitives: size(self.primitives, greatest[1], 12),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pools_keep_to_what_can_be_filled_and_bound() {
        let pool = GeometryPool {
            vertices: u32::MAX,
            primitives: 0,
        };
        let room = pool.bounded([u64::MAX; 2], 20);
        assert_eq!((room.vertices, room.primitives), (6_710_886, 1));
        assert_eq!(pool.bounded([7, 9], 20).vertices, 7);
    }

    #[test]
    fn every_stand_in_of_the_draw_can_be_replaced() {
        let vertex = "fn evaluated_vertex() {}";
        let source = DrawShader::source(Some("a::"), Some("b::"), Some(vertex));
        assert!(!source.contains("dolomite::geometry::user_"));
        for text in ["#import a::material", "#import b::amplify", vertex] {
            assert!(source.contains(text), "{text}");
        }
    }
}
