//! What each view is lit with: its list of lights, its way, and the buffers and textures of that way.

use bevy::camera::visibility::RenderLayers;
use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::log::warn_once;
use bevy::prelude::*;
use bevy::render::camera::ExtractedCamera;
use bevy::render::render_resource::{
    Buffer, BufferDescriptor, BufferUsages, Extent3d, TextureDescriptor, TextureDimension,
    TextureFormat, TextureUsages, WgpuFeatures,
};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::sync_world::MainEntity;
use bevy::render::texture::{CachedTexture, TextureCache};
use bevy::render::view::ExtractedView;
use bytemuck::{Pod, Zeroable};

use super::lights::Lights;
use super::occlusion::{Uniform, ViewOcclusion};
use super::pipeline::{Maker, ViewPipelines};
use super::pyramid::{MANY, ViewPyramid};
use super::stats::{DeferredStats, ViewStats};
use crate::choice::{Chosen, Variation, choose};
use crate::components::{DeferredLighting, Way};
use crate::cull::{Listed, Sides};
use crate::occlusion::AmbientOcclusion;

/// Pixels on a side of a tile.
pub const TILE: u32 = 16;
/// Words of the memory of a tile's workgroup, of which WebGPU grants 16 KiB, for many lights and for few: a tile keeps a
/// bit a light in it.
const MOST_WORDS: u32 = 3072;
/// See [`MOST_WORDS`].
const FEW_WORDS: u32 = 128;
/// Words for the lists of all tiles of a view: at least so many, and so many for each tile.
const ROOM: u32 = 1 << 18;
/// See [`ROOM`].
const ROOM_EACH: u32 = 256;

/// `Lighting` in `shaders/src/deferred/bindings.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct LightingUniform {
    /// Of the view's list.
    pub lights: u32,
    /// Of them, those that tiles list.
    pub in_tiles: u32,
    /// In a row, and rows.
    pub tiles: [u32; 2],
    /// Words for the lists.
    pub room: u32,
    /// Greatest value that the target holds.
    pub brightest: f32,
    /// Of the view's list, those without shadows, which come first.
    pub open: u32,
    /// To 32 bytes.
    pub pad: u32,
}

/// What a view is lit with; on the view's entity in the render world.
#[derive(Component, Default)]
pub struct ViewLighting {
    /// What this frame is drawn with: where another is wanted, the last one until that is compiled.
    pub variation: Option<Variation>,
    /// Of the tiles' memory in the pipelines of this frame; 0 before there are any.
    words: u32,
    pub(super) listed: Listed,
    pub(super) uniform: LightingUniform,
    pub(super) pipelines: ViewPipelines,
    pub(super) uniform_buffer: Option<Buffer>,
    pub(super) list_buffer: Option<Buffer>,
    pub(super) tiles: Option<TileBuffers>,
    pub(super) pyramid: Option<ViewPyramid>,
    pub(super) gathered: Option<CachedTexture>,
    pub(super) occlusion: Option<ViewOcclusion>,
    uploaded: Vec<u32>,
}

/// Of the tiled way.
pub(super) struct TileBuffers {
    /// Words taken of the room.
    pub used: Buffer,
    /// Heads and lists.
    pub lists: Buffer,
}

impl ViewLighting {
    /// Passes that are recorded for the view.
    #[must_use]
    pub fn passes(&self) -> u32 {
        let light = match self.variation.map(|variation| variation.chosen) {
            None => 0,
            Some(Chosen::Nothing | Chosen::BruteForce) => 1,
            Some(Chosen::Tiled) => 2 + u32::from(self.pyramid.is_some()),
            Some(Chosen::Volumes) => 2,
        };
        light + u32::from(self.occlusion.is_some())
    }

    /// Lists of lights of the tiles: from the second word on, three words a tile, of which the third says how many lights it
    /// has. `None` unless the view is lit by tiles.
    #[must_use]
    pub fn tile_lists(&self) -> Option<&Buffer> {
        self.tiles.as_ref().map(|tiles| &tiles.lists)
    }

    /// The share of the light from everywhere that reaches each pixel; `None` without ambient occlusion.
    #[must_use]
    pub fn visible_share(&self) -> Option<&CachedTexture> {
        self.occlusion.as_ref().map(|occlusion| &occlusion.visible)
    }

    /// The depth pyramid: bits of its texels from level 1 on, as [`pyramid`](crate::pyramid) lays them out. `None` unless
    /// the view is lit by tiles and has as many lights in view that the pyramid saves time: 256.
    #[must_use]
    pub fn depth_pyramid(&self) -> Option<&Buffer> {
        self.pyramid.as_ref().map(ViewPyramid::texels)
    }

    /// Takes the wanted variation, or keeps the last one until the wanted one is compiled. So many lights want so much of
    /// the tiles' memory: a pipeline with more of it is another.
    fn take(&mut self, wanted: Variation, view: &ExtractedView, maker: &mut Maker) -> Variation {
        // Of the workgroup's memory.
        let words = if self.listed.indices.len() as u32 <= 32 * FEW_WORDS {
            FEW_WORDS
        } else {
            MOST_WORDS
        };
        let made = maker.make(view, wanted, words);
        let ready = made.as_ref().is_some_and(|made| maker.ready(made));
        let had = self.words;
        let last = self
            .variation
            .filter(|last| !ready && (*last != wanted || had != words));
        let (variation, words, made) = match last {
            Some(last) => (last, had, maker.make(view, last, had)),
            None => (wanted, words, made),
        };
        self.variation = Some(variation);
        self.words = words;
        self.pipelines = made.unwrap_or_default();
        variation
    }

    fn bytes(&self) -> u64 {
        let tiles = self
            .tiles
            .as_ref()
            .map_or(0, |t| t.used.size() + t.lists.size());
        let buffers = [&self.uniform_buffer, &self.list_buffer];
        let buffers: u64 = buffers.into_iter().flatten().map(|b| b.size()).sum();
        let gathered = self.gathered.as_ref().map_or(0, |texture| {
            u64::from(texture.texture.width()) * u64::from(texture.texture.height()) * 16
        });
        let pyramid = self.pyramid.as_ref().map_or(0, ViewPyramid::bytes);
        let occlusion = self.occlusion.as_ref().map_or(0, ViewOcclusion::bytes);
        tiles + buffers + gathered + pyramid + occlusion
    }
}

/// What a view is lit by.
#[derive(QueryData)]
pub struct Lit {
    view: &'static ExtractedView,
    camera: &'static ExtractedCamera,
    layers: Option<&'static RenderLayers>,
    occlusion: Option<&'static AmbientOcclusion>,
}

/// What fills a [`ViewLighting`].
#[derive(SystemParam)]
pub struct Tools<'w> {
    device: Res<'w, RenderDevice>,
    queue: Res<'w, RenderQueue>,
    maker: Maker<'w>,
}

impl Tools<'_> {
    fn blends(&self) -> bool {
        let features = self.device.features();
        features.contains(WgpuFeatures::FLOAT32_BLENDABLE)
    }
}

impl ViewLighting {
    /// Lists what the view sees, and makes what `way` needs.
    pub(super) fn fill(
        &mut self,
        way: Way,
        lit: &LitItem,
        lights: &Lights,
        tools: &mut Tools,
        textures: &mut TextureCache,
    ) {
        let view = lit.view;
        let default = RenderLayers::default();
        let layers = lit.layers.unwrap_or(&default);
        let may = |index: usize| {
            let of_light = lights.layers.get(&(index as u32)).unwrap_or(&default);
            of_light.intersects(layers)
        };
        let sides = Sides::new(view.clip_from_view, view.world_from_view.to_matrix());
        let sides = (way != Way::BruteForce).then_some(&sides);
        self.listed.fill(&lights.rows, sides, may);
        let count = self.listed.indices.len() as u32;
        let chosen = choose(way, count, tools.blends());
        let size = view.viewport.zw();
        let uniform = lit.occlusion.and_then(Uniform::new);
        let wanted = Variation {
            chosen,
            suns: lights.suns,
            casters: self.listed.open() < count,
            culled: chosen == Chosen::Tiled && count >= MANY && size.min_element() > 0,
            occluded: uniform.is_some() && size.min_element() > 0,
        };
        let Variation {
            chosen,
            culled,
            occluded,
            ..
        } = self.take(wanted, view, &mut tools.maker);
        let (device, queue) = (&tools.device, &tools.queue);
        fill_uniform(self, view, chosen);
        fill_buffers(self, chosen, device, queue);
        fill_pyramid(self, culled, view, device);
        self.gathered =
            (chosen == Chosen::Volumes).then(|| textures.get(device, gathered_texture(lit.camera)));
        let last = self.occlusion.take();
        // A variation that is kept until another is compiled reads what it was compiled for, wanted or not.
        self.occlusion = uniform
            .or_else(|| last.as_ref().map(ViewOcclusion::uniform))
            .filter(|_| occluded)
            .map(|uniform| {
                let size = size.max(UVec2::ONE);
                ViewOcclusion::new(uniform, size, last, device, textures)
            });
    }
}

/// Adds [`ViewLighting`] to views, and fills it.
pub fn prepare(
    mut commands: Commands,
    mut views: Query<(
        Entity,
        &MainEntity,
        Lit,
        &DeferredLighting,
        Option<&mut ViewLighting>,
    )>,
    lights: Res<Lights>,
    mut textures: ResMut<TextureCache>,
    stats: Res<DeferredStats>,
    mut tools: Tools,
) {
    stats.clear();
    for (entity, main, lit, setting, old) in &mut views {
        let mut new = ViewLighting::default();
        let mut old = old;
        let lighting = old.as_deref_mut().unwrap_or(&mut new);
        if setting.way == Way::Volumes && !tools.blends() {
            warn_once!(
                "DeferredLighting: Way::Volumes needs the device feature FLOAT32_BLENDABLE, which is absent; Way::Tiled is taken"
            );
        }
        lighting.fill(setting.way, &lit, &lights, &mut tools, &mut textures);
        let drawn = lighting.variation.map(|variation| variation.chosen);
        stats.push(ViewStats {
            camera: main.id(),
            chosen: drawn.unwrap_or(Chosen::Nothing),
            lights: lighting.listed.indices.len() as u32,
            refused: lights.refused,
            passes: lighting.passes(),
            bytes: lighting.bytes() + lights.buffer.as_ref().map_or(0, |buffer| buffer.size()),
        });
        if old.is_none() {
            commands.entity(entity).insert(new);
        }
    }
}

fn gathered_texture(camera: &ExtractedCamera) -> TextureDescriptor<'static> {
    // The whole target, whatever the viewport: it is drawn to beside the camera's depth.
    let size = camera.physical_target_size.unwrap_or(UVec2::ONE);
    TextureDescriptor {
        label: Some("dolomite_deferred_gathered"),
        size: Extent3d {
            width: size.x.max(1),
            height: size.y.max(1),
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format: TextureFormat::Rgba32Float,
        usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    }
}

fn fill_pyramid(
    lighting: &mut ViewLighting,
    culled: bool,
    view: &ExtractedView,
    device: &RenderDevice,
) {
    let (corner, size) = (view.viewport.xy(), view.viewport.zw());
    if !culled || size.min_element() == 0 {
        lighting.pyramid = None;
        return;
    }
    let lights = lighting.uniform.in_tiles;
    let fits = |pyramid: &ViewPyramid| pyramid.fits(size, corner, lights);
    if !lighting.pyramid.as_ref().is_some_and(fits) {
        lighting.pyramid = Some(ViewPyramid::new(device, size, corner, lights));
    }
}

fn fill_uniform(lighting: &mut ViewLighting, view: &ExtractedView, chosen: Chosen) {
    let tiles = [
        view.viewport.z.div_ceil(TILE),
        view.viewport.w.div_ceil(TILE),
    ];
    let count = lighting.listed.indices.len() as u32;
    lighting.uniform = LightingUniform {
        lights: count,
        // The memory of the pipeline that runs says how many; each pixel goes through the rest.
        in_tiles: count.min(32 * lighting.words.max(FEW_WORDS)),
        tiles,
        room: if chosen == Chosen::Tiled {
            ROOM.max(tiles[0].saturating_mul(tiles[1]).saturating_mul(ROOM_EACH))
                .min(1 << 24)
        } else {
            0
        },
        brightest: if view.target_format == TextureFormat::Rgba16Float {
            65504.0
        } else {
            f32::MAX
        },
        open: lighting.listed.open(),
        pad: 0,
    };
}

fn fill_buffers(
    lighting: &mut ViewLighting,
    chosen: Chosen,
    device: &RenderDevice,
    queue: &RenderQueue,
) {
    let make = |label, size: u64, usage| {
        device.create_buffer(&BufferDescriptor {
            label: Some(label),
            size,
            usage: usage | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    };
    let uniform = lighting.uniform_buffer.get_or_insert_with(|| {
        make(
            "dolomite_deferred_uniform",
            size_of::<LightingUniform>() as u64,
            BufferUsages::UNIFORM,
        )
    });
    queue.write_buffer(uniform, 0, bytemuck::bytes_of(&lighting.uniform));
    if chosen == Chosen::Nothing {
        lighting.list_buffer = None;
        lighting.tiles = None;
        lighting.uploaded.clear();
        return;
    }
    let size = (4 * lighting.listed.indices.len() as u64)
        .next_power_of_two()
        .max(16);
    if lighting
        .list_buffer
        .as_ref()
        .is_none_or(|buffer| buffer.size() < size || buffer.size() > 4 * size)
    {
        lighting.list_buffer = Some(make("dolomite_deferred_list", size, BufferUsages::STORAGE));
        lighting.uploaded.clear();
    }
    if let Some(buffer) = &lighting.list_buffer
        && lighting.uploaded != lighting.listed.indices
    {
        queue.write_buffer(buffer, 0, bytemuck::cast_slice(&lighting.listed.indices));
        lighting.uploaded.clone_from(&lighting.listed.indices);
    }
    if chosen != Chosen::Tiled {
        lighting.tiles = None;
        return;
    }
    let [x, y] = lighting.uniform.tiles.map(u64::from);
    let words = 1 + 3 * x * y + u64::from(lighting.uniform.room);
    if lighting
        .tiles
        .as_ref()
        .is_none_or(|tiles| tiles.lists.size() != 4 * words)
    {
        lighting.tiles = Some(TileBuffers {
            used: make("dolomite_deferred_used", 4, BufferUsages::STORAGE),
            lists: make("dolomite_deferred_tiles", 4 * words, BufferUsages::STORAGE),
        });
    }
}
