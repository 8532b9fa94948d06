//! Sees in the renderer which frame shows the scene first, and from which on it is settled.
//!
//! Whether a frame draws all that it should is known in the renderer alone: a pass whose pipeline is not compiled yet
//! draws nothing. So what was ready is noted before a frame is recorded, and the time is taken when the device has
//! finished it; frames between are not waited for.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use bevy::prelude::*;
use bevy::render::render_resource::{CachedPipelineState, PipelineCache, PollType};
use bevy::render::renderer::{RenderDevice, RenderGraph, RenderGraphSystems};
use bevy::render::{Extract, ExtractSchedule, Render, RenderApp, RenderSystems};
use bevy::shader::ShaderCacheError;
use dolomite::geometry::render::Producers;
use dolomite::ground::render::GroundProgress;

use crate::run::offscreen::{has_person, has_relief};
use crate::settings::Settings;
use crate::view::start::Starting;

/// Frames in a row that have to be settled: what the GPU has counted comes two or three frames late.
const CALM: u32 = 5;

/// A frame that the device has finished.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// When it had.
    pub at: Instant,
    /// Which frame, from 1.
    pub frame: u32,
}

/// What has been seen.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// The first frame that shows the scene.
    pub first: Option<Moment>,
    /// The first of the settled frames that nothing but settled ones followed.
    pub settled: Option<Moment>,
    /// The first of those in which everything else is there too.
    pub whole: Option<Moment>,
    /// The bound that was asked for, pixels.
    pub asked: Option<f32>,
    /// The bound that is kept, pixels.
    pub held: Option<f32>,
    /// The longest time from when a frame was handed to the device to when the next one was, since the first picture.
    pub longest: Duration,
    /// Why it will never be whole.
    pub fault: Option<String>,
    /// Frames so far.
    frames: u32,
    /// End of the last frame.
    last: Option<Instant>,
}

impl Seen {
    /// Whether there is nothing more to see.
    pub fn is_done(&self) -> bool {
        let calm = self
            .whole
            .is_some_and(|whole| self.frames >= whole.frame + CALM);
        calm || self.fault.is_some()
    }

    /// Takes a frame in. `now` waits for the device, and is asked for at what is new alone.
    fn frame(&mut self, is: &Is, ended: Instant, now: impl Fn() -> Instant) {
        self.frames += 1;
        if let (Some(_), Some(last)) = (self.first, self.last) {
            self.longest = self.longest.max(ended.saturating_duration_since(last));
        }
        self.last = Some(ended);
        if is.shown && self.first.is_none() {
            self.first = Some(self.moment(now()));
        }
        let settled = is.shown && is.settled;
        if !settled {
            (self.settled, self.whole) = (None, None);
            return;
        }
        if self.settled.is_none() {
            self.settled = Some(self.moment(now()));
        }
        if !is.whole {
            self.whole = None;
        } else if self.whole.is_none() {
            self.whole = Some(self.moment(now()));
        }
        self.held = is.held;
    }

    const fn moment(&self, at: Instant) -> Moment {
        Moment {
            at,
            frame: self.frames,
        }
    }
}

/// What a frame is.
#[derive(Clone, Copy, Debug)]
struct Is {
    shown: bool,
    settled: bool,
    whole: bool,
    held: Option<f32>,
}

/// What has been seen so far; the same in both worlds.
#[derive(Resource, Clone, Default)]
pub struct Stopwatch(Arc<Mutex<Seen>>);

impl Stopwatch {
    /// What has been seen so far.
    pub fn seen(&self) -> Seen {
        self.with(|seen| seen.clone())
    }

    fn with<T>(&self, f: impl FnOnce(&mut Seen) -> T) -> T {
        // What was written before a panic is as true as before.
        f(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// What the renderer has to know of the main world.
#[derive(Resource, Clone, Copy, Debug, Default)]
struct Main {
    /// The start screen covers the scene.
    covered: bool,
    /// Relief map and figure are there.
    whole: bool,
    /// What was asked for, pixels.
    asked: Option<f32>,
}

/// Whether all pipelines were there when the frame was recorded.
#[derive(Resource, Default)]
struct Ready(bool);

/// Lets a stopwatch see the frames of an app that has all its plugins.
pub fn add(app: &mut App) -> Stopwatch {
    let watch = Stopwatch::default();
    app.insert_resource(watch.clone())
        .init_resource::<Main>()
        .add_systems(Last, look);
    if let Some(render) = renderer(app) {
        render
            .insert_resource(watch.clone())
            .init_resource::<Ready>()
            .init_resource::<Main>()
            .add_systems(ExtractSchedule, extract)
            .add_systems(RenderGraph, note_ready.in_set(RenderGraphSystems::Begin))
            .add_systems(Render, tick.in_set(RenderSystems::PostCleanup));
    }
    watch
}

/// The renderer, where it has not been sent to its thread yet.
fn renderer(app: &mut App) -> Option<&mut bevy::app::SubApp> {
    app.get_sub_app_mut(RenderApp)
}

fn look(world: &mut World) {
    let whole = has_relief(world) && has_person(world);
    let settings = world.resource::<Settings>();
    let main = Main {
        covered: world.contains_resource::<Starting>(),
        whole,
        // A budget asks for what it comes to.
        asked: settings.max_error.filter(|_| settings.budget.is_none()),
    };
    world.insert_resource(main);
}

fn extract(mut known: ResMut<Main>, main: Extract<Res<Main>>) {
    *known = **main;
}

/// Before a frame is recorded: whether every pipeline can be used.
fn note_ready(cache: Res<PipelineCache>, watch: Res<Stopwatch>, mut ready: ResMut<Ready>) {
    let mut all = true;
    for pipeline in cache.pipelines() {
        match &pipeline.state {
            CachedPipelineState::Ok(_) => {}
            CachedPipelineState::Queued
            | CachedPipelineState::Creating(_)
            // Bevy tries these two again.
            | CachedPipelineState::Err(
                ShaderCacheError::ShaderNotLoaded(_)
                | ShaderCacheError::ShaderImportNotYetAvailable,
            ) => all = false,
            CachedPipelineState::Err(error) => {
                all = false;
                watch.with(|seen| {
                    seen.fault.get_or_insert_with(|| format!("a render pipeline failed: {error}"));
                });
            }
        }
    }
    ready.0 = all;
}

/// Behind a frame.
fn tick(
    watch: Res<Stopwatch>,
    main: Res<Main>,
    ready: Res<Ready>,
    producers: Option<Res<Producers>>,
    ground: Option<Res<GroundProgress>>,
    device: Res<RenderDevice>,
) {
    let Some(producers) = producers else {
        return;
    };
    // Of scenes without a ground, the classic one in some of its modes, the producers know.
    let ground = ground.and_then(|ground| ground.all());
    let mut views = producers
        .iter()
        .flat_map(|producer| producer.views.values());
    let anything = producers
        .iter()
        .any(|producer| producer.views.values().any(|view| view.is_shown()));
    let is = Is {
        shown: ready.0 && !main.covered && anything && ground.is_none_or(|ground| ground.drawn),
        settled: views.all(|view| view.settled) && ground.is_none_or(|ground| ground.settled),
        whole: main.whole,
        held: ground.and_then(|ground| ground.held),
    };
    let ended = Instant::now();
    let now = || {
        // A device that is lost is told of by whoever draws next.
        let _ = device.poll(PollType::wait_indefinitely());
        Instant::now()
    };
    watch.with(|seen| {
        seen.asked = main.asked.filter(|_| ground.is_some());
        seen.frame(&is, ended, now);
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(of: &[(bool, bool, bool)]) -> Seen {
        let mut seen = Seen::default();
        let start = Instant::now();
        for (index, &(shown, settled, whole)) in of.iter().enumerate() {
            let at = start + Duration::from_secs(index as u64);
            let is = Is {
                shown,
                settled,
                whole,
                held: Some(index as f32),
            };
            seen.frame(&is, at, || at);
        }
        seen
    }

    #[test]
    fn a_frame_is_settled_that_only_settled_ones_follow() {
        let (no, yes) = (false, true);
        let unseen = frames(&[(no, yes, yes), (no, no, no)]);
        assert!(unseen.first.is_none() && unseen.settled.is_none() && !unseen.is_done());
        let mut all = vec![
            (no, no, no),
            (yes, no, no),
            // Settled, and then not.
            (yes, yes, no),
            (yes, no, no),
            (yes, yes, no),
            (yes, yes, yes),
        ];
        let early = frames(&all);
        let number = |moment: Option<Moment>| moment.map(|moment| moment.frame);
        assert_eq!(number(early.first), Some(2));
        assert_eq!(number(early.settled), Some(5));
        assert_eq!(number(early.whole), Some(6));
        assert_eq!(early.longest, Duration::from_secs(1));
        assert!(!early.is_done(), "not calm yet");
        all.extend([(yes, yes, yes); CALM as usize]);
        assert!(frames(&all).is_done());
    }
}
