//! What the last tessellated frames did: counters for the panel, the bench and the tests.

use bevy::prelude::*;

/// Counters of terrain tessellation, summed over all views.
///
/// `dispatches` and `patches` are of the newest frame; the others are read back from the GPU and
/// are two or three frames old. Published as diagnostics under `dolomite/tessellation/<name>`.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TessellationStats {
    /// Triangles drawn.
    pub triangles: u32,
    /// Vertices emitted.
    pub vertices: u32,
    /// Patches inside the view frustum.
    pub patches_drawn: u32,
    /// Patches outside the view frustum: they emit nothing.
    pub patches_culled: u32,
    /// Compute dispatches of the newest frame; 0 while neither view nor terrain changes.
    pub dispatches: u32,
    /// Bytes of vertices and indices that the drawn triangles occupy.
    pub bytes: u64,
    /// How often levels were lowered to fit the pools, in the newest tessellation; 0 is usual.
    pub lowered: u32,
}
