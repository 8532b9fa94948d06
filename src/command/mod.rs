//! The command line: what can be asked for, and how it becomes a setup.

mod bench;
mod bot;
mod elevation;
mod fbx2gltf;
mod heights;
mod scene;
mod values;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use dolomite_game::bench::BenchError;
use dolomite_game::console;
use dolomite_game::input::keys;
use dolomite_game::level::menu::Screen;
use dolomite_game::run::Setup;
use dolomite_game::run::meet::Meet;
use dolomite_game::settings::choices::user_choices;

use bench::Bench;
use bot::Bot;
use fbx2gltf::Fbx2gltf;
use heights::Heights;
use scene::SceneArgs;
use values::{Size, Stand};

/// A mountain to fly and walk over, refined on the GPU.
///
/// Without a command, plays.
#[derive(Parser)]
#[command(version, after_help = after_help(), after_long_help = after_help())]
#[command(args_conflicts_with_subcommands = true)]
pub struct Line {
    #[command(subcommand)]
    pub command: Option<Command>,
    #[command(flatten)]
    pub play: Play,
}

fn after_help() -> String {
    format!(
        "Keys:\n{}\nConsole (the key left of 1, or --exec FILE):\n{}\nExamples:\n  \
         dolomite --scene jacksboro --detail 8\n  \
         dolomite --scene alps.png --spacing 25 --height-scale 0.08\n  \
         dolomite shot --scene mountain --size 1920x1080 --out mountain.png\n  \
         dolomite bench --scene mountain --path fly --frames 600 --json fly.json\n  \
         dolomite bot --level mountain --seed 1 --runs 10 --json won.json\n  \
         dolomite bench --scene classic --matrix --frames 12\n\n\
         Environment:\n  \
         DOLOMITE_ASSETS    the assets folder, where it is not found\n  \
         DOLOMITE_SHARED    the folder of shared data, for the scene `classic`\n  \
         WGPU_ADAPTER_NAME  part of the name of the Vulkan device to use\n  \
         RUST_LOG           what is logged, for example info\n",
        indented(&keys::table()),
        indented(&console::table().help())
    )
}

fn indented(text: &str) -> String {
    text.lines()
        .map(|line| format!("  {}\n", line.trim_end()))
        .collect()
}

#[derive(Subcommand)]
pub enum Command {
    /// Play in a window (the default).
    Play(Play),
    /// Render one picture without a window.
    Shot(Shot),
    /// Fly a fixed path without a window and write what each frame cost, as JSON.
    Bench(Bench),
    /// Let a bot play a level to its end, by input alone, without a window.
    Bot(Bot),
    /// Convert an FBX file to glTF and say how exact the result is.
    Fbx2gltf(Fbx2gltf),
    /// Say what a file of elevation is, picture it, convert it.
    Heights(Heights),
    /// Print the default settings as a file, with a comment on each.
    Settings,
}

/// Play in a window.
#[derive(Args)]
pub struct Play {
    #[command(flatten)]
    scene: SceneArgs,
    /// Size of the window [default: 1600x900, or that of the settings].
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    size: Option<Size>,
    /// Do not wait for the display between frames.
    #[arg(long)]
    no_vsync: bool,
    /// Do not show the panel of frame times and counts.
    #[arg(long)]
    no_hud: bool,
}

impl Play {
    /// Settings and scene.
    ///
    /// # Errors
    /// [`BenchError`], naming the file and the reason.
    pub fn setup(&self) -> Result<Setup, BenchError> {
        let mut setup = self.scene.setup(user_choices(), |settings| {
            if let Some(Size(size)) = self.size {
                settings.window = (size.x, size.y);
            }
            settings.vsync &= !self.no_vsync;
            settings.panel &= !self.no_hud && self.scene.level.is_none();
        })?;
        if self.scene.camera.is_none() {
            setup.start_behind_figure();
            // A scene that draws itself has nobody to follow.
            setup.switches.follow = setup.scene.own.is_none();
        }
        Ok(setup)
    }
}

/// Render one picture without a window.
#[derive(Args)]
pub struct Shot {
    #[command(flatten)]
    scene: SceneArgs,
    /// Size of the picture.
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1280x720")]
    pub size: Size,
    /// Steps of a sixtieth of a second that are played before the picture is taken.
    #[arg(long, default_value_t = 1)]
    pub frames: u32,
    /// The PNG to write.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Let the figure walk meanwhile, this way as the camera sees it, and let the camera follow: 0 is
    /// ahead, 90 to the left, 180 towards the camera. Of `--camera` the turn and the pitch count.
    #[arg(
        long,
        value_name = "DEGREES",
        num_args = 0..=1,
        default_missing_value = "0",
        allow_negative_numbers = true
    )]
    pub walk: Option<f32>,
    /// Show the panel of frame times and counts.
    #[arg(long)]
    hud: bool,
    /// With --level: the screen that is shown.
    #[arg(long, value_enum, default_value = "play", help_heading = "Level")]
    screen: Screens,
    /// With --level: where the player stands and looks, metres and degrees.
    #[arg(
        long,
        value_name = "X,Z,DEGREES",
        allow_hyphen_values = true,
        help_heading = "Level"
    )]
    stand: Option<Stand>,
    /// With --level: the hour of the day.
    #[arg(long, help_heading = "Level")]
    hour: Option<f32>,
    /// With --level: so many beacons burn.
    #[arg(long, default_value_t = 0, help_heading = "Level")]
    lit: usize,
    /// With --level: three soldiers stand so far ahead of the player, and look there.
    #[arg(long, value_name = "METRES", help_heading = "Level")]
    meet: Option<f32>,
    /// With --meet: so many of them fell, and lie there.
    #[arg(long, default_value_t = 0, requires = "meet", help_heading = "Level")]
    fallen: usize,
}

/// Screens of a level.
#[derive(clap::ValueEnum, Clone, Copy, Debug)]
enum Screens {
    Title,
    Play,
    Pause,
    Settings,
    Keys,
    Won,
    Lost,
}

impl From<Screens> for Screen {
    fn from(screen: Screens) -> Self {
        match screen {
            Screens::Title => Self::Title,
            Screens::Play => Self::Play,
            Screens::Pause => Self::Pause,
            Screens::Settings => Self::Settings,
            Screens::Keys => Self::Keys,
            Screens::Won => Self::Won,
            Screens::Lost => Self::Lost,
        }
    }
}

impl Shot {
    /// Settings and scene.
    ///
    /// # Errors
    /// [`BenchError`], naming the file and the reason.
    pub fn setup(&self) -> Result<Setup, BenchError> {
        let mut setup = self
            .scene
            .setup(None, |settings| settings.panel = self.hud)?;
        setup.panels = self.hud;
        if let Some(level) = &mut setup.level {
            let mut file = (*level.level.file).clone();
            file.start = self.stand.map_or(file.start, |Stand(at)| at);
            file.hour = self.hour.unwrap_or(file.hour);
            level.level.file = file.into();
            level.screen = self.screen.into();
            level.lit = self.lit;
            level.keeps_nothing = true;
            level.meet = self.meet.map(|ahead| Meet {
                ahead,
                count: 3,
                fallen: self.fallen,
            });
        }
        if self.walk.is_some() {
            if self.scene.camera.is_none() {
                setup.start_behind_figure();
            }
            setup.switches.follow = true;
        }
        Ok(setup)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;
    use dolomite_game::settings::Settings;

    #[test]
    fn the_command_line_is_consistent() {
        Line::command().debug_assert();
    }

    #[test]
    fn without_a_command_it_plays() {
        let line = Line::try_parse_from(["dolomite", "--scene", "jacksboro", "--lines"]).unwrap();
        assert!(line.command.is_none());
        assert_eq!(line.play.scene.scene, "jacksboro");
        assert!(line.play.scene.lines);
    }

    #[test]
    fn one_rule_of_detail_is_chosen() {
        let rules = |arguments: &str| {
            let line = Line::try_parse_from(
                ["dolomite", "--scene", "mountain"]
                    .into_iter()
                    .chain(arguments.split_whitespace()),
            )
            .map_err(|error| error.to_string())?;
            // Settings of nobody: the defaults, whoever runs this.
            let mut settings = Settings::default();
            line.play.scene.rule(&mut settings);
            Ok::<_, String>((settings.max_error, settings.budget))
        };
        assert_eq!(rules(""), Ok((Some(1.0), None)));
        assert_eq!(rules("--max-error 4"), Ok((Some(4.0), None)));
        assert_eq!(rules("--budget 3"), Ok((Some(1.0), Some(3.0))));
        for patches in ["--pixels-per-edge 8", "--finest-patch 4"] {
            assert_eq!(rules(patches), Ok((None, None)), "{patches}");
            for other in ["--max-error 1", "--budget 3"] {
                assert!(rules(&format!("{patches} {other}")).is_err());
            }
        }
    }

    #[test]
    fn help_names_every_command_of_the_console() {
        let help = Line::command().render_long_help().to_string();
        let table = console::table();
        table.command().clone().debug_assert();
        for name in [
            "set", "get", "scene", "shot", "bench", "spawn", "bot", "views",
        ] {
            assert!(table.list().any(|(known, _)| known == name), "{name}");
        }
        for (name, about) in table.list() {
            // Some names begin other lines too.
            let told = help
                .lines()
                .any(|line| line.split_whitespace().next() == Some(name) && line.contains(&about));
            assert!(told, "{name}");
        }
    }

    #[test]
    fn help_names_every_key() {
        let help = Line::command().render_long_help().to_string();
        for key in keys::KEYS {
            assert!(
                help.contains(key.keys) && help.contains(key.does),
                "{}",
                key.keys
            );
        }
    }
}
