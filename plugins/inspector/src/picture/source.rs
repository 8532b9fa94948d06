//! What a picture reads, and in which ways it is made.

use bevy::ecs::entity::Entity;
use bevy::ecs::world::{EntityRef, World};
use bevy::math::UVec4;
use bevy::render::render_resource::binding_types::{
    storage_buffer_read_only, texture_2d, texture_2d_multisampled, texture_depth_2d,
    texture_depth_2d_multisampled,
};
use bevy::render::render_resource::{
    BindGroupLayoutEntryBuilder, BindingType, Buffer, IntoBindGroupLayoutEntryBuilder, ShaderType,
    TextureSampleType, TextureView, TextureViewDimension,
};

/// A picture that may be shown in place of the frame.
#[derive(Clone, Debug)]
pub struct Picture {
    /// What it is called in the console.
    pub name: &'static str,
    /// What it shows.
    pub about: &'static str,
    /// How it is made: the first whose source a view has.
    pub ways: Vec<Way>,
}

impl Picture {
    /// A picture that is made in one way.
    #[must_use]
    pub fn new(name: &'static str, about: &'static str, way: Way) -> Self {
        Self {
            name,
            about,
            ways: vec![way],
        }
    }
}

/// A way to make a picture.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// What is read.
    pub source: Source,
    /// The definition by which `shaders/src/inspector/picture.wgsl` shows it.
    pub define: &'static str,
}

/// What is read.
#[derive(Clone, Copy, Debug)]
pub enum Source {
    /// Bevy's deferred target, `DeferredPrepass`.
    Words,
    /// Depth, `DepthPrepass`.
    Depth,
    /// Normals of the `NormalPrepass`.
    Normals,
    /// Motion vectors, `MotionVectorPrepass`.
    Motion,
    /// Floats of a texture of the view's entity in the render world.
    Texture(fn(EntityRef) -> Option<TextureView>),
    /// All layers of a depth texture, and what became of them in this frame, by the render world and the view.
    Layers(
        fn(EntityRef) -> Option<TextureView>,
        fn(&World, Entity) -> Marks,
    ),
    /// Words of a buffer.
    Buffer(fn(EntityRef) -> Option<Buffer>),
}

/// What became of the layers of a texture in a frame: a bit each of the first 256.
#[derive(ShaderType, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Marks {
    drawn: [UVec4; 2],
    kept: [UVec4; 2],
}

impl Marks {
    /// Layers that have a bit.
    pub const LAYERS: u32 = 256;

    /// The layer was drawn in this frame.
    pub fn drawn(&mut self, layer: u32) {
        set(&mut self.drawn, layer);
    }

    /// It holds what an earlier frame drew.
    pub fn kept(&mut self, layer: u32) {
        set(&mut self.kept, layer);
    }
}

/// Layers beyond the last bit have none.
fn set(bits: &mut [UVec4; 2], layer: u32) {
    if layer < Marks::LAYERS {
        let word = (layer / 32) as usize;
        bits[word / 4][word % 4] |= 1 << (layer % 32);
    }
}

/// What was found of a source in a view.
#[derive(Clone)]
pub(super) enum Found {
    /// A texture.
    Texture(TextureView),
    /// A buffer.
    Buffer(Buffer),
}

impl Source {
    /// The definition by which the shader binds it.
    #[must_use]
    pub const fn define(&self) -> &'static str {
        match self {
            Self::Words => "WORDS",
            Self::Depth => "DEPTHS",
            Self::Normals | Self::Motion | Self::Texture(_) => "NUMBERS",
            Self::Layers(..) => "LAYERS",
            Self::Buffer(_) => "COUNTS",
        }
    }

    /// Whether a camera of several samples a pixel has it with as many.
    #[must_use]
    pub const fn follows_samples(&self) -> bool {
        matches!(self, Self::Depth | Self::Normals | Self::Motion)
    }

    pub(super) fn layout(&self, many_samples: bool) -> BindGroupLayoutEntryBuilder {
        let floats = TextureSampleType::Float { filterable: false };
        match (self, many_samples) {
            (Self::Words, _) => texture_2d(TextureSampleType::Uint),
            (Self::Depth, false) => texture_depth_2d(),
            (Self::Depth, true) => texture_depth_2d_multisampled(),
            (Self::Normals | Self::Motion, true) => texture_2d_multisampled(floats),
            (Self::Normals | Self::Motion | Self::Texture(_), _) => texture_2d(floats),
            (Self::Layers(..), _) => BindingType::Texture {
                sample_type: TextureSampleType::Depth,
                view_dimension: TextureViewDimension::D2Array,
                multisampled: false,
            }
            .into_bind_group_layout_entry_builder(),
            (Self::Buffer(_), _) => storage_buffer_read_only::<Vec<u32>>(false),
        }
    }
}

const fn way(source: Source, define: &'static str) -> Way {
    Way { source, define }
}

/// Pictures that any app has.
pub(super) fn own_pictures() -> Vec<Picture> {
    let of_words = |name, about, define| Picture::new(name, about, way(Source::Words, define));
    vec![
        of_words(
            "base_colour",
            "base colour of the G-buffer, without light",
            "BASE_COLOUR",
        ),
        Picture {
            name: "normals",
            about: "normals in world axes: 0.5 is 0, red x, green y, blue z",
            ways: vec![
                way(Source::Words, "NORMALS_OF_WORDS"),
                way(Source::Normals, "NORMALS"),
            ],
        },
        of_words(
            "roughness",
            "perceptual roughness: black 0, white 1",
            "ROUGHNESS",
        ),
        of_words("metallic", "metallic: black 0, white 1", "METALLIC"),
        of_words(
            "reflectance",
            "reflectance at normal incidence: black 0, white 1",
            "REFLECTANCE",
        ),
        of_words(
            "baked_occlusion",
            "occlusion that materials bring along: white is open",
            "BAKED_OCCLUSION",
        ),
        of_words(
            "emitted",
            "emitted radiance, and the colour of what is not lit; half at 1",
            "EMITTED",
        ),
        of_words(
            "flags",
            "red: not lit; green: fog lies over it; blue: shadows fall on it",
            "FLAGS",
        ),
        Picture::new(
            "depth",
            "distance from the camera's plane: white FramePicture.near, black .far",
            way(Source::Depth, "DISTANCE"),
        ),
        Picture::new(
            "motion",
            "motion on the screen: grey at rest, red to the right, green downwards",
            way(Source::Motion, "MOTION"),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layer_has_a_bit_and_those_beyond_the_last_have_none() {
        let mut marks = Marks::default();
        for layer in [0, 33, 255, 256, 4000] {
            marks.drawn(layer);
        }
        marks.kept(128);
        assert_eq!(
            marks.drawn,
            [UVec4::new(1, 2, 0, 0), UVec4::new(0, 0, 0, 1 << 31)]
        );
        assert_eq!(marks.kept, [UVec4::ZERO, UVec4::new(1, 0, 0, 0)]);
    }
}
