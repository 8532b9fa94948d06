//! Menus over a level: title, pause, settings, keys, victory, defeat.

use bevy::prelude::*;

use super::look::{DANGER, FIRE, LETTERS, PALE, text};
use crate::input::keys;
use crate::level::STEPS;
use crate::level::menu::{Item, Menu, Screen};
use crate::level::parts::{Level, LevelState, Verdict};
use crate::settings::Settings;
use crate::view::UiCamera;

/// Draws the [`Menu`].
pub struct ScreensPlugin;

impl Plugin for ScreensPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            Update,
            draw.run_if(any_with_component::<UiCamera>).run_if(
                resource_exists_and_changed::<Menu>
                    .or_else(resource_changed::<Settings>)
                    .or_else(not(any_with_component::<Shown>)),
            ),
        );
    }
}

/// What is on the screen; also there, and empty, while there is no menu.
#[derive(Component)]
struct Shown;

fn words(item: Item, settings: &Settings, level: &Level, screen: Screen) -> String {
    match item {
        Item::Begin if screen == Screen::Title => "Play".to_owned(),
        Item::Begin => "Play again from the beginning".to_owned(),
        Item::Load => "Go on with the saved game".to_owned(),
        Item::Resume => level.file.words.back.clone(),
        Item::Save => "Save".to_owned(),
        Item::Other => "Another level".to_owned(),
        Item::Settings => "Settings".to_owned(),
        Item::Keys => "Keys".to_owned(),
        Item::Mouse => format!(
            "Sensitivity of the mouse   < {:.2} >",
            settings.mouse_sensitivity
        ),
        Item::Invert => {
            let state = if settings.invert_y {
                "inverted"
            } else {
                "as it is"
            };
            format!("Up and down   < {state} >")
        }
        Item::View => format!("Field of view   < {:.0} degrees >", settings.fov),
        Item::Back => "Back".to_owned(),
        Item::Quit => "Leave".to_owned(),
    }
}

/// Headline, its colour, and what is said below it.
fn head(menu: &Menu, level: &Level, state: &LevelState) -> (String, Color, String) {
    let time = state.steps as f64 / STEPS;
    let took = format!("{}:{:02}", time as u64 / 60, time as u64 % 60);
    let words = &level.file.words;
    let (title, color, below) = match menu.screen {
        Screen::Play => ("", LETTERS, String::new()),
        Screen::Title => (level.file.title.as_str(), LETTERS, level.file.about.clone()),
        Screen::Pause => ("Rest", LETTERS, words.rests.clone()),
        Screen::Settings => ("Settings", LETTERS, "Left and right change them".to_owned()),
        Screen::Keys => ("Keys", LETTERS, String::new()),
        Screen::Won => {
            let calls = match state.calls {
                0 => "Nobody saw you.".to_owned(),
                1 => "The alarm was raised once.".to_owned(),
                count => format!("The alarm was raised {count} times."),
            };
            (words.won.as_str(), FIRE, format!("It took {took}. {calls}"))
        }
        Screen::Lost => {
            let why = match state.verdict {
                Some(Verdict::Late) => words.late.as_str(),
                _ => "You fell.",
            };
            let all = level.file.beacons.len();
            (
                words.lost.as_str(),
                DANGER,
                format!("{why} {} of {all} {}.", state.lit, words.sum),
            )
        }
    };
    (title.to_owned(), color, below)
}

fn draw(
    mut commands: Commands,
    menu: Res<Menu>,
    level: Res<Level>,
    state: Res<LevelState>,
    settings: Res<Settings>,
    camera: Single<Entity, With<UiCamera>>,
    old: Query<Entity, With<Shown>>,
) {
    for old in &old {
        commands.entity(old).despawn();
    }
    if menu.screen == Screen::Play {
        commands.spawn((Shown, Node::default()));
        return;
    }
    let (title, color, below) = head(&menu, &level, &state);
    commands
        .spawn((
            Shown,
            UiTargetCamera(*camera),
            GlobalZIndex(10),
            Node {
                position_type: PositionType::Absolute,
                width: percent(100),
                height: percent(100),
                flex_direction: FlexDirection::Column,
                align_items: AlignItems::Center,
                justify_content: JustifyContent::Center,
                row_gap: px(7),
                ..default()
            },
            BackgroundColor(Color::srgba(0.02, 0.03, 0.05, 0.66)),
        ))
        .with_children(|screen| {
            let small = menu.screen == Screen::Keys;
            screen.spawn(text(&title, if small { 22.0 } else { 38.0 }, color));
            if !below.is_empty() {
                screen.spawn(text(&below, 15.0, PALE));
            }
            if small {
                screen.spawn(text(keys::table().trim_end(), 11.5, LETTERS));
            } else {
                screen.spawn(Node {
                    height: px(14),
                    ..default()
                });
            }
            for (number, &item) in menu.items().iter().enumerate() {
                let chosen = number == menu.chosen;
                let (color, ground) = match chosen {
                    true => (FIRE, Color::srgba(1.0, 0.72, 0.30, 0.14)),
                    false => (LETTERS, Color::NONE),
                };
                let words = words(item, &settings, &level, menu.screen);
                screen.spawn((
                    Node {
                        padding: UiRect::axes(px(20), px(5)),
                        border_radius: BorderRadius::all(px(6)),
                        ..default()
                    },
                    BackgroundColor(ground),
                    children![text(&words, 19.0, color)],
                ));
            }
            screen.spawn(text(&menu.note, 13.0, FIRE));
            screen.spawn(text(
                "Up, down and Enter - directional pad and south button - Esc, start: back",
                11.0,
                PALE,
            ));
        });
}
