//! The components that shape the ground: one on the camera, one on the terrain.

use bevy::prelude::*;

use dolomite_tessellation::StageCamera;

/// Makes a camera see the terrain, and sets its patches. How fine they are cut is set by the
/// [`StageCamera`], which comes along: wanted length of an edge in pixels, the point that detail
/// follows, fill and lines.
///
/// A camera without this component costs nothing: no pipeline, no buffer, no pass. It also needs
/// Bevy's deferred G-buffer, see [`StageCamera`].
#[derive(Component, Clone, Debug, PartialEq)]
#[require(crate::TerrainCover, StageCamera)]
pub struct TerrainView {
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

impl Default for TerrainView {
    fn default() -> Self {
        Self {
            finest_patch: 16.0,
            split_distance: 2.0,
            max_vertices: 1 << 20,
            max_triangles: 1 << 21,
        }
    }
}

/// Where each ground material lies: by height, slope and the sea.
///
/// Heights are world metres, slopes are rise over run. Boundaries are moved by the height of the
/// textures and by low-frequency noise, so that they never show as contour lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialBands {
    /// Sand reaches this height above the sea level, metres. Default 4.
    pub sand_top: f32,
    /// Grass gives way to scree around this height. Default 700.
    pub tree_line: f32,
    /// Snow lies above this height where it is not too steep. Default 1250.
    pub snow_line: f32,
    /// Width of the transitions at the tree and snow lines, metres. Default 160.
    pub blend: f32,
    /// Slope at which grass gives way to bare rock. Default 0.75.
    pub rock_slope: f32,
    /// Slope at which snow no longer holds. Default 1.1.
    pub snow_slope: f32,
}

impl Default for MaterialBands {
    fn default() -> Self {
        Self {
            sand_top: 4.0,
            tree_line: 700.0,
            snow_line: 1250.0,
            blend: 160.0,
            rock_slope: 0.75,
            snow_slope: 1.1,
        }
    }
}

#[cfg(feature = "render")]
/// The look of a terrain: goes on the entity that carries the `Terrain`.
///
/// Both images are 2D arrays of the same size with the layers 0 sand, 1 grass, 2 rock, 3 snow,
/// 4 scree. Until they are loaded the terrain is not drawn.
#[derive(Component, Clone, Debug)]
pub struct TerrainMaterial {
    /// `Rgba8UnormSrgb` array: albedo in rgb, height for height blending in a.
    pub albedo_height: Handle<Image>,
    /// `Rgba8Unorm` array: tangent-space normal xy, perceptual roughness, ambient occlusion.
    pub normal_roughness: Handle<Image>,
    /// Side of one texture tile on the ground, metres. Default 3.
    pub tile: f32,
    /// Where each material lies.
    pub bands: MaterialBands,
}

#[cfg(feature = "render")]
impl TerrainMaterial {
    /// A material from its two texture arrays, with the default tile size and bands.
    pub fn new(albedo_height: Handle<Image>, normal_roughness: Handle<Image>) -> Self {
        Self {
            albedo_height,
            normal_roughness,
            tile: 3.0,
            bands: MaterialBands::default(),
        }
    }
}
