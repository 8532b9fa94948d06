//! The menu of a level, without its looks: which screen there is, what can be chosen on it, and what follows (`deeds`).
//!
//! While there is a menu the virtual time rests, and with it everything that moves.

mod deeds;

pub use deeds::{MenuPlugin, MenuSystems, SaveTo, add};

use bevy::prelude::*;

use crate::input::PlayerInput;

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
