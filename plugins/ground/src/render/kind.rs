//! The ground as what draws it knows it: what its functions read.

use std::sync::Arc;

use bevy::camera::visibility::RenderLayers;
use bevy::math::{DVec2, Vec4};
use bevy::prelude::*;
use bevy::render::render_resource::{AsBindGroup, ShaderType};
use bevy::render::storage::ShaderBuffer;
use dolomite_terrain::{EditTable, GpuTerrainUniform, Terrain};

use super::detail::DetailKind;
use super::look::GroundLook;
use crate::cover::{GROUND_LAYOUT, PatchDetail, TerrainView};
use crate::range::DEPTH_RANGE;
use dolomite_tessellation::PatchLayout;
use dolomite_tessellation::render::{PatchKind, PatchPool, PatchShader, Viewpoint};

/// The ground of a slot: its height function, its textures, its look. Kept by the plugin.
#[derive(Resource, AsBindGroup, Clone, Default)]
pub struct GroundKind<const SLOT: usize> {
    /// Layers of the height function.
    #[storage(0, read_only, visibility(compute))]
    pub(super) layers: Handle<ShaderBuffer>,
    /// Tables and samples of the height function.
    #[storage(1, read_only, visibility(compute))]
    pub(super) data: Handle<ShaderBuffer>,
    #[uniform(2)]
    pub(super) heights: HeightUniform,
    /// Both arrays; none where no layer has a texture.
    #[texture(3, dimension = "2d_array", visibility(fragment))]
    #[sampler(5, visibility(fragment))]
    pub(super) albedo_height: Option<Handle<Image>>,
    #[texture(4, dimension = "2d_array", visibility(fragment))]
    pub(super) normal_roughness: Option<Handle<Image>>,
    #[texture(6, visibility(fragment))]
    #[sampler(7, visibility(fragment))]
    pub(super) relief: Option<Handle<Image>>,
    #[uniform(8)]
    pub(super) look: GroundLook,
    /// Whether every layer is shaded.
    pub(super) full: bool,
    /// Least corner of the extent, which the relief map starts at, metres.
    pub(super) extent_min: DVec2,
    /// From the lowest to the highest ground of all, metres.
    pub(super) heights_apart: f32,
    /// Bytes of its buffers on the GPU.
    pub(super) buffer_bytes: u64,
    /// Bytes of its textures on the GPU; of arrays that terrains share, those of the first slot alone.
    pub(super) texture_bytes: u64,
    /// What the buffers hold.
    pub(super) terrain: Option<Terrain>,
    /// Where in the data the table of edits begins, and what it held when the data were laid out.
    pub(super) edits: Option<Arc<(usize, EditTable)>>,
    /// Whether it is drawn.
    pub(super) shown: bool,
    /// Layers of which a camera has to see one.
    pub(super) seen_on: RenderLayers,
    /// Most that a view asks for whose ground is of patches.
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

/// Definitions of the material's shader: it is the full one; that has [`FEW_LAYERS`] at most; there is no sea.
const FULL: &str = "GROUND_FULL";
const FEW: &str = "GROUND_FEW_LAYERS";
const DRY: &str = "GROUND_WITHOUT_SEA";

/// Layers that the smaller arrays of the material's shader hold, as in `layers.wgsl`.
const FEW_LAYERS: u32 = 8;

impl<const SLOT: usize> GroundKind<SLOT> {
    /// Takes other edits of the ground over that the buffers hold, if their table has room for them: who renders writes
    /// what differs (`edits.rs`).
    pub(super) fn takes_edits(&mut self, terrain: &Terrain) -> bool {
        let same = self
            .terrain
            .as_ref()
            .is_some_and(|known| known.same_base(terrain));
        let fits = match (&self.edits, terrain.edits()) {
            (None, None) => true,
            (Some(table), Some(edits)) => {
                table.1.room().holds(edits) && table.1.edits().lattice() == edits.lattice()
            }
            _ => false,
        };
        if same && fits {
            self.terrain = Some(terrain.clone());
        }
        same && fits
    }

    fn numbers(&self, view: &Viewpoint) -> [Vec4; 4] {
        let anchor = DVec2::new(view.anchor.x, view.anchor.z);
        self.look.numbers(anchor, self.extent_min)
    }
}

impl<const SLOT: usize> PatchKind for GroundKind<SLOT> {
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

impl<const SLOT: usize> DetailKind for GroundKind<SLOT> {
    type Cameras = (With<TerrainView>, Without<PatchDetail>);
    const MATERIAL: &'static str = "dolomite::ground::surface";
    const SHADED_ONCE: bool = true;
    const MATERIAL_DEFS: &[&[&'static str]] = &[
        &[],
        &[DRY],
        &[FULL],
        &[FULL, FEW],
        &[FULL, DRY],
        &[FULL, FEW, DRY],
    ];

    fn ground(&self) -> Option<&Terrain> {
        self.terrain.as_ref()
    }

    fn relief(&self) -> f32 {
        self.heights_apart
    }

    fn is_shown(&self) -> bool {
        self.shown
    }

    fn data_bytes(&self) -> u64 {
        self.buffer_bytes + self.texture_bytes
    }

    fn layers(&self) -> RenderLayers {
        self.seen_on.clone()
    }

    fn view_numbers(&self, view: &Viewpoint) -> [Vec4; 4] {
        self.numbers(view)
    }

    fn material_defs(&self) -> Vec<&'static str> {
        let full = self.full;
        let few = full && self.look.count <= FEW_LAYERS;
        let dry = self.look.sea_level == GpuTerrainUniform::NO_SEA;
        let defs = [(full, FULL), (few, FEW), (dry, DRY)];
        let defs = defs.into_iter().filter(|(is, _)| *is);
        defs.map(|(_, name)| name).collect()
    }
}
