//! The app of the example: with a window, or a picture without one.

use std::time::Duration;

use bevy::app::ScheduleRunnerPlugin;
use bevy::camera::RenderTarget;
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk};
use bevy::time::TimeUpdateStrategy;
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;

/// Frames before the picture: all pipelines are there.
const FRAMES: u32 = 60;

/// What follows an option of the command line.
fn option(name: &str) -> Option<String> {
    std::env::args()
        .skip_while(|argument| argument != name)
        .nth(1)
}

/// Bevy's plugins; time stands still for a picture.
pub fn app() -> App {
    let mut app = App::new();
    if option("--shot").is_some() {
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    }
    let Some(path) = option("--shot") else {
        app.add_plugins(DefaultPlugins);
        return app;
    };
    app.add_plugins(
        DefaultPlugins
            .set(WindowPlugin {
                primary_window: None,
                exit_condition: ExitCondition::DontExit,
                ..default()
            })
            .disable::<WinitPlugin>(),
    )
    .add_plugins(ScheduleRunnerPlugin::run_loop(Duration::ZERO))
    .add_systems(
        Update,
        move |mut commands: Commands,
              mut images: ResMut<Assets<Image>>,
              cameras: Query<Entity, With<Camera3d>>,
              mut target: Local<Option<Handle<Image>>>,
              mut frame: Local<u32>| {
            let target = target.get_or_insert_with(|| {
                let format = TextureFormat::Rgba8UnormSrgb;
                images.add(Image::new_target_texture(960, 540, format, None))
            });
            if *frame == 0 {
                for camera in &cameras {
                    let target = RenderTarget::Image(target.clone().into());
                    commands.entity(camera).insert(target);
                }
            }
            *frame += 1;
            if *frame == FRAMES {
                commands
                    .spawn(Screenshot::image(target.clone()))
                    .observe(save_to_disk(path.clone()))
                    .observe(
                        |_: On<ScreenshotCaptured>, mut exit: MessageWriter<AppExit>| {
                            exit.write(AppExit::Success);
                        },
                    );
            }
        },
    );
    app
}
