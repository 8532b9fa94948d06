//! A level without a window, stepped by hand: one step of the level in each update, so that the input of a step is
//! all that a game consists of.

use bevy::app::{TaskPoolOptions, TaskPoolPlugin};
use bevy::ecs::schedule::{Schedules, SingleThreadedExecutor};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use dolomite::DolomiteMinimalPlugins;
use dolomite::logic::state_hash;

use crate::input::PlayerInput;
use crate::level::parts::LevelState;
use crate::level::{Level, LevelPlugin};
use crate::play::figure::Figure;
use crate::play::{SimulationPlugin, Switches};
use crate::scene::{CurrentScene, LoadedScene, SceneRequest};
use crate::settings::paths::AssetsDir;

/// Steps between two looks at the whole state for the hash.
const LOOKS: u64 = 60;

/// A level that is being played.
pub struct Game {
    /// Its app.
    pub app: App,
    hash: u64,
}

impl Game {
    /// At the beginning. With `threads`, systems run on so many; this counts for the first game of a process, whose
    /// threads are kept. Without, systems run one after the other. The game is the same.
    pub fn new(level: &Level, scene: &LoadedScene, threads: Option<usize>) -> Self {
        let options = threads.map_or_else(TaskPoolOptions::default, |threads| {
            TaskPoolOptions::with_num_threads(threads)
        });
        let pools = TaskPoolPlugin {
            task_pool_options: options,
        };
        let mut app = App::new();
        app.add_plugins((
            MinimalPlugins.set(pools),
            TransformPlugin,
            DolomiteMinimalPlugins,
        ))
        .insert_resource(AssetsDir(std::path::PathBuf::new()))
        .insert_resource(SceneRequest::new(level.file.scene.clone()))
        .insert_resource(CurrentScene(scene.clone()))
        .insert_resource(level.clone())
        .insert_resource(Switches {
            follow: true,
            ..default()
        })
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
        .add_plugins((SimulationPlugin, LevelPlugin));
        app.finish();
        app.cleanup();
        if threads.is_none() {
            // Systems of a level take some microseconds: handing them to other threads takes longer.
            let mut schedules = app.world_mut().resource_mut::<Schedules>();
            for (_, schedule) in schedules.iter_mut() {
                schedule.set_executor(SingleThreadedExecutor::new());
            }
        }
        // The first update has no time; everything is put up in it.
        app.update();
        Self { app, hash: 0 }
    }

    /// One step with this input. Nothing happens any more once the level has ended.
    pub fn step(&mut self, input: PlayerInput) {
        *self.app.world_mut().resource_mut::<PlayerInput>() = input;
        self.app.update();
        let state = self.state();
        if state.steps.is_multiple_of(LOOKS) || state.verdict.is_some() {
            self.look();
        }
    }

    /// What it has come to.
    pub fn state(&self) -> LevelState {
        *self.app.world().resource::<LevelState>()
    }

    /// A number of all that happened so far: two games with the same one were the same.
    pub const fn hash(&self) -> u64 {
        self.hash
    }

    fn look(&mut self) {
        let world = self.app.world_mut();
        let mut words = vec![state_hash(world)];
        for figure in world.query::<&Figure>().iter(world) {
            let now = figure.now;
            words.extend([now.place.x.to_bits(), now.place.y.to_bits()]);
            words.push(u64::from(now.yaw.to_bits()));
            words.push(now.jump.lift().to_bits());
        }
        for word in words {
            // FNV-1a over 64-bit words, with the high bits brought down.
            self.hash = (self.hash ^ word).wrapping_mul(0x0100_0000_01b3);
            self.hash ^= self.hash >> 29;
        }
    }
}
