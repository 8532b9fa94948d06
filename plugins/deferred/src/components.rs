//! Settings of a camera.

#[cfg(feature = "render")]
use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::prelude::*;

/// Lights what a camera sees by our passes instead of Bevy's deferred lighting pass.
///
/// It brings the G-buffer along (`DepthPrepass`, `DeferredPrepass`, one sample a pixel); materials write it
/// where their `opaque_render_method` is deferred, or with `DefaultOpaqueRendererMethod::deferred()`.
/// Removed again, the camera is lit by Bevy.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[cfg_attr(feature = "render", require(DepthPrepass, DeferredPrepass, Msaa::Off))]
pub struct DeferredLighting {
    /// How point and spot lights are found.
    pub way: Way,
}

/// How the point and spot lights of a pixel are found. All ways give the same picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq, Hash)]
pub enum Way {
    /// The one that is the fastest for the number of lights, see [`crate::choice`].
    #[default]
    Auto,
    /// Each light is drawn as a sphere, cone or cylinder around its reach, and added in a texture of
    /// 16 bytes a pixel. Needs a device that blends 32-bit floats (`FLOAT32_BLENDABLE`); on others it is
    /// `Tiled`, with a warning.
    Volumes,
    /// A compute pass lists the lights of each 16 × 16 pixels between their nearest and farthest surface.
    Tiled,
    /// Every pixel goes through all lights: the check of the others, and the fastest for a few.
    BruteForce,
}

/// On a point light whose shadows are those of things that mostly rest: a face of its shadow map is drawn where the light or
/// a caster in its reach moved, came or went, and some frames after. Without it, or on other lights, all is drawn in each
/// frame, as in Bevy.
///
/// Skinned and morphed meshes, and those with a `VisibilityRange`, count as moving. So does a mesh in the frames in which its
/// material changes, whatever of it: that may be its alpha mask. What is not seen to change is what draws itself into shadow
/// maps without being a mesh, such as patches and plants; change `redraw` for these.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct StillShadows {
    /// When it changes, all faces are drawn again.
    pub redraw: u32,
}

/// Lights what a camera with [`DeferredLighting`] sees once more, by [`Way::BruteForce`] through all lights of the world, and
/// keeps in each pixel how far both are apart.
///
/// While a camera has it: one full-screen pass through all lights, one that compares, and a texel of the target and 4 bytes a
/// pixel more; ambient occlusion is looked for once more. Without one there is no pass, no pipeline, no texture.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct LightingDifference;
