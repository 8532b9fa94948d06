//! What is bound and extracted for a kind of ground, and who sees it; [`blocks`](super::blocks) chooses what is drawn of it.
//!
//! A camera's [`TerrainLod`](crate::detail::TerrainLod) says how fine. What it takes is made when the first such camera
//! looks; a view that did not change dispatches nothing.

pub(super) mod extract;
pub(crate) mod probe;
pub(super) mod view;
pub(super) mod want;

use std::any::type_name;
use std::marker::PhantomData;

use bevy::camera::visibility::RenderLayers;
use bevy::ecs::query::QueryFilter;
use bevy::prelude::*;
use bevy::render::render_resource::{AsBindGroup, BindGroupLayoutDescriptor};
use bevy::render::{ExtractSchedule, Render, RenderApp};
use bevy::shader::{Shader, ShaderDefVal};
use dolomite_geometry::render::{
    DrawShader, DrawTraits, GeometrySystems, Producer, ProducerKey, Producers, ShaderVariant,
    Viewpoint, build_render, draw_variants, shader_asset,
};
use dolomite_terrain::Terrain;

use super::pools::PoolRooms;

/// A ground whose triangles the level of detail makes: what is bound, what it looks like, who sees it. A
/// resource of the main world.
///
/// Its data begin with what `terrain_height` reads: layers at binding 0, their data at 1, the uniform at 2.
pub trait DetailKind: AsBindGroup + Resource + Clone {
    /// The cameras that see it, of those with a [`GeometryCamera`](dolomite_geometry::GeometryCamera); one without a
    /// [`TerrainLod`](crate::detail::TerrainLod) by the default.
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
        .init_resource::<extract::ExtractedGround<K>>()
        .init_resource::<want::DetailData<K>>()
        .init_resource::<PoolRooms<K>>()
        .add_systems(ExtractSchedule, extract::extract::<K>)
        .add_systems(Render, want::want::<K>.in_set(GeometrySystems::Want));
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
