//! The scene in a resolution of its own: drawn into a picture that a second camera shows over the whole display, with
//! panels and text in the display's own pixels.
//!
//! Until the resolution is first another than the display's there is no picture and no second camera, and the scene is
//! drawn straight into the display.

use bevy::camera::{CameraUpdateSystems, ClearColorConfig, RenderTarget};
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;
use bevy::render::renderer::RenderDevice;
use bevy::window::PrimaryWindow;

use super::{OffscreenTarget, UiCamera};
use crate::settings::MAX_SIDE;
use crate::settings::quality::Quality;

/// Order of the camera that shows the picture: behind the scene's, which has 0, and before the start screen's.
const ORDER: isize = 1;

/// On the camera of a scene that may be scaled.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct Scaled;

/// The camera that shows the picture, and the picture on it.
#[derive(Component)]
struct Shows;

/// The picture that the scene is drawn into, and its size.
#[derive(Resource)]
struct Picture {
    image: Handle<Image>,
    size: UVec2,
}

/// Width and height of what is drawn and of what is shown, pixels.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PictureSize {
    /// The scene's.
    pub drawn: UVec2,
    /// The display's.
    pub shown: UVec2,
}

/// Scales scenes as [`Quality::resolution`] says.
pub struct ScaledPlugin;

impl Plugin for ScaledPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<PictureSize>().add_systems(
            PostUpdate,
            (fit, follow_panels)
                .chain()
                // Sizes of targets are brought up to date there, in the same frame.
                .before(CameraUpdateSystems),
        );
    }
}

/// Width and height of the display, pixels; none while there is no window, or a minimised one.
fn display_size(
    target: Option<&OffscreenTarget>,
    images: &Assets<Image>,
    windows: &Query<&Window, With<PrimaryWindow>>,
) -> Option<UVec2> {
    let size = match target {
        Some(target) => images.get(&target.0)?.size(),
        None => windows.iter().next()?.physical_size(),
    };
    (size.min_element() > 0).then_some(size)
}

fn display_target(target: Option<&OffscreenTarget>) -> RenderTarget {
    target.map_or_else(RenderTarget::default, |target| {
        RenderTarget::Image(target.0.clone().into())
    })
}

fn fit(
    mut commands: Commands,
    quality: Res<Quality>,
    target: Option<Res<OffscreenTarget>>,
    device: Option<Res<RenderDevice>>,
    windows: Query<&Window, With<PrimaryWindow>>,
    scenes: Query<(Entity, Option<&RenderTarget>), With<Scaled>>,
    picture: Option<ResMut<Picture>>,
    mut images: ResMut<Assets<Image>>,
    mut sizes: ResMut<PictureSize>,
    mut frames: Query<&mut ImageNode, With<Shows>>,
) {
    let Some((scene, known)) = scenes.iter().next() else {
        return;
    };
    let target = target.as_deref();
    let Some(shown) = display_size(target, &images, &windows) else {
        return;
    };
    let most = device.map_or(MAX_SIDE, |device| device.limits().max_texture_dimension_2d);
    let drawn = quality.drawn(shown, most);
    sizes.set_if_neq(PictureSize { drawn, shown });
    // Once there is a picture it stays, at whichever size.
    if drawn == shown && picture.is_none() {
        return;
    }
    let mut image = || {
        images.add(Image::new_target_texture(
            drawn.x,
            drawn.y,
            TextureFormat::Rgba8UnormSrgb,
            None,
        ))
    };
    if let Some(mut picture) = picture {
        if picture.size != drawn {
            picture.image = image();
            picture.size = drawn;
            for mut frame in &mut frames {
                frame.image = picture.image.clone();
            }
        }
        let is_there = known.is_some_and(
            |known| matches!(known, RenderTarget::Image(known) if known.handle == picture.image),
        );
        if !is_there {
            let target = RenderTarget::Image(picture.image.clone().into());
            commands.entity(scene).insert(target);
        }
        return;
    }
    let image = image();
    let display = commands
        .spawn((
            Shows,
            UiCamera,
            Camera2d,
            Camera {
                order: ORDER,
                clear_color: ClearColorConfig::Custom(Color::BLACK),
                ..default()
            },
            Msaa::Off,
            display_target(target),
        ))
        .id();
    commands.spawn((
        Shows,
        UiTargetCamera(display),
        // Below every panel.
        GlobalZIndex(i32::MIN),
        Node {
            position_type: PositionType::Absolute,
            width: percent(100),
            height: percent(100),
            ..default()
        },
        ImageNode {
            image: image.clone(),
            image_mode: NodeImageMode::Stretch,
            ..default()
        },
    ));
    commands
        .entity(scene)
        .insert(RenderTarget::Image(image.clone().into()))
        .remove::<UiCamera>();
    commands.insert_resource(Picture { image, size: drawn });
}

/// Panels stand on the camera that draws into the display, whichever that is.
fn follow_panels(
    cameras: Query<Entity, Added<UiCamera>>,
    others: Query<(), With<UiCamera>>,
    mut panels: Query<&mut UiTargetCamera, Without<Shows>>,
    scenes: Query<Entity, With<Scaled>>,
    mut last: Local<Option<Entity>>,
) {
    let Some(camera) = cameras.iter().next() else {
        return;
    };
    debug_assert!(!others.is_empty(), "one was added");
    for mut panel in &mut panels {
        // The start screen has a camera of its own.
        if scenes.contains(panel.0) || Some(panel.0) == *last {
            panel.0 = camera;
        }
    }
    *last = Some(camera);
}
