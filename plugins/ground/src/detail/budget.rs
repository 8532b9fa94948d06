//! The ground's tolerance under a time budget: [`dolomite_geometry::budget`] decides, the metric follows.
//!
//! What a view asks for at every tolerance is counted on the GPU as the ground is chosen ([`work`]), so that the
//! controller knows what a tolerance will cost in this view.
//!
//! The GPU's times come from Bevy's `RenderDiagnosticsPlugin`, which the app adds. Until there is one, the tolerance
//! that the metric has stays.
//!
//! ```
//! # use bevy::prelude::*;
//! # use dolomite_ground::detail::TerrainLod;
//! # use dolomite_ground::detail::budget::{Budget, frame_time};
//! fn hold_four_milliseconds(mut commands: Commands, camera: Single<Entity, With<TerrainLod>>) {
//!     commands.entity(*camera).insert((Budget::default(), frame_time()));
//! }
//! ```

use bevy::prelude::*;

pub use dolomite_geometry::budget::*;

use super::work::{self, GroundWork};
use super::{Metric, TerrainLod};
use crate::sets::GroundSystems;

/// The GPU's time for choosing the ground's detail and drawing it into the G-buffer: what its tolerance
/// moves. Needs Bevy's `RenderDiagnosticsPlugin`.
#[must_use]
pub fn frame_time() -> FrameTime {
    FrameTime::of_passes(&["detail", "geometry_gbuffer"])
}

/// Writes the tolerances into the metrics of the ground's detail. [`Metric::Classic`] has none and stays as
/// it is.
fn follow(mut cameras: Query<(&BudgetReport, &mut TerrainLod), With<Budget>>) {
    for (report, mut detail) in &mut cameras {
        // Before anything was measured there is none.
        if report.tau <= 0.0 {
            continue;
        }
        let pixels = report.tau;
        let metric = match detail.metric {
            Metric::ErrorBound { .. } => Metric::ErrorBound { pixels },
            Metric::EdgeLength { .. } => Metric::EdgeLength { pixels },
            classic @ Metric::Classic { .. } => classic,
        };
        if detail.metric != metric {
            detail.metric = metric;
        }
    }
}

/// Lets the ground's detail follow the budgets of cameras; comes with the ground's plugin. Added again it does
/// nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct DetailBudgetPlugin;

/// Marks an app that has the system.
#[derive(Resource)]
struct Added;

impl Plugin for DetailBudgetPlugin {
    fn build(&self, app: &mut App) {
        if app.world().contains_resource::<Added>() {
            return;
        }
        app.insert_resource(Added)
            .init_resource::<GroundWork>()
            .add_plugins(BudgetPlugin)
            .add_systems(
                PostUpdate,
                (
                    work::supply.before(BudgetSystems),
                    follow.in_set(GroundSystems::Budget).after(BudgetSystems),
                )
                    .run_if(any_with_component::<Budget>),
            );
    }

    fn is_unique(&self) -> bool {
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::MinimalPlugins;
    use bevy::diagnostic::{Diagnostic, DiagnosticMeasurement, DiagnosticsStore};

    /// What a frame of the tests takes: 1 ms and 4 ms a pixel's inverse.
    fn time(tau: f32) -> f32 {
        1.0 + 4.0 / tau
    }

    #[test]
    fn a_tolerance_stays_while_nothing_is_measured() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, DetailBudgetPlugin));
        let detail = TerrainLod {
            metric: Metric::ErrorBound { pixels: 1.5 },
            ..default()
        };
        let bundle = (Budget::default(), detail, GlobalTransform::default());
        // By the budget alone, and with times that nobody publishes.
        let cameras = [
            app.world_mut().spawn(bundle).id(),
            app.world_mut().spawn((bundle, frame_time())).id(),
        ];
        for _ in 0..20 {
            app.update();
        }
        for camera in cameras {
            assert_eq!(app.world().get::<TerrainLod>(camera), Some(&detail));
        }
    }

    #[test]
    fn the_grounds_detail_follows_its_budget() {
        let mut app = App::new();
        app.add_plugins(MinimalPlugins)
            .init_resource::<DiagnosticsStore>();
        app.add_plugins(DetailBudgetPlugin);
        let bundle = (
            Budget::default(),
            frame_time(),
            Transform::default(),
            GlobalTransform::default(),
        );
        let camera = app.world_mut().spawn(bundle).id();
        let FrameTime::Diagnostics { paths, .. } = frame_time() else {
            panic!("by diagnostics");
        };
        let mut store = app.world_mut().resource_mut::<DiagnosticsStore>();
        for path in &paths {
            store.add(Diagnostic::new(path.clone()));
        }
        let mut detail = TerrainLod::default();
        app.world_mut().entity_mut(camera).insert(detail);
        let tau = |app: &App| match app.world().get::<TerrainLod>(camera).unwrap().metric {
            Metric::ErrorBound { pixels } => pixels,
            other => panic!("{other:?}"),
        };
        let mut taus = vec![1.0];
        for _ in 0..200 {
            let past = taus[taus.len().saturating_sub(3)];
            let mut store = app.world_mut().resource_mut::<DiagnosticsStore>();
            // A third of the time is the draw's.
            for (path, share) in paths.iter().zip([2.0 / 3.0, 1.0 / 3.0]) {
                store
                    .get_mut(path)
                    .unwrap()
                    .add_measurement(DiagnosticMeasurement {
                        time: bevy::platform::time::Instant::now(),
                        value: f64::from(time(past) * share),
                    });
            }
            app.update();
            taus.push(tau(&app));
        }
        let reached = time(tau(&app)) / 4.0;
        assert!((0.93..=1.0).contains(&reached), "{reached}");
        assert_eq!(
            tau(&app),
            app.world().get::<BudgetReport>(camera).unwrap().tau
        );

        // What has no tolerance is left alone, and so is a camera without a budget.
        detail.metric = Metric::Classic {
            patch: 16.0,
            least: 1.0,
            greatest: 32.0,
            reach: 400.0,
            height: 10.0,
        };
        app.world_mut().entity_mut(camera).insert(detail);
        let other = app.world_mut().spawn(TerrainLod::default()).id();
        app.update();
        assert_eq!(app.world().get::<TerrainLod>(camera), Some(&detail));
        assert_eq!(
            app.world().get::<TerrainLod>(other),
            Some(&TerrainLod::default())
        );
    }
}
