//! What every way to run the game needs: settings, assets, a scene; and every way it can fail.
//!
//! | file | concern |
//! |---|---|
//! | [`began`], [`ended`] | when the process began; its end |
//! | [`device`] | is there a device that can draw this |
//! | [`window`], [`patient`] | play in a window, which answers from its first frame on |
//! | [`offscreen`], [`mod@shot`] | an app without a window; one picture from it |
//! | [`meet`] | soldiers before the player, for a picture |

pub mod began;
pub mod device;
pub mod ended;
pub mod meet;
pub mod offscreen;
pub mod patient;
pub mod shot;
pub mod unseen;
pub mod window;

use std::path::PathBuf;

use bevy::log::{Level, LogPlugin};
use bevy::prelude::*;
use bevy::render::diagnostic::RenderDiagnosticsPlugin;
use thiserror::Error;

use crate::console::ConsolePlugin;
use crate::console::script::{Script, ScriptError};
use crate::level::menu::{Menu, MenuPlugin, Screen};
use crate::level::parts::{self, Beacon, Numbered};
use crate::level::{LevelError, LevelPlugin, LevelSystems};
use crate::play::camera::FreeCamera;
use crate::play::figure::Figure;
use crate::play::{SimulationPlugin, Switches};
use crate::scene::{self, CurrentScene, Pose, SceneError, SceneRequest, read_about};
use crate::settings::choices::KeepTo;
use crate::settings::paths::{self, AssetsDir, AssetsError};
use crate::settings::{Settings, SettingsError};
use crate::view::level::LevelViewPlugin;
use crate::view::panel::PanelPlugin;
use crate::view::progress::{self, ProgressPlugin};
use crate::view::start::StartPlugin;
use crate::view::textures::{self, TextureError};
use crate::view::{DressPlugin, SceneTextures, ViewPlugin};
use device::DeviceError;
use dolomite::logic::Lamp;
use dolomite::{DolomiteMinimalPlugins, DolomitePlugins};
use meet::Meet;
use offscreen::OffscreenError;

/// Everything that can go wrong in the game, with file, reason, and what to do.
#[derive(Debug, Error)]
pub enum GameError {
    /// No assets folder.
    #[error(transparent)]
    Assets(#[from] AssetsError),
    /// Settings were refused.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The scene was refused.
    #[error(transparent)]
    Scene(#[from] Box<SceneError>),
    /// The level was refused.
    #[error(transparent)]
    Level(#[from] LevelError),
    /// No device to draw with.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// A texture was refused.
    #[error(transparent)]
    Texture(#[from] TextureError),
    /// A script cannot be read.
    #[error(transparent)]
    Script(#[from] ScriptError),
    /// Rendering without a window failed.
    #[error(transparent)]
    Offscreen(#[from] OffscreenError),
}

impl From<SceneError> for GameError {
    fn from(error: SceneError) -> Self {
        // Boxed: scene errors are large, and all other errors would carry their size.
        Self::Scene(Box::new(error))
    }
}

/// What the game starts from.
pub struct Setup {
    /// What the player may set.
    pub settings: Settings,
    /// The assets folder.
    pub assets: PathBuf,
    /// What was asked for.
    pub request: SceneRequest,
    /// The scene that it names.
    pub scene: CurrentScene,
    /// Lines and fill at the start.
    pub switches: Switches,
    /// Shows panels.
    pub panels: bool,
    /// The level that is played in the scene.
    pub level: Option<LevelSetup>,
    /// Commands of the console, done once the scene is there.
    pub script: Option<Script>,
    /// Where what is chosen in the menu is kept.
    pub keep: Option<PathBuf>,
}

/// A level, and how it is come upon.
#[derive(Clone)]
pub struct LevelSetup {
    /// The level.
    pub level: parts::Level,
    /// The screen that is shown first.
    pub screen: Screen,
    /// Beacons that burn already.
    pub lit: usize,
    /// Where the camera is, in place of behind the figure.
    pub camera: Option<Pose>,
    /// Nobody plays: nothing is saved by itself.
    pub keeps_nothing: bool,
    /// Soldiers who stand before the player.
    pub meet: Option<Meet>,
}

impl LevelSetup {
    fn add(self, app: &mut App) {
        let mut menu = Menu::at(self.screen);
        menu.keeps_nothing = self.keeps_nothing;
        app.insert_resource(self.level)
            .insert_resource(menu)
            .add_plugins((LevelPlugin, MenuPlugin, LevelViewPlugin));
        if let Some(meet) = self.meet {
            meet.add(app);
        }
        let (lit, camera) = (self.lit, self.camera);
        let arrange = move |mut lamps: Query<(&Numbered, &mut Lamp), With<Beacon>>,
                            mut cameras: Query<&mut FreeCamera>,
                            mut switches: ResMut<Switches>| {
            let mut all: Vec<_> = lamps.iter_mut().collect();
            all.sort_by_key(|(number, _)| **number);
            for (_, lamp) in all.iter_mut().take(lit) {
                lamp.lit = true;
            }
            if let Some(pose) = camera {
                switches.follow = false;
                for mut camera in &mut cameras {
                    camera.pose = pose;
                }
            }
        };
        app.add_systems(Startup, arrange.after(LevelSystems::Begin));
    }
}

impl Setup {
    /// Finds the assets and loads the scene that `request` names. `camera` replaces the scene's
    /// start.
    ///
    /// # Errors
    /// [`GameError::Assets`] or [`GameError::Scene`].
    pub fn load(
        settings: Settings,
        request: SceneRequest,
        camera: Option<Pose>,
    ) -> Result<Self, GameError> {
        let assets = paths::assets_dir()?;
        let mut scene = CurrentScene(scene::load(&request, &assets)?);
        if let Some(pose) = camera {
            scene.0.camera = pose;
        }
        Ok(Self {
            settings,
            assets,
            request,
            scene,
            switches: Switches::default(),
            panels: true,
            level: None,
            script: None,
            keep: None,
        })
    }

    /// Starts the camera behind the figure, looking where it faces.
    pub fn start_behind_figure(&mut self) {
        let scene = &mut self.scene.0;
        read_about(&scene.terrain, scene.figure);
        let place = Figure::at(scene.figure, &scene.terrain).now.place;
        scene.camera = Pose::behind(place, scene.facing, &scene.terrain);
    }

    /// Adds simulation, view and panels to an app that has Bevy's own plugins.
    ///
    /// # Errors
    /// [`GameError::Texture`] when the ground's textures are missing or wrong.
    pub fn add_to(self, app: &mut App) -> Result<(), GameError> {
        if self.scene.own.is_none() {
            let read = textures::read_ground(&self.assets.join("textures"))?;
            let mut images = app.world_mut().resource_mut::<Assets<Image>>();
            let textures = SceneTextures::new(read, &mut images);
            app.insert_resource(textures);
        }
        self.add(app);
        app.add_plugins(DressPlugin);
        app.add_systems(Startup, progress::textures_are_there);
        Ok(())
    }

    /// The same, with a screen that says what is being done until there is a picture. Textures are read
    /// meanwhile; where they are missing or wrong the app says so and ends.
    pub fn add_behind_start_screen(self, app: &mut App) {
        self.add(app);
        app.add_plugins(StartPlugin);
    }

    fn add(self, app: &mut App) {
        let own = self.scene.own.clone();
        app.insert_resource(self.settings)
            .insert_resource(AssetsDir(self.assets))
            .insert_resource(self.request)
            .insert_resource(self.scene)
            .insert_resource(self.switches)
            .add_plugins((RenderDiagnosticsPlugin, ProgressPlugin));
        match own {
            Some(own) => {
                app.add_plugins((DolomiteMinimalPlugins, SimulationPlugin));
                own.build(app);
            }
            None => {
                app.add_plugins((DolomitePlugins, SimulationPlugin, ViewPlugin));
                if let Some(level) = self.level {
                    level.add(app);
                }
            }
        }
        if let Some(keep) = self.keep {
            app.insert_resource(KeepTo(keep));
        }
        if self.panels {
            app.add_plugins(PanelPlugin);
        }
        app.add_plugins(ConsolePlugin);
        if let Some(script) = self.script {
            app.insert_resource(script);
        }
    }
}

/// Warnings and errors only; `RUST_LOG` shows more.
pub fn log_plugin() -> LogPlugin {
    LogPlugin {
        level: Level::WARN,
        ..default()
    }
}
