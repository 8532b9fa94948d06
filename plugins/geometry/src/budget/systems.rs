//! Budgets of cameras: where times arrive, and the system that decides.

use bevy::diagnostic::{DiagnosticPath, DiagnosticsStore};
use bevy::prelude::*;
use bevy::time::Real;

use super::controller::{BudgetController, NextFrame, TimeSample};
use super::settings::{Budget, BudgetReport};
use super::work_curve::WorkCurve;

/// A camera that moved farther than this in one frame was put elsewhere, metres: an aircraft at the
/// speed of sound makes 12 m in a frame of a slow display (30 Hz).
const CUT_METRES: f32 = 25.0;
/// Cosine of the turn in one frame that counts as a cut: 40 degrees, 1200 degrees a second at 30 Hz.
const CUT_TURN: f32 = 0.766;

/// Keeps every [`Budget`]: decides the tolerance of each frame in `PostUpdate`, after transforms are
/// propagated. Without a budget in the world it does nothing.
///
/// A frame goes: who selects detail puts the view's [`ViewWork`] on the camera; [`BudgetSystems`] decide; who
/// owns the tolerance takes [`BudgetReport::tau`] over after them. May be added any number of times.
#[derive(Clone, Copy, Debug, Default)]
pub struct BudgetPlugin;

/// The set in which tolerances are decided (schedule `PostUpdate`).
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BudgetSystems;

/// Marks an app that has the systems.
#[derive(Resource)]
struct Added;

impl Plugin for BudgetPlugin {
    fn build(&self, app: &mut App) {
        if app.world().contains_resource::<Added>() {
            return;
        }
        app.insert_resource(Added)
            .register_type::<Budget>()
            .register_type::<BudgetReport>()
            .add_systems(
                PostUpdate,
                (gather_times, decide)
                    .chain()
                    .run_if(any_with_component::<Budget>)
                    .in_set(BudgetSystems)
                    .after(bevy::transform::TransformSystems::Propagate),
            )
            .add_observer(forget);
    }

    fn is_unique(&self) -> bool {
        false
    }
}

/// A camera without its budget has nothing to report, and begins anew when it gets one again.
fn forget(removed: On<Remove, Budget>, mut commands: Commands) {
    commands
        .entity(removed.entity)
        .try_remove::<(Controlled, BudgetReport, TimeSamples)>();
}

/// Where a camera's time is measured.
#[derive(Component, Clone, Debug, Default, PartialEq)]
pub enum FrameTime {
    /// By whoever pushes it into the camera's [`TimeSamples`], with the frame that it is of.
    #[default]
    Given,
    /// The sum of the newest values of diagnostics in milliseconds, as Bevy's render diagnostics publish
    /// the spans of GPU passes (`render/<span>/elapsed_gpu`). Counts when one of them is new and none
    /// is missing.
    Diagnostics {
        /// Which are added up.
        paths: Vec<DiagnosticPath>,
        /// Frames between a frame's decision and the moment when its time is known. Diagnostics carry no number;
        /// 3 is the most that Bevy's take. Rather one too many: a time taken for one of an older view is
        /// passed over, one taken for one of a newer view misleads.
        lag: u32,
    },
    /// Wall time from frame to frame. With a display that waits for its refresh it is never below the
    /// refresh, whatever is drawn.
    Wall {
        /// As above; 1 where the CPU is the slower one.
        lag: u32,
    },
}

impl FrameTime {
    /// The sum of the GPU's times of render passes, by the names of their spans. Needs Bevy's
    /// `RenderDiagnosticsPlugin`.
    #[must_use]
    pub fn of_passes(spans: &[&str]) -> Self {
        let path = |span: &&str| DiagnosticPath::new(format!("render/{span}/elapsed_gpu"));
        Self::Diagnostics {
            paths: spans.iter().map(path).collect(),
            lag: 3,
        }
    }
}

/// Measured frames that have not been taken in. In the order of frames; emptied every frame.
#[derive(Component, Clone, Debug, Default, PartialEq)]
pub struct TimeSamples(Vec<TimeSample>);

impl TimeSamples {
    /// Most that wait.
    const MOST: usize = 64;

    /// Adds a measured frame; its number is [`BudgetReport::frame`] as it stood when it was drawn. What
    /// is over 64 in a frame is dropped.
    pub fn push(&mut self, sample: TimeSample) {
        if self.0.len() < Self::MOST {
            self.0.push(sample);
        }
    }
}

/// What the camera's view of this frame asks for; who selects detail writes it. Without it, work is
/// taken as 1/τ.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct ViewWork(pub Option<WorkCurve>);

/// The controller of a camera, made when its budget is first seen.
#[derive(Component, Clone, Debug)]
struct Controlled {
    controller: BudgetController,
    frame: u64,
    pose: GlobalTransform,
}

/// Turns what [`FrameTime`] names into samples.
fn gather_times(
    diagnostics: Option<Res<DiagnosticsStore>>,
    time: Option<Res<Time<Real>>>,
    mut cameras: Query<(Entity, &FrameTime, &BudgetReport, &mut TimeSamples)>,
    mut newest: Local<bevy::platform::collections::HashMap<Entity, bevy::platform::time::Instant>>,
) {
    for (camera, source, report, mut samples) in &mut cameras {
        let (milliseconds, lag) = match source {
            FrameTime::Given => continue,
            FrameTime::Wall { lag } => {
                let Some(time) = &time else { continue };
                (time.delta_secs_f64() * 1e3, *lag)
            }
            FrameTime::Diagnostics { paths, lag } => {
                let Some(store) = &diagnostics else { continue };
                let Some((sum, when)) = newest_sum(store, paths) else {
                    continue;
                };
                if newest.insert(camera, when) == Some(when) {
                    continue;
                }
                (sum, *lag)
            }
        };
        // The report is still the last frame's: a lag of 1 is the frame just past.
        let Some(frame) = (report.frame + 1).checked_sub(u64::from(lag.max(1))) else {
            continue;
        };
        samples.push(TimeSample {
            milliseconds: milliseconds as f32,
            // The frame's own is remembered.
            tau: f32::NAN,
            triangles: None,
            frame,
        });
    }
    newest.retain(|camera, _| cameras.contains(*camera));
}

/// Sum of the newest values, and when the newest of them came; `None` if one is missing.
fn newest_sum(
    store: &DiagnosticsStore,
    paths: &[DiagnosticPath],
) -> Option<(f64, bevy::platform::time::Instant)> {
    let mut found: Option<(f64, bevy::platform::time::Instant)> = None;
    for path in paths {
        let next = store.get_measurement(path)?;
        let (sum, when) = found.unwrap_or((0.0, next.time));
        found = Some((sum + next.value, when.max(next.time)));
    }
    found
}

/// Decides this frame's tolerance of every camera with a budget.
fn decide(
    mut commands: Commands,
    mut cameras: Query<(
        Entity,
        &Budget,
        &GlobalTransform,
        Option<&ViewWork>,
        Option<&mut Controlled>,
        &mut TimeSamples,
        &mut BudgetReport,
    )>,
) {
    for (camera, budget, pose, curve, controlled, mut samples, mut report) in &mut cameras {
        let curve = curve.and_then(|curve| curve.0.as_ref());
        let mut new = None;
        let state = match controlled {
            Some(state) => state.into_inner(),
            None => match BudgetController::new(*budget) {
                Ok(controller) => new.insert(Controlled {
                    controller,
                    frame: 0,
                    pose: *pose,
                }),
                Err(fault) => {
                    report.fault = Some(fault);
                    continue;
                }
            },
        };
        let fault = state.controller.set_budget(*budget).err();
        for sample in samples.0.drain(..) {
            state.controller.observe(&sample);
        }
        state.frame += 1;
        let next = NextFrame {
            number: state.frame,
            curve,
            cut: is_cut(&state.pose, pose),
        };
        state.pose = *pose;
        // A faulty budget leaves the tolerance where it was, and the last good one stays in force.
        if fault.is_none() {
            state.controller.decide(&next);
        }
        let said = BudgetReport {
            fault,
            ..state.controller.report()
        };
        report.set_if_neq(said);
        if let Some(new) = new {
            commands.entity(camera).insert(new);
        }
    }
}

/// Whether a camera was put elsewhere between two frames. Poses that are not finite are no cut.
fn is_cut(before: &GlobalTransform, now: &GlobalTransform) -> bool {
    let moved = before.translation().distance(now.translation());
    let turned = before.forward().dot(*now.forward());
    moved > CUT_METRES || turned < CUT_TURN
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::MinimalPlugins;
    use bevy::diagnostic::{Diagnostic, DiagnosticMeasurement};

    const SPAN: DiagnosticPath = DiagnosticPath::const_new("render/ground/elapsed_gpu");

    fn app(budget: Budget, source: FrameTime) -> (App, Entity) {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, BudgetPlugin))
            .init_resource::<DiagnosticsStore>();
        let camera = app
            .world_mut()
            .spawn((
                budget,
                source,
                Transform::default(),
                GlobalTransform::default(),
            ))
            .id();
        (app, camera)
    }

    fn report(app: &App, camera: Entity) -> BudgetReport {
        *app.world().get::<BudgetReport>(camera).unwrap()
    }

    /// What a frame of the tests takes: 1 ms and 4 ms a pixel's inverse.
    fn time(tau: f32) -> f32 {
        1.0 + 4.0 / tau
    }

    #[test]
    fn a_camera_comes_to_its_budget_by_given_times() {
        let (mut app, camera) = app(Budget::default(), FrameTime::Given);
        let mut drawn: Vec<BudgetReport> = Vec::new();
        for _ in 0..200 {
            app.update();
            drawn.push(report(&app, camera));
            if let Some(past) = drawn.len().checked_sub(3).map(|i| drawn[i]) {
                let mut samples = app.world_mut().get_mut::<TimeSamples>(camera).unwrap();
                samples.push(TimeSample {
                    milliseconds: time(past.tau),
                    tau: past.tau,
                    triangles: None,
                    frame: past.frame,
                });
            }
        }
        let end = report(&app, camera);
        assert!(end.held, "{end:?}");
        // Without noise the aim is below the budget by the least noise assumed and the rest band.
        let reached = time(end.tau) / 4.0;
        assert!((0.93..=1.0).contains(&reached), "{reached}");
    }

    #[test]
    fn a_camera_comes_to_its_budget_by_diagnostics() {
        let source = FrameTime::Diagnostics {
            paths: vec![SPAN],
            lag: 3,
        };
        let (mut app, camera) = app(Budget::default(), source);
        app.update();
        assert!(!report(&app, camera).held, "nothing was measured yet");
        app.world_mut()
            .resource_mut::<DiagnosticsStore>()
            .add(Diagnostic::new(SPAN));
        let mut taus = vec![report(&app, camera).tau];
        for _ in 0..200 {
            let tau = taus[taus.len().saturating_sub(3)];
            app.world_mut()
                .resource_mut::<DiagnosticsStore>()
                .get_mut(&SPAN)
                .unwrap()
                .add_measurement(DiagnosticMeasurement {
                    time: bevy::platform::time::Instant::now(),
                    value: f64::from(time(tau)),
                });
            app.update();
            taus.push(report(&app, camera).tau);
        }
        let reached = time(report(&app, camera).tau) / 4.0;
        assert!((0.93..=1.0).contains(&reached), "{reached}");
    }

    #[test]
    fn a_faulty_budget_is_reported_and_the_last_good_one_stays() {
        let wrong = Budget {
            milliseconds: f32::NAN,
            ..Budget::default()
        };
        let (mut app, camera) = app(wrong, FrameTime::Given);
        app.update();
        assert!(report(&app, camera).fault.is_some());
        assert_eq!(report(&app, camera).tau, 0.0);
        app.world_mut().entity_mut(camera).insert(Budget::default());
        app.update();
        let good = report(&app, camera);
        assert_eq!((good.fault, good.tau), (None, Budget::default().greatest));
        app.world_mut().entity_mut(camera).insert(wrong);
        app.update();
        let after = report(&app, camera);
        assert!(after.fault.is_some());
        assert_eq!(after.tau, good.tau);
    }

    #[test]
    fn who_loses_the_budget_begins_anew_with_the_next() {
        let (mut app, camera) = app(Budget::default(), FrameTime::Given);
        for _ in 0..5 {
            app.update();
        }
        assert_eq!(report(&app, camera).frame, 5);
        app.world_mut().entity_mut(camera).remove::<Budget>();
        app.update();
        let left = app.world().entity(camera);
        assert!(!left.contains::<BudgetReport>() && !left.contains::<Controlled>());
        app.world_mut().entity_mut(camera).insert(Budget::default());
        app.update();
        assert_eq!(report(&app, camera).frame, 1);
        // A camera that goes takes everything along.
        app.world_mut().despawn(camera);
        app.update();
    }

    #[test]
    fn a_camera_that_is_put_elsewhere_is_cut() {
        let at = |x: f32, yaw: f32| {
            GlobalTransform::from(
                Transform::from_xyz(x, 0.0, 0.0).with_rotation(Quat::from_rotation_y(yaw)),
            )
        };
        assert!(!is_cut(&at(0.0, 0.0), &at(12.0, 0.3)));
        assert!(is_cut(&at(0.0, 0.0), &at(500.0, 0.0)));
        assert!(is_cut(&at(0.0, 0.0), &at(0.0, 1.5)));
        assert!(!is_cut(&at(f32::NAN, 0.0), &at(0.0, 0.0)));
    }
}
