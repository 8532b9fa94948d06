//! What an app sets can be read and written by reflection, for scenes and inspectors.

use std::any::TypeId;

use bevy::prelude::*;
use dolomite_sky::{Sky, SkyPlugin, Sun};

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
        .add_plugins((MinimalPlugins, SkyPlugin));
    let all = [is_registered::<Sun>(&app), is_registered::<Sky>(&app)];
    assert_eq!(all, [true; 2]);
    assert!(!is_registered::<Unknown>(&app), "the check can fail");
}
