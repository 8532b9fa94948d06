//! Pictures of the frame that read what plugins make: how many lights a tile has, ambient occlusion, shadow maps. And Bevy's
//! wireframes, where an app has them.

use bevy::app::App;
use bevy::ecs::world::EntityRef;
use bevy::pbr::ViewShadowBindings;
use bevy::pbr::wireframe::WireframeConfig;
use bevy::render::render_resource::{Buffer, TextureView};
use dolomite_deferred::render::ViewLighting;
use dolomite_inspector::picture::AddPicture;
use dolomite_inspector::picture::source::{Picture, Source, Way};
use dolomite_inspector::views::{AddFrameView, FrameView};

/// How they are made: lights, occlusion, shadow maps.
pub const WAYS: [Way; 3] = [
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
];

/// Adds them to an app, whether the inspector was added already or not.
pub fn pictures(app: &mut App) {
    let [lights, share, shadows] = WAYS;
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
