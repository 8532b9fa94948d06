//! Budgets of cameras: the system that decides.

use bevy::diagnostic::DiagnosticsStore;
use bevy::prelude::*;
use bevy::time::Real;

use super::controller::{BudgetController, NextFrame};
use super::cut::is_cut;
use super::settings::{Budget, BudgetReport};
use super::times::{FrameTime, TimeSample, TimeSamples, newest_sum};
use super::work_curve::WorkCurve;

/// Frames that a budget may wait for its first time before it is missed: some seconds, in which pipelines are
/// compiled and passes do not run yet.
const PATIENCE: u32 = 240;

/// Keeps every [`Budget`]: decides the tolerance of each frame in `PostUpdate`, after transforms are
/// propagated. Without a budget in the world it does nothing.
///
/// A frame goes: [`BudgetSystems`] decide by the times that [`FrameTime`] names; who owns the tolerance takes
/// [`BudgetReport::tau`] over after them, where it is above 0. It is 0 until a time has come, so that a tolerance
/// that somebody set stays as long as nothing is measured; after some seconds a warning says what is missing.
/// [`ViewWork`] is written by producers that know what their view asks for at each tolerance: Dolomite's ground counts
/// it on the GPU. May be added any number of times.
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
            .register_type::<FrameTime>()
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

/// What the camera's view asks for at each tolerance, by who can count it, written before [`BudgetSystems`]: of this
/// frame, or of one some frames ago. Without it, work is taken as 1/τ.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct ViewWork(pub Option<WorkCurve>);

/// The controller of a camera, made when its budget is first seen.
#[derive(Component, Clone, Debug)]
struct Controlled {
    controller: BudgetController,
    frame: u64,
    pose: GlobalTransform,
    /// The first frame whose tolerance was said: that of earlier ones was somebody else's.
    since: Option<u64>,
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
        samples.sees(milliseconds as f32);
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

/// Decides this frame's tolerance of every camera with a budget.
fn decide(
    mut commands: Commands,
    diagnostics: Option<Res<DiagnosticsStore>>,
    mut cameras: Query<(
        Entity,
        &Budget,
        &FrameTime,
        &GlobalTransform,
        Option<&ViewWork>,
        Option<&mut Controlled>,
        &mut TimeSamples,
        &mut BudgetReport,
    )>,
) {
    for (camera, budget, source, pose, curve, controlled, mut samples, mut report) in &mut cameras {
        let curve = curve.and_then(|curve| curve.0.as_ref());
        let mut new = None;
        let state = match controlled {
            Some(state) => state.into_inner(),
            None => match BudgetController::new(*budget) {
                Ok(controller) => new.insert(Controlled {
                    controller,
                    frame: 0,
                    pose: *pose,
                    since: None,
                }),
                Err(fault) => {
                    report.fault = Some(fault);
                    continue;
                }
            },
        };
        let fault = state.controller.set_budget(*budget).err();
        state.frame += 1;
        if samples.has_come() {
            state.since = state.since.or(Some(state.frame));
        } else if state.frame == u64::from(PATIENCE) {
            miss(camera, source, diagnostics.as_deref());
        }
        for sample in samples.take() {
            if state.since.is_some_and(|since| sample.frame >= since) {
                state.controller.observe(&sample);
            }
        }
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
        let reached = state.controller.report();
        let said = if state.since.is_some() {
            BudgetReport { fault, ..reached }
        } else {
            // The frame is counted, so that a time can be given with its number.
            BudgetReport {
                frame: reached.frame,
                fault,
                ..default()
            }
        };
        report.set_if_neq(said);
        if let Some(new) = new {
            commands.entity(camera).insert(new);
        }
    }
}

/// Says, once a budget, that no time came, and what of it is missing.
fn miss(camera: Entity, source: &FrameTime, diagnostics: Option<&DiagnosticsStore>) {
    let missing = source.missing(diagnostics);
    #[cfg(feature = "render")]
    bevy::log::warn!(
        "the Budget of {camera} has moved nothing in {PATIENCE} frames, for no time was measured: {missing}"
    );
    // Without a renderer there is no log; the report says it by a tolerance of 0.
    #[cfg(not(feature = "render"))]
    let _ = (camera, missing);
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::MinimalPlugins;
    use bevy::diagnostic::{Diagnostic, DiagnosticMeasurement, DiagnosticPath};

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

    fn sample(frame: u64, milliseconds: f32) -> TimeSample {
        TimeSample {
            milliseconds,
            tau: f32::NAN,
            triangles: None,
            frame,
        }
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
            let mut frame = report(&app, camera);
            if frame.tau == 0.0 {
                // Its own, which means nothing for the budget.
                frame.tau = 0.7;
            }
            drawn.push(frame);
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
        let first = report(&app, camera);
        assert!(!first.held && first.tau == 0.0, "nothing was measured yet");
        app.world_mut()
            .resource_mut::<DiagnosticsStore>()
            .add(Diagnostic::new(SPAN));
        let mut taus = vec![3.0];
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
        app.world_mut()
            .get_mut::<TimeSamples>(camera)
            .unwrap()
            .push(sample(0, 1.0));
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
    fn nothing_is_said_while_nothing_is_measured_and_nothing_learnt_of_those_frames() {
        for source in [FrameTime::Given, FrameTime::of_passes(&["nobody"])] {
            let (mut app, camera) = app(Budget::default(), source);
            for _ in 0..=PATIENCE {
                app.update();
            }
            let waiting = report(&app, camera);
            let frame = u64::from(PATIENCE) + 1;
            assert_eq!(waiting, BudgetReport { frame, ..default() });
            // A time of a frame that was drawn with somebody else's tolerance, far over the budget: it is a sign
            // that times come, and of no use beside.
            let mut samples = app.world_mut().get_mut::<TimeSamples>(camera).unwrap();
            samples.push(sample(frame, f32::NAN));
            samples.push(sample(frame, 400.0));
            app.update();
            let begun = report(&app, camera);
            assert_eq!(
                (begun.tau, begun.expected),
                (Budget::default().greatest, 0.0)
            );
        }
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
}
