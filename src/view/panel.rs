//! The panel on the screen: frame time, counts, GPU time of each pass, keys, and what went wrong.

use std::fmt::Write;
use std::time::Duration;

use bevy::diagnostic::{DiagnosticsStore, FrameTimeDiagnosticsPlugin};
use bevy::prelude::*;
use bevy::time::common_conditions::on_real_timer;
use dolomite::ground::PatchDetail;
use dolomite::ground::detail::budget::BudgetReport;
use dolomite::ground::detail::{Metric, TerrainLod};
use dolomite::tessellation::render::GeometryStats;

use super::passes::{self, Clock};
use super::scaled::PictureSize;
use super::{Dress, DressSystems, OffscreenTarget, UiCamera};
use crate::input::keys;
use crate::play::{DetailFocus, Switches};
use crate::scene::CurrentScene;
use crate::scene::reload::SceneFault;
use crate::settings::quality::{AntiAliasing, Occlusion, Quality};
use crate::settings::{Renderer, Settings};

/// How often the figures change: four times a second can still be read.
const PERIOD: Duration = Duration::from_millis(250);

/// Passes shown at most, the slowest first.
const PASSES: usize = 9;

/// Size of the letters, logical pixels.
const LETTERS: f32 = 13.0;

/// Panels over the view.
pub struct PanelPlugin;

/// Rows of a scene that draws itself, name and figure, in place of those of a landscape.
#[derive(Resource, Clone, Debug, Default, PartialEq, Eq)]
pub struct PanelRows(pub Vec<(&'static str, String)>);

#[derive(Component)]
struct Figures;

#[derive(Component)]
struct FigurePanel;

#[derive(Component)]
struct KeyPanel;

#[derive(Component)]
struct FaultPanel;

impl Plugin for PanelPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(FrameTimeDiagnosticsPlugin::default())
            .add_systems(Dress, spawn.in_set(DressSystems::Panels))
            .add_systems(
                Update,
                (
                    // Without a window time stands still but for the steps that are asked for.
                    write_figures
                        .run_if(on_real_timer(PERIOD).or_else(resource_exists::<OffscreenTarget>)),
                    show_keys.run_if(resource_changed::<Switches>),
                    show_fault.run_if(resource_changed::<SceneFault>),
                ),
            );
    }
}

fn spawn(mut commands: Commands, settings: Res<Settings>, camera: Single<Entity, With<UiCamera>>) {
    let camera = *camera;
    let shown = visible(settings.panel);
    commands.spawn((
        FigurePanel,
        panel(camera),
        shown,
        children![(Figures, line(""), TextColor(Color::srgb(0.93, 0.95, 0.97)))],
    ));
    commands.spawn((
        KeyPanel,
        panel(camera),
        Visibility::Hidden,
        children![(
            line(keys::table().trim_end()),
            TextColor(Color::srgb(0.93, 0.95, 0.97))
        )],
    ));
    let mut fault = panel(camera);
    fault.1.top = auto();
    fault.1.bottom = px(12);
    fault.1.max_width = percent(96);
    commands.spawn((
        FaultPanel,
        fault,
        Visibility::Hidden,
        children![(line(""), TextColor(Color::srgb(1.0, 0.62, 0.50)))],
    ));
}

/// A translucent panel in the upper left corner.
fn panel(camera: Entity) -> (UiTargetCamera, Node, BackgroundColor) {
    (
        UiTargetCamera(camera),
        Node {
            position_type: PositionType::Absolute,
            top: px(12),
            left: px(12),
            padding: UiRect::axes(px(12), px(9)),
            border_radius: BorderRadius::all(px(7)),
            ..default()
        },
        BackgroundColor(Color::srgba(0.03, 0.05, 0.08, 0.62)),
    )
}

fn line(text: &str) -> (Text, TextFont) {
    (
        Text::new(text),
        TextFont {
            font_size: FontSize::Px(LETTERS),
            ..default()
        },
    )
}

fn write_figures(
    diagnostics: Res<DiagnosticsStore>,
    stats: Option<Res<GeometryStats>>,
    scene: Res<CurrentScene>,
    (switches, settings): (Res<Switches>, Res<Settings>),
    own: Option<Res<PanelRows>>,
    quality: Option<Res<Quality>>,
    size: Option<Res<PictureSize>>,
    detail: Option<Single<(&TerrainLod, Option<&BudgetReport>), Without<PatchDetail>>>,
    text: Option<Single<&mut Text, With<Figures>>>,
) {
    let Some(mut text) = text else { return };
    let smoothed = |path| {
        diagnostics
            .get(&path)
            .and_then(|d| d.smoothed())
            .unwrap_or(0.0)
    };
    let milliseconds = smoothed(FrameTimeDiagnosticsPlugin::FRAME_TIME);
    let rate = smoothed(FrameTimeDiagnosticsPlugin::FPS);
    let focus = match switches.focus {
        DetailFocus::Camera => "camera",
        DetailFocus::Figure => "figure",
    };
    let mut lines = format!("{}   F1 keys\n", scene.name);
    row(&mut lines, "frame", format!("{milliseconds:.2} ms"));
    row(&mut lines, "rate", format!("{rate:.0} /s"));
    if let Some(stats) = stats {
        row(&mut lines, "triangles", thousands(stats.primitives.into()));
        row(&mut lines, "patches drawn", thousands(stats.seen().into()));
        row(
            &mut lines,
            "patches culled",
            thousands(stats.discarded.into()),
        );
    }
    match own {
        Some(rows) => {
            for (name, figure) in &rows.0 {
                row(&mut lines, name, figure.clone());
            }
        }
        None => row(&mut lines, "detail follows", focus.to_owned()),
    }
    if let Some((detail, budget)) = detail.as_deref() {
        if let Metric::ErrorBound { pixels } = detail.metric {
            row(&mut lines, "error at most", format!("{pixels:.2} px"));
        }
        if let Some(report) = budget {
            let held = if report.held { "held" } else { "over" };
            row(&mut lines, "budget", held.to_owned());
        }
    }
    if let Some(quality) = quality {
        row(&mut lines, "quality", quality.preset.name().to_owned());
        row(&mut lines, "glow, edges, shadows", effects(&quality));
        if settings.renderer == Renderer::Dolomite {
            let occlusion = match quality.occlusion {
                Occlusion::Off => "off",
                Occlusion::Half => "half",
                Occlusion::Full => "full",
            };
            row(&mut lines, "occlusion", occlusion.into());
        }
        let shading = format!("{:?}", quality.shading).to_lowercase();
        row(&mut lines, "ground's shading", shading);
    }
    if let Some(PictureSize { drawn, shown }) = size.as_deref().copied()
        && drawn != UVec2::ZERO
    {
        let part = 100.0 * drawn.y as f32 / shown.y as f32;
        row(
            &mut lines,
            "drawn",
            format!("{}x{} {part:.0} %", drawn.x, drawn.y),
        );
    }
    let mut gpu = passes::newest(&diagnostics, Clock::Gpu);
    gpu.sort_by(|a, b| b.1.total_cmp(&a.1));
    for (name, milliseconds) in gpu.into_iter().take(PASSES) {
        row(&mut lines, &name, format!("{milliseconds:.2} ms"));
    }
    let lines = lines.trim_end();
    if text.0 != lines {
        lines.clone_into(&mut text.0);
    }
}

/// What is on, in short.
fn effects(quality: &Quality) -> String {
    let edges = match quality.anti_aliasing {
        AntiAliasing::Off => "off",
        AntiAliasing::Fxaa => "fxaa",
        AntiAliasing::Smaa => "smaa",
    };
    let glow = if quality.bloom { "on" } else { "off" };
    format!("{glow}, {edges}, {}", quality.shadow_cascades)
}

/// A row of 34 letters: a name to the left, a figure to the right.
fn row(text: &mut String, name: &str, figure: String) {
    let width = 34_usize.saturating_sub(figure.len() + 1);
    let name: String = name.chars().take(width).collect();
    writeln!(text, "{name:width$} {figure}").expect("writing to a String cannot fail");
}

/// 1234567 as "1 234 567".
fn thousands(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// The panel of keys takes the place of the panel of figures: a small window cannot hold both.
fn show_keys(
    switches: Res<Switches>,
    settings: Res<Settings>,
    keys: Option<Single<&mut Visibility, With<KeyPanel>>>,
    figures: Option<Single<&mut Visibility, (With<FigurePanel>, Without<KeyPanel>)>>,
) {
    if let Some(mut keys) = keys {
        **keys = visible(switches.keys);
    }
    if let Some(mut figures) = figures {
        **figures = visible(settings.panel && !switches.keys);
    }
}

fn show_fault(
    fault: Res<SceneFault>,
    panel: Option<Single<(&mut Visibility, &Children), With<FaultPanel>>>,
    mut texts: Query<&mut Text>,
) {
    let Some(panel) = panel else { return };
    let (mut visibility, children) = panel.into_inner();
    *visibility = visible(fault.0.is_some());
    for child in children {
        if let Ok(mut text) = texts.get_mut(*child) {
            fault
                .0
                .as_deref()
                .unwrap_or_default()
                .clone_into(&mut text.0);
        }
    }
}

fn visible(shown: bool) -> Visibility {
    if shown {
        Visibility::Inherited
    } else {
        Visibility::Hidden
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_aligned_and_numbers_grouped() {
        assert_eq!(thousands(7), "7");
        assert_eq!(thousands(1000), "1 000");
        assert_eq!(thousands(1_234_567), "1 234 567");
        let mut text = String::new();
        row(&mut text, "frame", "3.20 ms".to_owned());
        row(
            &mut text,
            "a name that is far too long for one row",
            "12 345 678".to_owned(),
        );
        assert!(text.lines().all(|line| line.len() == 34), "{text}");
    }
}
