//! The level of detail of the ground on the GPU: what [`crate::detail`] does, in compute passes that write
//! the vertices and triangles which [`dolomite_geometry`] then draws.
//!
//! A camera's [`TerrainLod`] says how fine. What it takes is made when the first such camera looks; a view that
//! did not change dispatches nothing.

mod counted;
mod hand_in;
mod host;
mod pass;
mod pipeline;
pub(super) mod prepare;
pub(crate) mod probe;
pub mod record;
mod state;
mod store;
pub(super) mod view;

use std::any::type_name;
use std::marker::PhantomData;

use bevy::camera::visibility::RenderLayers;
use bevy::core_pipeline::Core3d;
use bevy::ecs::query::QueryFilter;
use bevy::prelude::*;
use bevy::render::render_resource::{AsBindGroup, BindGroupLayoutDescriptor};
use bevy::render::sync_world::RenderEntity;
use bevy::render::{Extract, ExtractSchedule, Render, RenderApp, RenderSystems};
use bevy::shader::{Shader, ShaderDefVal};
use dolomite_geometry::GeometryCamera;
use dolomite_geometry::budget::Budget;
use dolomite_geometry::render::{
    DrawShader, DrawTraits, GeometrySystems, ModuleShaders, Producer, ProducerKey, Producers,
    ShaderVariant, Viewpoint, build_render, draw_variants, shader_asset,
};
use dolomite_terrain::Terrain;

use crate::detail::{Choice, MakingBudget, TerrainLod};
use crate::render::tiles::Tiles;

/// A ground whose triangles the level of detail makes: what is bound, what it looks like, who sees it. A
/// resource of the main world.
///
/// Its data begin with what `terrain_height` reads: layers at binding 0, their data at 1, the uniform at 2.
pub trait DetailKind: AsBindGroup + Resource + Clone {
    /// The cameras that see it, of those with a [`GeometryCamera`]; one without a [`TerrainLod`] by the default.
    type Cameras: QueryFilter + 'static;
    /// Import path of the shader library with its function `material(surface: Surface) -> Shaded`.
    const MATERIAL: &'static str;
    /// Greatest |u| of a vertex: its depth below the sea, metres.
    const UV_RANGE: f32 = crate::range::DEPTH_RANGE;
    /// All that [`Self::material_defs`] may give.
    const MATERIAL_DEFS: &[&[&'static str]] = &[&[]];
    /// Whether, in a view without G-buffer, `material` runs at the vertices.
    const VERTEX_SHADED: bool = false;
    /// Whether it is drawn into shadow maps.
    const SHADOWS: bool = true;
    /// Whether, in a view with a G-buffer, `material` runs once a pixel in place of in the draw; see
    /// [`DrawTraits::shaded_once`]: it may not use derivatives but the surface's own.
    const SHADED_ONCE: bool = false;

    /// The ground; without one nothing is drawn.
    fn ground(&self) -> Option<&Terrain>;

    /// From the lowest to the highest ground, metres.
    fn relief(&self) -> f32;

    /// Whether it is drawn at all. What is not keeps no buffer.
    fn is_shown(&self) -> bool {
        true
    }

    /// Bytes of the buffers and textures that its data are bound from, but for those that another kind counts.
    fn data_bytes(&self) -> u64 {
        0
    }

    /// Layers of which a camera has to see one.
    fn layers(&self) -> RenderLayers {
        RenderLayers::default()
    }

    /// Numbers of the view that `material` reads as `geometry_draw.numbers`.
    fn view_numbers(&self, _view: &Viewpoint) -> [Vec4; 4] {
        [Vec4::ZERO; 4]
    }

    /// Definitions for the shader of the material, one of [`Self::MATERIAL_DEFS`].
    fn material_defs(&self) -> Vec<&'static str> {
        Vec::new()
    }

    /// Whether the CPU chooses and places, and uploads what it made.
    fn on_host(&self) -> bool {
        false
    }
}

/// Which producer draws the detail of a kind.
struct DetailOf<K>(PhantomData<fn() -> K>);

/// Key of the producer that draws the detail of a kind.
#[must_use]
pub fn detail_key<K: 'static>() -> ProducerKey {
    ProducerKey::of::<DetailOf<K>>()
}

/// The ground of a kind, in the render world.
#[derive(Resource)]
pub(super) struct ExtractedGround<K> {
    /// The newest resource, until it is bound.
    kind: Option<K>,
    /// Whether it has just changed.
    newer: bool,
    pub(super) terrain: Option<Terrain>,
    /// Of a map that is read by tiles, what has arrived of it.
    pub(super) tiles: Option<Tiles>,
    /// From the lowest to the highest ground, metres.
    pub(super) relief: f32,
    on_host: bool,
    /// How many blocks a frame makes.
    pub(super) making: MakingBudget,
    /// Bytes of its data on the GPU.
    data_bytes: u64,
    /// Who sees it, and how.
    cameras: Vec<(Entity, TerrainLod)>,
    /// Those of them whose vertices are counted, for their budgets.
    pub(super) counted: Vec<Entity>,
}

impl<K> ExtractedGround<K> {
    /// Who sees it by a choice in blocks, or by one of cells; the CPU knows cells alone.
    pub(super) fn seeing(&self, blocks: bool) -> impl Iterator<Item = (Entity, TerrainLod)> {
        let in_blocks = move |detail: &TerrainLod| detail.choice == Choice::Blocks && !self.on_host;
        let cameras = self.cameras.iter().copied();
        cameras.filter(move |(_, detail)| in_blocks(detail) == blocks)
    }
}

impl<K> Default for ExtractedGround<K> {
    fn default() -> Self {
        Self {
            kind: None,
            newer: false,
            terrain: None,
            tiles: None,
            relief: 0.0,
            on_host: false,
            making: MakingBudget::default(),
            data_bytes: 0,
            cameras: Vec::new(),
            counted: Vec::new(),
        }
    }
}

/// Entry shaders of the passes, in the order of `DEPTH_PASSES` and then `LAST_PASSES`.
#[derive(Resource, Clone)]
pub(super) struct DetailShaders {
    entries: Vec<Handle<Shader>>,
    _modules: ModuleShaders,
}

/// Adds the systems of a kind to an app that renders, from `Plugin::finish` on; whether they were not there and are now.
pub(super) fn build<K: DetailKind>(app: &mut App) -> bool {
    build_render(app);
    let key = detail_key::<K>();
    let known = |app: &App| {
        let producers = app
            .get_sub_app(RenderApp)?
            .world()
            .get_resource::<Producers>()?;
        Some(producers.get(key).is_some())
    };
    if known(app) != Some(false) {
        return false;
    }
    let Some(shaders) = shaders(app) else {
        return false;
    };
    let name = type_name::<K>();
    let file = format!("geometry/draw.wgsl#detail of {name}");
    let Some(mut assets) = app.world_mut().get_resource_mut::<Assets<Shader>>() else {
        return false;
    };
    let draw = DrawShader {
        handle: assets.add(shader_asset(draw_source::<K>(), &file)),
        defs: Vec::new(),
    };
    let traits = draw_traits::<K>();
    let nothing = BindGroupLayoutDescriptor::new("detail_inputs", &[]);
    let producer = Producer::new(name, traits, draw, nothing);
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return false;
    };
    render_app
        .world_mut()
        .resource_mut::<Producers>()
        .insert(key, producer);
    render_app
        .insert_resource(shaders)
        .init_resource::<ExtractedGround<K>>()
        .init_resource::<prepare::DetailViews<K>>()
        .add_systems(ExtractSchedule, extract::<K>)
        .add_systems(
            Render,
            (
                prepare::want::<K>.in_set(GeometrySystems::Want),
                prepare::prepare::<K>.in_set(GeometrySystems::Bind),
                hand_in::hand_in::<K>.in_set(RenderSystems::Cleanup),
            ),
        )
        .add_systems(Core3d, pass::choose::<K>.in_set(GeometrySystems::Make));
    true
}

fn draw_traits<K: DetailKind>() -> DrawTraits {
    DrawTraits {
        vertex_shaded: K::VERTEX_SHADED,
        shaded_once: K::SHADED_ONCE,
        shadows: K::SHADOWS,
        others: true,
        uv_range: K::UV_RANGE,
        ..default()
    }
}

fn draw_source<K: DetailKind>() -> String {
    DrawShader::source(Some(&format!("{}::", K::MATERIAL)), None, None)
}

/// Every shader that a pipeline of the kind's draws may ask for; those of the passes are the same for all kinds.
#[doc(hidden)]
#[must_use]
pub fn detail_variants<K: DetailKind>() -> Vec<ShaderVariant> {
    let source = draw_source::<K>();
    let variants = K::MATERIAL_DEFS.iter().flat_map(|defs| {
        let defs: Vec<ShaderDefVal> = defs.iter().map(|def| (*def).into()).collect();
        draw_variants(&source, &defs, &draw_traits::<K>())
    });
    variants.collect()
}

/// What all kinds share.
fn shaders(app: &mut App) -> Option<DetailShaders> {
    let known = app.get_sub_app(RenderApp)?.world();
    if let Some(known) = known.get_resource::<DetailShaders>() {
        return Some(known.clone());
    }
    let modules = ModuleShaders::load(app)?;
    let mut assets = app.world_mut().get_resource_mut::<Assets<Shader>>()?;
    let entries = pipeline::files()
        .map(|file| assets.add(shader_asset(dolomite_shaders::find(file).source, file)))
        .collect();
    Some(DetailShaders {
        entries,
        _modules: modules,
    })
}

type Seeing<'a> = (
    RenderEntity,
    Option<&'a TerrainLod>,
    Option<&'a RenderLayers>,
    Has<Budget>,
);

fn extract<K: DetailKind>(
    mut ground: ResMut<ExtractedGround<K>>,
    kind: Extract<Option<Res<K>>>,
    making: Extract<Option<Res<MakingBudget>>>,
    cameras: Extract<Query<Seeing, (With<GeometryCamera>, K::Cameras)>>,
) {
    ground.cameras.clear();
    ground.counted.clear();
    ground.making = making.as_ref().map(|making| **making).unwrap_or_default();
    let Some(kind) = kind.as_ref() else {
        ground.terrain = None;
        ground.tiles = None;
        ground.data_bytes = 0;
        return;
    };
    if kind.is_changed() {
        ground.kind = Some((**kind).clone());
        ground.newer = true;
    }
    let same = match (&ground.terrain, kind.ground()) {
        (Some(known), Some(terrain)) => known.same(terrain),
        (known, terrain) => known.is_none() && terrain.is_none(),
    };
    if !same {
        ground.terrain = kind.ground().cloned();
    }
    let known = ground.tiles.take();
    ground.tiles = ground
        .terrain
        .as_ref()
        .and_then(|terrain| Tiles::extract(known, terrain));
    ground.relief = kind.relief();
    ground.on_host = kind.on_host();
    ground.data_bytes = kind.data_bytes();
    if kind.is_shown() {
        let layers = kind.layers();
        // A map that is read by tiles is drawn in blocks, whatever a camera chooses: they wait for what they stand on.
        let by_tiles = ground.tiles.is_some();
        let seen = cameras
            .iter()
            .filter(|(_, _, own, _)| own.unwrap_or(&RenderLayers::default()).intersects(&layers));
        for (entity, detail, _, budget) in seen {
            // Who has lost its detail sees the ground by the default.
            let mut detail = detail.copied().unwrap_or_default();
            if by_tiles {
                detail.choice = Choice::Blocks;
            }
            ground.cameras.push((entity, detail.clamped()));
            if budget {
                ground.counted.push(entity);
            }
        }
    }
}
