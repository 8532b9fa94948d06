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
                    .or_else(resized)
                    .or_else(not(any_with_component::<Shown>)),
            ),
        );
    }
}

/// Height and width of letters as a multiple of their size, about: what is said in Bevy's own font.
const LINE: f32 = 1.2;
const LETTER: f32 = 0.55;

/// Pixels between two rows, around the words of an item, below the head, and that the edge of a window is left free.
const GAP: f32 = 7.0;
const ITEM: f32 = 10.0;
const BELOW: f32 = 14.0;
const EDGE: f32 = 14.0;

/// Menus are never smaller than this part of their size: nobody could read them.
const LEAST: f32 = 0.4;

/// The sides of what menus are drawn over, logical pixels.
fn sides(camera: &Camera) -> Vec2 {
    camera
        .logical_viewport_size()
        .unwrap_or(Vec2::splat(1000.0))
}

fn resized(cameras: Query<&Camera, With<UiCamera>>, mut before: Local<Vec2>) -> bool {
    let now = cameras.iter().next().map_or(Vec2::ZERO, sides);
    std::mem::replace(&mut *before, now) != now
}

/// By how much a screen has to be smaller so that all of it is seen: `rows` are its words with the sizes of their letters
/// and what is around them, pixels.
fn fitting(rows: &[(&str, f32, f32)], sides: Vec2) -> f32 {
    let mut needed = Vec2::new(0.0, 2.0 * EDGE);
    for (words, size, around) in rows {
        let lines = words.lines().count().max(1) as f32;
        let widest = words.lines().map(|line| line.chars().count()).max();
        needed.y += lines * LINE * size + around + GAP;
        needed.x = needed
            .x
            .max(widest.unwrap_or(0) as f32 * LETTER * size + 2.0 * EDGE);
    }
    (sides / needed).min_element().clamp(LEAST, 1.0)
}

/// How to choose.
const HINT: &str = "Up, down and Enter - directional pad and south button - Esc, start: back";

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
        Item::Sound => format!("Sound   < {} >", if settings.sound { "on" } else { "off" }),
        Item::Volume => format!("Volume   < {:.0} % >", 100.0 * settings.volume),
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
    camera: Single<(Entity, &Camera), With<UiCamera>>,
    old: Query<Entity, With<Shown>>,
) {
    let (camera, sides) = (camera.0, sides(camera.1));
    for old in &old {
        commands.entity(old).despawn();
    }
    if menu.screen == Screen::Play {
        commands.spawn((Shown, Node::default()));
        return;
    }
    let (title, color, below) = head(&menu, &level, &state);
    let small = menu.screen == Screen::Keys;
    let items: Vec<String> = menu
        .items()
        .iter()
        .map(|&item| words(item, &settings, &level, menu.screen))
        .collect();
    let keys = if small { keys::table() } else { String::new() };
    let mut rows = vec![
        (title.as_str(), if small { 22.0 } else { 38.0 }, 0.0),
        (below.as_str(), 15.0, 0.0),
        (keys.trim_end(), 11.5, if small { 0.0 } else { BELOW }),
        (menu.note.as_str(), 13.0, 0.0),
        (HINT, 11.0, 0.0),
    ];
    rows.extend(items.iter().map(|words| (words.as_str(), 19.0, ITEM)));
    let part = fitting(&rows, sides);
    let text = |words: &str, size: f32, color: Color| text(words, part * size, color);
    commands
        .spawn((
            Shown,
            UiTargetCamera(camera),
            GlobalZIndex(10),
            Node {
                position_type: PositionType::Absolute,
                width: percent(100),
                height: percent(100),
                flex_direction: FlexDirection::Column,
                align_items: AlignItems::Center,
                justify_content: JustifyContent::Center,
                row_gap: px(part * GAP),
                ..default()
            },
            BackgroundColor(Color::srgba(0.02, 0.03, 0.05, 0.66)),
        ))
        .with_children(|screen| {
            screen.spawn(text(&title, if small { 22.0 } else { 38.0 }, color));
            if !below.is_empty() {
                screen.spawn(text(&below, 15.0, PALE));
            }
            if small {
                screen.spawn(text(keys.trim_end(), 11.5, LETTERS));
            } else {
                screen.spawn(Node {
                    height: px(part * BELOW),
                    ..default()
                });
            }
            for (number, words) in items.iter().enumerate() {
                let chosen = number == menu.chosen;
                let (color, ground) = match chosen {
                    true => (FIRE, Color::srgba(1.0, 0.72, 0.30, 0.14)),
                    false => (LETTERS, Color::NONE),
                };
                screen.spawn((
                    Node {
                        padding: UiRect::axes(px(part * 20.0), px(part * ITEM / 2.0)),
                        border_radius: BorderRadius::all(px(6)),
                        ..default()
                    },
                    BackgroundColor(ground),
                    children![text(words, 19.0, color)],
                ));
            }
            screen.spawn(text(&menu.note, 13.0, FIRE));
            screen.spawn(text(HINT, 11.0, PALE));
        });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn screens_are_as_small_as_their_window_asks_for() {
        let rows = [("Title", 40.0, 0.0), ("one\ntwo", 10.0, 6.0)];
        // 48 + 24 and what is around them are 120 high.
        assert_eq!(fitting(&rows, Vec2::new(500.0, 200.0)), 1.0);
        assert!((fitting(&rows, Vec2::new(500.0, 60.0)) - 0.5).abs() < 1e-6);
        // Title is 110 wide, and as much again is free of 28.
        assert!((fitting(&rows, Vec2::new(69.0, 500.0)) - 0.5).abs() < 1e-6);
        assert_eq!(fitting(&rows, Vec2::ONE), LEAST);
        assert_eq!(fitting(&[], Vec2::splat(100.0)), 1.0);
    }
}
