//! The controller as the engine runs it: a camera in an app, its times published as diagnostics, its tolerance read
//! from the metric that the ground's detail draws with. No work curve, for nothing in the engine writes one;
//! nothing counted; and a time says nothing of its frame but that it is about three frames old.

use super::control::Control;
use bevy::MinimalPlugins;
use bevy::app::App;
use bevy::diagnostic::{Diagnostic, DiagnosticMeasurement, DiagnosticPath, DiagnosticsStore};
use bevy::ecs::entity::Entity;
use bevy::platform::time::Instant;
use bevy::transform::components::GlobalTransform;
use dolomite_geometry::budget::{Budget, FrameTime, NextFrame, TimeSample};
use dolomite_ground::detail::budget::{DetailBudgetPlugin, frame_time};
use dolomite_ground::detail::{Metric, TerrainLod};
use std::time::Duration;

/// A camera that was put elsewhere is this far away, metres.
const ELSEWHERE: f32 = 1000.0;
/// Shares of the time that the passes have: the sum is what counts.
const SHARES: [f64; 2] = [0.25, 0.75];

/// An app with one camera.
pub struct InApp {
    app: App,
    camera: Entity,
    paths: Vec<DiagnosticPath>,
    start: Instant,
    frames: u32,
}

impl InApp {
    /// A camera with this budget and the ground's times.
    #[must_use]
    pub fn new(budget: Budget) -> Self {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, DetailBudgetPlugin))
            .init_resource::<DiagnosticsStore>();
        let source = frame_time();
        let paths = match &source {
            FrameTime::Diagnostics { paths, .. } => paths.clone(),
            _ => Vec::new(),
        };
        let mut store = app.world_mut().resource_mut::<DiagnosticsStore>();
        for path in &paths {
            store.add(Diagnostic::new(path.clone()));
        }
        let camera = app
            .world_mut()
            .spawn((
                budget,
                source,
                // Before the first time the tolerance is the camera's own: the coarsest, as for other controllers.
                TerrainLod {
                    metric: Metric::ErrorBound {
                        pixels: budget.greatest,
                    },
                    ..TerrainLod::default()
                },
                GlobalTransform::IDENTITY,
            ))
            .id();
        Self {
            app,
            camera,
            paths,
            start: Instant::now(),
            frames: 0,
        }
    }
}

impl Control for InApp {
    fn decide(&mut self, seen: &[TimeSample], next: &NextFrame) -> f32 {
        self.frames += 1;
        let world = self.app.world_mut();
        let mut store = world.resource_mut::<DiagnosticsStore>();
        for (k, sample) in (0..).zip(seen) {
            // Each a little later than the last, whatever the clock says.
            let time = self.start + Duration::from_micros(u64::from(self.frames) * 1000 + k);
            for (path, share) in self.paths.iter().zip(SHARES) {
                if let Some(diagnostic) = store.get_mut(path) {
                    diagnostic.add_measurement(DiagnosticMeasurement {
                        time,
                        value: f64::from(sample.milliseconds) * share,
                    });
                }
            }
        }
        if next.cut
            && let Some(mut pose) = world.get_mut::<GlobalTransform>(self.camera)
        {
            let x = pose.translation().x + ELSEWHERE;
            *pose = GlobalTransform::from_xyz(x, 0.0, 0.0);
        }
        self.app.update();
        let detail = self.app.world().get::<TerrainLod>(self.camera);
        match detail.map(|detail| detail.metric) {
            Some(Metric::ErrorBound { pixels }) => pixels,
            // Other metrics have no tolerance; the default is the one above.
            _ => f32::NAN,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_tolerance_is_the_coarsest_and_times_move_it() {
        let budget = Budget {
            milliseconds: 4.0,
            least: 0.25,
            greatest: 64.0,
        };
        let mut control = InApp::new(budget);
        let next = |number| NextFrame {
            number,
            curve: None,
            cut: false,
        };
        assert_eq!(control.decide(&[], &next(0)), 64.0);
        let mut tau = 64.0;
        for frame in 1..200 {
            let sample = TimeSample {
                milliseconds: 1.0,
                tau: f32::NAN,
                triangles: None,
                frame,
            };
            tau = control.decide(&[sample], &next(frame));
        }
        // A quarter of the budget whatever the tolerance: as fine as it may be.
        assert_eq!(tau, 0.25);
    }
}
