//! What is said over the picture of a level: what is to be done, the time, a compass, health, who is after the player.

use bevy::math::ops;
use bevy::prelude::*;
use dolomite::logic::parts::LogicTimer;
use dolomite::logic::{DayClock, Health, Lamp, Weapon};

use super::look::{DANGER, FIRE, GLASS, Hud, LETTERS, PALE, text};
use super::map;
use crate::level::gate::Bars;
use crate::level::lifts::Panel;
use crate::level::menu::{Menu, Screen};
use crate::level::parts::{Beacon, Cast, Level, LevelState, ground_of};
use crate::play::camera::FreeCamera;
use crate::view::{Dress, DressSystems, UiCamera};

/// Width of the compass, logical pixels, and the angle that it shows, radians.
const WIDTH: f32 = 420.0;
const SHOWN: f32 = 2.4;

/// Width of the bars of health and of fire, logical pixels.
const BAR: f32 = 220.0;

/// Width of the point that is aimed with, logical pixels.
const POINT: f32 = 5.0;

/// What is said of a level, and the compass.
pub struct HudPlugin;

impl Plugin for HudPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Dress, spawn.in_set(DressSystems::Panels))
            .add_systems(
                Update,
                (clear, spawn, map::spawn)
                    .chain()
                    .run_if(resource_changed::<Level>)
                    .run_if(any_with_component::<Hud>),
            )
            .add_systems(
                Update,
                (show, write, fill, turn)
                    .chain()
                    .run_if(resource_exists::<Cast>)
                    .run_if(any_with_component::<Hud>),
            );
    }
}

/// Nothing is said of the level before.
fn clear(mut commands: Commands, huds: Query<Entity, With<Hud>>) {
    for hud in &huds {
        commands.entity(hud).despawn();
    }
}

#[derive(Component, Clone, Copy, PartialEq, Eq)]
enum Line {
    Task,
    Time,
    Danger,
    Prompt,
    Note,
    Rounds,
}

#[derive(Component, Clone, Copy, PartialEq, Eq)]
enum Bar {
    Health,
    Fire,
}

/// A mark on the compass: a direction of the sky, a beacon by its number, or the gate that is open.
#[derive(Component, Clone, Copy)]
enum Mark {
    Sky(f32),
    Beacon(usize),
    Gate,
}

fn absolute(node: Node) -> Node {
    Node {
        position_type: PositionType::Absolute,
        ..node
    }
}

fn bar(kind: Bar, color: Color) -> impl Bundle {
    (
        Node {
            width: px(BAR),
            height: px(9),
            border_radius: BorderRadius::all(px(4)),
            ..default()
        },
        BackgroundColor(Color::srgba(0.0, 0.0, 0.0, 0.55)),
        children![(
            kind,
            Node {
                width: percent(100),
                height: percent(100),
                border_radius: BorderRadius::all(px(4)),
                ..default()
            },
            BackgroundColor(color),
        )],
    )
}

fn spawn(mut commands: Commands, level: Res<Level>, camera: Single<Entity, With<UiCamera>>) {
    let camera = UiTargetCamera(*camera);
    let file = &level.file;
    let glass = |node: Node| {
        (
            Hud,
            camera.clone(),
            Node {
                padding: UiRect::axes(px(12), px(8)),
                border_radius: BorderRadius::all(px(7)),
                flex_direction: FlexDirection::Column,
                row_gap: px(3),
                ..absolute(node)
            },
            BackgroundColor(GLASS),
        )
    };
    commands.spawn((
        glass(Node {
            // Below the compass, where the window is narrow.
            top: px(54),
            left: px(14),
            ..default()
        }),
        children![
            text(&file.title, 17.0, LETTERS),
            (Line::Task, text("", 14.0, FIRE)),
            (Line::Time, text("", 12.0, PALE)),
        ],
    ));
    commands.spawn((
        glass(Node {
            bottom: px(14),
            left: px(14),
            ..default()
        }),
        children![
            text("Health", 12.0, PALE),
            bar(Bar::Health, Color::srgb(0.42, 0.74, 0.36)),
            (Line::Rounds, text("", 12.0, PALE)),
        ],
    ));
    // What is in the middle is in a row over the whole width.
    let row = |node: Node| {
        (
            Hud,
            camera.clone(),
            Node {
                width: percent(100),
                flex_direction: FlexDirection::Column,
                align_items: AlignItems::Center,
                row_gap: px(6),
                ..absolute(node)
            },
        )
    };
    commands
        .spawn(row(Node {
            top: px(14),
            ..default()
        }))
        .with_children(|row| {
            row.spawn((
                Node {
                    width: px(WIDTH),
                    height: px(30),
                    overflow: Overflow::clip(),
                    border_radius: BorderRadius::all(px(7)),
                    ..default()
                },
                BackgroundColor(GLASS),
            ))
            .with_children(|strip| {
                let mark = |mark: Mark| {
                    (
                        mark,
                        absolute(Node {
                            width: px(40),
                            top: px(5),
                            justify_content: JustifyContent::Center,
                            ..default()
                        }),
                    )
                };
                let sky = ["N", "NE", "E", "SE", "S", "SW", "W", "NW"];
                for (number, letters) in (0..8_u8).zip(sky) {
                    let angle = f32::from(number) * std::f32::consts::FRAC_PI_4;
                    let size = if letters.len() == 1 { 15.0 } else { 11.0 };
                    strip.spawn((mark(Mark::Sky(angle)), children![text(letters, size, PALE)]));
                }
                let goals = (0..file.beacons.len()).map(Mark::Beacon);
                for goal in goals.chain(file.gate.map(|_| Mark::Gate)) {
                    // A spark each: letters would be taken for directions.
                    let spark = (
                        Node {
                            width: px(9),
                            height: px(9),
                            margin: UiRect::top(px(5)),
                            border_radius: BorderRadius::all(px(4.5)),
                            ..default()
                        },
                        BackgroundColor(FIRE),
                    );
                    strip.spawn((mark(goal), children![spark]));
                }
            });
            row.spawn((Line::Danger, text("", 15.0, DANGER)));
        });
    if file.weapon.is_some() {
        spawn_point(&mut commands, camera.clone());
    }
    commands.spawn((
        row(Node {
            bottom: percent(24),
            ..default()
        }),
        children![
            (Line::Prompt, text("", 16.0, LETTERS)),
            bar(Bar::Fire, FIRE),
            (Line::Note, text("", 13.0, PALE)),
        ],
    ));
}

/// A point in the middle of the picture, where there is something to aim with.
fn spawn_point(commands: &mut Commands, camera: UiTargetCamera) {
    commands.spawn((
        Hud,
        camera,
        absolute(Node {
            left: percent(50),
            top: percent(50),
            width: px(POINT),
            height: px(POINT),
            margin: UiRect::all(px(-POINT / 2.0)),
            border_radius: BorderRadius::all(px(POINT / 2.0)),
            ..default()
        }),
        BackgroundColor(Color::srgba(1.0, 1.0, 1.0, 0.7)),
    ));
}

fn show(menu: Option<Res<Menu>>, mut huds: Query<&mut Visibility, With<Hud>>) {
    let plays = menu.is_none_or(|menu| matches!(menu.screen, Screen::Play | Screen::Pause));
    for mut seen in &mut huds {
        seen.set_if_neq(if plays {
            Visibility::Inherited
        } else {
            Visibility::Hidden
        });
    }
}

/// Minutes and seconds.
fn clock(seconds: f32) -> String {
    let whole = seconds.max(0.0) as u32;
    format!("{}:{:02}", whole / 60, whole % 60)
}

/// What each line says.
fn write(
    level: Res<Level>,
    cast: Res<Cast>,
    state: Res<LevelState>,
    menu: Option<Res<Menu>>,
    timers: Query<&LogicTimer>,
    clocks: Query<&DayClock>,
    beacons: Query<&Beacon>,
    panels: Query<&Panel>,
    weapons: Query<&Weapon>,
    mut lines: Query<(&Line, &mut Text, &mut TextColor)>,
) {
    let left = timers
        .get(cast.timer)
        .map_or(0.0, |timer| timer.period - timer.passed);
    let hour = clocks.get(cast.clock).map_or(0.0, |clock| clock.hour);
    let all = level.file.beacons.len();
    for (line, mut text, mut color) in &mut lines {
        let words = match line {
            Line::Task if state.open => level.file.words.leave.clone(),
            Line::Task => format!("{}: {} of {all}", level.file.words.task, state.lit),
            Line::Time => {
                let minutes = (hour.fract() * 60.0) as u32;
                let part = if state.light > 0.5 { "day" } else { "night" };
                format!(
                    "{:02}:{minutes:02}, {part}   {} left",
                    hour as u32,
                    clock(left)
                )
            }
            Line::Danger if state.alarmed > 0 => {
                color.0 = DANGER;
                match state.alarmed {
                    1 => "A soldier is after you".to_owned(),
                    count => format!("{count} soldiers are after you"),
                }
            }
            Line::Danger if state.noticed > 0.05 => {
                color.0 = FIRE;
                "Somebody looks your way".to_owned()
            }
            Line::Danger => String::new(),
            Line::Prompt => match state.near.and_then(|near| beacons.get(near).ok()) {
                Some(beacon) => {
                    let verb = &level.file.words.verb;
                    format!("Hold E (south button) to {verb} {}", beacon.name)
                }
                None => match state.button.and_then(|button| panels.get(button).ok()) {
                    Some(Panel::Calls) => "E (south button): call the lift".to_owned(),
                    Some(Panel::Rides) => "E (south button): ride".to_owned(),
                    None => String::new(),
                },
            },
            Line::Rounds => match weapons.get(cast.player).map(|weapon| weapon.rounds) {
                Ok(Some(0)) => "No bolt left".to_owned(),
                Ok(Some(rounds)) => format!("Bolts: {rounds}"),
                _ => String::new(),
            },
            Line::Note => menu.as_ref().map_or_else(String::new, |menu| {
                if menu.screen == Screen::Play {
                    menu.note.clone()
                } else {
                    String::new()
                }
            }),
        };
        if text.0 != words {
            text.0 = words;
        }
    }
}

fn fill(
    cast: Res<Cast>,
    level: Res<Level>,
    state: Res<LevelState>,
    healths: Query<&Health>,
    beacons: Query<&Beacon>,
    mut bars: Query<(&Bar, &mut Node, &mut BackgroundColor, &ChildOf)>,
    mut frames: Query<&mut Visibility, Without<Bar>>,
) {
    for (bar, mut node, mut color, frame) in &mut bars {
        let part = match bar {
            Bar::Health => {
                let part = healths.get(cast.player).map_or(0.0, Health::part);
                color.0 = match part < 0.35 {
                    true => DANGER,
                    false => Color::srgb(0.42, 0.74, 0.36),
                };
                part
            }
            Bar::Fire => {
                let near = state.near.and_then(|near| beacons.get(near).ok());
                near.map_or(0.0, |beacon| beacon.kindled / level.file.hold)
            }
        };
        let width = percent(100.0 * part.clamp(0.0, 1.0));
        if node.width != width {
            node.width = width;
        }
        if *bar == Bar::Fire
            && let Ok(mut seen) = frames.get_mut(frame.parent())
        {
            seen.set_if_neq(if part > 0.0 {
                Visibility::Inherited
            } else {
                Visibility::Hidden
            });
        }
    }
}

/// The compass: what lies ahead is in the middle.
fn turn(
    cameras: Query<&FreeCamera>,
    beacons: Query<(Entity, &Transform, &Lamp), With<Beacon>>,
    gates: Query<&Transform, With<Bars>>,
    state: Res<LevelState>,
    mut marks: Query<(&Mark, &mut Node, &mut Visibility)>,
) {
    let Some(camera) = cameras.iter().next() else {
        return;
    };
    let pose = camera.pose;
    let mut all: Vec<_> = beacons.iter().collect();
    all.sort_by_key(|(entity, ..)| *entity);
    for (mark, mut node, mut seen) in &mut marks {
        // Clockwise from north; the camera's yaw goes the other way.
        let toward = |at: &Transform| {
            let from = Vec2::new(pose.position.x as f32, pose.position.z as f32);
            let way = ground_of(at) - from;
            ops::atan2(way.x, -way.y)
        };
        let (angle, shown) = match *mark {
            Mark::Gate => (gates.iter().next().map(toward), state.open),
            Mark::Sky(angle) => (Some(angle), true),
            Mark::Beacon(number) => match all.get(number) {
                Some((_, at, lamp)) => (Some(toward(at)), !lamp.lit),
                None => (None, false),
            },
        };
        let ahead = angle.map(|angle| {
            (angle + pose.yaw + std::f32::consts::PI).rem_euclid(std::f32::consts::TAU)
                - std::f32::consts::PI
        });
        let near = ahead.filter(|ahead| shown && ahead.abs() < SHOWN / 2.0);
        seen.set_if_neq(if near.is_some() {
            Visibility::Inherited
        } else {
            Visibility::Hidden
        });
        if let Some(ahead) = near {
            let left = px((WIDTH * (0.5 + ahead / SHOWN) - 20.0).round());
            if node.left != left {
                node.left = left;
            }
        }
    }
}
