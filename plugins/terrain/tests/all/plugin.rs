//! The plugin in an app: added more than once, and its types in the registry.

use std::any::TypeId;

use bevy::MinimalPlugins;
use bevy::app::{App, Plugin, PluginGroup, PluginGroupBuilder, PostUpdate, PreUpdate};
use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy::ecs::schedule::Schedule;
use bevy::math::DVec2;
use bevy::reflect::std_traits::ReflectDefault;
use bevy::transform::components::Transform;
use dolomite_terrain::{GroundProbe, GroundRect, ProbeBatch, Terrain, TerrainData, TerrainPlugin};

/// A group that brings the plugin along, as the umbrella's groups do.
struct Group;

impl PluginGroup for Group {
    fn build(self) -> PluginGroupBuilder {
        PluginGroupBuilder::start::<Self>().add(TerrainPlugin)
    }
}

fn systems(app: &App) -> [usize; 2] {
    let count = |schedule: Option<&Schedule>| schedule.map_or(0, Schedule::systems_len);
    [
        count(app.get_schedule(PreUpdate)),
        count(app.get_schedule(PostUpdate)),
    ]
}

#[test]
fn a_second_plugin_does_nothing() {
    let mut once = App::new();
    once.add_plugins((MinimalPlugins, TerrainPlugin));
    let mut more = App::new();
    more.add_plugins((MinimalPlugins, TerrainPlugin, Group));
    more.add_plugins(TerrainPlugin);
    assert!(!TerrainPlugin.is_unique());
    assert_eq!(systems(&more), systems(&once));

    let terrain = Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 10.0),
        layers: Vec::new(),
        base: 7.0,
        sea_level: None,
    });
    more.world_mut().spawn(terrain.expect("valid"));
    let probe = (GroundProbe::default(), Transform::default());
    let probe = more.world_mut().spawn(probe).id();
    let before = more.world().resource::<ProbeBatch>().frame();
    more.update();
    let frames = more.world().resource::<ProbeBatch>().frame() - before;
    assert_eq!(frames, 1, "probes are collected once a frame");
    let sample = more
        .world()
        .get::<GroundProbe>(probe)
        .and_then(|probe| probe.sample);
    assert_eq!(sample.map(|sample| sample.height), Some(7.0));
}

#[test]
fn settings_can_be_reflected() {
    let mut app = App::new();
    // An empty one: whatever Bevy's features enter by themselves, what is found comes from the plugin.
    app.insert_resource(AppTypeRegistry::default());
    app.add_plugins(TerrainPlugin);
    let registry = app.world().resource::<AppTypeRegistry>().read();
    for id in [TypeId::of::<GroundProbe>(), TypeId::of::<ProbeBatch>()] {
        let component = registry.get_type_data::<ReflectComponent>(id);
        let default = registry.get_type_data::<ReflectDefault>(id);
        assert!(component.is_some() && default.is_some(), "{id:?}");
    }
    // What the batch keeps for itself is not shown.
    let batch = registry
        .get_type_info(TypeId::of::<ProbeBatch>())
        .and_then(|info| info.as_struct().ok())
        .expect("a struct");
    assert_eq!(batch.field_names(), ["per_frame"]);
}
