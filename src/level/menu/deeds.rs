//! What follows from choices in the menu: games begin, are saved and gone on with, settings change and are kept.

use std::path::PathBuf;

use bevy::prelude::*;

use super::{Deed, Item, Menu, Screen};
use crate::input::{InputMode, PlayerInput};
use crate::level::begin::begin;
use crate::level::error::LevelError;
use crate::level::load::{self, LEVELS};
use crate::level::parts::{Level, LevelState, Verdict};
use crate::level::save;
use crate::play::camera::FreeCamera;
use crate::scene::{CurrentScene, SceneRequest};
use crate::settings::choices::{Choices, KeepTo};
use crate::settings::paths::AssetsDir;
use crate::settings::{FOV_RANGE, Settings};

/// Where the game is saved, in place of the player's own folder: for tests.
#[derive(Resource, Clone, Debug)]
pub struct SaveTo(pub PathBuf);

/// Shows menus over a level: begins with the resource [`Menu`], or the title.
pub struct MenuPlugin;

impl Plugin for MenuPlugin {
    fn build(&self, app: &mut App) {
        add(app);
    }
}

/// The menu (schedule `Update`), which may begin a level anew. Whoever adds components to entities of a level comes after
/// it: what was asked for one that is gone by then ends the program.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MenuSystems;

/// What the plugin adds; also to an app that has been finished.
pub fn add(app: &mut App) {
    app.init_resource::<Menu>()
        .init_resource::<InputMode>()
        .add_systems(PreUpdate, rest.after(bevy::input::InputSystems))
        .add_systems(
            Update,
            drive
                .in_set(MenuSystems)
                .run_if(resource_exists::<LevelState>),
        );
}

/// Time rests while there is a menu; keys mean what the screen is for.
fn rest(menu: Res<Menu>, mut time: ResMut<Time<Virtual>>, mut mode: ResMut<InputMode>) {
    let plays = menu.screen == Screen::Play;
    if plays == time.is_paused() {
        if plays {
            time.unpause();
        } else {
            time.pause();
        }
    }
    mode.set_if_neq(if plays {
        InputMode::Play
    } else {
        InputMode::Menu
    });
}

fn save_path(world: &World) -> Result<PathBuf, save::SaveError> {
    if let Some(SaveTo(path)) = world.get_resource() {
        return Ok(path.clone());
    }
    let level = world
        .get_resource::<Level>()
        .ok_or(save::SaveError::NoLevel)?;
    save::path(level.name)
}

fn saved(world: &mut World) -> Result<(), save::SaveError> {
    let path = save_path(world)?;
    let game = save::take(world).ok_or(save::SaveError::NoLevel)?;
    save::write(&path, &game)
}

/// What is said of a game that was loaded.
fn loaded(world: &mut World) -> Result<String, save::SaveError> {
    let (game, damage) = save::read(&save_path(world)?)?;
    save::put(world, &game)?;
    Ok(damage.map_or_else(String::new, |damage| {
        format!("The newest saved game is damaged ({damage}); this is the one before.")
    }))
}

/// The next level in the list, in its scene. Loading takes a moment, in which the picture stands. Where it cannot begin,
/// this one goes on in its own scene.
fn other(world: &mut World) -> Result<(), LevelError> {
    let now = world.resource::<Level>().clone();
    let at = LEVELS.iter().position(|(name, _)| *name == now.name);
    let (next, _) = LEVELS[at.map_or(0, |at| (at + 1) % LEVELS.len())];
    let assets = world.resource::<AssetsDir>().0.clone();
    let (level, scene) = load::load(next, now.seed, &assets)?;
    let before = (
        world.resource::<SceneRequest>().clone(),
        world.resource::<CurrentScene>().clone(),
    );
    world.resource_mut::<SceneRequest>().scene = level.file.scene.clone();
    world.insert_resource(CurrentScene(scene));
    world.insert_resource(level);
    begin(world).map_err(|error| {
        let (request, scene) = before;
        world.insert_resource(request);
        world.insert_resource(scene);
        world.insert_resource(now);
        error.into()
    })
}

/// One frame of the menu.
fn drive(world: &mut World, mut lit: Local<u32>, mut chosen: Local<Option<Choices>>) {
    let input = *world.resource::<PlayerInput>();
    let state = *world.resource::<LevelState>();
    let mut menu = world.resource::<Menu>().clone();
    let sets = menu.screen == Screen::Settings;
    if sets {
        chosen.get_or_insert_with(|| Choices::of(world.resource::<Settings>()));
    }
    if menu.screen == Screen::Play
        && let Some(verdict) = state.verdict
    {
        menu.go(match verdict {
            Verdict::Won => Screen::Won,
            Verdict::Fell | Verdict::Late => Screen::Lost,
        });
    }
    // Each beacon that burns is kept.
    let plays = menu.screen == Screen::Play && !menu.keeps_nothing;
    if plays && state.lit > *lit && state.verdict.is_none() {
        menu.note = match saved(world) {
            Ok(()) => "Saved".to_owned(),
            Err(error) => error.to_string(),
        };
    }
    match menu.step(&input) {
        None => {}
        Some(Deed::Begin) => match begin(world) {
            Ok(()) => menu.go(Screen::Play),
            Err(error) => menu.note = error.to_string(),
        },
        Some(Deed::Load) => match loaded(world) {
            Ok(note) => {
                menu.go(Screen::Play);
                menu.note = note;
            }
            Err(error) => menu.note = error.to_string(),
        },
        Some(Deed::Save) => {
            menu.note = match saved(world) {
                Ok(()) => "Saved".to_owned(),
                Err(error) => error.to_string(),
            };
        }
        Some(Deed::Other) => match other(world) {
            Ok(()) => menu.go(Screen::Title),
            Err(error) => menu.note = error.to_string(),
        },
        Some(Deed::Set(item, by)) => set(world, item, by),
        Some(Deed::Quit) => {
            world.write_message(AppExit::Success);
        }
    }
    // What was chosen is kept once its screen is left; who chose nothing has nothing kept.
    if sets
        && menu.screen != Screen::Settings
        && chosen.take() != Some(Choices::of(world.resource::<Settings>()))
    {
        keep(world, &mut menu);
    }
    // Of what goes on now: beacons of a saved game are kept already.
    *lit = world.resource::<LevelState>().lit;
    if *world.resource::<Menu>() != menu {
        world.insert_resource(menu);
    }
}

/// Keeps what was chosen, where the player has a folder for it.
fn keep(world: &World, menu: &mut Menu) {
    if let Some(KeepTo(path)) = world.get_resource() {
        let choices = Choices::of(world.resource::<Settings>());
        if let Err(error) = choices.write(path) {
            menu.note = error.to_string();
        }
    }
}

fn set(world: &mut World, item: Item, by: i32) {
    let mut settings = world.resource_mut::<Settings>();
    let by = by as f32;
    match item {
        Item::Mouse => {
            let next = settings.mouse_sensitivity + 0.02 * by;
            settings.mouse_sensitivity = next.clamp(0.02, 1.0);
        }
        Item::Invert => settings.invert_y = !settings.invert_y,
        Item::View => {
            let fov = (settings.fov + 5.0 * by).clamp(FOV_RANGE.0.max(30.0), FOV_RANGE.1);
            settings.fov = fov;
            for mut camera in world.query::<&mut FreeCamera>().iter_mut(world) {
                camera.fov = fov;
            }
        }
        Item::Sound => settings.sound = !settings.sound,
        Item::Volume => {
            // Steps of a tenth, without what additions leave over.
            let tenths = (settings.volume * 10.0).round() + by;
            settings.volume = (tenths / 10.0).clamp(0.0, 1.0);
        }
        _ => {}
    }
}
