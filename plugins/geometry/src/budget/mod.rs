//! A time budget: an error tolerance follows a measured time, and holds it at so many milliseconds. Whose
//! tolerance it is does not matter.
//!
//! Conventions: τ (tau) is the error tolerance in pixels, greater is coarser and cheaper; times are
//! milliseconds; *work* is what a frame's geometry asks for, as a [`WorkCurve`] counts it.
//!
//! **The model.** A frame costs `fixed + each · work(τ)` milliseconds. The two numbers are estimated
//! from the frames that were measured, each with the work of its own frame, so that a measurement which
//! arrives three frames late says nothing wrong: it speaks of the frame that it was taken of
//! (`estimate`). The selection of detail is nested, so the work of the frame about to be drawn is known
//! for every τ before it is drawn; the controller looks up the τ whose time fits. There is no loop
//! through the delay, and with it no cause for oscillation. Without a curve, work is taken as 1/τ.
//!
//! **The aim.** Measured times scatter. The τ chosen is the one of which 99 frames in 100 are expected
//! within the budget: expected time + 2.33 standard deviations of noise and of the estimate = budget
//! (a chance constraint; Charnes and Cooper, 1959). The noise is measured too.
//!
//! **Rest.** τ stands while the time stays within [`BudgetController::REST`] of the aim, and moves by at
//! most [`BudgetController::SLOWEST`] a frame where it has to move a little; steps grow with the
//! distance, and beyond [`BudgetController::FAR`], after a cut or after a change of load it goes there
//! at once.
//!
//! | part | what it does |
//! |---|---|
//! | [`BudgetController`] | the decision, without an ECS |
//! | [`WorkCurve`] | vertices by tolerance, of one view |
//! | [`Budget`], [`BudgetReport`], [`BudgetPlugin`] | the same for cameras |
//!
//! ```
//! use bevy::prelude::*;
//! use dolomite_geometry::budget::{Budget, BudgetReport, FrameTime};
//!
//! #[derive(Component)]
//! struct Tolerance(f32);
//!
//! fn hold_four_milliseconds(mut commands: Commands, camera: Single<Entity, With<Tolerance>>) {
//!     let time = FrameTime::of_passes(&["my_pass", "geometry_gbuffer"]);
//!     commands.entity(*camera).insert((Budget::default(), time));
//! }
//!
//! // In `PostUpdate`, after `BudgetSystems`.
//! fn follow(mut cameras: Query<(&BudgetReport, &mut Tolerance)>) {
//!     for (report, mut tolerance) in &mut cameras {
//!         if report.tau > 0.0 {
//!             tolerance.0 = report.tau;
//!         }
//!     }
//! }
//! ```
//!
//! As long as nothing is measured there is no τ, and whoever owns a tolerance keeps it.
//!
//! The lab's study `budget` measures it beside other controllers.

mod controller;
mod cut;
mod estimate;
mod settings;
mod systems;
mod times;
mod work_curve;

pub use controller::{BudgetController, NextFrame};
pub use settings::{Budget, BudgetError, BudgetLimit, BudgetReport};
pub use systems::{BudgetPlugin, BudgetSystems, ViewWork};
pub use times::{FrameTime, TimeSample, TimeSamples};
pub use work_curve::{WorkCurve, WorkCurveError};
