//! The stars in the sky: one entity of six thousand octahedra, which the tessellation stage draws on
//! a dome about the camera. By day there is none.

use bevy::math::Vec4;
use bevy::prelude::*;
use bevy::render::render_resource::{AsBindGroup, ShaderType};
use dolomite_tessellation::render::{PatchKind, PatchPool, PatchShader};
use dolomite_tessellation::{PatchLayout, PatchMesh};

use super::dome::DOME;
use super::dress::DrawnSky;
use super::night::{Hung, NightKind};
use super::star_mesh;
use crate::air::zenith_depth;
use crate::seen::SeenSky;
use crate::star_catalogue::{self, COLOURS, STARS};

/// Illuminance of a star of magnitude 0 outside the air, lux.
const MAGNITUDE_0: f32 = 2.54e-6;

/// Share of a star's colour that is shown: the rest is white, as the eye has it.
const COLOURED: f32 = 0.7;

/// The kind of patches that stars are.
#[derive(Resource, AsBindGroup, Clone, Default, PartialEq)]
pub struct Star {
    #[uniform(0)]
    light: StarLight,
    #[texture(1, dimension = "cube")]
    #[sampler(2)]
    sky: Option<Handle<Image>>,
}

/// Laid out as `StarLight` in `star.wgsl`.
#[derive(ShaderType, Clone, Copy, Default, PartialEq)]
struct StarLight {
    /// Exposed illuminance of a star of magnitude 0, for each class of colour.
    colours: [Vec4; COLOURS as usize],
    /// Optical depth of the air above; w: exposed luminance of 1 in the map of the sky.
    depth: Vec4,
}

impl PatchKind for Star {
    const LAYOUT: PatchLayout = PatchLayout::TRIANGLE;
    const CUSTOM_MATERIAL: bool = true;
    const SHADOWS: bool = false;

    fn shader() -> PatchShader {
        PatchShader::Library("dolomite::sky::star")
    }

    /// Every octahedron of the dome, unrefined.
    fn pool(&self) -> PatchPool {
        PatchPool {
            vertices: 6 * STARS,
            primitives: 8 * STARS,
        }
    }
}

impl NightKind for Star {
    const NAME: &'static str = "stars";

    fn of(seen: &SeenSky, drawn: &DrawnSky) -> Option<Self> {
        let share = seen.heavens.stars;
        if share == 0.0 || seen.sky.stars == 0.0 {
            return None;
        }
        let light = MAGNITUDE_0 * seen.sky.stars * share * drawn.exposure;
        let mut colours = [Vec4::ZERO; COLOURS as usize];
        for (class, colour) in (0..).zip(&mut colours) {
            let shown = Vec3::ONE.lerp(star_catalogue::colour(class), COLOURED);
            *colour = (shown * light).extend(0.0);
        }
        Some(Self {
            light: StarLight {
                colours,
                depth: zenith_depth(seen.sky.dust).extend(drawn.exposure * drawn.scale),
            },
            sky: Some(drawn.map.clone()),
        })
    }

    fn hung(_: &SeenSky) -> Hung {
        Hung {
            offset: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            scale: DOME,
        }
    }

    fn mesh() -> Option<PatchMesh> {
        star_mesh::mesh(&star_catalogue::catalogue())
            .inspect_err(|fault| error!("there are no stars: {fault}"))
            .ok()
    }
}
