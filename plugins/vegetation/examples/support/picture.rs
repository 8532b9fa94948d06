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
use dolomite_ground::GroundCanopy;
use dolomite_sky::Sun;
use dolomite_vegetation::render::VegetationStats;

/// Frames that nothing is dispatched in before the picture: pipelines are there, the ground is whole.
const FRAMES: u32 = 8;

/// The picture is taken after so many at the latest.
const MOST_FRAMES: u32 = 900;

/// What follows an option of the command line.
pub fn option(name: &str) -> Option<String> {
    std::env::args()
        .skip_while(|argument| argument != name)
        .nth(1)
}

/// Numbers of an option, separated by commas.
pub fn numbers<const N: usize>(name: &str) -> Option<[f32; N]> {
    let text = option(name)?;
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    numbers.ok()?.try_into().ok()
}

/// `--sun AZIMUTH,ELEVATION`, in degrees; else an afternoon.
pub fn sun() -> Sun {
    let [azimuth, elevation] = numbers("--sun").unwrap_or([290.0, 26.0]);
    Sun { azimuth, elevation }
}

/// Bevy's plugins. For a picture a frame is a sixtieth of a second, however long it takes.
pub fn app() -> App {
    let mut app = App::new();
    let Some(path) = option("--shot") else {
        app.add_plugins(DefaultPlugins);
        return app;
    };
    let [width, height] = numbers("--size").unwrap_or([960.0, 540.0]);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_micros(
        16_667,
    )))
    .add_plugins(
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
              stats: Res<VegetationStats>,
              canopies: Query<&GroundCanopy>,
              mut frame: Local<u32>,
              mut rests: Local<(u64, u32)>| {
            let target = target.get_or_insert_with(|| {
                let format = TextureFormat::Rgba8UnormSrgb;
                images.add(Image::new_target_texture(
                    width as u32,
                    height as u32,
                    format,
                    None,
                ))
            });
            if *frame == 0 {
                for camera in &cameras {
                    let target = RenderTarget::Image(target.clone().into());
                    commands.entity(camera).insert(target);
                }
            }
            *frame += 1;
            let count = stats.get();
            if count.draws == 0 || count.dispatches != rests.0 || canopies.is_empty() {
                *rests = (count.dispatches, *frame);
            }
            if *frame - rests.1 == FRAMES || *frame == MOST_FRAMES {
                println!("{count:?}");
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
