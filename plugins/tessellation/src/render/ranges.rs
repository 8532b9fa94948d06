//! Layout of the pass that chooses what of a kind shadow views draw, see
//! [`ShadowRanges`](dolomite_geometry::render::ShadowRanges).

use std::num::NonZero;

use bevy::render::render_resource::binding_types::{
    storage_buffer_read_only_sized, storage_buffer_sized, uniform_buffer_sized,
};
use bevy::render::render_resource::{
    BindGroupLayoutDescriptor, BindGroupLayoutEntries, ShaderStages,
};

use crate::layout::StageParams;

/// Parameters, tables, data, work; arguments of the draws; half-spaces of the shadow views.
pub fn layout() -> BindGroupLayoutDescriptor {
    let read = || storage_buffer_read_only_sized(false, None);
    BindGroupLayoutDescriptor::new(
        "stage_shadow_ranges",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::COMPUTE,
            (
                uniform_buffer_sized(false, NonZero::new(size_of::<StageParams>() as u64)),
                read(),
                read(),
                read(),
                storage_buffer_sized(false, None),
                read(),
            ),
        ),
    )
}
