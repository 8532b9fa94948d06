//! Kinds with functions in Rust: tessellated on the CPU, uploaded, drawn as all others.

use bevy::prelude::*;
use bevy::render::renderer::RenderQueue;
use bytemuck::{bytes_of, cast_slice};

use super::prepare::StageKinds;
use super::stats::StageShared;
use crate::tessellate_host;

/// Fills the pools of each view whose inputs changed.
pub fn tessellate(
    mut kinds: ResMut<StageKinds>,
    queue: Res<RenderQueue>,
    shared: Res<StageShared>,
) {
    for kind in kinds.0.values_mut() {
        let Some(functions) = kind.host.clone() else {
            continue;
        };
        for state in kind.views.values_mut().filter(|state| !state.settled) {
            let params = &state.params;
            let made = tessellate_host(
                &kind.traits.tessellator,
                &kind.instances,
                &*functions,
                &params.view,
                [params.max_vertices, params.max_primitives],
                params.uv_range,
            );
            let (vertices, indices) = (cast_slice(&made.vertices), cast_slice(&made.indices));
            queue.write_buffer(&state.vertices, 0, vertices);
            queue.write_buffer(&state.indices, 0, indices);
            queue.write_buffer(&state.work, 0, bytes_of(&made.head));
            shared.count_upload((vertices.len() + indices.len()) as u64);
            state.counters.set(made.head);
            state.settled = true;
            state.filled = true;
            if let Some(ranges) = &mut state.ranges {
                ranges.due = true;
            }
        }
    }
}
