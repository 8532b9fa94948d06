//! What every way to run the game needs: settings, assets, a scene; and every way it can fail.

use std::path::PathBuf;

use bevy::log::{Level, LogPlugin};
use bevy::prelude::*;
use bevy::render::diagnostic::RenderDiagnosticsPlugin;
use thiserror::Error;

use super::bench::BenchError;
use super::camera::Pose;
use super::classic_view::ClassicViewPlugin;
use super::device::DeviceError;
use super::hot_reload::AssetsDir;
use super::hud::HudPlugin;
use super::methods::{MethodError, Methods};
use super::offscreen::OffscreenError;
use super::paths::{self, AssetsError};
use super::player::Figure;
use super::scenes::{self, CurrentScene, SceneError, SceneRequest};
use super::settings::{Settings, SettingsError};
use super::simulation::{SimulationPlugin, Switches};
use super::textures::{self, Content, TextureError};
use super::view::{GroundTextures, ViewPlugin};
use crate::{DolomiteMinimalPlugins, DolomitePlugins};

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
    /// The bench failed.
    #[error(transparent)]
    Bench(#[from] BenchError),
    /// A way to make triangles was refused.
    #[error(transparent)]
    Method(#[from] MethodError),
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
    /// How the triangles of the classic scene are made.
    pub methods: Methods,
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
        let mut scene = CurrentScene(scenes::load(&request, &assets)?);
        if let Some(pose) = camera {
            scene.0.camera = pose;
        }
        Ok(Self {
            settings,
            assets,
            request,
            scene,
            switches: Switches::default(),
            methods: Methods::default(),
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
        if let Some(heights) = self.scene.classic.clone() {
            app.insert_resource(self.settings)
                .insert_resource(AssetsDir(self.assets))
                .insert_resource(self.request)
                .insert_resource(self.scene)
                .insert_resource(self.switches)
                .insert_resource(self.methods)
                .add_plugins((
                    DolomiteMinimalPlugins,
                    SimulationPlugin,
                    ClassicViewPlugin { heights },
                    RenderDiagnosticsPlugin,
                ));
            if self.panels {
                app.add_plugins(HudPlugin);
            }
            return Ok(());
        }
        let folder = self.assets.join("textures");
        let read = |name, content| textures::read_array(&folder.join(name), content);
        let albedo_height = read("terrain_albedo_height.png", Content::Colour)?;
        let normal_roughness = read("terrain_normal_roughness.png", Content::Data)?;
        let mut images = app.world_mut().resource_mut::<Assets<Image>>();
        let textures = GroundTextures {
            albedo_height: images.add(albedo_height),
            normal_roughness: images.add(normal_roughness),
        };
        app.insert_resource(textures)
            .insert_resource(self.settings)
            .insert_resource(AssetsDir(self.assets))
            .insert_resource(self.request)
            .insert_resource(self.scene)
            .insert_resource(self.switches)
            .add_plugins((
                DolomitePlugins,
                SimulationPlugin,
                ViewPlugin,
                RenderDiagnosticsPlugin,
            ));
        if self.panels {
            app.add_plugins(HudPlugin);
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
