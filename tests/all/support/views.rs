//! Views of the frame, by the table that the console, the panel and the help have, and what is seen of them.

use super::picture;

use bevy::prelude::*;
use dolomite::inspector::views::FrameViews;

/// Switches a view.
pub fn switch(app: &mut App, name: &str, on: bool) {
    let views = app.world().resource::<FrameViews>().clone();
    let view = views.get(name).expect("it is in the table");
    view.switch(app.world_mut(), on).expect("it is not refused");
    assert_eq!(view.is_on(app.world()), on);
}

/// What is seen after some frames with a view on. `DOLOMITE_PICTURES` keeps it in that folder.
pub fn shown(app: &mut App, target: &Handle<Image>, name: &str) -> Vec<[u8; 4]> {
    switch(app, name, true);
    let image = picture::picture(app, target, 8);
    if let Some(folder) = std::env::var_os("DOLOMITE_PICTURES") {
        let file = std::path::Path::new(&folder).join(format!("view-{name}.png"));
        let kept = image.clone().try_into_dynamic().expect("bytes");
        kept.to_rgb8()
            .save(file)
            .expect("the folder can be written");
    }
    let data = image.data.expect("it was read back");
    data.as_chunks().0.to_vec()
}

/// How far a pixel is from a colour, levels of 255 in its worst channel.
pub fn off(pixel: [u8; 4], colour: Vec3) -> f32 {
    let off = |(channel, expected): (u8, f32)| (f32::from(channel) - 255.0 * expected).abs();
    let channels = pixel.into_iter().zip(colour.to_array());
    channels.map(off).fold(0.0, f32::max)
}

/// The colour passes through a target that keeps it by sRGB, and is rounded.
pub fn assert_is(pixel: [u8; 4], colour: Vec3, what: &str) {
    let off = off(pixel, colour);
    assert!(off <= 1.0, "{what}: {pixel:?} for {colour}, off by {off}");
}
