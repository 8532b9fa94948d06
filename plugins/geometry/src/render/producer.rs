//! Who makes triangles.

use std::any::TypeId;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use bevy::prelude::*;
use bevy::render::render_resource::{BindGroup, BindGroupLayoutDescriptor, Buffer, PipelineCache};
use bevy::render::renderer::RenderDevice;
use bevy::shader::ShaderDefVal;

use super::material::GeometryMaterial;
use super::pipeline::DrawPipelines;
use super::space::Viewpoint;
use super::traits::{DrawShader, DrawTraits, GeometryPool};
use super::view::GeometryView;

/// Names a producer: its type, and which of those that share it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ProducerKey {
    kind: TypeId,
    part: u64,
}

impl ProducerKey {
    /// The only producer of a type.
    #[must_use]
    pub fn of<K: 'static>() -> Self {
        Self::part::<K>(0)
    }

    /// One of several producers of a type.
    #[must_use]
    pub fn part<K: 'static>(part: u64) -> Self {
        Self {
            kind: TypeId::of::<K>(),
            part,
        }
    }
}

/// All producers, in the order in which they are drawn. A resource of the render world.
#[derive(Resource, Default)]
pub struct Producers(BTreeMap<ProducerKey, Producer>);

impl Producers {
    /// Adds one, in place of an older one of the same key.
    pub fn insert(&mut self, key: ProducerKey, producer: Producer) {
        self.0.insert(key, producer);
    }

    /// Takes one away, with all that it holds.
    pub fn remove(&mut self, key: ProducerKey) -> Option<Producer> {
        self.0.remove(&key)
    }

    /// One of them.
    #[must_use]
    pub fn get(&self, key: ProducerKey) -> Option<&Producer> {
        self.0.get(&key)
    }

    /// One of them.
    pub fn get_mut(&mut self, key: ProducerKey) -> Option<&mut Producer> {
        self.0.get_mut(&key)
    }

    /// All.
    pub fn iter(&self) -> impl Iterator<Item = &Producer> {
        self.0.values()
    }

    /// All.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut Producer> {
        self.0.values_mut()
    }
}

/// Numbers that a material reads as `geometry_draw.numbers`, made in f64 where it matters.
pub type ViewNumbers = Arc<dyn Fn(&Viewpoint) -> [Vec4; 4] + Send + Sync>;

/// A producer in the render world: what it wants to draw, and the views that it draws in.
pub struct Producer {
    /// Its name in messages and counters.
    pub name: &'static str,
    /// How it is drawn.
    pub traits: DrawTraits,
    /// Its draws.
    pub shader: DrawShader,
    /// Layout of group 0 of the draws: what its vertex functions read beside its data. Its bind groups are
    /// those of the views ([`GeometryView::inputs`]).
    pub inputs_layout: BindGroupLayoutDescriptor,
    /// Layout of group 1: its data. Nothing is drawn before it is known.
    pub data_layout: Option<BindGroupLayoutDescriptor>,
    /// Group 1.
    pub data: Option<BindGroup>,
    /// The views that it wants to draw in, with the room that each needs. A view that is not among them any
    /// more loses its buffers.
    pub wanted: Vec<(Entity, GeometryPool)>,
    /// Whether nothing that it makes depends on the view: the anchor then stays while the camera is near.
    pub still: bool,
    /// Numbers of a view.
    pub numbers: Option<ViewNumbers>,
    /// Its materials; at most 16 count.
    pub materials: Vec<GeometryMaterial>,
    /// Whether they are newer than what was uploaded.
    pub materials_changed: bool,
    /// Bytes of buffers that all of its views share.
    pub shared_bytes: u64,
    /// Number of its own pipelines, for the census.
    pub pipelines: usize,
    /// Why its own pipelines cannot be made, if they cannot.
    pub fault: Option<String>,
    /// Its views. Made and dropped by this crate.
    pub views: HashMap<Entity, GeometryView>,
    pub(super) material_rows: Option<Buffer>,
    pub(super) draws: Option<DrawPipelines>,
    /// Whether a fault was told of.
    pub(super) told: bool,
}

impl Producer {
    /// One that wants nothing yet.
    #[must_use]
    pub fn new(
        name: &'static str,
        traits: DrawTraits,
        shader: DrawShader,
        inputs_layout: BindGroupLayoutDescriptor,
    ) -> Self {
        Self {
            name,
            traits,
            shader,
            inputs_layout,
            data_layout: None,
            data: None,
            wanted: Vec::new(),
            still: false,
            numbers: None,
            materials: Vec::new(),
            materials_changed: true,
            shared_bytes: 0,
            pipelines: 0,
            fault: None,
            views: HashMap::new(),
            material_rows: None,
            draws: None,
            told: false,
        }
    }

    /// Binds an empty group where its draws read no data of its own. Call it in
    /// [`GeometrySystems::Want`](super::GeometrySystems::Want); costs nothing when they are there.
    pub fn bind_no_data(&mut self, device: &RenderDevice, cache: &PipelineCache) {
        let nothing = BindGroupLayoutDescriptor::new("geometry_nothing", &[]);
        if self.data.is_none() {
            let layout = cache.get_bind_group_layout(&nothing);
            self.data = Some(device.create_bind_group("geometry_nothing", &layout, &[]));
            self.data_layout = Some(nothing);
        }
    }

    /// Other definitions for its draws: where they differ, their pipelines are made anew.
    pub fn set_defs(&mut self, defs: impl IntoIterator<Item = &'static str>) {
        let defs: Vec<ShaderDefVal> = defs.into_iter().map(ShaderDefVal::from).collect();
        if self.shader.defs != defs {
            self.shader.defs = defs;
            self.draws = None;
        }
    }

    /// Pipelines of its draws that were queued.
    #[must_use]
    pub fn draw_pipelines(&self) -> usize {
        self.draws.as_ref().map_or(0, DrawPipelines::count)
    }
}
