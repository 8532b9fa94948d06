//! The kinds of patches that a city is made of.

use bevy::math::IVec4;
use bevy::prelude::*;
use bevy::render::render_resource::AsBindGroup;
use bevy::render::storage::ShaderBuffer;
use dolomite_tessellation::render::{GeometryMaterial, PatchKind, PatchPool, PatchShader};
use dolomite_tessellation::{Domain, PatchLayout};

use super::params::CityParams;
use crate::tube::MOST_SIDES;

/// Ground, walls, roofs and hedges: one kind, so that whatever lowers levels lowers all of them.
#[derive(Resource, AsBindGroup, Clone, Default)]
pub struct CityFaces {
    #[uniform(0)]
    pub(super) params: CityParams,
    #[storage(1, read_only, visibility(compute, vertex, fragment))]
    pub(super) maps: Handle<ShaderBuffer>,
}

/// Four corners, and four points of data, which belong to no side.
pub const FACE_LAYOUT: PatchLayout = PatchLayout {
    domain: Domain::Quads,
    points: 8,
    point_size: 1,
    sides: &[&[3, 0], &[0, 1], &[1, 2], &[2, 3]],
    split: false,
};

impl PatchKind for CityFaces {
    const LAYOUT: PatchLayout = FACE_LAYOUT;
    const CUSTOM_MATERIAL: bool = true;
    const UV_RANGE: f32 = 128.0;

    fn shader() -> PatchShader {
        PatchShader::Library("dolomite::city::patches")
    }

    /// 46 MB.
    fn pool(&self) -> PatchPool {
        PatchPool {
            vertices: 1 << 20,
            primitives: 1 << 21,
        }
    }
}

/// Buildings and hedges beyond the patches, by records.
#[derive(Resource, AsBindGroup, Clone, Default)]
pub struct CityRecords {
    #[uniform(0)]
    pub(super) params: CityParams,
    #[uniform(1)]
    pub(super) near: IVec4,
}

impl PatchKind for CityRecords {
    const LAYOUT: PatchLayout = PatchLayout::lines(2);
    const AMPLIFIED: u32 = 54;
    const CUSTOM_MATERIAL: bool = true;
    const UV_RANGE: f32 = 64.0;
    const SHADOWS: bool = false;

    fn shader() -> PatchShader {
        PatchShader::Library("dolomite::city::far")
    }
}

/// Posts of lamps.
#[derive(Resource, AsBindGroup, Clone, Default)]
pub struct CityPosts {
    #[uniform(0)]
    pub(super) params: CityParams,
}

impl PatchKind for CityPosts {
    const LAYOUT: PatchLayout = PatchLayout::lines(1);
    const AMPLIFIED: u32 = 6 * MOST_SIDES;

    fn shader() -> PatchShader {
        PatchShader::Library("dolomite::city::post")
    }

    fn materials(&self) -> Vec<GeometryMaterial> {
        vec![GeometryMaterial {
            base_color: LinearRgba::rgb(0.03, 0.036, 0.034),
            roughness: 0.4,
            ..default()
        }]
    }
}

/// Globes of lamps.
#[derive(Resource, AsBindGroup, Clone, Default)]
pub struct CityGlobes {
    #[uniform(0)]
    pub(super) params: CityParams,
}

impl PatchKind for CityGlobes {
    const LAYOUT: PatchLayout = PatchLayout::TRIANGLE;
    const CUSTOM_MATERIAL: bool = true;
    const SHADOWS: bool = false;

    fn shader() -> PatchShader {
        PatchShader::Library("dolomite::city::globe")
    }
}
