//! What has been made of what the first picture needs: for the start screen, and for the terminal where
//! there is none.

use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use bevy::prelude::*;
use bevy::render::render_resource::{CachedPipelineState, PipelineCache};
use bevy::render::{Render, RenderApp, RenderSystems};
use dolomite::tessellation::render::GeometryStats;

/// Who waits is told so after this, and then as often.
const FIRST: Duration = Duration::from_secs(1);
const AGAIN: Duration = Duration::from_secs(4);

/// What has been made; the same for both worlds.
#[derive(Resource, Clone, Default)]
pub struct Progress(Arc<Mutex<Made>>);

/// What has been made so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Made {
    /// The textures of the ground have been read; a scene that draws itself has none.
    pub textures: bool,
    /// Pipelines that can be used, and those that were asked for. More are asked for as more is drawn.
    pub shaders: (u32, u32),
    /// Triangles that the stage has made.
    pub triangles: u32,
}

impl Made {
    /// What is being done, in words.
    pub fn step(&self) -> String {
        let (ready, asked) = self.shaders;
        if !self.textures {
            "loading textures".to_owned()
        } else if asked == 0 {
            // Without a window they are compiled within the first frame.
            "compiling the first shaders".to_owned()
        } else if ready < asked || self.triangles == 0 {
            // The ground is built by shaders: without triangles some are still to be asked for.
            format!("compiling shaders, {ready} of {asked}")
        } else {
            format!("building the ground, {} triangles", self.triangles)
        }
    }

    /// Part of what is known to be needed that has been done, 0 to 1.
    pub fn part(&self) -> f32 {
        let (ready, asked) = self.shaders;
        let shaders = ready as f32 / asked.max(1) as f32;
        0.1 * f32::from(self.textures) + 0.8 * shaders + 0.1 * f32::from(self.triangles > 0)
    }

    /// Whether there is a picture to show.
    pub fn is_ready(&self) -> bool {
        let (ready, asked) = self.shaders;
        self.textures && self.triangles > 0 && ready == asked
    }
}

impl Progress {
    /// What has been made so far.
    pub fn made(&self) -> Made {
        // What was written before a panic is as true as before.
        *self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn change(&self, change: impl FnOnce(&mut Made)) {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }

    /// Says on standard error what is being done, from a thread of its own, until the answer is dropped: a
    /// single step may take longer than a reader waits.
    pub fn told(&self) -> Told {
        let (stop, stopped) = channel();
        let progress = self.clone();
        let began = Instant::now();
        let thread = std::thread::spawn(move || {
            let mut wait = FIRST;
            while stopped.recv_timeout(wait) == Err(RecvTimeoutError::Timeout) {
                let seconds = began.elapsed().as_secs();
                eprintln!("dolomite: {} ({seconds} s)", progress.made().step());
                wait = AGAIN;
            }
        });
        Told {
            stop: Some(stop),
            thread: Some(thread),
        }
    }
}

/// Ends the lines of [`Progress::told`] when it is dropped.
pub struct Told {
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Drop for Told {
    fn drop(&mut self) {
        self.stop = None;
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has nothing more to say.
            let _ = thread.join();
        }
    }
}

/// Keeps [`Progress`] up to date.
pub struct ProgressPlugin;

impl Plugin for ProgressPlugin {
    fn build(&self, app: &mut App) {
        let progress = Progress::default();
        app.insert_resource(progress.clone())
            .add_systems(Last, count_triangles);
        if let Some(render) = app.get_sub_app_mut(RenderApp) {
            render
                .insert_resource(progress)
                .add_systems(Render, count_pipelines.in_set(RenderSystems::Cleanup));
        }
    }
}

/// Textures have been read.
pub fn textures_are_there(progress: Res<Progress>) {
    progress.change(|made| made.textures = true);
}

fn count_triangles(progress: Res<Progress>, stats: Option<Res<GeometryStats>>) {
    let triangles = stats.map_or(0, |stats| stats.primitives);
    if progress.made().triangles != triangles {
        progress.change(|made| made.triangles = triangles);
    }
}

fn count_pipelines(progress: Res<Progress>, cache: Res<PipelineCache>) {
    let waits = |state: &CachedPipelineState| {
        use CachedPipelineState::{Creating, Queued};
        matches!(state, Queued | Creating(_))
    };
    let (mut asked, mut waiting) = (0, 0);
    for pipeline in cache.pipelines() {
        asked += 1;
        waiting += u32::from(waits(&pipeline.state));
    }
    progress.change(|made| made.shaders = (asked - waiting, asked));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_follow_what_has_been_made() {
        let mut made = Made::default();
        let mut parts = vec![made.part()];
        assert_eq!(made.step(), "loading textures");
        made.textures = true;
        parts.push(made.part());
        assert_eq!(made.step(), "compiling the first shaders");
        made.shaders = (3, 40);
        parts.push(made.part());
        assert_eq!(made.step(), "compiling shaders, 3 of 40");
        made.shaders = (40, 40);
        parts.push(made.part());
        assert!(!made.is_ready());
        made.triangles = 1200;
        parts.push(made.part());
        assert_eq!(made.step(), "building the ground, 1200 triangles");
        assert!(made.is_ready());
        // Another kind of thing appears: it is waited for too.
        made.shaders = (40, 41);
        assert!(!made.is_ready());
        assert!(parts.is_sorted() && parts[4] == 1.0, "{parts:?}");
    }
}
