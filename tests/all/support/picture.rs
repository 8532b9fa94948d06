//! What a camera sees, on the CPU.

use bevy::app::App;
use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};

#[derive(Resource, Default)]
struct Captured(Option<Image>);

/// The image after `frames` frames.
pub fn picture(app: &mut App, target: &Handle<Image>, frames: usize) -> Image {
    for _ in 0..frames {
        app.update();
        assert_eq!(app.should_exit(), None, "rendering stopped");
    }
    app.init_resource::<Captured>();
    app.world_mut()
        .spawn(Screenshot::image(target.clone()))
        .observe(
            |shot: On<ScreenshotCaptured>, mut captured: ResMut<Captured>| {
                captured.0 = Some(shot.image.clone());
            },
        );
    for _ in 0..200 {
        app.update();
        if let Some(image) = app.world_mut().resource_mut::<Captured>().0.take() {
            return image;
        }
    }
    panic!("no picture came back");
}
