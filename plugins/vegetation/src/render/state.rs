//! Buffers of what grows on one ground in one view.

use bevy::math::{DMat4, DVec3};
use bevy::prelude::*;
use bevy::render::render_resource::{
    BindGroup, BindGroupEntry, BindingResource, Buffer, BufferBinding, BufferDescriptor, BufferId,
    BufferUsages, PipelineCache,
};
use bevy::render::renderer::RenderDevice;
use dolomite_geometry::render::{Counters, GeometryView};

use super::layout::{
    ARGUMENT_BYTES, BladeView, GrowCounts, GrowParams, LODS, PIECE_BYTES, RECORD_ALIGN,
    RECORD_BYTES, SHADOW_SLOT, SHADOW_VIEWS,
};
use super::pipeline::VegetationPipelines;

/// Room for what a view draws. A resource of the main world.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub struct VegetationPool {
    /// Records of 16 bytes. Where they are too few, blades are thinned by rank, evenly, and
    /// [`VegetationCount::cut`](super::VegetationCount::cut) says how much.
    pub records: u32,
    /// Pieces of work of 8 bytes to begin with; more are made when they are needed, up to eight times as many.
    pub pieces: u32,
}

impl Default for VegetationPool {
    /// 18 MiB.
    fn default() -> Self {
        Self {
            records: 1 << 20,
            pieces: 1 << 18,
        }
    }
}

impl VegetationPool {
    /// Room of each level of detail, and where its records begin: an eighth, a quarter, the rest.
    #[must_use]
    pub fn parts(self) -> ([u32; LODS], [u32; LODS]) {
        let all = self.records.clamp(RECORD_ALIGN * LODS as u32, 1 << 23);
        let aligned = |count: u32| (count / RECORD_ALIGN * RECORD_ALIGN).max(RECORD_ALIGN);
        let [near, middle] = [aligned(all / 8), aligned(all / 4)];
        let far = aligned(all - near - middle);
        ([near, middle, far], [0, near, near + middle])
    }
}

/// What grows on one ground in one view.
pub struct ViewState {
    /// What the passes were told last.
    pub params: Box<GrowParams>,
    /// Whether records are not those of this frame's inputs.
    pub due: bool,
    /// Whether there are records.
    pub grown: bool,
    /// World position that records are counted from.
    pub anchor: DVec3,
    /// From the world to clip space in the last frame.
    pub previous_clip: Option<DMat4>,
    /// Lights whose maps blades are drawn into, in the order of their matrices.
    pub shadows: Vec<Entity>,
    /// What was counted.
    pub counters: Counters<GrowCounts>,
    /// Room.
    pub pool: VegetationPool,
    /// The buffers.
    pub buffers: ViewBuffers,
    /// Their groups.
    pub groups: Option<ViewGroups>,
    /// Which buffers of the ground are bound.
    ground: Option<[BufferId; 3]>,
}

/// Buffers of a view.
pub struct ViewBuffers {
    pub params: Buffer,
    pub view: Buffer,
    pub counts: Buffer,
    pub pieces: Buffer,
    pub arguments: Buffer,
    pub records: Buffer,
    pub shadows: Buffer,
}

/// Groups of a view.
pub struct ViewGroups {
    pub shared: BindGroup,
    pub arguments: BindGroup,
    pub records: BindGroup,
    pub draws: [BindGroup; LODS],
    pub shadows: BindGroup,
}

impl ViewBuffers {
    fn new(device: &RenderDevice, pool: VegetationPool) -> Self {
        let buffer = |label, size: u64, usage| {
            device.create_buffer(&BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let uniform = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let (rooms, _) = pool.parts();
        let records = rooms.iter().map(|room| u64::from(*room)).sum::<u64>();
        Self {
            params: buffer("vegetation_params", size_of::<GrowParams>() as u64, uniform),
            view: buffer("vegetation_view", size_of::<BladeView>() as u64, uniform),
            counts: buffer("vegetation_counts", size_of::<GrowCounts>() as u64, storage),
            pieces: buffer(
                "vegetation_pieces",
                u64::from(pool.pieces.max(1)) * PIECE_BYTES,
                storage,
            ),
            arguments: buffer(
                "vegetation_arguments",
                ARGUMENT_BYTES,
                storage | BufferUsages::INDIRECT,
            ),
            records: buffer("vegetation_records", records * RECORD_BYTES, storage),
            shadows: buffer(
                "vegetation_shadow_views",
                SHADOW_SLOT * SHADOW_VIEWS as u64,
                uniform,
            ),
        }
    }

    /// Bytes of all.
    pub fn bytes(&self) -> u64 {
        let all = [
            &self.params,
            &self.view,
            &self.counts,
            &self.pieces,
            &self.arguments,
            &self.records,
            &self.shadows,
        ];
        all.iter().map(|buffer| buffer.size()).sum()
    }
}

impl ViewState {
    /// Of a view that has nothing yet.
    pub fn new(device: &RenderDevice, pool: VegetationPool) -> Self {
        Self {
            params: Box::new(bytemuck::Zeroable::zeroed()),
            due: true,
            grown: false,
            anchor: DVec3::ZERO,
            previous_clip: None,
            shadows: Vec::new(),
            counters: Counters::default(),
            pool,
            buffers: ViewBuffers::new(device, pool),
            groups: None,
            ground: None,
        }
    }

    /// Other rooms: all grows anew.
    pub fn fit(&mut self, device: &RenderDevice, pool: VegetationPool) {
        if self.pool != pool {
            self.pool = pool;
            self.buffers = ViewBuffers::new(device, pool);
            self.groups = None;
            self.due = true;
            self.grown = false;
        }
    }

    /// Binds the ground's pools and these buffers, where that is not done.
    pub fn bind(
        &mut self,
        device: &RenderDevice,
        cache: &PipelineCache,
        pipelines: &VegetationPipelines,
        ground: &GeometryView,
    ) {
        let ids = [ground.vertices.id(), ground.indices.id(), ground.work.id()];
        if self.groups.is_some() && self.ground == Some(ids) {
            return;
        }
        if self.ground != Some(ids) {
            self.due = true;
        }
        self.ground = Some(ids);
        let group = |layout, bound: &[&Buffer]| {
            let entries: Vec<_> = (0..)
                .zip(bound)
                .map(|(binding, buffer)| BindGroupEntry {
                    binding,
                    resource: buffer.as_entire_binding(),
                })
                .collect();
            let layout = cache.get_bind_group_layout(layout);
            device.create_bind_group("vegetation", &layout, &entries)
        };
        let own = &self.buffers;
        let (rooms, bases) = self.pool.parts();
        let draw = cache.get_bind_group_layout(&pipelines.draw);
        let draws = std::array::from_fn(|lod| {
            let part = BufferBinding {
                buffer: &own.records,
                offset: u64::from(bases[lod]) * RECORD_BYTES,
                size: (u64::from(rooms[lod]) * RECORD_BYTES).try_into().ok(),
            };
            let entries = [
                BindGroupEntry {
                    binding: 0,
                    resource: own.view.as_entire_binding(),
                },
                BindGroupEntry {
                    binding: 1,
                    resource: BindingResource::Buffer(part),
                },
            ];
            device.create_bind_group("vegetation_draw", &draw, &entries)
        });
        self.groups = Some(ViewGroups {
            shared: group(
                &pipelines.shared,
                &[
                    &own.params,
                    &ground.vertices,
                    &ground.indices,
                    &ground.work,
                    &own.counts,
                    &own.pieces,
                ],
            ),
            arguments: group(&pipelines.arguments, &[&own.arguments]),
            records: group(&pipelines.records, &[&own.records]),
            draws,
            shadows: device.create_bind_group(
                "vegetation_shadow_view",
                &cache.get_bind_group_layout(&pipelines.shadow_view),
                &[BindGroupEntry {
                    binding: 0,
                    resource: BindingResource::Buffer(BufferBinding {
                        buffer: &own.shadows,
                        offset: 0,
                        size: 64.try_into().ok(),
                    }),
                }],
            ),
        });
    }
}
