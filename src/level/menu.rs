//! The menu of a level, without its looks: which screen there is, what can be chosen on it, and what follows.
//!
//! While there is a menu the virtual time rests, and with it everything that moves.

use std::path::PathBuf;

use bevy::prelude::*;

use super::begin::begin;
use super::error::LevelError;
use super::load::{self, LEVELS};
use super::parts::{Level, LevelState, Verdict};
use super::save;
use crate::input::{InputMode, PlayerInput};
use crate::play::camera::FreeCamera;
use crate::scene::{CurrentScene, SceneRequest};
use crate::settings::choices::{Choices, KeepTo};
use crate::settings::paths::AssetsDir;
use crate::settings::{FOV_RANGE, Settings};

/// What is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Screen {
    /// Before a game.
    #[default]
    Title,
    /// No menu: the game.
    Play,
    /// The game rests.
    Pause,
    /// What the player may set.
    Settings,
    /// What every key does.
    Keys,
    /// Won.
    Won,
    /// Lost.
    Lost,
}

/// What can be chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Item {
    /// A new game.
    Begin,
    /// The saved game.
    Load,
    /// On with this one.
    Resume,
    /// Saves it.
    Save,
    /// To the next level's title.
    Other,
    /// To the settings.
    Settings,
    /// To the keys.
    Keys,
    /// Sensitivity of the mouse.
    Mouse,
    /// Up is down.
    Invert,
    /// Field of view.
    View,
    /// Sound on or off.
    Sound,
    /// How loud it is.
    Volume,
    /// To the screen before.
    Back,
    /// Out of the game.
    Quit,
}

/// What follows from a choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Deed {
    /// A level begins.
    Begin,
    /// The saved game is gone on with.
    Load,
    /// The game is saved.
    Save,
    /// The next level is loaded.
    Other,
    /// A setting changes, one step up or down.
    Set(Item, i32),
    /// The program ends.
    Quit,
}

/// The menu.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct Menu {
    /// What is shown.
    pub screen: Screen,
    /// The number of the item that is chosen.
    pub chosen: usize,
    /// What became of the last deed.
    pub note: String,
    /// Beacons that burn are not saved by themselves: nobody plays.
    pub keeps_nothing: bool,
    /// Where settings and keys were come to from.
    from: Screen,
}

impl Menu {
    /// At a screen.
    pub fn at(screen: Screen) -> Self {
        Self {
            screen,
            from: match screen {
                Screen::Settings | Screen::Keys => Screen::Title,
                other => other,
            },
            ..Self::default()
        }
    }

    /// What can be chosen.
    pub fn items(&self) -> &'static [Item] {
        match self.screen {
            Screen::Play => &[],
            Screen::Title => &[
                Item::Begin,
                Item::Load,
                Item::Other,
                Item::Settings,
                Item::Keys,
                Item::Quit,
            ],
            Screen::Pause => &[
                Item::Resume,
                Item::Save,
                Item::Load,
                Item::Settings,
                Item::Keys,
                Item::Begin,
                Item::Quit,
            ],
            Screen::Settings => &[
                Item::Mouse,
                Item::Invert,
                Item::View,
                Item::Sound,
                Item::Volume,
                Item::Back,
            ],
            Screen::Keys => &[Item::Back],
            Screen::Won | Screen::Lost => &[Item::Begin, Item::Load, Item::Keys, Item::Quit],
        }
    }

    fn go(&mut self, screen: Screen) {
        self.screen = screen;
        self.chosen = 0;
        self.note.clear();
    }

    /// What the player wants in this frame.
    pub fn step(&mut self, input: &PlayerInput) -> Option<Deed> {
        if self.screen == Screen::Play {
            if input.menu {
                self.go(Screen::Pause);
            }
            return None;
        }
        if input.menu {
            match self.screen {
                Screen::Pause => self.go(Screen::Play),
                Screen::Settings | Screen::Keys => self.go(self.from),
                _ => {}
            }
            return None;
        }
        let items = self.items();
        let count = items.len() as i32;
        let next = self.chosen as i32 + input.navigate.y;
        self.chosen = next.rem_euclid(count.max(1)) as usize;
        let item = *items.get(self.chosen)?;
        let sets = matches!(
            item,
            Item::Mouse | Item::Invert | Item::View | Item::Sound | Item::Volume
        );
        if sets && input.navigate.x != 0 {
            return Some(Deed::Set(item, input.navigate.x.signum()));
        }
        if !input.confirm {
            return None;
        }
        match item {
            Item::Begin => Some(Deed::Begin),
            Item::Load => Some(Deed::Load),
            Item::Save => Some(Deed::Save),
            Item::Other => Some(Deed::Other),
            Item::Quit => Some(Deed::Quit),
            Item::Mouse | Item::Invert | Item::View | Item::Sound | Item::Volume => {
                Some(Deed::Set(item, 1))
            }
            Item::Resume => {
                self.go(Screen::Play);
                None
            }
            Item::Back => {
                self.go(self.from);
                None
            }
            Item::Settings | Item::Keys => {
                self.from = self.screen;
                self.go(match item {
                    Item::Settings => Screen::Settings,
                    _ => Screen::Keys,
                });
                None
            }
        }
    }
}

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

/// What the plugin adds; also to an app that has been finished.
pub fn add(app: &mut App) {
    app.init_resource::<Menu>()
        .init_resource::<InputMode>()
        .add_systems(PreUpdate, rest.after(bevy::input::InputSystems))
        .add_systems(Update, drive.run_if(resource_exists::<LevelState>));
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

/// The next level in the list, in its scene. Loading takes a moment, in which the picture stands.
fn other(world: &mut World) -> Result<(), LevelError> {
    let now = world.resource::<Level>().clone();
    let at = LEVELS.iter().position(|(name, _)| *name == now.name);
    let (next, _) = LEVELS[at.map_or(0, |at| (at + 1) % LEVELS.len())];
    let assets = world.resource::<AssetsDir>().0.clone();
    let (level, scene) = load::load(next, now.seed, &assets)?;
    world.resource_mut::<SceneRequest>().scene = level.file.scene.clone();
    world.insert_resource(CurrentScene(scene));
    world.insert_resource(level);
    Ok(begin(world)?)
}

/// One frame of the menu.
fn drive(world: &mut World, mut lit: Local<u32>) {
    let input = *world.resource::<PlayerInput>();
    let state = *world.resource::<LevelState>();
    let mut menu = world.resource::<Menu>().clone();
    let sets = menu.screen == Screen::Settings;
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
    *lit = state.lit;
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
    // What was chosen is kept once its screen is left.
    if sets && menu.screen != Screen::Settings {
        keep(world, &mut menu);
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn press(menu: &mut Menu, y: i32, confirm: bool) -> Option<Deed> {
        menu.step(&PlayerInput {
            navigate: IVec2::new(0, y),
            confirm,
            ..default()
        })
    }

    #[test]
    fn every_item_is_come_to_and_leads_somewhere() {
        let mut menu = Menu::default();
        assert_eq!(press(&mut menu, 0, true), Some(Deed::Begin));
        // Upwards from the first is the last.
        assert_eq!(press(&mut menu, -1, true), Some(Deed::Quit));
        press(&mut menu, 4, false);
        assert_eq!(menu.items()[menu.chosen], Item::Settings);
        press(&mut menu, 0, true);
        assert_eq!(menu.screen, Screen::Settings);
        let step = PlayerInput {
            navigate: IVec2::X,
            ..default()
        };
        assert_eq!(menu.step(&step), Some(Deed::Set(Item::Mouse, 1)));
        let back = PlayerInput {
            menu: true,
            ..default()
        };
        assert_eq!(menu.step(&back), None);
        assert_eq!(menu.screen, Screen::Title);
        for screen in [Screen::Title, Screen::Pause, Screen::Won, Screen::Lost] {
            for at in 0..Menu::at(screen).items().len() {
                let mut menu = Menu::at(screen);
                let deed = press(&mut menu, at as i32, true);
                assert!(deed.is_some() || menu.screen != screen, "{screen:?} {at}");
            }
        }
    }

    #[test]
    fn escape_opens_and_closes_the_pause() {
        let mut menu = Menu::at(Screen::Play);
        let key = PlayerInput {
            menu: true,
            ..default()
        };
        menu.step(&key);
        assert_eq!(menu.screen, Screen::Pause);
        menu.step(&key);
        assert_eq!(menu.screen, Screen::Play);
        let mut won = Menu::at(Screen::Won);
        won.step(&key);
        assert_eq!(won.screen, Screen::Won, "what is won is not escaped");
    }
}
