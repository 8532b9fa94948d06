//! Which views see the ground of a kind, with how much room; and its data, bound.

use std::marker::PhantomData;
use std::sync::Arc;

use bevy::ecs::system::{StaticSystemParam, SystemParamItem};
use bevy::prelude::*;
use bevy::render::render_resource::{
    AsBindGroup, AsBindGroupError, BindingResources, Buffer, OwnedBindingResource, PipelineCache,
};
use bevy::render::renderer::RenderDevice;
use dolomite_geometry::render::{GeometryPool, Producers};

use super::extract::ExtractedGround;
use super::{DetailKind, detail_key};
use crate::blocks::kept::lattice_of;
use crate::blocks::layout::least_pools;
use crate::detail::DetailLattice;
use crate::render::pools::PoolRooms;
use crate::render::told::is_news;

/// What is bound of a kind's data.
#[derive(Resource)]
pub(in crate::render) struct DetailData<K> {
    /// Whether the bind group is older than the kind's data.
    pub is_due: bool,
    /// What the height function reads: layers, their data, uniform.
    pub heights: Option<[Buffer; 3]>,
    kind: PhantomData<fn() -> K>,
}

impl<K> Default for DetailData<K> {
    fn default() -> Self {
        Self {
            is_due: true,
            heights: None,
            kind: PhantomData,
        }
    }
}

/// What the height function reads, of a kind's bindings.
fn height_buffers(bindings: &BindingResources) -> Option<[Buffer; 3]> {
    let buffer = |at: u32| match bindings.iter().find(|(binding, _)| *binding == at)? {
        (_, OwnedBindingResource::Buffer(buffer)) => Some(buffer.clone()),
        _ => None,
    };
    Some([buffer(0)?, buffer(1)?, buffer(2)?])
}

/// Room for so many vertices, and for what is there whatever a view asks for.
fn pool_for(room: u32, lattice: &DetailLattice) -> GeometryPool {
    let [vertices, primitives] = least_pools(lattice);
    GeometryPool {
        vertices: room.max(vertices),
        // Two a vertex, those at a border left out.
        primitives: room.saturating_mul(2).max(primitives),
    }
}

/// Says where the ground is drawn, and binds its data.
pub(super) fn want<K: DetailKind>(
    mut producers: ResMut<Producers>,
    mut bound: ResMut<DetailData<K>>,
    (mut ground, rooms): (ResMut<ExtractedGround<K>>, Res<PoolRooms<K>>),
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    param: StaticSystemParam<<K as AsBindGroup>::Param>,
    mut told: Local<Vec<String>>,
) {
    let Some(producer) = producers.get_mut(detail_key::<K>()) else {
        return;
    };
    producer.wanted.clear();
    let ground = &mut *ground;
    if std::mem::take(&mut ground.newer)
        && let Some(kind) = &ground.kind
    {
        producer.set_defs(kind.material_defs());
        let newest = kind.clone();
        producer.numbers = Some(Arc::new(move |view| newest.view_numbers(view)));
        bound.is_due = true;
    }
    if ground.terrain.is_none() {
        // The bind group would keep the buffers and the textures of the ground that was.
        producer.data = None;
        bound.heights = None;
        bound.is_due = true;
        return;
    }
    if ground.cameras.is_empty() {
        return;
    }
    if bound.is_due
        && let Some(kind) = &ground.kind
    {
        let layout = producer
            .data_layout
            .get_or_insert_with(|| K::bind_group_layout_descriptor(&device));
        let mut param: SystemParamItem<<K as AsBindGroup>::Param> = param.into_inner();
        match kind.as_bind_group(layout, &device, &cache, &mut param) {
            Ok(prepared) => {
                producer.data = Some(prepared.bind_group);
                bound.heights = height_buffers(&prepared.bindings);
                bound.is_due = false;
                ground.kind = None;
            }
            // An image that has not arrived: again in the next frame.
            Err(AsBindGroupError::RetryNextUpdate) => {}
            Err(fault) => {
                let fault = fault.to_string();
                if is_news(&mut told, &fault) {
                    error!("{}: {fault}", producer.name);
                }
            }
        }
    }
    if let (Some(_), Some(terrain)) = (&producer.data, &ground.terrain) {
        let wanted = ground.cameras.iter().map(|(camera, detail)| {
            let room = rooms.vertices(*camera, detail.max_vertices);
            let pool = pool_for(room, &lattice_of(terrain, detail.finest));
            let pool = pool.bounded([u64::MAX; 2], producer.traits.vertex_bytes());
            (*camera, pool)
        });
        producer.wanted.extend(wanted);
    }
}
