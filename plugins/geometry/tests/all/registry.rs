//! What an app sets can be read and written by reflection, for scenes and inspectors.
use std::any::TypeId;

use bevy::prelude::*;
use dolomite_geometry::budget::{Budget, BudgetPlugin, BudgetReport, FrameTime};
use dolomite_geometry::{GeometryCamera, GeometryPlugin};

/// What no plugin knows.
#[derive(Component, Reflect, Default)]
#[reflect(Component, Default)]
struct Unknown;

/// Whether a component is in the app's registry, as one that can be made and inserted.
fn is_registered<T: Component>(app: &App) -> bool {
    let registry = app.world().resource::<AppTypeRegistry>().read();
    registry.get(TypeId::of::<T>()).is_some_and(|known| {
        known.contains::<ReflectComponent>() && known.contains::<ReflectDefault>()
    })
}

#[test]
fn settings_are_registered_by_the_plugins() {
    let mut app = App::new();
    // Nothing that Bevy registers by itself, where it was built so.
    app.insert_resource(AppTypeRegistry::default())
        .add_plugins((MinimalPlugins, GeometryPlugin, BudgetPlugin));
    let all = [
        is_registered::<GeometryCamera>(&app),
        is_registered::<Budget>(&app),
        is_registered::<BudgetReport>(&app),
        is_registered::<FrameTime>(&app),
    ];
    assert_eq!(all, [true; 4]);
    assert!(!is_registered::<Unknown>(&app), "the check can fail");
}
