//! From the start of the process to the first picture, to the settled one, and to the whole one.
//!
//! | file | concern |
//! |---|---|
//! | [`mod@stopwatch`] | sees in the renderer which frame is the first, and which is settled |

pub mod stopwatch;

use std::fmt;
use std::path::Path;
use std::time::Duration;

use bevy::app::AppExit;
use bevy::prelude::*;
use serde::Serialize;

use super::{BenchError, check_file, tell};
use crate::run::began::{self, Clock};
use crate::run::device::Device;
use crate::run::offscreen::{Offscreen, hurry};
use crate::run::{Setup, window};
use crate::view::progress::Progress;
use stopwatch::{Moment, Seen, Stopwatch};

/// Updates after which a start without a window has failed: as many as a view is given to settle.
const MOST_UPDATES: u32 = 2000;

/// A start, measured. Times are seconds since the process began.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StartReport {
    /// Scene.
    pub scene: String,
    /// `start`, as the path is called.
    pub path: &'static str,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Whether it was in a window.
    pub window: bool,
    /// Device that drew.
    pub device: String,
    /// Build of this program: `release` or `debug`.
    pub build: &'static str,
    /// What knows when the process began.
    pub clock: Clock,
    /// The first frame that shows the scene, its ground in it: all that it draws was compiled, nothing covers it, and
    /// the device has finished it.
    pub first_s: f64,
    /// Number of that frame, from 1.
    pub first_frame: u32,
    /// The first frame from which on the ground keeps the bound that was asked for, as far as it can, and nothing of
    /// it is still being made.
    pub settled_s: f64,
    /// Number of that frame.
    pub settled_frame: u32,
    /// The first settled frame in which the relief map of the far ground and the figure are there as well: nothing
    /// of a view at rest changes any more.
    pub whole_s: f64,
    /// Number of that frame.
    pub whole_frame: u32,
    /// The bound that was asked for, pixels; absent where the scene has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub asked_px: Option<f32>,
    /// The bound that the settled ground keeps, pixels; absent likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub held_px: Option<f32>,
    /// The longest time from when a frame was handed to the device to when the next one was, behind the first picture; seconds.
    pub longest_frame_s: f64,
}

impl StartReport {
    fn new(
        scene: String,
        size: UVec2,
        window: bool,
        device: &Device,
        seen: &Seen,
    ) -> Result<Self, BenchError> {
        let began = began::began();
        if let Some(fault) = &seen.fault {
            return Err(BenchError::NotStarted(fault.clone()));
        }
        let moment = |moment: Option<Moment>, what: &str| {
            let moment = moment.ok_or_else(|| BenchError::NotStarted(format!("no {what}")))?;
            let seconds = moment.at.saturating_duration_since(began.at).as_secs_f64();
            Ok::<_, BenchError>((seconds, moment.frame))
        };
        let (first_s, first_frame) = moment(seen.first, "picture")?;
        let (settled_s, settled_frame) = moment(seen.settled, "settled picture")?;
        let (whole_s, whole_frame) = moment(seen.whole, "whole picture")?;
        Ok(Self {
            scene,
            path: "start",
            size: size.to_array(),
            window,
            device: device.name.clone(),
            build: super::build(),
            clock: began.by,
            first_s,
            first_frame,
            settled_s,
            settled_frame,
            whole_s,
            whole_frame,
            asked_px: seen.asked,
            held_px: seen.held,
            longest_frame_s: seen.longest.as_secs_f64(),
        })
    }
}

impl fmt::Display for StartReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            scene,
            size: [width, height],
            ..
        } = self;
        let place = if self.window {
            "in a window"
        } else {
            "without a window"
        };
        write!(
            f,
            "{scene}, {width}x{height} {place}: first picture after {:.2} s, settled after {:.2} s",
            self.first_s, self.settled_s,
        )?;
        if let (Some(held), Some(asked)) = (self.held_px, self.asked_px) {
            write!(f, " ({held:.2} px kept, {asked:.2} asked)")?;
        }
        write!(
            f,
            ", whole after {:.2} s; longest frame {:.2} s; {}, {}",
            self.whole_s, self.longest_frame_s, self.device, self.build
        )
    }
}

/// Starts the game of `setup` with pictures of `size` pixels, in a window or without one, until its picture is whole,
/// and writes the report to `file`, or to standard output. Progress goes to standard error.
///
/// # Errors
/// [`BenchError`]: no device, no display, a wrong size, a pipeline that fails, a file that cannot be written.
pub fn start(
    setup: Setup,
    size: UVec2,
    window: bool,
    file: Option<&Path>,
) -> Result<StartReport, BenchError> {
    // Whoever has not noted it begins here.
    began::began();
    check_file(file)?;
    let report = if window {
        in_window(setup, size)?
    } else {
        without_window(setup, size, |_| {})?
    };
    tell(file, &report)?;
    Ok(report)
}

/// Starts without a window. `first` is called once, behind the first picture; what it takes counts.
///
/// # Errors
/// As [`start`].
pub fn without_window(
    setup: Setup,
    size: UVec2,
    first: impl FnOnce(&mut Offscreen),
) -> Result<StartReport, BenchError> {
    // Whoever has not noted it begins here.
    began::began();
    let scene = setup.scene.name.clone();
    let mut offscreen = Offscreen::new(setup, size)?;
    let watch = stopwatch::add(&mut offscreen.app);
    // What is waited for is the settled picture.
    hurry(offscreen.app.world_mut());
    let _told = offscreen.app.world().resource::<Progress>().told();
    let mut first = Some(first);
    for _ in 0..MOST_UPDATES {
        offscreen.step(Duration::ZERO)?;
        let seen = watch.seen();
        if seen.first.is_some()
            && let Some(first) = first.take()
        {
            first(&mut offscreen);
        }
        if seen.is_done() {
            break;
        }
    }
    StartReport::new(scene, size, false, &offscreen.device, &watch.seen())
}

fn in_window(setup: Setup, size: UVec2) -> Result<StartReport, BenchError> {
    let scene = setup.scene.name.clone();
    let (mut app, device) = window::app(setup)?;
    let watch = stopwatch::add(&mut app);
    app.add_systems(Last, leave);
    let _told = app.world().resource::<Progress>().told();
    app.run();
    StartReport::new(scene, size, true, &device, &watch.seen())
}

/// Ends the program when everything has been seen.
fn leave(watch: Res<Stopwatch>, mut exit: MessageWriter<AppExit>) {
    if watch.seen().is_done() {
        exit.write(AppExit::Success);
    }
}
