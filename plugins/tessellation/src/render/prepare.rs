//! Buffers of each kind, and what each of its views is told in a frame; the views' own are in
//! [`super::view_buffers`].

use std::any::TypeId;
use std::collections::HashMap;
use std::sync::Arc;

use bevy::ecs::system::{StaticSystemParam, SystemParamItem};
use bevy::math::{DMat4, DVec3};
use bevy::pbr::{ShadowView, ViewLightEntities};
use bevy::prelude::*;
use bevy::render::camera::TemporalJitter;
use bevy::render::render_resource::{
    AsBindGroup, AsBindGroupError, BindGroupLayoutDescriptor, Buffer, BufferInitDescriptor,
    BufferUsages, PipelineCache, PreparedBindGroup,
};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::view::ExtractedView;
use bytemuck::cast_slice;

use super::camera::Camera;
use super::extract::{ExtractedStageCamera, StageScene, same_meshes};
use super::kind::{PatchKind, PatchMaterial, PatchPool};
use super::pipeline::{KindPipelines, KindShaders};
use super::view::{StageSpace, Viewpoint, stage_view};
use super::view_buffers::pool_sizes;
pub use super::view_buffers::{SHADOW_SLOTS, ViewGroups, ViewKind};
use crate::layout::{
    DRAW_SLOT, EVALUATED_BYTES, FILL, LINES, MATERIAL_ROWS, MaterialRow, StageDraw, StageParams,
    VERTEX_BYTES,
};
use crate::patches::BINDING_LIMIT;
use crate::tables::{Instance, Tables};
use crate::{Domain, HostFunctions, PatchLayout, PatchMesh, Tessellator};

/// How far the camera may go from the anchor of a kind that nothing moves, metres: an f32 still has
/// a quarter of a millimetre there.
const STILL_REACH: f64 = 4096.0;

/// What is the same for all entities and views of a kind.
#[derive(Clone, Copy, Debug)]
pub struct KindTraits {
    pub layout: PatchLayout,
    pub tessellator: Tessellator,
    pub animated: bool,
    pub moves: bool,
    /// Whether the draws evaluate the vertices.
    pub evaluated: bool,
    pub uv_range: f32,
    /// Whether direct draws shade vertices.
    pub vertex_shaded: bool,
    pub amplified: u32,
    pub double_sided: bool,
    pub shadows: bool,
    /// Whether shadow views draw the patches alone that they may see.
    pub bounded: bool,
}

impl KindTraits {
    /// Those of a kind.
    pub fn of<K: PatchKind>() -> Self {
        let evaluated = super::evaluated::<K>();
        Self {
            layout: K::LAYOUT,
            tessellator: Tessellator {
                domain: K::LAYOUT.domain,
                spacing: K::SPACING,
                winding: K::WINDING,
                mode: K::MODE,
            },
            animated: K::ANIMATED,
            moves: K::MOVES && !evaluated,
            evaluated,
            uv_range: K::UV_RANGE,
            vertex_shaded: K::VERTEX_SHADED,
            amplified: K::AMPLIFIED,
            double_sided: K::DOUBLE_SIDED,
            shadows: K::SHADOWS,
            bounded: K::BOUNDED && K::SHADOWS && K::AMPLIFIED == 0,
        }
    }

    /// Of a vertex in the pool, without its place in the last frame.
    pub const fn vertex_bytes(&self) -> u64 {
        if self.evaluated {
            EVALUATED_BYTES
        } else {
            VERTEX_BYTES
        }
    }
}

/// Every kind, by its type.
#[derive(Resource, Default)]
pub struct StageKinds(pub HashMap<TypeId, Kind>);

/// A kind of patches in the render world.
pub struct Kind {
    pub name: &'static str,
    pub traits: KindTraits,
    pub shaders: KindShaders,
    pub pool: PatchPool,
    /// What tessellates in place of the passes.
    pub host: Option<Arc<dyn HostFunctions>>,
    /// Whether nothing depends on the view.
    pub still: bool,
    /// Whether another plugin writes what the stage would emit.
    pub given: bool,
    pub materials: Vec<PatchMaterial>,
    pub materials_changed: bool,
    pub instances: Vec<(Arc<PatchMesh>, Instance)>,
    pub instances_changed: bool,
    /// Entities whose mesh has another layout.
    pub other_layout: usize,
    /// Counts the changes that tessellation depends on.
    pub version: u64,
    /// Layout and bind group of the user's data.
    pub data_layout: Option<BindGroupLayoutDescriptor>,
    pub data: Option<PreparedBindGroup>,
    /// Whether the bind group is older than the user's data.
    pub data_due: bool,
    /// The user's numbers of a view.
    pub numbers: Option<ViewNumbers>,
    pub pipelines: Option<KindPipelines>,
    pub buffers: Option<KindBuffers>,
    pub views: HashMap<Entity, ViewKind>,
}

/// [`PatchKind::view_numbers`] of the newest resource.
pub type ViewNumbers = Arc<dyn Fn(&Viewpoint) -> [Vec4; 4] + Send + Sync>;

/// Buffers that all views of a kind share.
pub struct KindBuffers {
    /// Counts the buffers that replaced others: bind groups of older ones are out of date.
    generation: u64,
    meshes: Vec<Arc<PatchMesh>>,
    pub tables: Buffer,
    pub data: Buffer,
    pub materials: Buffer,
    /// Counts and places; the rest is the view's.
    params: StageParams,
    /// Most vertices and primitives that the patches can have.
    greatest: [u64; 2],
}

/// The bind group of the user's data.
pub fn data<K: PatchKind>(
    mut kinds: ResMut<StageKinds>,
    settings: Option<Res<ExtractedKind<K>>>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    param: StaticSystemParam<<K as AsBindGroup>::Param>,
) {
    let Some(kind) = kinds.0.get_mut(&TypeId::of::<K>()) else {
        return;
    };
    let Some(settings) = settings else {
        return;
    };
    if settings.is_changed() {
        let newest = settings.0.clone();
        kind.numbers = Some(Arc::new(move |view| newest.view_numbers(view)));
        kind.data_due = true;
    }
    if kind.instances.is_empty() || (kind.data.is_some() && !kind.data_due) {
        return;
    }
    let layout = kind
        .data_layout
        .get_or_insert_with(|| K::bind_group_layout_descriptor(&device));
    let mut param: SystemParamItem<<K as AsBindGroup>::Param> = param.into_inner();
    match settings
        .0
        .as_bind_group(layout, &device, &cache, &mut param)
    {
        Ok(prepared) => {
            kind.data = Some(prepared);
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

/// Uploads tables, entities and materials that changed.
pub fn buffers(
    mut kinds: ResMut<StageKinds>,
    cameras: Query<(), With<ExtractedStageCamera>>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
    for kind in kinds.0.values_mut() {
        if kind.instances.is_empty() || cameras.is_empty() {
            kind.buffers = None;
            kind.views.clear();
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
                    kind.views.clear();
                }
            }
            kind.instances_changed = false;
            kind.materials_changed = true;
        }
        let Some(buffers) = &kind.buffers else {
            continue;
        };
        if kind.instances_changed {
            let instances: Vec<Instance> = kind.instances.iter().map(|(_, i)| *i).collect();
            queue.write_buffer(&buffers.data, 0, cast_slice(&instances));
            kind.instances_changed = false;
        }
        if kind.materials_changed {
            queue.write_buffer(
                &buffers.materials,
                0,
                cast_slice(&material_rows(&kind.materials)),
            );
            kind.materials_changed = false;
        }
    }
}

fn material_rows(materials: &[PatchMaterial]) -> [MaterialRow; MATERIAL_ROWS] {
    let mut rows = [MaterialRow::default(); MATERIAL_ROWS];
    for (row, material) in rows.iter_mut().zip(materials) {
        let base = material.base_color;
        let shine = material.emissive;
        *row = MaterialRow {
            base_color: [
                base.red,
                base.green,
                base.blue,
                f32::from(u8::from(material.unlit)),
            ],
            emissive: [shine.red, shine.green, shine.blue, material.reflectance],
            surface: [
                material.roughness,
                material.metallic,
                1.0,
                f32::from(u8::from(!material.fog)),
            ],
        };
    }
    rows
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
        let layout = kind.traits.layout;
        let Tables {
            words,
            data,
            mut params,
        } = Tables::new(layout, &kind.instances)?;
        params.uv_range = kind.traits.uv_range;
        params.amplified = kind.traits.amplified;
        let make = |label, contents: &[u8], usage| {
            device.create_buffer_with_data(&BufferInitDescriptor {
                label: Some(label),
                contents,
                usage: usage | BufferUsages::COPY_DST,
            })
        };
        let (words, data): (&[u8], &[u8]) = (cast_slice(&words), cast_slice(&data));
        let room = |buffer: &Buffer, bytes: &[u8]| buffer.size() >= bytes.len() as u64;
        let kept = before.filter(|old| room(&old.tables, words) && room(&old.data, data));
        let (tables, given, generation) = if let Some(old) = kept {
            queue.write_buffer(&old.tables, 0, words);
            queue.write_buffer(&old.data, 0, data);
            (old.tables.clone(), old.data.clone(), old.generation)
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
                make("stage_tables", &spare(words), BufferUsages::STORAGE),
                make("stage_data", &spare(data), BufferUsages::STORAGE),
                before.map_or(0, |old| old.generation + 1),
            )
        };
        let rows = [MaterialRow::default(); MATERIAL_ROWS];
        Ok(Self {
            generation,
            meshes: kind
                .instances
                .iter()
                .map(|(mesh, _)| mesh.clone())
                .collect(),
            tables,
            data: given,
            materials: before.map_or_else(
                || make("stage_materials", cast_slice(&rows), BufferUsages::UNIFORM),
                |old| old.materials.clone(),
            ),
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

type ViewItem<'a> = (
    Entity,
    &'a ExtractedView,
    &'a ExtractedStageCamera,
    Option<&'a ViewLightEntities>,
    Option<&'a TemporalJitter>,
);

/// Writes the uniforms of each kind in each view, and unsettles those whose inputs changed.
pub fn views(
    mut kinds: ResMut<StageKinds>,
    scene: Res<StageScene>,
    views: Query<ViewItem>,
    shadow_views: Query<&ExtractedView, With<ShadowView>>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
    mut clips: Local<Vec<DMat4>>,
) {
    for kind in kinds.0.values_mut() {
        kind.views.retain(|entity, _| views.contains(*entity));
        let Some(buffers) = &kind.buffers else {
            continue;
        };
        for (entity, view, camera, lights, jitter) in &views {
            let matrices = Camera::new(view, jitter);
            let kept = kind.views.get(&entity).map(|state| state.anchor);
            let near = |anchor: &DVec3| anchor.distance(matrices.position) < STILL_REACH;
            let space = match kept.filter(near) {
                Some(anchor) if kind.still => StageSpace { anchor },
                _ => StageSpace::new(matrices.position),
            };
            let mut params = buffers.params;
            let time = if kind.traits.animated {
                scene.time
            } else {
                [0.0; 2]
            };
            params.view = stage_view(view, &matrices, &space, camera, scene.sun, time);
            let greatest = if kind.given {
                [u64::MAX; 2]
            } else {
                buffers.greatest
            };
            let [vertices, primitives] =
                pool_sizes(kind.pool, greatest, kind.traits.vertex_bytes());
            // The ranges of shadow views are those of patches.
            let traits = &KindTraits {
                bounded: kind.traits.bounded && !kind.given,
                ..kind.traits
            };
            params.max_vertices = vertices;
            params.max_primitives = primitives;
            let state = kind
                .views
                .entry(entity)
                .or_insert_with(|| ViewKind::new(&device, &params, traits));
            if [state.params.max_vertices, state.params.max_primitives] != [vertices, primitives]
                || state.ranges.is_some() != traits.bounded
            {
                *state = ViewKind::new(&device, &params, traits);
            }
            state.fit(&device, &params, traits, buffers.generation);
            state.anchor = space.anchor;
            state.steady_clip =
                Mat4::from_cols_array_2d(&space.clip_from_stage(matrices.steady_clip_from_world));
            let timeless = kind.traits.evaluated;
            state.update(&queue, &params, kind.version, [timeless, kind.still]);
            let mut main = StageDraw {
                clip_from_stage: space.clip_from_stage(matrices.clip_from_world),
                previous_clip_from_stage: space
                    .clip_from_stage(state.previous_clip.unwrap_or(matrices.clip_from_world)),
                camera: space.relative(matrices.position),
                time: scene.time[0],
                anchor: params.view.anchor,
                uv_range: params.uv_range,
                viewport: view.viewport.zw().as_vec2().to_array(),
                flags: u32::from(camera.settings.fill) * FILL
                    + u32::from(camera.settings.lines) * LINES,
                pad: 0,
                numbers: kind.numbers.as_ref().map_or([[0.0; 4]; 4], |numbers| {
                    numbers(&space.viewpoint(&matrices, scene.time[0])).map(|n| n.to_array())
                }),
            };
            state.shown = [camera.settings.fill, camera.settings.lines];
            state.previous_clip = Some(matrices.clip_from_world);
            queue.write_buffer(&state.draw, 0, bytemuck::bytes_of(&main));
            state.shadows.clear();
            clips.clear();
            let lights = lights
                .into_iter()
                .flat_map(|lights| lights.lights.iter().copied());
            for light in lights.filter(|_| kind.traits.shadows) {
                let slot = state.shadows.len() as u64 + 1;
                let Ok(shadow) = shadow_views.get(light) else {
                    continue;
                };
                if slot > SHADOW_SLOTS {
                    break;
                }
                let clip = Camera::new(shadow, None).clip_from_world;
                main.clip_from_stage = space.clip_from_stage(clip);
                clips.push(clip * DMat4::from_translation(space.anchor));
                queue.write_buffer(&state.draw, slot * DRAW_SLOT, bytemuck::bytes_of(&main));
                state.shadows.push((light, (slot * DRAW_SLOT) as u32));
            }
            if let Some(ranges) = &mut state.ranges {
                ranges.update(&queue, &clips);
            }
        }
    }
}

impl StageSpace {
    /// Position relative to the anchor.
    fn relative(&self, world: DVec3) -> [f32; 3] {
        (world - self.anchor).as_vec3().to_array()
    }
}
