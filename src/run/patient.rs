//! A window that answers while its first pictures are made.
//!
//! With Bevy's `PipelinedRenderingPlugin` a frame is rendered while the next is simulated, and at the end of
//! each the renderer is waited for, as long as it takes. A software device compiles the machine code of a
//! pass when the pass first runs; that takes many seconds, in which the window answers nobody. So while the
//! start screen is shown, and on a software device always, a frame begins only when the renderer is back: until
//! then the event loop goes on, no system runs, nothing is missed, and who wants to leave leaves at once.
//! Otherwise all is as Bevy has it.

use std::pin::Pin;
use std::sync::{Mutex, PoisonError};
use std::task::{Context, Poll};
use std::time::{Duration, Instant};

use bevy::app::{Main, SubApp};
use bevy::ecs::message::MessageCursor;
use bevy::ecs::schedule::{MainThreadExecutor, ScheduleLabel, SingleThreadedExecutor};
use bevy::input::ButtonState;
use bevy::input::keyboard::KeyboardInput;
use bevy::prelude::*;
use bevy::render::pipelined_rendering::{RenderAppChannels, RenderExtractApp};
use bevy::tasks::{ComputeTaskPool, futures_lite::future};
use bevy::window::WindowCloseRequested;
use bevy::winit::WINIT_WINDOWS;
use dolomite::inspector::Inspector;

use super::ended::end;
use crate::view::start::Starting;

/// How long the renderer is waited for before the event loop has its turn.
const WAIT: Duration = Duration::from_millis(50);

/// Keeps the window answering while [`Starting`] is in the world. Add after Bevy's plugins.
pub struct PatientRenderingPlugin {
    /// Afterwards too: for devices on which frames take long, and which leave no core to the next frame's
    /// simulation.
    pub always: bool,
}

/// In the world where every frame is waited for so.
#[derive(Resource)]
struct Always;

/// What [`App::update`] runs in place of [`Main`].
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct PatientMain;

/// The renderer, between its return and the next extraction.
#[derive(Resource, Default)]
struct Returned(Mutex<Option<SubApp>>);

/// Keys that systems had a chance to see: what those mean is theirs.
#[derive(Resource, Default)]
struct SeenKeys(MessageCursor<KeyboardInput>);

impl Returned {
    fn put(&self, renderer: SubApp) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(renderer);
    }

    fn take(&self) -> Option<SubApp> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

impl Plugin for PatientRenderingPlugin {
    fn build(&self, app: &mut App) {
        // Without it the renderer runs on this thread, and nothing can be waited for.
        let Some(extraction) = app.get_sub_app_mut(RenderExtractApp) else {
            return;
        };
        extraction.set_extract(|world, _| extract(world));
        app.init_resource::<Returned>()
            .init_resource::<SeenKeys>()
            .add_systems(PatientMain, frame)
            // As Bevy's `Main`: what waits for the renderer here is then in no scope of an executor's.
            .edit_schedule(PatientMain, |schedule| {
                schedule.set_executor(SingleThreadedExecutor::new());
            });
        if self.always {
            app.insert_resource(Always);
        }
        app.main_mut().update_schedule = Some(PatientMain.intern());
    }
}

fn is_patient(world: &World) -> bool {
    world.contains_resource::<Starting>() || world.contains_resource::<Always>()
}

/// A frame, where one can begin.
fn frame(world: &mut World) {
    if is_patient(world) {
        leave_if_asked(world);
        match receive(world, Some(WAIT)) {
            Received::Renderer(renderer) => world.resource::<Returned>().put(*renderer),
            Received::Nothing => return,
            Received::Gone => {
                world.write_message(AppExit::error());
                return;
            }
        }
    }
    world.run_schedule(Main);
    world.resource_scope(|world, mut seen: Mut<SeenKeys>| {
        if let Some(keys) = world.get_resource::<Messages<KeyboardInput>>() {
            seen.0.clear(keys);
        }
    });
}

/// Hands the frame to the renderer, which is there already or waited for.
fn extract(world: &mut World) {
    let returned = world.resource::<Returned>().take();
    let mut renderer = match returned {
        Some(renderer) => renderer,
        // The frame was put off.
        None if is_patient(world) => return,
        None => match receive(world, None) {
            Received::Renderer(renderer) => *renderer,
            Received::Nothing | Received::Gone => {
                world.write_message(AppExit::error());
                return;
            }
        },
    };
    renderer.extract(world);
    world
        .resource_mut::<RenderAppChannels>()
        .send_blocking(renderer);
}

enum Received {
    Renderer(Box<SubApp>),
    /// Not yet.
    Nothing,
    /// Its thread has ended.
    Gone,
}

/// Waits for the renderer, for `most` at most.
fn receive(world: &mut World, most: Option<Duration>) -> Received {
    world.resource_scope(|world, executor: Mut<MainThreadExecutor>| {
        let mut channels = world.resource_mut::<RenderAppChannels>();
        let wait = async {
            let received = async {
                match channels.recv().await {
                    Some(renderer) => Received::Renderer(Box::new(renderer)),
                    None => Received::Gone,
                }
            };
            match most {
                None => received.await,
                Some(most) => future::or(received, Alarm::after(most)).await,
            }
        };
        // The renderer may have work meanwhile that only this thread can do. Where the event loop is to have its
        // turn, that is all this thread helps with: a system of the renderer that any thread may run can wait for
        // the device, as the one does that acquires the window's next picture, and taken up here it would keep the
        // event loop waiting for as long as a pass is compiled. For the same reason `wait` is polled here and not
        // by a worker, who may be the one that waits for the device.
        let helps = most.is_none();
        ComputeTaskPool::get()
            .scope_with_executor(helps, Some(&*executor.0), |scope| {
                scope.spawn_on_scope(wait)
            })
            .pop()
            .unwrap_or(Received::Gone)
    })
}

/// Becomes [`Received::Nothing`] after a while.
struct Alarm {
    at: Instant,
    set: bool,
}

impl Alarm {
    fn after(wait: Duration) -> Self {
        Self {
            at: Instant::now() + wait,
            set: false,
        }
    }
}

impl Future for Alarm {
    type Output = Received;

    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Received> {
        let left = self.at.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Poll::Ready(Received::Nothing);
        }
        if !self.set {
            self.set = true;
            let waker = context.waker().clone();
            std::thread::spawn(move || {
                std::thread::sleep(left);
                waker.wake();
            });
        }
        Poll::Pending
    }
}

/// Ends the program where the player has asked for it: the renderer cannot be asked to stop within a frame. An Escape that
/// is to close the inspector asks for nothing else.
fn leave_if_asked(world: &World) {
    let keys = world.get_resource::<Messages<KeyboardInput>>();
    let inspected = world.get_resource::<Inspector>();
    let escape = !inspected.is_some_and(|inspector| inspector.is_open())
        && keys.is_some_and(|keys| {
            let mut new = world.resource::<SeenKeys>().0.clone();
            new.read(keys)
                .any(|key| key.key_code == KeyCode::Escape && key.state == ButtonState::Pressed)
        });
    let closed = world.get_resource::<Messages<WindowCloseRequested>>();
    let closed = closed.is_some_and(|closed| !closed.is_empty());
    if escape || closed {
        hide_windows();
        end(0);
    }
}

/// Takes the windows off the display before the process ends. Its memory, most of a gigabyte, is freed by the last of its threads
/// to go; where that is the one by which software Vulkan keeps compiled shaders, which runs when no other program wants to,
/// busy cores take more than a second for it, and what is still open stands there all the while.
fn hide_windows() {
    WINIT_WINDOWS.with_borrow(|all| {
        for window in all.windows.values() {
            window.set_visible(false);
        }
    });
}
