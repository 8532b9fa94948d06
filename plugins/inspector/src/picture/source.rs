//! What a picture reads, and in which ways it is made.

use bevy::ecs::world::EntityRef;
use bevy::render::render_resource::binding_types::{
    storage_buffer_read_only, texture_2d, texture_2d_multisampled, texture_depth_2d,
    texture_depth_2d_multisampled,
};
use bevy::render::render_resource::{
    BindGroupLayoutEntryBuilder, BindingType, Buffer, IntoBindGroupLayoutEntryBuilder,
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
    /// All layers of a depth texture.
    Layers(fn(EntityRef) -> Option<TextureView>),
    /// Words of a buffer.
    Buffer(fn(EntityRef) -> Option<Buffer>),
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
            Self::Layers(_) => "LAYERS",
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
            (Self::Layers(_), _) => BindingType::Texture {
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
