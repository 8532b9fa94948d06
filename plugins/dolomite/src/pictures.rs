//! Pictures of the frame that read what plugins make: how many lights a tile has, ambient occlusion, shadow maps, the depth
//! pyramid, how far the light is from the reference, and what is found out of the drawn ground and of what grows on it. And
//! Bevy's wireframes, where an app has them.
//!
//! | file | concern |
//! |---|---|
//! | `lent` | what cameras have while a picture reads it |
//! | `shadows` | shadow maps, and which were drawn |

mod lent;
mod shadows;

use bevy::app::App;
use bevy::ecs::world::EntityRef;
use bevy::pbr::wireframe::WireframeConfig;
use bevy::render::render_resource::{Buffer, TextureView};
use dolomite_deferred::render::{ViewDifference, ViewLighting};
use dolomite_ground::GroundInspection;
use dolomite_ground::render::inspect::ViewInspection;
use dolomite_inspector::picture::AddPicture;
use dolomite_inspector::picture::source::{Picture, Source, Way};
use dolomite_inspector::views::{AddFrameView, FrameView};
use dolomite_vegetation::render::ranks::ViewRanks;

const fn way(source: Source, define: &'static str) -> Way {
    Way { source, define }
}

/// How they are made: lights, occlusion, shadow maps of suns and spots, and of points, the depth pyramid, the difference
/// against the reference; level, error and overdraw of the ground; ranks of what grows.
pub const WAYS: [Way; 10] = [
    way(Source::Buffer(light_lists), "LIGHT_COUNTS"),
    way(Source::Texture(visible_share), "SHARE"),
    shadows::SUNS,
    shadows::POINTS,
    way(Source::Buffer(depth_pyramid), "DEPTH_PYRAMID"),
    way(Source::Texture(light_difference), "LIGHT_DIFFERENCE"),
    way(Source::Texture(ground_level), "GROUND_LEVEL"),
    way(Source::Texture(ground_error), "GROUND_ERROR"),
    way(Source::Texture(ground_overdraw), "GROUND_OVERDRAW"),
    way(Source::Texture(grass_rank), "GRASS_RANK"),
];

/// Names of the pictures, and what they show, in the order of [`WAYS`].
const NAMED: [(&str, &str); WAYS.len()] = [
    (
        "lights",
        "point and spot lights of each tile: black none, red FramePicture.most; where tiles are lit",
    ),
    (
        "occlusion",
        "ambient occlusion: white is open; where a camera has AmbientOcclusion",
    ),
    (
        "shadow_maps",
        "shadow maps of directional and spot lights side by side: white is near; orange frames: drawn in this frame",
    ),
    (
        "point_shadow_maps",
        "faces of point lights' shadow maps side by side, bright is near; orange frames: drawn in this frame, blue: kept",
    ),
    (
        "depth_pyramid",
        "farthest distance under each texel of level FramePicture.level, as depth; where 256 lights of tiles are in view",
    ),
    (
        "light_difference",
        "how far the light is from that by all lights in each pixel, in percent: yellow FramePicture.difference, blue more; where DeferredLighting lights",
    ),
    (
        "ground_level",
        "the ground alone: level of the cell of each triangle, 0 a root; 23 and finer alike",
    ),
    (
        "ground_error",
        "the ground alone: how far it is from the true one in the picture, black 0, yellow the tolerance, blue beyond",
    ),
    (
        "ground_overdraw",
        "the ground alone: how many of its triangles a pixel shades, yellow 8, blue more",
    ),
    (
        "grass_rank",
        "what grows alone: its rank among those of its kind, black the first, which are drawn far away, yellow the last",
    ),
];

/// Adds them to an app, whether the inspector was added already or not.
pub fn pictures(app: &mut App) {
    for ((name, about), way) in NAMED.into_iter().zip(WAYS) {
        app.picture(Picture::new(name, about, way));
    }
    lent::build(app);
    app.frame_view(FrameView::refusing(
        "wireframe",
        "edges of all meshes, by Bevy's WireframePlugin",
        |world| {
            let config = world.get_resource::<WireframeConfig>();
            config.is_some_and(|config| config.global)
        },
        |world, on| match world.get_resource_mut::<WireframeConfig>() {
            Some(mut config) => {
                config.global = on;
                Ok(())
            }
            None => Err("wireframe is not shown: this app lacks Bevy's WireframePlugin".to_owned()),
        },
    ));
}

fn light_lists(view: EntityRef) -> Option<Buffer> {
    view.get::<ViewLighting>()?.tile_lists().cloned()
}

fn visible_share(view: EntityRef) -> Option<TextureView> {
    let share = view.get::<ViewLighting>()?.visible_share()?;
    Some(share.default_view.clone())
}

fn depth_pyramid(view: EntityRef) -> Option<Buffer> {
    view.get::<ViewLighting>()?.depth_pyramid().cloned()
}

fn light_difference(view: EntityRef) -> Option<TextureView> {
    Some(view.get::<ViewDifference>()?.found.default_view.clone())
}

fn inspection(view: EntityRef, what: GroundInspection) -> Option<TextureView> {
    let own = view.get::<ViewInspection>()?;
    (own.what == what).then(|| own.found.default_view.clone())
}

fn ground_level(view: EntityRef) -> Option<TextureView> {
    inspection(view, GroundInspection::Level)
}

fn ground_error(view: EntityRef) -> Option<TextureView> {
    inspection(view, GroundInspection::Error)
}

fn ground_overdraw(view: EntityRef) -> Option<TextureView> {
    inspection(view, GroundInspection::Overdraw)
}

fn grass_rank(view: EntityRef) -> Option<TextureView> {
    Some(view.get::<ViewRanks>()?.found.default_view.clone())
}
