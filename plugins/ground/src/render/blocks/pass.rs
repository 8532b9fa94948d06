//! What is recorded for a view whose ground changed, or is still being made.

use bevy::prelude::*;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::{ComputePassDescriptor, PipelineCache};
use bevy::render::renderer::{RenderContext, RenderDevice, ViewQuery};
use dolomite_geometry::render::{ExtractedGeometryCamera, GeometryShared, Producers};

use super::parts::Part;
use super::prepare::BlockViews;
use super::record::{BlockBound, record_clear, record_look_again, record_step};
use crate::render::detail::want::DetailData;
use crate::render::detail::{DetailKind, detail_key};

/// Chooses the view's ground, draws what there is, and makes what is missing, as much as a frame may.
pub fn choose<K: DetailKind>(
    view: ViewQuery<Entity, With<ExtractedGeometryCamera>>,
    mut producers: ResMut<Producers>,
    (mut blocks, bound): (ResMut<BlockViews<K>>, Res<DetailData<K>>),
    cache: Res<PipelineCache>,
    shared: Res<GeometryShared>,
    device: Res<RenderDevice>,
    mut ctx: RenderContext,
) {
    let entity = view.into_inner();
    let blocks = &mut *blocks;
    let (Some(state), Some(own), Some(pace)) = (
        producers
            .get_mut(detail_key::<K>())
            .and_then(|producer| producer.views.get_mut(&entity)),
        blocks.views.get_mut(&entity),
        &mut blocks.pace,
    ) else {
        return;
    };
    // Heights come from the data: not before those of this terrain are bound.
    if state.settled || bound.is_due {
        return;
    }
    let ready = blocks
        .pipelines
        .as_ref()
        .and_then(|pipelines| pipelines.ready(&cache));
    let (Some(ready), Some(groups)) = (ready, &own.groups) else {
        return;
    };
    let buffers = BlockBound {
        shared: &groups.shared,
        looked: &groups.looked,
        arguments: &groups.arguments,
        triangles: &groups.triangles,
        ground: &groups.ground,
        head: &groups.head,
        looked_arguments: &own.looked,
        other_arguments: &own.arguments,
        slots: own.slots,
    };
    let store = blocks.stores.get_mut(&own.inputs.detail.finest.to_bits());
    let mut extras = own.extras;
    // Another view of the frame may have taken them over.
    if store.as_ref().is_none_or(|store| store.edited.is_empty()) {
        extras.edits = None;
    }
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let encoder = ctx.command_encoder();
    let (mut dispatches, mut looked) = (0, false);
    let rounds = (1..own.rounds).flat_map(|_| [Part::Look, Part::Make]);
    let parts = [Part::Begin].into_iter().chain(rounds);
    for part in parts.chain([Part::Choose, Part::Make]) {
        let mut steps = part.steps(extras).peekable();
        if steps.peek().is_none() {
            continue;
        }
        if part == Part::Begin && extras.edits.is_some() {
            record_clear(encoder, [&own.looked, &own.counts]);
        }
        if matches!(part, Part::Look | Part::Choose) {
            record_clear(encoder, [&own.looked, &own.counts]);
            // Rounds behind one that made nothing have nothing to do; what is drawn is chosen in any case.
            if part == Part::Choose || !looked {
                record_look_again(encoder, &own.lists, own.slots);
            }
            looked = true;
        }
        let makes = part == Part::Make;
        let name = if makes { "detail_making" } else { "detail" };
        let timestamp_writes = makes.then(|| pace.begin(&device)).flatten();
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
            label: Some(name),
            timestamp_writes,
        });
        let span = recorder.pass_span(&mut pass, name);
        for step in steps {
            record_step(&mut pass, ready[step.pass], &buffers, step);
            dispatches += 1;
        }
        span.end(&mut pass);
        drop(pass);
        if makes {
            pace.copy(encoder, &own.counts);
        }
    }
    shared.count_dispatches(dispatches);
    if let Some(store) = store {
        store.fresh = false;
        store.edited.clear();
    }
    state.settled = true;
    state.filled = true;
    state.counters.want();
}
