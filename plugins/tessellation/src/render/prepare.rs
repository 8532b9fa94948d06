//! Buffers of each kind, and what each of its views is told in a frame.

use std::any::TypeId;
use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::ecs::system::{StaticSystemParam, SystemParamItem};
use bevy::prelude::*;
use bevy::render::render_resource::{
    AsBindGroup, AsBindGroupError, Buffer, BufferInitDescriptor, BufferUsages, PipelineCache,
};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bytemuck::cast_slice;
use dolomite_geometry::render::{
    DrawTraits, ExtractedGeometryCamera, GeometryPool, ProducerKey, Producers,
};

use super::kind::{PatchKind, PatchPool};
use super::layers::{SeenBy, layer_bits};
use super::pipeline::{KindPipelines, KindShaders};
use super::view::{StageViewState, StageViews, stage_view};
use crate::layout::StageParams;
use crate::patches::BINDING_LIMIT;
use crate::tables::{Instance, Tables};
use crate::{Domain, HostFunctions, PatchLayout, PatchMesh, Tessellator};

/// Every kind, by its type.
#[derive(Resource, Default)]
pub struct StageKinds(pub BTreeMap<TypeId, Kind>);

/// A kind of patches in the render world: what of it is the stage's own. The rest is a producer's.
pub struct Kind {
    pub name: &'static str,
    pub key: ProducerKey,
    pub layout: PatchLayout,
    pub tessellator: Tessellator,
    pub animated: bool,
    pub traits: DrawTraits,
    pub shaders: KindShaders,
    pub pool: PatchPool,
    /// What tessellates in place of the passes.
    pub host: Option<Arc<dyn HostFunctions>>,
    pub instances: Vec<(Arc<PatchMesh>, Instance)>,
    pub instances_changed: bool,
    /// Which cameras see any of them.
    pub seen_by: SeenBy,
    /// Entities whose mesh has another layout.
    pub other_layout: usize,
    /// Counts the changes that tessellation depends on.
    pub version: u64,
    /// Whether the bind group is older than the user's data.
    pub data_due: bool,
    pub pipelines: Option<KindPipelines>,
    pub buffers: Option<KindBuffers>,
    pub views: StageViews,
}

/// Buffers that all views of a kind share.
pub struct KindBuffers {
    meshes: Vec<Arc<PatchMesh>>,
    pub tables: Buffer,
    pub data: Buffer,
    /// Counts and places; the rest is the view's.
    params: StageParams,
    /// Most vertices and primitives that the patches can have.
    greatest: [u64; 2],
}

/// Whether any entity of a kind is drawn.
pub fn has_entities<K: PatchKind>(kinds: Res<StageKinds>) -> bool {
    let kind = kinds.0.get(&TypeId::of::<K>());
    kind.is_some_and(|kind| !kind.instances.is_empty())
}

/// The bind group of the user's data.
pub fn data<K: PatchKind>(
    mut kinds: ResMut<StageKinds>,
    mut producers: ResMut<Producers>,
    settings: Option<Res<ExtractedKind<K>>>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    param: StaticSystemParam<<K as AsBindGroup>::Param>,
) {
    let Some(kind) = kinds.0.get_mut(&TypeId::of::<K>()) else {
        return;
    };
    let (Some(settings), Some(producer)) = (settings, producers.get_mut(kind.key)) else {
        return;
    };
    if settings.is_changed() {
        let newest = settings.0.clone();
        producer.numbers = Some(Arc::new(move |view| newest.view_numbers(view)));
        kind.data_due = true;
    }
    if kind.instances.is_empty() || (producer.data.is_some() && !kind.data_due) {
        return;
    }
    let layout = producer
        .data_layout
        .get_or_insert_with(|| K::bind_group_layout_descriptor(&device));
    let mut param: SystemParamItem<<K as AsBindGroup>::Param> = param.into_inner();
    match settings
        .0
        .as_bind_group(layout, &device, &cache, &mut param)
    {
        Ok(prepared) => {
            producer.data = Some(prepared.bind_group);
            kind.data_due = false;
            kind.version += 1;
        }
        // An image that has not arrived: again in the next frame.
        Err(AsBindGroupError::RetryNextUpdate) => {}
        Err(fault) => error!("{}: {fault}", kind.name),
    }
}

/// The user's resource in the render world.
#[derive(Resource)]
pub struct ExtractedKind<K>(pub K);

/// Meshes are told apart by their place in memory.
fn same_meshes(a: &[Arc<PatchMesh>], b: &[(Arc<PatchMesh>, Instance)]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, (b, _))| Arc::ptr_eq(a, b))
}

/// Uploads tables and entities that changed, and says where the kinds are drawn: for cameras that see any of their
/// entities.
pub fn buffers(
    mut kinds: ResMut<StageKinds>,
    mut producers: ResMut<Producers>,
    cameras: Query<(Entity, &ExtractedGeometryCamera)>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
    for kind in kinds.0.values_mut() {
        let Some(producer) = producers.get_mut(kind.key) else {
            continue;
        };
        producer.wanted.clear();
        let seen_by = &kind.seen_by;
        let seeing: Vec<Entity> = cameras
            .iter()
            .filter(|(_, camera)| seen_by.is_seen(camera.number, &camera.layers))
            .map(|(view, _)| view)
            .collect();
        if kind.instances.is_empty() || seeing.is_empty() {
            kind.buffers = None;
            producer.shared_bytes = 0;
            continue;
        }
        let other_meshes = kind
            .buffers
            .as_ref()
            .is_none_or(|buffers| !same_meshes(&buffers.meshes, &kind.instances));
        if other_meshes {
            match KindBuffers::new(kind, kind.buffers.as_ref(), &device, &queue) {
                Ok(buffers) => kind.buffers = Some(buffers),
                Err(bytes) => {
                    error!(
                        "{}: the patches of {} entities need {bytes} bytes in one buffer, more than {BINDING_LIMIT}; none of this kind is drawn until there are fewer",
                        kind.name,
                        kind.instances.len()
                    );
                    kind.instances.clear();
                    kind.buffers = None;
                }
            }
            kind.instances_changed = false;
        }
        let Some(buffers) = &kind.buffers else {
            continue;
        };
        if kind.instances_changed {
            let instances: Vec<Instance> = kind.instances.iter().map(|(_, i)| *i).collect();
            queue.write_buffer(&buffers.data, 0, cast_slice(&instances));
            kind.instances_changed = false;
        }
        producer.shared_bytes = buffers.tables.size() + buffers.data.size();
        let pool: GeometryPool = kind.pool.into();
        let pool = pool.bounded(buffers.greatest, kind.traits.vertex_bytes());
        producer
            .wanted
            .extend(seeing.into_iter().map(|view| (view, pool)));
    }
}

impl KindBuffers {
    /// Tables of all entities, in the buffers that were there before where these are large enough;
    /// fails with the size that is too large for a buffer.
    fn new(
        kind: &Kind,
        before: Option<&Self>,
        device: &RenderDevice,
        queue: &RenderQueue,
    ) -> Result<Self, u64> {
        let layout = kind.layout;
        let Tables {
            words,
            data,
            mut params,
        } = Tables::new(layout, &kind.instances)?;
        params.uv_range = kind.traits.uv_range;
        params.amplified = kind.traits.amplified;
        let make = |label, contents: &[u8]| {
            device.create_buffer_with_data(&BufferInitDescriptor {
                label: Some(label),
                contents,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
            })
        };
        let (words, data): (&[u8], &[u8]) = (cast_slice(&words), cast_slice(&data));
        let room = |buffer: &Buffer, bytes: &[u8]| buffer.size() >= bytes.len() as u64;
        let kept = before.filter(|old| room(&old.tables, words) && room(&old.data, data));
        let (tables, given) = if let Some(old) = kept {
            queue.write_buffer(&old.tables, 0, words);
            queue.write_buffer(&old.data, 0, data);
            (old.tables.clone(), old.data.clone())
        } else {
            // Once replaced, patches come and go: a quarter to spare.
            let spare = |bytes: &[u8]| {
                let mut bytes = bytes.to_vec();
                if before.is_some() {
                    bytes.resize((bytes.len() + bytes.len() / 4).next_multiple_of(16), 0);
                }
                bytes
            };
            (
                make("stage_tables", &spare(words)),
                make("stage_data", &spare(data)),
            )
        };
        Ok(Self {
            meshes: kind
                .instances
                .iter()
                .map(|(mesh, _)| mesh.clone())
                .collect(),
            tables,
            data: given,
            params,
            greatest: greatest_sizes(layout, u64::from(params.patches)),
        })
    }
}

/// Most vertices and primitives of so many patches.
const fn greatest_sizes(layout: PatchLayout, patches: u64) -> [u64; 2] {
    let [vertices, primitives] = match layout.domain {
        Domain::Triangles => [3169, 6144],
        Domain::Quads => [4225, 8192],
        Domain::Isolines => [4160, 4096],
    };
    // The second half of a split side has up to 64 segments more.
    let more = if layout.split { 4 * 64 } else { 0 };
    [patches * (vertices + more), patches * (primitives + more)]
}

/// Writes the parameters of each kind in each view, and unsettles those whose inputs changed.
pub fn views(
    mut kinds: ResMut<StageKinds>,
    mut producers: ResMut<Producers>,
    cameras: Query<&ExtractedGeometryCamera>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
    for kind in kinds.0.values_mut() {
        let Some(producer) = producers.get_mut(kind.key) else {
            continue;
        };
        kind.views
            .retain(|entity, _| producer.views.contains_key(entity));
        let Some(buffers) = &kind.buffers else {
            continue;
        };
        for (entity, state) in &mut producer.views {
            let Ok(camera) = cameras.get(*entity) else {
                continue;
            };
            let own = kind
                .views
                .entry(*entity)
                .or_insert_with(|| StageViewState::new(&device));
            let mut params = buffers.params;
            params.view = stage_view(&state.frame, kind.animated);
            params.max_vertices = state.pool.vertices;
            params.max_primitives = state.pool.primitives;
            params.layers = layer_bits(&camera.layers).0;
            state.fit_work(&device, params.work_bytes());
            state.looked_at = params.patches;
            state.own_bytes = own.uniform.size();
            let timeless = kind.traits.evaluated;
            own.update(
                &queue,
                state,
                &params,
                kind.version,
                [timeless, producer.still],
            );
        }
    }
}
