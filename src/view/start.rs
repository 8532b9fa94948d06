//! The start screen: what is being done, from the first frame until there is a picture.
//!
//! The first frames hold nothing else, so that they are quick. Meanwhile the textures are read in the
//! background; then the [`Dress`] schedule makes the scene visible, and what its picture needs is compiled
//! and built below this screen.

use std::time::Duration;

use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, futures_lite::future};

use dolomite::ground::detail::MakingBudget;

use super::progress::{Made, Progress, textures_are_there};
use super::textures::TextureError;
use super::{Dress, SceneTextures, textures};
use crate::scene::CurrentScene;
use crate::settings::paths::AssetsDir;

/// Blocks of ground that a frame makes below this screen: how long such a frame takes matters less than how fine the
/// first picture is.
const BELOW: MakingBudget = MakingBudget { blocks: Some(128) };

/// Frames of the finished screen in a window that is shown before the scene joins it: the first is on the display
/// when the third is made.
const ALONE: u32 = 3;

/// Shows what is being done until there is a picture. In place of [`Dress`] at the start.
pub struct StartPlugin;

impl Plugin for StartPlugin {
    fn build(&self, app: &mut App) {
        super::init_dress(app);
        app.insert_resource(Starting)
            .init_resource::<Finished>()
            .add_systems(Startup, (spawn, read_textures))
            .add_systems(
                Update,
                (
                    take_textures.run_if(resource_exists::<Reading>),
                    count_finished.run_if(not(resource_exists::<Dressed>)),
                    show_window.run_if(any_with_component::<Hidden>),
                    dress.run_if(not(resource_exists::<Dressed>)),
                    write.run_if(any_with_component::<Screen>),
                )
                    .chain(),
            );
    }
}

/// In the world while the screen is shown.
#[derive(Resource)]
pub struct Starting;

/// A window that is made with `visible: false` and shown once the screen was drawn into it: before that Bevy
/// presents pictures that no pass has written, whose memory may hold anything.
#[derive(Component)]
pub struct Hidden;

/// Frames of the finished screen until such a window is shown: the first has been presented when the second is made.
const UNSEEN: u32 = 2;

/// It is shown after this in any case, so that nobody waits for a window without a word.
const SHOWN_AFTER: Duration = Duration::from_secs(2);

/// The screen, and its camera.
#[derive(Component)]
struct Screen;

#[derive(Component)]
struct Words;

#[derive(Component)]
struct Bar;

/// The scene has been made visible.
#[derive(Resource)]
struct Dressed;

/// Frames of this screen with all its shaders so far.
#[derive(Resource, Default)]
struct Finished(u32);

/// The textures are being read.
#[derive(Resource)]
struct Reading(Task<Result<[Image; 2], TextureError>>);

fn spawn(mut commands: Commands, scene: Res<CurrentScene>, making: Option<ResMut<MakingBudget>>) {
    if let Some(mut making) = making {
        *making = BELOW;
    }
    let camera = commands
        .spawn((
            Screen,
            Camera2d,
            // As the camera that shows a scaled scene: cameras of one window share its depth texture.
            Msaa::Off,
            Camera {
                // Over the scene, which is drawn below it before it is whole.
                order: 2,
                ..default()
            },
        ))
        .id();
    let line = |text: &str, size: f32, grey: f32| {
        (
            Text::new(text),
            TextFont {
                font_size: FontSize::Px(size),
                ..default()
            },
            TextColor(Color::srgb(grey, grey, grey)),
        )
    };
    commands.spawn((
        Screen,
        UiTargetCamera(camera),
        Node {
            width: percent(100),
            height: percent(100),
            flex_direction: FlexDirection::Column,
            align_items: AlignItems::Center,
            justify_content: JustifyContent::Center,
            row_gap: px(10),
            ..default()
        },
        BackgroundColor(Color::srgb(0.03, 0.05, 0.08)),
        children![
            line(&format!("Dolomite: {}", scene.name), 22.0, 0.95),
            (line(&Made::default().step(), 14.0, 0.75), Words),
            (
                Node {
                    width: percent(40),
                    height: px(4),
                    ..default()
                },
                BackgroundColor(Color::srgb(0.12, 0.15, 0.2)),
                children![(
                    Bar,
                    Node {
                        width: percent(0),
                        height: percent(100),
                        ..default()
                    },
                    BackgroundColor(Color::srgb(0.93, 0.95, 0.97)),
                )],
            ),
            line("Esc leaves", 12.0, 0.45),
        ],
    ));
}

/// Reads the ground's textures in the background, where the scene has need of them.
fn read_textures(mut commands: Commands, scene: Res<CurrentScene>, assets: Res<AssetsDir>) {
    if scene.own.is_some() {
        commands.run_system_cached(textures_are_there);
        return;
    }
    let folder = assets.0.join("textures");
    let task = AsyncComputeTaskPool::get().spawn(async move { textures::read_ground(&folder) });
    commands.insert_resource(Reading(task));
}

fn take_textures(
    mut commands: Commands,
    mut reading: ResMut<Reading>,
    mut images: ResMut<Assets<Image>>,
    mut exit: MessageWriter<AppExit>,
) {
    let Some(read) = block_on(future::poll_once(&mut reading.0)) else {
        return;
    };
    commands.remove_resource::<Reading>();
    match read {
        Ok(read) => {
            commands.insert_resource(SceneTextures::new(read, &mut images));
            commands.run_system_cached(textures_are_there);
        }
        Err(error) => {
            eprintln!("dolomite: {error}");
            exit.write(AppExit::error());
        }
    }
}

/// Counts the frames in which all shaders that were asked for are there.
fn count_finished(progress: Res<Progress>, mut finished: ResMut<Finished>) {
    let (ready, asked) = progress.made().shaders;
    finished.0 += u32::from(asked > 0 && ready == asked);
}

fn show_window(
    mut commands: Commands,
    finished: Res<Finished>,
    time: Res<Time<Real>>,
    mut windows: Query<(Entity, &mut Window), With<Hidden>>,
) {
    if finished.0 < UNSEEN && time.elapsed() < SHOWN_AFTER {
        return;
    }
    for (entity, mut window) in &mut windows {
        window.visible = true;
        // It may be closed in the same frame.
        commands.entity(entity).try_remove::<Hidden>();
    }
}

/// Makes the scene visible once this screen has been seen and the textures are there. What the scene needs
/// would else be compiled before what the screen needs.
fn dress(world: &mut World) {
    let made = world.resource::<Progress>().made();
    if world.resource::<Finished>().0 > UNSEEN + ALONE && made.textures {
        world.insert_resource(Dressed);
        world.run_schedule(Dress);
    }
}

/// Says what is being done; goes when there is a picture.
fn write(
    mut commands: Commands,
    progress: Res<Progress>,
    dressed: Option<Res<Dressed>>,
    screens: Query<Entity, With<Screen>>,
    mut words: Query<&mut Text, With<Words>>,
    mut bars: Query<&mut Node, With<Bar>>,
    (time, making): (Res<Time<Real>>, Option<ResMut<MakingBudget>>),
    mut said: Local<Option<Made>>,
) {
    let made = progress.made();
    if dressed.is_some() && made.is_ready() {
        for screen in &screens {
            commands.entity(screen).despawn();
        }
        commands.remove_resource::<Starting>();
        if let Some(mut making) = making {
            *making = MakingBudget::default();
        }
        let seconds = time.elapsed_secs();
        eprintln!("dolomite: the first picture is there ({seconds:.0} s)");
        return;
    }
    if *said == Some(made) {
        return;
    }
    *said = Some(made);
    for mut words in &mut words {
        words.0 = made.step();
    }
    for mut bar in &mut bars {
        bar.width = percent(100.0 * made.part());
    }
}
