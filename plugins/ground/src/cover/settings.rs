//! The components that make a camera see the ground, and choose how it is refined there.

use bevy::prelude::*;

use crate::detail::TerrainLod;
use dolomite_tessellation::GeometryCamera;

/// Makes a camera see every visible terrain. Each takes pools of its own in every view.
///
/// Which triangles it gets is chosen by the [`TerrainLod`] that comes along: the ground is drawn with its error
/// bounded in pixels. A [`PatchDetail`] beside it says patches of the tessellation stage instead; each camera has
/// its own rule, whatever others have. Fill and lines are set by the [`GeometryCamera`], which comes along too.
///
/// A camera without this component costs nothing: no pipeline, no buffer, no pass. It also needs
/// Bevy's deferred G-buffer, see [`GeometryCamera`].
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default)]
#[require(crate::TerrainCover, GeometryCamera, TerrainLod)]
pub struct TerrainView;

/// Makes a camera with a [`TerrainView`] see the ground as patches of the tessellation stage, in place of what its
/// [`TerrainLod`] says: a quadtree around the focus, whose leaves are cut by the length of their edges in the picture.
///
/// How fine they are cut, and the focus, are set by the [`GeometryCamera`]. There are no bounds of the error, and no
/// height queries from what is drawn; of several terrains the first visible one is drawn, and a warning says so.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct PatchDetail {
    /// Side of the smallest patch, in metres. Default 16; range 1 to 4096 (clamped). The densest
    /// possible grid is a 64th of it.
    pub finest_patch: f32,
    /// A quadtree node is split while the focus is nearer than this many of its sides.
    /// Default 2; at least 1.5 (clamped), which keeps neighbours within one level.
    pub split_distance: f32,
    /// Capacity of the vertex pool, in vertices of 20 bytes. Default 1 048 576 (20 MiB).
    /// Where a frame needs more, all levels are lowered evenly until it fits. With several views the
    /// greatest of them counts for each.
    pub max_vertices: u32,
    /// Capacity of the index pool, in triangles of 12 bytes. Default 2 097 152 (24 MiB).
    pub max_triangles: u32,
}

impl Default for PatchDetail {
    fn default() -> Self {
        Self {
            finest_patch: 16.0,
            split_distance: 2.0,
            max_vertices: 1 << 20,
            max_triangles: 1 << 21,
        }
    }
}

impl PatchDetail {
    /// The same with every field in its documented range.
    #[must_use]
    pub(crate) fn clamped(self) -> Self {
        let finite = |value: f32, low: f32, high: f32, default: f32| {
            if value.is_finite() {
                value.clamp(low, high)
            } else {
                default
            }
        };
        Self {
            finest_patch: finite(self.finest_patch, 1.0, 4096.0, 16.0),
            split_distance: finite(self.split_distance, 1.5, 16.0, 2.0),
            max_vertices: self.max_vertices.clamp(1 << 16, 1 << 23),
            max_triangles: self.max_triangles.clamp(1 << 17, 10_000_000),
        }
    }
}
