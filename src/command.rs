//! The command line: what can be asked for, and how it becomes a setup.

use std::path::{Path, PathBuf};

use bevy::math::UVec2;
use clap::{Args, Parser, Subcommand};
use dolomite_game::game::bench_path;
use dolomite_game::game::classic_view::FIELD_OF_VIEW;
use dolomite_game::game::keys;
use dolomite_game::game::methods::{MethodError, Methods, Metric, Mode};
use dolomite_game::game::scenes::{CLASSIC, MapOptions, SceneRequest};
use dolomite_game::game::settings::Settings;
use dolomite_game::game::setup::{GameError, Setup};
use dolomite::terrain::RawFormat;

use crate::fbx2gltf::Fbx2gltf;
use crate::values::{Camera, Degrees2, RawType, Size};

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
        "Keys:\n{}\nExamples:\n  \
         dolomite --scene jacksboro --detail 8\n  \
         dolomite --scene alps.png --spacing 25 --height-scale 0.08\n  \
         dolomite shot --scene mountain --size 1920x1080 --out mountain.png\n  \
         dolomite bench --scene mountain --path fly --frames 600 --json fly.json\n  \
         dolomite bench --scene classic --matrix --frames 12\n\n\
         Environment:\n  \
         DOLOMITE_ASSETS    the assets folder, where it is not found\n  \
         DOLOMITE_SHARED    the folder of shared data, for the scene `classic`\n  \
         WGPU_ADAPTER_NAME  part of the name of the Vulkan device to use\n  \
         RUST_LOG           what is logged, for example info\n",
        indented(&keys::table())
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
    /// Convert an FBX file to glTF and say how exact the result is.
    Fbx2gltf(Fbx2gltf),
    /// Print the default settings as a file, with a comment on each.
    Settings,
}

/// What is shown; the same for every command.
#[derive(Args)]
pub struct SceneArgs {
    /// `mountain`, `jacksboro`, `classic` (to compare methods; needs the shared data), a scene file
    /// (.ron), or a height map (.png, .raw, .r16, .f32).
    #[arg(long, default_value = "mountain")]
    scene: String,
    /// Folder of the shared data [default: DOLOMITE_SHARED, or `shared` beside the checkout].
    #[arg(long, value_name = "DIR", help_heading = "Classic scene")]
    data: Option<PathBuf>,
    /// Who makes the triangles of the classic scene, and when.
    #[arg(long, value_enum, default_value_t, help_heading = "Classic scene")]
    mode: Mode,
    /// By what rule, in modes that follow the view.
    #[arg(long, value_enum, default_value_t, help_heading = "Classic scene")]
    metric: Metric,
    /// What the rule aims at: length of an edge, or error [default: --pixels-per-edge].
    #[arg(long, value_name = "PIXELS", help_heading = "Classic scene")]
    tau: Option<f32>,
    /// Tessellate patches outside of the frustum too, as the scene's definition has it; the picture is the
    /// same.
    #[arg(long, help_heading = "Classic scene")]
    no_cull: bool,
    /// Height map: metres between samples.
    #[arg(
        long,
        value_name = "METRES",
        default_value_t = 30.0,
        help_heading = "Height map"
    )]
    spacing: f64,
    /// Height map: columns and rows, needed for all but PNG.
    #[arg(long, value_name = "COLUMNSxROWS", help_heading = "Height map")]
    size_of_raw: Option<Size>,
    /// Height map: the little-endian numbers of a raw file, where the ending does not tell (.raw is
    /// i16, .r16 is u16, .f32 is f32).
    #[arg(long, value_enum, help_heading = "Height map")]
    raw_type: Option<RawType>,
    /// Height map: metres for one unit of a sample [default: 1; 0.1 for PNG].
    #[arg(
        long,
        value_name = "METRES",
        allow_negative_numbers = true,
        help_heading = "Height map"
    )]
    height_scale: Option<f32>,
    /// Height map: metres added to the scaled sample.
    #[arg(
        long,
        value_name = "METRES",
        default_value_t = 0.0,
        allow_negative_numbers = true,
        help_heading = "Height map"
    )]
    height_offset: f32,
    /// Settings file [default: ~/.config/dolomite/settings.ron, where there is one].
    #[arg(long, value_name = "FILE", help_heading = "Settings")]
    settings: Option<PathBuf>,
    /// Amplitude of the detail below the sample spacing, for scenes that have some (jacksboro).
    #[arg(long, value_name = "METRES", help_heading = "Settings")]
    detail: Option<f32>,
    /// Sun: azimuth clockwise from north, elevation above the horizon.
    #[arg(
        long,
        value_name = "AZIMUTH,ELEVATION",
        allow_hyphen_values = true,
        help_heading = "Settings"
    )]
    sun: Option<Degrees2>,
    /// Vertical field of view.
    #[arg(long, value_name = "DEGREES", help_heading = "Settings")]
    fov: Option<f32>,
    /// Ground of patches with triangle edges of this length on the screen, in place of a bounded error.
    #[arg(
        long,
        value_name = "PIXELS",
        help_heading = "Settings",
        conflicts_with_all = ["max_error", "budget"]
    )]
    pixels_per_edge: Option<f32>,
    /// Ground of patches, the smallest with this side, in place of a bounded error.
    #[arg(
        long,
        value_name = "METRES",
        help_heading = "Settings",
        conflicts_with_all = ["max_error", "budget"]
    )]
    finest_patch: Option<f32>,
    /// How far the drawn ground may be from the true one in the picture [default: 1].
    #[arg(long, value_name = "PIXELS", help_heading = "Settings")]
    max_error: Option<f32>,
    /// Hold the GPU's time for the ground's detail by the error in the picture, in place of --max-error.
    #[arg(
        long,
        value_name = "MILLISECONDS",
        help_heading = "Settings",
        conflicts_with = "max_error"
    )]
    budget: Option<f32>,
    /// Start at this camera: metres, and degrees. Yaw 0 looks north and grows to the left, pitch
    /// grows upwards. [default: that of the scene; for play, behind the figure]
    #[arg(long, value_name = "X,Y,Z,YAW,PITCH", allow_hyphen_values = true)]
    camera: Option<Camera>,
    /// Draw triangle edges.
    #[arg(long)]
    lines: bool,
    /// Do not fill triangles.
    #[arg(long)]
    no_fill: bool,
}

impl SceneArgs {
    /// By what rule the ground is refined, where the command line says it.
    fn rule(&self, settings: &mut Settings) {
        if self.pixels_per_edge.or(self.finest_patch).is_some() {
            (settings.max_error, settings.budget) = (None, None);
        } else if self.max_error.is_some() {
            (settings.max_error, settings.budget) = (self.max_error, None);
        } else {
            settings.budget = self.budget.or(settings.budget);
        }
    }

    fn setup(&self, change: impl FnOnce(&mut Settings)) -> Result<Setup, GameError> {
        let mut settings = Settings::load(self.settings.as_deref())?;
        settings.detail = self.detail.or(settings.detail);
        settings.sun = self.sun.map(|Degrees2(a, b)| (a, b)).or(settings.sun);
        let fov = (self.scene == CLASSIC).then_some(FIELD_OF_VIEW);
        settings.fov = self.fov.or(fov).unwrap_or(settings.fov);
        settings.pixels_per_edge = self.pixels_per_edge.unwrap_or(settings.pixels_per_edge);
        settings.finest_patch = self.finest_patch.unwrap_or(settings.finest_patch);
        self.rule(&mut settings);
        change(&mut settings);
        settings.check(Path::new("command line"))?;
        let request = SceneRequest {
            scene: self.scene.clone(),
            map: MapOptions {
                spacing: self.spacing,
                size: self.size_of_raw.map(|Size(size)| (size.x, size.y)),
                raw: self.raw_type.map(RawFormat::from),
                scale: self.height_scale,
                offset: self.height_offset,
            },
            detail: settings.detail,
            data: self.data.clone(),
        };
        let mut setup = Setup::load(settings, request, self.camera.map(|Camera(pose)| pose))?;
        setup.methods = Methods {
            mode: self.mode,
            metric: self.metric,
            tau: self.tau,
            no_cull: self.no_cull,
        };
        setup.methods.check(&setup.scene)?;
        setup.switches.lines = self.lines;
        setup.switches.fill = !self.no_fill;
        Ok(setup)
    }
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
    /// [`GameError`], naming the file and the reason.
    pub fn setup(&self) -> Result<Setup, GameError> {
        let mut setup = self.scene.setup(|settings| {
            if let Some(Size(size)) = self.size {
                settings.window = (size.x, size.y);
            }
            settings.vsync &= !self.no_vsync;
            settings.panel &= !self.no_hud;
        })?;
        if self.scene.camera.is_none() {
            setup.start_behind_figure();
            // The classic scene has nobody to follow.
            setup.switches.follow = setup.scene.classic.is_none();
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
}

impl Shot {
    /// Settings and scene.
    ///
    /// # Errors
    /// [`GameError`], naming the file and the reason.
    pub fn setup(&self) -> Result<Setup, GameError> {
        let mut setup = self.scene.setup(|settings| settings.panel = self.hud)?;
        setup.panels = self.hud;
        if self.walk.is_some() {
            if self.scene.camera.is_none() {
                setup.start_behind_figure();
            }
            setup.switches.follow = true;
        }
        Ok(setup)
    }
}

/// Fly a fixed path without a window and write what each frame cost.
#[derive(Args)]
pub struct Bench {
    #[command(flatten)]
    scene: SceneArgs,
    /// The path to fly.
    #[arg(long, value_enum, required_unless_present = "matrix")]
    path: Option<bench_path::Path>,
    /// Size of the picture [default: 1920x1080; 1280x720 for the classic scene].
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    size: Option<Size>,
    /// Number of frames, a sixtieth of a second of the path each [default: 300; 120 for the classic
    /// scene].
    #[arg(long)]
    frames: Option<u32>,
    /// The report to write.
    #[arg(long, value_name = "FILE", required_unless_present = "matrix")]
    pub json: Option<PathBuf>,
    /// Compare every way to make the triangles of the classic scene, filled and as lines, and print a
    /// table.
    #[arg(long, conflicts_with_all = ["mode", "lines", "no_fill"])]
    pub matrix: bool,
}

impl Bench {
    fn is_classic(&self) -> bool {
        self.scene.scene == CLASSIC
    }

    /// The path to fly.
    pub fn path(&self) -> bench_path::Path {
        self.path.unwrap_or(bench_path::Path::Orbit)
    }

    /// Size of the picture, pixels.
    pub fn size(&self) -> UVec2 {
        let default = match self.is_classic() {
            true => UVec2::new(1280, 720),
            false => UVec2::new(1920, 1080),
        };
        self.size.map_or(default, |Size(size)| size)
    }

    /// Number of frames.
    pub fn frames(&self) -> u32 {
        self.frames
            .unwrap_or(if self.is_classic() { 120 } else { 300 })
    }

    /// Settings and scene.
    ///
    /// # Errors
    /// [`GameError`], naming the file and the reason.
    pub fn setup(&self) -> Result<Setup, GameError> {
        let mut setup = self.scene.setup(|settings| settings.panel = false)?;
        if self.matrix && setup.scene.classic.is_none() {
            return Err(MethodError::OtherScene(setup.scene.name.clone()).into());
        }
        setup.panels = false;
        Ok(setup)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

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

    fn bench_of(arguments: &str) -> Result<Bench, clap::Error> {
        let words = ["dolomite", "bench"]
            .into_iter()
            .chain(arguments.split(' '));
        match Line::try_parse_from(words)?.command {
            Some(Command::Bench(bench)) => Ok(bench),
            _ => panic!("`bench` is the bench"),
        }
    }

    #[test]
    fn the_bench_knows_the_classic_scene() {
        let bench = bench_of(
            "--scene classic --path orbit --metric edge --tau 3 --mode static-cpu --json f.json",
        )
        .unwrap();
        assert_eq!(
            (bench.scene.mode, bench.scene.metric),
            (Mode::StaticCpu, Metric::Edge)
        );
        assert_eq!((bench.size(), bench.frames()), (UVec2::new(1280, 720), 120));
        let other = bench_of("--path fly --json f.json").unwrap();
        assert_eq!(
            (other.size(), other.frames()),
            (UVec2::new(1920, 1080), 300)
        );
        let matrix = bench_of("--scene classic --matrix --frames 12 --size 64x48").unwrap();
        assert_eq!(
            (matrix.path(), matrix.json.as_ref()),
            (bench_path::Path::Orbit, None)
        );
        assert_eq!((matrix.size(), matrix.frames()), (UVec2::new(64, 48), 12));
        for wrong in [
            "--scene classic --path orbit",
            "--scene classic --json f.json",
            "--scene classic --matrix --mode cpu",
            "--scene classic --path orbit --json f.json --metric best",
        ] {
            assert!(bench_of(wrong).is_err(), "{wrong} was accepted");
        }
    }

    #[test]
    fn methods_are_refused_with_reasons() {
        let refused = |arguments: &str| {
            let bench = bench_of(arguments).unwrap();
            bench.setup().err().expect("refused").to_string()
        };
        for (arguments, words) in [
            ("--path fly --json f --mode cpu", "--scene classic"),
            ("--matrix", "--scene classic"),
            (
                "--scene classic --data no/such --path orbit --json f",
                "no/such/data/classic/heights",
            ),
        ] {
            let error = refused(arguments);
            assert!(error.contains(words), "{error} does not say {words}");
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
