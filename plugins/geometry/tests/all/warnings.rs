//! A budget that nothing is measured for says so, once.
use bevy::prelude::*;
use dolomite_geometry::budget::{Budget, BudgetPlugin, FrameTime};
use dolomite_testkit::logs;

#[test]
fn a_budget_without_times_is_missed_once() {
    logs::keep();
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, BudgetPlugin));
    let alone = app
        .world_mut()
        .spawn((Budget::default(), GlobalTransform::default()))
        .id();
    for _ in 0..100 {
        app.update();
    }
    assert!(logs::with("Budget").is_empty(), "it may still come");
    for _ in 0..500 {
        app.update();
    }
    let said = logs::with("Budget");
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].contains("TimeSamples"), "{said:?}");
    assert!(said[0].contains(&alone.to_string()), "{said:?}");
    // Another has a reason of its own.
    let passes = FrameTime::of_passes(&["nobody"]);
    app.world_mut()
        .spawn((Budget::default(), passes, GlobalTransform::default()));
    for _ in 0..500 {
        app.update();
    }
    let said = logs::with("Budget");
    assert_eq!(said.len(), 2, "{said:?}");
    assert!(said[1].contains("DiagnosticsStore"), "{said:?}");
}
