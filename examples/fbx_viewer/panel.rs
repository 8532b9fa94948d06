//! What is said of the file: the report of its conversion, its clips, the keys.

use std::fmt::Write as _;

use bevy::prelude::*;
use dolomite::fbx::{FbxConversion, Report};

use super::clips::Playing;
use super::{Shown, State, name_of};

/// The keys, as `--help` and the panel show them.
pub const KEYS: &str = "\
drag, right-drag, wheel   go round, aside, closer
up, down                  clip before, next clip
space                     stop, go on
left, right               a thirtieth of a second back, on
- =                       half, twice the speed
R                         report on, off
drop a file               open it";

/// Losses that are listed; of more the number is said.
const LISTED: usize = 8;

/// Panels.
pub struct PanelPlugin;

impl Plugin for PanelPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Startup, build)
            .add_systems(Update, (write, switch));
    }
}

#[derive(Component)]
struct ReportText;

#[derive(Component)]
struct ClipText;

#[derive(Component)]
struct Panel;

fn build(mut commands: Commands) {
    let panel = |node: Node| {
        (
            Panel,
            Node {
                position_type: PositionType::Absolute,
                padding: UiRect::axes(px(12), px(9)),
                max_width: percent(46),
                border_radius: BorderRadius::all(px(7)),
                ..node
            },
            BackgroundColor(Color::srgba(0.03, 0.05, 0.08, 0.62)),
        )
    };
    let font = || TextFont {
        font_size: FontSize::Px(13.0),
        ..default()
    };
    let left = Node {
        top: px(12),
        left: px(12),
        ..default()
    };
    let right = Node {
        top: px(12),
        right: px(12),
        ..default()
    };
    commands.spawn((
        panel(left),
        children![(ReportText, Text::default(), font())],
    ));
    commands.spawn((panel(right), children![(ClipText, Text::default(), font())]));
}

fn switch(keys: Res<ButtonInput<KeyCode>>, mut panels: Query<&mut Visibility, With<Panel>>) {
    if keys.just_pressed(KeyCode::KeyR) {
        for mut visibility in &mut panels {
            *visibility = match *visibility {
                Visibility::Hidden => Visibility::Inherited,
                _ => Visibility::Hidden,
            };
        }
    }
}

fn write(
    shown: Res<Shown>,
    playing: Res<Playing>,
    conversions: Res<Assets<FbxConversion>>,
    mut report: Single<&mut Text, (With<ReportText>, Without<ClipText>)>,
    mut clips: Single<&mut Text, With<ClipText>>,
) {
    let name = name_of(&shown.path);
    let text = match (&shown.state, conversions.get(&shown.made)) {
        (State::Failed(reason), _) => format!("{name}\n\n{reason}"),
        (State::Loading, _) => format!("{name}\n\nconverting ..."),
        (_, Some(made)) => told(&name, &made.report, made.glb.len()),
        (_, None) => name,
    };
    if report.0 != text {
        report.0 = text;
    }
    let text = listed(&playing);
    if clips.0 != text {
        clips.0 = text;
    }
}

/// The report, as lines.
fn told(name: &str, report: &Report, bytes: usize) -> String {
    let mut text = format!(
        "{name}\nFBX {}.{}, {}\n1 unit = {} m, {:.3} m across\n\n",
        report.version / 1000,
        report.version / 100 % 10,
        if report.creator.is_empty() {
            "maker unknown"
        } else {
            &report.creator
        },
        report.unit,
        report.size
    );
    let mut row = |name: &str, value: String| {
        writeln!(text, "{name}: {value}").expect("writing to a String cannot fail");
    };
    row(
        "nodes, joints",
        format!("{}, {}", report.nodes, report.joints),
    );
    row(
        "vertices, triangles",
        format!("{}, {}", report.vertices, report.triangles),
    );
    let clips = report
        .clips
        .iter()
        .map(|clip| clip.error)
        .fold(0.0, f64::max);
    if !report.clips.is_empty() {
        row(
            "keys of baked",
            format!("{} of {}", report.keys(), report.baked()),
        );
        row(
            "error of clips, bound",
            format!("{:.4}, {:.4} mm", clips * 1e3, report.bound * 1e3),
        );
    }
    if report.refitted > 0 {
        row(
            "more than four joints",
            format!(
                "{} vertices, {:.3} mm off (largest weights alone: {:.3} mm)",
                report.refitted,
                report.weight_error * 1e3,
                report.largest_weights_error * 1e3
            ),
        );
    }
    row("glTF", format!("{:.2} MB", bytes as f64 / 1e6));
    if report.lost.is_empty() {
        text += "\nnothing is lost";
        return text;
    }
    text += "\nnot in glTF:\n";
    for lost in report.lost.iter().take(LISTED) {
        let size = lost
            .metres
            .map_or(String::new(), |metres| format!(", {:.3} mm", metres * 1e3));
        writeln!(text, "  {} {}{size}", lost.what, lost.name).expect("a String takes it");
    }
    if report.lost.len() > LISTED {
        writeln!(text, "  and {} more", report.lost.len() - LISTED).expect("a String takes it");
    }
    text
}

/// The clips, and the keys.
fn listed(playing: &Playing) -> String {
    let mut text = String::new();
    for (number, (name, seconds)) in playing.names.iter().zip(&playing.seconds).enumerate() {
        let mark = if number == playing.clip { ">" } else { " " };
        writeln!(text, "{mark} {name}, {seconds:.2} s").expect("a String takes it");
    }
    if playing.names.is_empty() {
        text += "no clips\n";
    } else {
        writeln!(
            text,
            "\nat {:.2} s{}{}",
            playing.at,
            if playing.paused { ", stopped" } else { "" },
            if playing.speed == 1.0 {
                String::new()
            } else {
                format!(", x {}", playing.speed)
            }
        )
        .expect("a String takes it");
    }
    text + "\n" + KEYS
}
