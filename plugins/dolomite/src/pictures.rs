//! Pictures of the frame that read what plugins make: how many lights a tile has, ambient occlusion, shadow maps, the depth
//! pyramid, and what is found out of the drawn ground. And Bevy's wireframes, where an app has them.

use bevy::app::{App, PostUpdate};
use bevy::ecs::prelude::*;
use bevy::ecs::world::EntityRef;
use bevy::pbr::ViewShadowBindings;
use bevy::pbr::wireframe::WireframeConfig;
use bevy::render::render_resource::{Buffer, TextureView};
use dolomite_deferred::render::ViewLighting;
use dolomite_ground::render::inspect::ViewInspection;
use dolomite_ground::{GroundInspection, TerrainView};
use dolomite_inspector::picture::source::{Picture, Source, Way};
use dolomite_inspector::picture::{AddPicture, FramePicture};
use dolomite_inspector::views::{AddFrameView, FrameView};

/// How they are made: lights, occlusion, shadow maps, the depth pyramid; level, error and overdraw of the ground.
pub const WAYS: [Way; 7] = [
    Way {
        source: Source::Buffer(light_lists),
        define: "LIGHT_COUNTS",
    },
    Way {
        source: Source::Texture(visible_share),
        define: "SHARE",
    },
    Way {
        source: Source::Layers(cascades),
        define: "SHADOW_MAPS",
    },
    Way {
        source: Source::Buffer(depth_pyramid),
        define: "DEPTH_PYRAMID",
    },
    Way {
        source: Source::Texture(ground_level),
        define: "GROUND_LEVEL",
    },
    Way {
        source: Source::Texture(ground_error),
        define: "GROUND_ERROR",
    },
    Way {
        source: Source::Texture(ground_overdraw),
        define: "GROUND_OVERDRAW",
    },
];

/// Pictures of the ground, and what of it they need.
const INSPECTIONS: [(&str, GroundInspection); 3] = [
    ("ground_level", GroundInspection::Level),
    ("ground_error", GroundInspection::Error),
    ("ground_overdraw", GroundInspection::Overdraw),
];

/// A camera has its [`GroundInspection`] for a picture alone.
#[derive(Component)]
struct LentInspection;

/// Adds them to an app, whether the inspector was added already or not.
pub fn pictures(app: &mut App) {
    let [lights, share, shadows, pyramid, level, error, overdraw] = WAYS;
    app.picture(Picture::new(
        "lights",
        "point and spot lights of each tile: black none, red FramePicture.most; where tiles are lit",
        lights,
    ))
    .picture(Picture::new(
        "occlusion",
        "ambient occlusion: white is open; where a camera has AmbientOcclusion",
        share,
    ))
    .picture(Picture::new(
        "shadow_maps",
        "shadow maps of directional lights side by side, a layer a cascade: white is near",
        shadows,
    ))
    .picture(Picture::new(
        "depth_pyramid",
        "farthest distance under each texel of level FramePicture.level, as depth; where 256 lights of tiles are in view",
        pyramid,
    ))
    .picture(Picture::new(
        "ground_level",
        "the ground alone: level of the cell of each triangle, 0 a root; 23 and finer alike",
        level,
    ))
    .picture(Picture::new(
        "ground_error",
        "the ground alone: how far it is from the true one in the picture, black 0, yellow the tolerance, blue beyond",
        error,
    ))
    .picture(Picture::new(
        "ground_overdraw",
        "the ground alone: how many of its triangles a pixel shades, yellow 8, blue more",
        overdraw,
    ))
    .add_systems(PostUpdate, lend.run_if(is_inspected))
    .frame_view(FrameView::refusing(
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

fn wanted(shown: &FramePicture) -> Option<GroundInspection> {
    let mut all = INSPECTIONS.into_iter();
    let (_, what) = all.find(|(name, _)| shown.shown == *name)?;
    Some(what)
}

fn is_inspected(shown: Option<Res<FramePicture>>, lent: Query<(), With<LentInspection>>) -> bool {
    !lent.is_empty() || shown.is_some_and(|shown| wanted(&shown).is_some())
}

/// Lends cameras what the picture reads, and takes it back. What a camera has of its own stays.
fn lend(
    mut commands: Commands,
    shown: Res<FramePicture>,
    cameras: Query<(Entity, Option<&GroundInspection>, Has<LentInspection>), With<TerrainView>>,
) {
    let wanted = wanted(&shown);
    for (camera, own, lent) in &cameras {
        let mut camera = commands.entity(camera);
        match wanted {
            Some(what) if own.is_none() || (lent && own != Some(&what)) => {
                camera.insert((what, LentInspection));
            }
            None if lent => {
                camera.remove::<(GroundInspection, LentInspection)>();
            }
            _ => {}
        }
    }
}

fn light_lists(view: EntityRef) -> Option<Buffer> {
    view.get::<ViewLighting>()?.tile_lists().cloned()
}

fn visible_share(view: EntityRef) -> Option<TextureView> {
    let share = view.get::<ViewLighting>()?.visible_share()?;
    Some(share.default_view.clone())
}

fn cascades(view: EntityRef) -> Option<TextureView> {
    let bindings = view.get::<ViewShadowBindings>()?;
    Some(bindings.directional_light_depth_texture_view.clone())
}

fn depth_pyramid(view: EntityRef) -> Option<Buffer> {
    view.get::<ViewLighting>()?.depth_pyramid().cloned()
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
