//! The example, in an app without a window: something good to look at is drawn, without a file.
//!
//! With `DOLOMITE_PICTURE=FILE.png` the picture is saved.

#![cfg(feature = "render")]

mod app;
#[expect(dead_code, reason = "its `main` opens a window")]
#[path = "../examples/ground.rs"]
mod ground;

use std::collections::HashSet;
use std::time::Duration;

use bevy::camera::RenderTarget;
use bevy::prelude::*;

#[test]
fn gpu_the_example_draws_an_island_without_a_file() {
    let Some(mut app) = app::app() else { return };
    app.insert_resource(ClearColor(Color::srgb(0.55, 0.70, 0.86)));
    let saved = std::env::var_os("DOLOMITE_PICTURE");
    let size = if saved.is_some() { [960, 540] } else { [320, 180] };
    app.world_mut()
        .run_system_cached(ground::setup)
        .expect("the system runs")
        .expect("the terrain is valid");
    let target = app::target(&mut app, size[0], size[1]);
    let mut cameras = app.world_mut().query_filtered::<Entity, With<Camera3d>>();
    let camera = cameras.single(app.world()).expect("one camera");
    app.world_mut()
        .entity_mut(camera)
        .insert(RenderTarget::Image(target.clone().into()));
    // Textures are made in the background.
    for _ in 0..600 {
        app::frames(&mut app, 1);
        std::thread::sleep(Duration::from_millis(10));
        let stats = app.world().resource::<dolomite_geometry::GeometryStats>();
        if stats.primitives > 1000 {
            break;
        }
    }
    app::frames(&mut app, 8);
    let image = app::picture(&mut app, &target);
    if let Some(path) = saved {
        let picture = image.clone().try_into_dynamic().expect("eight bits");
        picture.to_rgb8().save(path).expect("a file that can be written");
    }
    let data = image.data.expect("pixels");
    let colours: HashSet<[u8; 3]> = data.chunks_exact(4).map(|p| [p[0] / 8, p[1] / 8, p[2] / 8]).collect();
    // Of 32 768: a picture of one material in even light has some dozens.
    assert!(colours.len() > 200, "{} colours", colours.len());
    let greens = data.chunks_exact(4).filter(|p| p[1] > p[0] && p[1] > p[2]).count();
    assert!(greens * 20 > data.len() / 4, "grass covers {greens} pixels");
}
