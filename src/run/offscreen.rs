//! The game without a window: an app that is stepped by hand, in virtual time.

use std::time::Duration;

use bevy::asset::AssetPlugin;
use bevy::camera::RenderTarget;
use bevy::gilrs::GilrsPlugin;
use bevy::prelude::*;
use bevy::render::error_handler::{RenderErrorHandler, RenderErrorPolicy};
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::{CachedPipelineState, PipelineCache, PollType, TextureFormat};
use bevy::render::renderer::RenderDevice;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::render::{RenderApp, RenderPlugin};
use bevy::shader::ShaderCacheError;
use bevy::time::TimeUpdateStrategy;
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;
use dolomite::ground::detail::MakingBudget;
use dolomite::ground::render::TerrainRelief;
use dolomite::inspector::Console;
use dolomite::inspector::panel::InspectorTarget;
use dolomite::tessellation::render::GeometryStats;
use thiserror::Error;

use super::device::{self, Device};
use super::unseen::{self, Unseen};
use super::{GameError, Setup, log_plugin};
use crate::console::script::{self, Script};
use crate::play::Landscape;
use crate::scene::CurrentScene;
use crate::settings::{MAX_SIDE, Settings};
use crate::view::level::soldiers;
use crate::view::progress::Progress;
use crate::view::{OffscreenTarget, hero};

/// One step of virtual time: a sixtieth of a second.
pub const STEP: Duration = Duration::from_nanos(16_666_667);

/// Updates after which a view that has not settled never will. Shaders of Bevy's embedded assets
/// arrive within tens of updates; a software adapter compiles within the same updates.
const SETTLE_LIMIT: u32 = 2000;

/// Updates without change after which the view is settled: figures are read back from the GPU two
/// or three updates late.
const CALM: u32 = 5;

/// Why a picture or a measurement was not made.
#[derive(Debug, Error)]
pub enum OffscreenError {
    /// The size of the picture.
    #[error(
        "size {width}x{height}: must be 1x1 to {most}x{most} pixels on this device, for example \
         1280x720"
    )]
    Size {
        /// Asked width.
        width: u32,
        /// Asked height.
        height: u32,
        /// Largest side.
        most: u32,
    },
    /// A shader or a pipeline.
    #[error("render pipeline `{name}` failed: {reason}")]
    Pipeline {
        /// Label of the pipeline.
        name: String,
        /// What the compiler said.
        reason: String,
    },
    /// The device refused a command or was lost.
    #[error("rendering stopped: {0}")]
    Render(String),
    /// Pipelines or terrain never came to rest.
    #[error("the view did not settle within {SETTLE_LIMIT} updates: {0}")]
    NotSettled(String),
    /// A script has a mistake; where and which was said.
    #[error("the script {0} stopped at a mistake")]
    Script(String),
    /// No picture came back from the device.
    #[error("the device gave no picture back")]
    NoPicture,
    /// The picture cannot be written.
    #[error("picture {}: {source}; check that the folder exists and the name ends in .png", .path.display())]
    Write {
        /// The file.
        path: std::path::PathBuf,
        /// What went wrong.
        source: image::ImageError,
    },
}

/// Why rendering stopped, if it did.
#[derive(Resource)]
struct RenderFault(String);

/// The newest picture that came back.
#[derive(Resource, Default)]
struct Captured(Option<Image>);

/// The game without a window.
pub struct Offscreen {
    /// The app. Step it with [`Offscreen::step`].
    pub app: App,
    /// What draws.
    pub device: Device,
    target: Handle<Image>,
    script: Option<Script>,
}

impl Offscreen {
    /// Builds the game of `setup` with a picture of `size` pixels.
    ///
    /// # Errors
    /// [`GameError`]: no device, a size of 0 or too large, missing assets.
    pub fn new(mut setup: Setup, size: UVec2) -> Result<Self, GameError> {
        check_size(size, MAX_SIDE)?;
        let device = device::probe()?;
        check_size(size, device.max_texture)?;
        // It waits until the view has settled.
        let script = setup.script.take();
        let mut app = App::new();
        app.add_plugins(
            DefaultPlugins
                .build()
                .set(bevy::window::WindowPlugin {
                    primary_window: None,
                    exit_condition: ExitCondition::DontExit,
                    ..default()
                })
                .set(RenderPlugin {
                    render_creation: device::wgpu_settings().into(),
                    // A pipeline that is queued is there in the same update.
                    synchronous_pipeline_compilation: true,
                    ..default()
                })
                .set(AssetPlugin {
                    file_path: setup.assets.to_string_lossy().into_owned(),
                    ..default()
                })
                .set(log_plugin())
                .disable::<WinitPlugin>()
                .disable::<GilrsPlugin>()
                // Else the render world lives on another thread and cannot be asked.
                .disable::<PipelinedRenderingPlugin>(),
        )
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO))
        .insert_resource(RenderErrorHandler(|error, main, _| {
            main.insert_resource(RenderFault(error.description.clone()));
            RenderErrorPolicy::StopRendering
        }))
        .init_resource::<Captured>();
        let target =
            app.world_mut()
                .resource_mut::<Assets<Image>>()
                .add(Image::new_target_texture(
                    size.x,
                    size.y,
                    TextureFormat::Rgba8UnormSrgb,
                    None,
                ));
        app.insert_resource(InspectorTarget(RenderTarget::Image(target.clone().into())))
            .insert_resource(OffscreenTarget(target.clone()));
        setup.add_to(&mut app)?;
        unseen::add(&mut app);
        app.finish();
        app.cleanup();
        Ok(Self {
            app,
            device,
            target,
            script,
        })
    }

    /// One update, `time` of virtual time later, then waits for the device.
    ///
    /// # Errors
    /// [`OffscreenError::Render`] when the device refused a command or was lost.
    pub fn step(&mut self, time: Duration) -> Result<(), OffscreenError> {
        self.app
            .insert_resource(TimeUpdateStrategy::ManualDuration(time));
        self.app.update();
        if let Some(device) = self.app.world().get_resource::<RenderDevice>() {
            device
                .poll(PollType::wait_indefinitely())
                .map_err(|error| OffscreenError::Render(error.to_string()))?;
        }
        if let Some(fault) = self.app.world().get_resource::<RenderFault>() {
            return Err(OffscreenError::Render(fault.0.clone()));
        }
        match self.app.should_exit() {
            Some(exit) => Err(OffscreenError::Render(format!(
                "the app left with {exit:?}"
            ))),
            None => Ok(()),
        }
    }

    /// Steps without virtual time until every pipeline is there and the ground no longer changes, and draws that. Nobody
    /// sees the frames before, which have no pixels, and in which as many blocks of ground are made as a frame may. Where that
    /// takes longer than a second, lines on standard error say what is being done.
    ///
    /// # Errors
    /// [`OffscreenError`] when a pipeline fails or nothing comes to rest.
    pub fn settle(&mut self) -> Result<(), OffscreenError> {
        let making = hurry(self.app.world_mut());
        // A budget learns from the times of frames as they are seen.
        let budget = self.app.world().resource::<Settings>().budget;
        self.app.insert_resource(Unseen(budget.is_none()));
        let mut settled = self.rest();
        self.app.insert_resource(Unseen(false));
        if settled.is_ok()
            && let Some(script) = self.script.take()
        {
            settled = self.run_script(&script).and_then(|()| self.rest());
        }
        if let Some(making) = making {
            self.app.insert_resource(making);
        }
        settled?;
        // With pixels.
        self.step(Duration::ZERO)
    }

    /// Does the commands of a script, with steps of a sixtieth of a second where they wait.
    fn run_script(&mut self, script: &Script) -> Result<(), OffscreenError> {
        script::begin(self.app.world_mut(), script);
        let faults = self.app.world().resource::<Console>().faults();
        while !self.app.world().resource::<Console>().queue.is_empty() {
            self.step(STEP)?;
        }
        // What the last command said is told in the next step.
        self.step(Duration::ZERO)?;
        if self.app.world().resource::<Console>().faults() > faults {
            return Err(OffscreenError::Script(script.name.clone()));
        }
        Ok(())
    }

    /// Steps until nothing changes any more.
    fn rest(&mut self) -> Result<(), OffscreenError> {
        let _told = self.app.world().resource::<Progress>().told();
        let mut calm = 0;
        let mut last = None;
        let mut waiting = String::new();
        for _ in 0..SETTLE_LIMIT {
            self.step(Duration::ZERO)?;
            let pending = self.pending_pipelines()?;
            let stats = self.app.world().get_resource::<GeometryStats>().cloned();
            let at_rest = stats.as_ref().is_some_and(|stats| {
                stats.patches > 0 && stats.dispatches == 0 && stats.uploaded == 0
            });
            // The relief map arrives from the background when it is done; both are the game's own view's.
            let relief = has_relief(self.app.world_mut());
            let person = has_person(self.app.world_mut());
            if pending.is_empty() && relief && person && at_rest && stats == last {
                calm += 1;
                if calm == CALM {
                    return Ok(());
                }
            } else {
                calm = 0;
            }
            let state = format!("{stats:?}");
            last = stats;
            waiting = if !relief {
                "waiting for the relief map of the terrain".to_owned()
            } else if !person {
                format!("waiting for {} and soldiers", hero::MODEL)
            } else if pending.is_empty() {
                format!("terrain at {state}")
            } else {
                format!("waiting for pipelines {}", pending.join(", "))
            };
        }
        Err(OffscreenError::NotSettled(waiting))
    }

    /// Labels of pipelines that are not there yet.
    fn pending_pipelines(&self) -> Result<Vec<String>, OffscreenError> {
        let Some(cache) = self
            .app
            .get_sub_app(RenderApp)
            .and_then(|app| app.world().get_resource::<PipelineCache>())
        else {
            return Ok(vec!["all: there is no render app".to_owned()]);
        };
        let mut pending = Vec::new();
        for pipeline in cache.pipelines() {
            let name = || label(&pipeline.descriptor);
            match &pipeline.state {
                CachedPipelineState::Ok(_) => {}
                CachedPipelineState::Queued
                | CachedPipelineState::Creating(_)
                // Bevy tries these two again.
                | CachedPipelineState::Err(
                    ShaderCacheError::ShaderNotLoaded(_)
                    | ShaderCacheError::ShaderImportNotYetAvailable,
                ) => pending.push(name()),
                CachedPipelineState::Err(error) => {
                    return Err(OffscreenError::Pipeline {
                        name: name(),
                        reason: error.to_string(),
                    });
                }
            }
        }
        Ok(pending)
    }

    /// The picture of the next update, 8-bit sRGB without alpha.
    ///
    /// # Errors
    /// [`OffscreenError`] when rendering stopped or no picture came back.
    pub fn capture(&mut self) -> Result<image::RgbImage, OffscreenError> {
        self.app
            .world_mut()
            .spawn(Screenshot::image(self.target.clone()))
            .observe(
                |shot: On<ScreenshotCaptured>, mut captured: ResMut<Captured>| {
                    captured.0 = Some(shot.image.clone());
                },
            );
        // The copy is asked for in the first, mapped in the second, handed over in the third.
        for _ in 0..60 {
            self.step(Duration::ZERO)?;
            if let Some(picture) = self.app.world_mut().resource_mut::<Captured>().0.take() {
                return picture
                    .try_into_dynamic()
                    .map(|picture| picture.into_rgb8())
                    .map_err(|error| OffscreenError::Render(error.to_string()));
            }
        }
        Err(OffscreenError::NoPicture)
    }
}

/// Lets frames make as many blocks of ground as they may, where nobody waits for a frame but for what is settled. Returns
/// how many it was; nothing where no ground asks.
pub fn hurry(world: &mut World) -> Option<MakingBudget> {
    let mut making = world.get_resource_mut::<MakingBudget>()?;
    Some(std::mem::replace(
        &mut *making,
        MakingBudget {
            blocks: Some(u32::MAX),
        },
    ))
}

fn draws_itself(world: &World) -> bool {
    let scene = world.get_resource::<CurrentScene>();
    scene.is_some_and(|scene| scene.own.is_some())
}

/// Whether the relief map of the ground has come, where the scene has one.
pub fn has_relief(world: &mut World) -> bool {
    let mut with = world.query_filtered::<(), (With<Landscape>, With<TerrainRelief>)>();
    draws_itself(world) || with.iter(world).next().is_some()
}

/// Whether the figure looks as it will, where the scene has one.
pub fn has_person(world: &mut World) -> bool {
    draws_itself(world) || (hero::is_there(world) && soldiers::are_there(world))
}

fn check_size(size: UVec2, most: u32) -> Result<(), OffscreenError> {
    let allowed = 1..=most;
    if allowed.contains(&size.x) && allowed.contains(&size.y) {
        Ok(())
    } else {
        Err(OffscreenError::Size {
            width: size.x,
            height: size.y,
            most,
        })
    }
}

fn label(descriptor: &bevy::render::render_resource::PipelineDescriptor) -> String {
    use bevy::render::render_resource::PipelineDescriptor::{
        ComputePipelineDescriptor, RenderPipelineDescriptor,
    };
    match descriptor {
        RenderPipelineDescriptor(render) => render.label.as_deref(),
        ComputePipelineDescriptor(compute) => compute.label.as_deref(),
    }
    .unwrap_or("without a label")
    .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_of_zero_and_beyond_the_device_are_refused() {
        assert!(check_size(UVec2::new(1, 4096), 4096).is_ok());
        for size in [UVec2::new(0, 10), UVec2::new(10, 0), UVec2::new(4097, 10)] {
            let error = check_size(size, 4096).unwrap_err().to_string();
            assert!(error.contains("4096x4096"), "{error}");
        }
    }
}
