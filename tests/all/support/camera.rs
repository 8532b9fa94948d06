//! A camera that draws into an image.

use bevy::camera::RenderTarget;
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;

/// A camera of this many pixels with `components` besides, and what it draws into.
pub fn camera(app: &mut App, size: UVec2, components: impl Bundle) -> (Entity, Handle<Image>) {
    let image = Image::new_target_texture(size.x, size.y, TextureFormat::Rgba8UnormSrgb, None);
    let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
    let target = RenderTarget::Image(image.clone().into());
    let camera = (Camera3d::default(), Msaa::Off, target);
    let mut camera = app.world_mut().spawn(camera);
    camera.insert(components);
    (camera.id(), image)
}
