//! Kinds with functions in Rust: tessellated on the CPU, uploaded, drawn as all others.

use std::borrow::Cow;

use bevy::prelude::*;
use bevy::render::renderer::RenderQueue;
use bytemuck::cast_slice;
use dolomite_geometry::render::{GeometryShared, Producers};

use super::prepare::StageKinds;
use crate::tessellate_host;

/// Fills the pools of each view whose inputs changed.
pub fn tessellate(
    kinds: Res<StageKinds>,
    mut producers: ResMut<Producers>,
    queue: Res<RenderQueue>,
    shared: Res<GeometryShared>,
) {
    for kind in kinds.0.values() {
        let (Some(functions), Some(producer)) = (&kind.host, producers.get_mut(kind.key)) else {
            continue;
        };
        for (entity, state) in &mut producer.views {
            let Some(own) = kind.views.get(entity).filter(|_| !state.settled) else {
                continue;
            };
            let params = &own.params;
            let all = &kind.instances;
            let seen = if all.iter().all(|(_, entity)| entity.is_in(params.layers)) {
                Cow::Borrowed(all.as_slice())
            } else {
                let seen = all.iter().filter(|(_, entity)| entity.is_in(params.layers));
                Cow::Owned(seen.cloned().collect())
            };
            let made = tessellate_host(
                &kind.tessellator,
                &seen,
                &**functions,
                &params.view,
                [params.max_vertices, params.max_primitives],
                params.uv_range,
            );
            let (vertices, indices) = (cast_slice(&made.vertices), cast_slice(&made.indices));
            state.upload(&queue, &shared, [vertices, indices], made.head.into());
        }
    }
}
