//! What every way to run the game needs: settings, assets, a scene; and every way it can fail.
//!
//! | file | concern |
//! |---|---|
//! | [`device`] | is there a device that can draw this |
//! | [`window`] | play in a window |
//! | [`offscreen`], [`mod@shot`] | an app without a window; one picture from it |

pub mod device;
pub mod offscreen;
pub mod shot;
pub mod window;

use std::path::PathBuf;

use bevy::log::{Level, LogPlugin};
use bevy::prelude::*;
use bevy::render::diagnostic::RenderDiagnosticsPlugin;
use thiserror::Error;

use crate::play::figure::Figure;
use crate::play::{SimulationPlugin, Switches};
use crate::scene::{self, CurrentScene, Pose, SceneError, SceneRequest};
use crate::settings::paths::{self, AssetsDir, AssetsError};
use crate::settings::{Settings, SettingsError};
use crate::view::panel::PanelPlugin;
use crate::view::textures::{self, Content, TextureError};
use crate::view::{GroundTextures, ViewPlugin};
use device::DeviceError;
use dolomite::{DolomiteMinimalPlugins, DolomitePlugins};
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
    /// No device to draw with.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// A texture was refused.
    #[error(transparent)]
    Texture(#[from] TextureError),
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
        })
    }

    /// Starts the camera behind the figure, looking where it faces.
    pub fn start_behind_figure(&mut self) {
        let scene = &mut self.scene.0;
        let place = Figure::at(scene.figure, &scene.terrain).now.place;
        scene.camera = Pose::behind(place, scene.facing, &scene.terrain);
    }

    /// Adds simulation, view and panels to an app that has Bevy's own plugins.
    ///
    /// # Errors
    /// [`GameError::Texture`] when the ground's textures are missing or wrong.
    pub fn add_to(self, app: &mut App) -> Result<(), GameError> {
        let own = self.scene.own.clone();
        app.insert_resource(self.settings)
            .insert_resource(self.request)
            .insert_resource(self.scene)
            .insert_resource(self.switches);
        if let Some(own) = own {
            app.insert_resource(AssetsDir(self.assets))
                .add_plugins((DolomiteMinimalPlugins, SimulationPlugin));
            own.build(app);
        } else {
            let folder = self.assets.join("textures");
            let read = |name, content| textures::read_array(&folder.join(name), content);
            let albedo_height = read("terrain_albedo_height.png", Content::Colour)?;
            let normal_roughness = read("terrain_normal_roughness.png", Content::Data)?;
            let mut images = app.world_mut().resource_mut::<Assets<Image>>();
            let textures = GroundTextures {
                albedo_height: images.add(albedo_height),
                normal_roughness: images.add(normal_roughness),
            };
            app.insert_resource(AssetsDir(self.assets))
                .insert_resource(textures)
                .add_plugins((DolomitePlugins, SimulationPlugin, ViewPlugin));
        }
        app.add_plugins(RenderDiagnosticsPlugin);
        if self.panels {
            app.add_plugins(PanelPlugin);
        }
        Ok(())
    }
}

/// Warnings and errors only; `RUST_LOG` shows more.
pub fn log_plugin() -> LogPlugin {
    LogPlugin {
        level: Level::WARN,
        ..default()
    }
}
