//! The ground as a kind of the stage: what its functions read.

use bevy::math::{DVec2, Vec4};
use bevy::prelude::*;
use bevy::render::render_resource::{AsBindGroup, ShaderType};
use bevy::render::storage::ShaderBuffer;
use dolomite_terrain::{GpuTerrainUniform, Terrain};

use super::detail::DetailKind;
use crate::cover::functions::DEPTH_RANGE;
use crate::cover::{GROUND_LAYOUT, TerrainView};
use dolomite_tessellation::PatchLayout;
use dolomite_tessellation::render::{PatchKind, PatchPool, PatchShader, Viewpoint};

/// The ground: its height function, its textures, its look. Kept by the plugin.
#[derive(Resource, AsBindGroup, Clone, Default)]
pub struct GroundKind {
    /// Layers of the height function.
    #[storage(0, read_only, visibility(compute))]
    pub(super) layers: Handle<ShaderBuffer>,
    /// Tables and samples of the height function.
    #[storage(1, read_only, visibility(compute))]
    pub(super) data: Handle<ShaderBuffer>,
    #[uniform(2)]
    pub(super) heights: HeightUniform,
    #[texture(3, dimension = "2d_array", visibility(fragment))]
    #[sampler(5, visibility(fragment))]
    pub(super) albedo_height: Handle<Image>,
    #[texture(4, dimension = "2d_array", visibility(fragment))]
    pub(super) normal_roughness: Handle<Image>,
    #[texture(6, visibility(fragment))]
    #[sampler(7, visibility(fragment))]
    pub(super) relief: Option<Handle<Image>>,
    #[uniform(8)]
    pub(super) look: GroundLook,
    /// Least corner of the extent, which the relief map starts at, metres.
    pub(super) extent_min: DVec2,
    /// From the lowest to the highest ground of all, metres.
    pub(super) heights_apart: f32,
    /// What the buffers hold.
    pub(super) terrain: Option<Terrain>,
    /// Whether the terrain can be drawn: its textures are there.
    pub(super) shown: bool,
    /// Most that a view asks for.
    pub(super) pool: PatchPool,
}

/// [`GpuTerrainUniform`] as it is bound.
#[derive(ShaderType, Clone, Copy, Debug, Default)]
pub struct HeightUniform {
    layer_count: u32,
    base: f32,
    sea_level: f32,
    pad: u32,
}

impl From<GpuTerrainUniform> for HeightUniform {
    fn from(uniform: GpuTerrainUniform) -> Self {
        Self {
            layer_count: uniform.layer_count,
            base: uniform.base,
            sea_level: uniform.sea_level,
            pad: 0,
        }
    }
}

/// How the ground looks; see `shaders/src/ground/types.wgsl` for units and meanings.
#[derive(ShaderType, Clone, Copy, Debug, Default, PartialEq)]
#[expect(missing_docs, reason = "each field is documented once, in types.wgsl")]
pub struct GroundLook {
    pub sea_level: f32,
    pub tile: f32,
    pub sand_top: f32,
    pub tree_line: f32,
    pub snow_line: f32,
    pub blend: f32,
    pub rock_slope: f32,
    pub snow_slope: f32,
    pub relief_texel: f32,
    pub relief_scale: f32,
    pub pad_a: f32,
    pub pad_b: f32,
}

/// Ratio of the far to the near texture scale, as `FAR_TILES` in `material.wgsl`.
const FAR_TILES: f64 = 11.3;

impl PatchKind for GroundKind {
    const LAYOUT: PatchLayout = GROUND_LAYOUT;
    const UV_RANGE: f32 = DEPTH_RANGE;
    const CUSTOM_MATERIAL: bool = true;
    const BOUNDED: bool = true;

    fn shader() -> PatchShader {
        PatchShader::Library("dolomite::ground::functions")
    }

    fn view_numbers(&self, view: &Viewpoint) -> [Vec4; 4] {
        self.numbers(view)
    }

    fn pool(&self) -> PatchPool {
        self.pool
    }
}

impl GroundKind {
    /// Texture coordinates of the anchor, as fractions of a tile: far from the origin f32 would not
    /// hold them.
    fn numbers(&self, view: &Viewpoint) -> [Vec4; 4] {
        let anchor = DVec2::new(view.anchor.x, view.anchor.z);
        let offset = |tile: f64| (anchor / tile - (anchor / tile).floor()).as_vec2();
        let tile = f64::from(self.look.tile.max(0.01));
        let (near, far) = (offset(tile), offset(tile * FAR_TILES));
        let relief = (anchor - self.extent_min) * f64::from(self.look.relief_scale);
        [
            Vec4::new(near.x, near.y, far.x, far.y),
            relief.as_vec2().extend(0.0).extend(0.0),
            Vec4::ZERO,
            Vec4::ZERO,
        ]
    }
}

impl DetailKind for GroundKind {
    type Cameras = With<TerrainView>;
    const MATERIAL: &'static str = "dolomite::ground::surface";

    fn ground(&self) -> Option<&Terrain> {
        self.terrain.as_ref()
    }

    fn relief(&self) -> f32 {
        self.heights_apart
    }

    fn is_shown(&self) -> bool {
        self.shown
    }

    fn view_numbers(&self, view: &Viewpoint) -> [Vec4; 4] {
        self.numbers(view)
    }
}
