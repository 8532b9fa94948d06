//! What is shown, as the command line says it; the same for every command.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::BoolishValueParser;
use dolomite_game::bench::BenchError;
use dolomite_game::bench::classic::args::ClassicArgs;
use dolomite_game::bench::classic::{self, view::FIELD_OF_VIEW};
use dolomite_game::console::script::Script;
use dolomite_game::level::load;
use dolomite_game::level::menu::Screen;
use dolomite_game::run::{GameError, LevelSetup, Setup};
use dolomite_game::scene::{MapOptions, SceneRequest};
use dolomite_game::settings::choices::Choices;
use dolomite_game::settings::paths;
use dolomite_game::settings::quality::Preset;
use dolomite_game::settings::{Renderer, Settings};

use super::elevation::ReadArgs;
use super::values::{Camera, Degrees2};

/// What is shown; the same for every command.
#[derive(Args)]
pub struct SceneArgs {
    /// `mountain`, `jacksboro`, `night`, `city`, `classic` (to compare methods; needs the shared data), a scene file
    /// (.ron), or a height map (.png, .tif, .asc, .hgt, .raw, .r16, .r32, .f32).
    #[arg(long, default_value = "mountain")]
    pub scene: String,
    /// Play a level in its scene: `mountain`, `city`.
    #[arg(long, value_name = "LEVEL", conflicts_with = "scene")]
    pub level: Option<String>,
    /// Seed of a level: where its soldiers begin.
    #[arg(long, default_value_t = 1)]
    level_seed: u64,
    #[command(flatten)]
    pub classic: ClassicArgs,
    /// Height map: metres between samples [default: what the file tells, else 30].
    #[arg(long, value_name = "METRES", help_heading = "Height map")]
    spacing: Option<f64>,
    #[command(flatten)]
    read: ReadArgs,
    /// Height map: leave samples without data as a sea of this level [default: fill them from their border].
    #[arg(
        long,
        value_name = "METRES",
        allow_negative_numbers = true,
        help_heading = "Height map"
    )]
    sea_in_holes: Option<f32>,
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
    /// Height map: most memory that its heights take, and as much on the GPU; of a larger map fine tiles are read about the camera, from
    /// a file of tiles that is made beside it once [default: a map of up to 16 385 x 16 385 samples is read as a whole, a larger one
    /// within 128].
    #[arg(long, value_name = "MIB", help_heading = "Height map")]
    map_memory: Option<u64>,
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
    /// Who lights the picture [default: that of the settings, else bevy].
    #[arg(long, value_enum, help_heading = "Settings")]
    renderer: Option<Renderer>,
    /// Draw what grows [default: that of the settings, else in windows that a GPU draws].
    #[arg(
        long,
        value_name = "on|off",
        value_parser = BoolishValueParser::new(),
        help_heading = "Settings"
    )]
    vegetation: Option<bool>,
    /// So many lamps, in scenes that have some (night), in place of the scene's own number.
    #[arg(long, value_name = "LAMPS")]
    lights: Option<u32>,
    /// Do the commands of the console in this file, a line each, once the scene is there; a mistake leaves out the rest.
    #[arg(long, value_name = "FILE")]
    exec: Option<PathBuf>,
    /// Give the figure a torch.
    #[arg(long)]
    torch: bool,
    /// What pictures are drawn with, where the settings do not say it by hand [default: auto: that of the device
    /// in a window, full in pictures and measurements].
    #[arg(long, value_enum, help_heading = "Settings")]
    preset: Option<Preset>,
    /// Sides of the picture that is drawn over those of the one that is shown, 0.25 to 2; the errors above are in
    /// pixels of what is drawn [default: that of the preset].
    #[arg(long, value_name = "SCALE", help_heading = "Settings")]
    resolution: Option<f32>,
    /// Start at this camera: metres, and degrees. Yaw 0 looks north and grows to the left, pitch
    /// grows upwards. [default: that of the scene; for play, behind the figure]
    #[arg(long, value_name = "X,Y,Z,YAW,PITCH", allow_hyphen_values = true)]
    pub camera: Option<Camera>,
    /// Draw triangle edges.
    #[arg(long)]
    pub lines: bool,
    /// Draw what collision knows: shapes, contacts, tiles.
    #[arg(long)]
    pub shapes: bool,
    /// Do not fill triangles.
    #[arg(long)]
    no_fill: bool,
}

impl SceneArgs {
    /// Whether it is the scene to compare methods on, whose definition says more than where the ground is.
    pub fn is_classic(&self) -> bool {
        self.scene == classic::NAME
    }

    /// By what rule the ground is refined, where the command line says it.
    pub fn rule(&self, settings: &mut Settings) {
        if self.pixels_per_edge.or(self.finest_patch).is_some() {
            (settings.max_error, settings.budget) = (None, None);
        } else if self.max_error.is_some() {
            (settings.max_error, settings.budget) = (self.max_error, None);
        } else {
            settings.budget = self.budget.or(settings.budget);
        }
    }

    /// `kept` is the file of what was chosen in the menu before; a file of settings that is named has its own say.
    pub fn setup(
        &self,
        kept: Option<PathBuf>,
        change: impl FnOnce(&mut Settings),
    ) -> Result<Setup, BenchError> {
        let mut settings = Settings::load(self.settings.as_deref()).map_err(GameError::from)?;
        let kept = kept.filter(|_| self.settings.is_none());
        if let Some(path) = &kept {
            // Nobody is kept from playing by it: the next choice writes it anew.
            match Choices::over(settings.clone(), path) {
                Ok(chosen) => settings = chosen,
                Err(error) => eprintln!("dolomite: what was chosen in the menu is lost: {error}"),
            }
        }
        settings.detail = self.detail.or(settings.detail);
        settings.sun = self.sun.map(|Degrees2(a, b)| (a, b)).or(settings.sun);
        let fov = self.is_classic().then_some(FIELD_OF_VIEW);
        settings.fov = self.fov.or(fov).unwrap_or(settings.fov);
        settings.pixels_per_edge = self.pixels_per_edge.unwrap_or(settings.pixels_per_edge);
        settings.finest_patch = self.finest_patch.unwrap_or(settings.finest_patch);
        settings.renderer = self.renderer.unwrap_or(settings.renderer);
        settings.vegetation = self.vegetation.or(settings.vegetation);
        settings.preset = self.preset.unwrap_or(settings.preset);
        settings.resolution = self.resolution.or(settings.resolution);
        self.rule(&mut settings);
        change(&mut settings);
        settings
            .check(Path::new("command line"))
            .map_err(GameError::from)?;
        let level = match &self.level {
            Some(name) => {
                let assets = paths::assets_dir().map_err(GameError::from)?;
                let loaded = load::load(name, self.level_seed, &assets);
                Some(loaded.map_err(GameError::from)?.0)
            }
            None => None,
        };
        let scene = level
            .as_ref()
            .map_or(&self.scene, |level| &level.file.scene);
        let request = SceneRequest {
            scene: scene.clone(),
            map: MapOptions {
                spacing: self.spacing,
                read: self.read.options(self.spacing.is_some()),
                sea: self.sea_in_holes,
                scale: self.height_scale,
                offset: self.height_offset,
                budget: self.map_memory.map(|mib| mib.saturating_mul(1 << 20)),
            },
            detail: settings.detail,
            lights: self.lights,
            named: vec![self.classic.scene()],
        };
        let mut setup = Setup::load(settings, request, self.camera.map(|Camera(pose)| pose))?;
        self.classic.check(&setup.scene)?;
        setup.level = level.map(|level| LevelSetup {
            level,
            screen: Screen::Title,
            lit: 0,
            camera: self.camera.map(|Camera(pose)| pose),
            keeps_nothing: false,
            meet: None,
        });
        setup.keep = kept;
        setup.switches.follow = setup.level.is_some();
        setup.switches.lines = self.lines;
        setup.switches.shapes = self.shapes;
        setup.switches.torch = self.torch;
        setup.switches.fill = !self.no_fill;
        setup.script = match &self.exec {
            Some(file) => Some(Script::read(file).map_err(GameError::from)?),
            None => None,
        };
        Ok(setup)
    }
}
