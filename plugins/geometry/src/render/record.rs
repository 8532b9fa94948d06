//! What is recorded for a draw, in wgpu's own types: Bevy's passes, tests and studies all call this.

use crate::layout::{AMPLIFIED_ARGUMENTS, PLAIN_ARGUMENTS};

/// What a draw reads.
#[derive(Clone, Copy)]
pub struct Pools<'a> {
    /// Vertices.
    pub vertices: &'a wgpu::Buffer,
    /// Where they were in the last frame.
    pub previous: Option<&'a wgpu::Buffer>,
    /// Indices.
    pub indices: &'a wgpu::Buffer,
    /// Begins with a [`GeometryHead`](crate::layout::GeometryHead).
    pub work: &'a wgpu::Buffer,
}

/// Where a draw has its vertices from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawSource {
    /// Vertex and index buffers; arguments at the beginning of the work buffer.
    Indexed,
    /// The shader fetches them, by indices.
    Plain,
    /// The shader fetches a primitive, and makes of it what it likes.
    Amplified,
}

/// Pipeline and groups of draws.
pub struct DrawCall<'a> {
    /// Its pipeline.
    pub pipeline: &'a wgpu::RenderPipeline,
    /// Inputs of the producer, its data, and the view: group 2 has the fetched pools too, for draws that
    /// fetch.
    pub groups: [&'a wgpu::BindGroup; 3],
    /// Place in the view's uniform, bytes; `None` where the layout has no dynamic offset.
    pub slot: Option<u32>,
    /// What is drawn.
    pub pools: Pools<'a>,
    /// How.
    pub source: DrawSource,
}

/// Sets the call's pipeline, groups and buffers, and draws. Instead of all primitives, draws with `ranges`
/// are those whose arguments lie at these places of a buffer.
pub fn record_draw(
    pass: &mut wgpu::RenderPass<'_>,
    call: &DrawCall<'_>,
    ranges: Option<(&wgpu::Buffer, &mut dyn Iterator<Item = u64>)>,
) {
    pass.set_pipeline(call.pipeline);
    pass.set_bind_group(0, call.groups[0], &[]);
    pass.set_bind_group(1, call.groups[1], &[]);
    pass.set_bind_group(2, call.groups[2], call.slot.as_slice());
    let pools = &call.pools;
    match call.source {
        DrawSource::Plain => pass.draw_indirect(pools.work, PLAIN_ARGUMENTS),
        DrawSource::Amplified => pass.draw_indirect(pools.work, AMPLIFIED_ARGUMENTS),
        DrawSource::Indexed => {
            pass.set_vertex_buffer(0, pools.vertices.slice(..));
            if let Some(previous) = pools.previous {
                pass.set_vertex_buffer(1, previous.slice(..));
            }
            pass.set_index_buffer(pools.indices.slice(..), wgpu::IndexFormat::Uint32);
            match ranges {
                None => pass.draw_indexed_indirect(pools.work, 0),
                Some((arguments, places)) => {
                    for place in places {
                        pass.draw_indexed_indirect(arguments, place);
                    }
                }
            }
        }
    }
}

/// Sets the call's pipeline and groups, and `surfaces` as group 3, and shades what was kept of the surfaces of its producer
/// in a triangle over the picture; see [`DrawTraits::shaded_once`](super::DrawTraits::shaded_once).
pub fn record_covering(
    pass: &mut wgpu::RenderPass<'_>,
    call: &DrawCall<'_>,
    surfaces: &wgpu::BindGroup,
) {
    pass.set_pipeline(call.pipeline);
    pass.set_bind_group(0, call.groups[0], &[]);
    pass.set_bind_group(1, call.groups[1], &[]);
    pass.set_bind_group(2, call.groups[2], call.slot.as_slice());
    pass.set_bind_group(3, surfaces, &[]);
    pass.draw(0..3, 0..1);
}
