//! The example of the README, drawn.

use bevy::camera::RenderTarget;
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use dolomite_deferred::choice::Chosen;
use dolomite_deferred::{DeferredPlugin, DeferredStats};
use dolomite_testkit::light as support;

use crate::night;

#[derive(Resource, Default)]
struct Captured(Option<Image>);

#[test]
fn a_night_of_lamps_is_lit_by_tiles() {
    let app = support::app_with(|app| {
        app.add_plugins(DeferredPlugin)
            .init_resource::<Captured>()
            .add_systems(Startup, night::setup);
    });
    let Some(mut app) = app else { return };
    app.update();
    let target = Image::new_target_texture(640, 360, TextureFormat::Rgba8UnormSrgb, None);
    let target = app.world_mut().resource_mut::<Assets<Image>>().add(target);
    let world = app.world_mut();
    let mut cameras = world.query_filtered::<Entity, With<Camera3d>>();
    let camera = cameras.single(world).expect("one camera");
    world
        .entity_mut(camera)
        .insert(RenderTarget::Image(target.clone().into()));
    support::frames(&mut app, 8);
    app.world_mut().spawn(Screenshot::image(target)).observe(
        |shot: On<ScreenshotCaptured>, mut captured: ResMut<Captured>| {
            captured.0 = Some(shot.image.clone());
        },
    );
    support::frames(&mut app, 4);
    let views = app.world().resource::<DeferredStats>().views();
    assert_eq!(views[0].chosen, Chosen::Tiled);
    assert!(views[0].lights > 100, "{views:?}");
    let image = app.world_mut().resource_mut::<Captured>().0.take();
    let picture = image
        .expect("a picture")
        .try_into_dynamic()
        .expect("8 bits")
        .into_rgb8();
    let lit = picture
        .pixels()
        .filter(|p| p.0.iter().any(|byte| *byte > 40))
        .count();
    assert!(lit > 20_000, "{lit} pixels of some light");
    if let Some(folder) = std::env::var_os("DOLOMITE_PICTURES") {
        let path = std::path::Path::new(&folder).join("deferred.png");
        picture.save(path).expect("written");
    }
}
