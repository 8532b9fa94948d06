//! Apps with a sky, and what is found in them.

#[cfg(feature = "render")]
pub mod renders;

use bevy::asset::AssetPlugin;
use bevy::prelude::*;
use bevy::transform::TransformPlugin;
use dolomite_sky::render::Dome;
use dolomite_sky::{Sky, SkyPlugin, Sun};

/// An app without a renderer that has assets and transforms, and the plugin.
pub fn app() -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        AssetPlugin::default(),
        TransformPlugin,
        SkyPlugin,
    ))
    .init_asset::<Image>();
    app
}

/// A sky whose maps are made in no time.
pub fn small() -> Sky {
    Sky {
        side: 8,
        ..Sky::default()
    }
}

/// A camera with one sample a pixel.
pub fn camera(app: &mut App, components: impl Bundle) -> Entity {
    let camera = (Camera3d::default(), Msaa::Off, components);
    app.world_mut().spawn(camera).id()
}

/// A sun at an elevation, degrees.
pub fn sun(app: &mut App, elevation: f32) -> Entity {
    let sun = Sun {
        elevation,
        ..Sun::default()
    };
    app.world_mut().spawn(sun).id()
}

/// Moves the sun.
pub fn set(app: &mut App, sun: Entity, elevation: f32) {
    let mut sun = app.world_mut().get_mut::<Sun>(sun).expect("a sun");
    sun.elevation = elevation;
}

/// Images, and what hangs in the skies, after two updates.
pub fn found(app: &mut App) -> (usize, usize) {
    app.update();
    app.update();
    let world = app.world_mut();
    let domes = world.query::<&Dome>().iter(world).count();
    (world.resource::<Assets<Image>>().len(), domes)
}
