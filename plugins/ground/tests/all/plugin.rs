//! The plugins in an app without a renderer: they keep covers, answer height queries, and may be added more than once.

use std::any::TypeId;

use bevy::app::{PluginGroup, PluginGroupBuilder};
use bevy::ecs::reflect::AppTypeRegistry;
use bevy::ecs::schedule::Schedule;
use bevy::math::DVec2;
use bevy::prelude::*;
use dolomite_ground::detail::budget::{Budget, DetailBudgetPlugin};
use dolomite_ground::detail::{DrawnProbes, TerrainLod};
use dolomite_ground::{
    GroundMaterial, GroundPlugin, MaterialBands, PatchDetail, Sea, TerrainCover, TerrainView,
};
use dolomite_terrain::{
    GroundProbe, GroundRect, Hill, Layer, ProbeBatch, Source, Terrain, TerrainData, TerrainPlugin,
};

/// A square of 400 m with a hill of 10 m in its middle.
fn terrain() -> Terrain {
    let hill = Hill {
        centre: DVec2::ZERO,
        radius: 40.0,
        height: 10.0,
    };
    let terrain = Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 400.0),
        layers: vec![Layer {
            source: Source::Hill(hill),
            mask: None,
        }],
        base: 0.0,
        sea_level: None,
    });
    terrain.expect("valid")
}

/// The plugins in the order of the umbrella's groups.
struct Group;

impl PluginGroup for Group {
    fn build(self) -> PluginGroupBuilder {
        PluginGroupBuilder::start::<Self>()
            .add(TerrainPlugin)
            .add(GroundPlugin::default())
    }
}

fn systems(app: &App) -> [usize; 3] {
    let count = |schedule: Option<&Schedule>| schedule.map_or(0, Schedule::systems_len);
    [
        count(app.get_schedule(PreUpdate)),
        count(app.get_schedule(Update)),
        count(app.get_schedule(PostUpdate)),
    ]
}

#[test]
fn a_second_plugin_does_nothing() {
    let mut once = App::new();
    once.add_plugins((MinimalPlugins, GroundPlugin::default()));
    let mut more = App::new();
    more.add_plugins((
        MinimalPlugins,
        DetailBudgetPlugin,
        TerrainPlugin,
        GroundPlugin { relief_side: 64 },
        Group,
        GroundPlugin::default(),
        DetailBudgetPlugin,
    ));
    assert_eq!(systems(&more), systems(&once));
    more.finish();
    more.cleanup();
    more.update();
}

#[test]
fn without_a_renderer_covers_are_kept_and_probes_answered() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, GroundPlugin::default()));
    app.finish();
    app.cleanup();
    let ground = app
        .world_mut()
        .spawn((terrain(), GroundMaterial::default()))
        .id();
    let place = Transform::from_xyz(0.0, 20.0, 0.0);
    let patches = (
        TerrainView,
        PatchDetail::default(),
        place,
        GlobalTransform::from(place),
    );
    let patches = app.world_mut().spawn(patches).id();
    let bounded = app
        .world_mut()
        .spawn((TerrainView, place, GlobalTransform::from(place)))
        .id();
    let probe = app
        .world_mut()
        .spawn((GroundProbe::default(), Transform::default()))
        .id();
    app.update();
    let cover = |app: &App, camera: Entity| {
        let cover = app.world().get::<TerrainCover>(camera).expect("required");
        (cover.terrain, cover.patches.mesh.patches())
    };
    let (of, near) = cover(&app, patches);
    assert!(of == Some(ground) && near > 1, "{of:?} {near}");
    assert_eq!(cover(&app, bounded), (None, 0), "chosen on the GPU alone");
    assert!(app.world().get::<TerrainLod>(bounded).is_some());
    let sample = app
        .world()
        .get::<GroundProbe>(probe)
        .and_then(|probe| probe.sample);
    assert_eq!(sample.map(|sample| sample.height), Some(10.0));

    // It follows the camera: from far away fewer patches do.
    let away = Transform::from_xyz(0.0, 4000.0, 0.0);
    app.world_mut()
        .entity_mut(patches)
        .insert((away, GlobalTransform::from(away)));
    app.update();
    let (of, far) = cover(&app, patches);
    assert!(of == Some(ground) && far < near, "{of:?} {far} of {near}");
    app.world_mut().despawn(ground);
    app.update();
    assert_eq!(cover(&app, patches), (None, 0));
}

#[test]
fn settings_can_be_reflected() {
    let mut app = App::new();
    // An empty one: whatever Bevy's features enter by themselves, what is found comes from the plugins.
    app.insert_resource(AppTypeRegistry::default());
    app.add_plugins(GroundPlugin::default());
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let components = [
        TypeId::of::<TerrainView>(),
        TypeId::of::<TerrainLod>(),
        TypeId::of::<PatchDetail>(),
        TypeId::of::<GroundMaterial>(),
        TypeId::of::<Sea>(),
        TypeId::of::<DrawnProbes>(),
        TypeId::of::<Budget>(),
        TypeId::of::<GroundProbe>(),
        TypeId::of::<ProbeBatch>(),
    ];
    #[cfg(feature = "render")]
    let of_render = [
        TypeId::of::<dolomite_ground::GroundTextures>(),
        TypeId::of::<dolomite_ground::render::TerrainRelief>(),
    ];
    #[cfg(not(feature = "render"))]
    let of_render = [];
    for id in components.into_iter().chain(of_render) {
        let found = registry.get_type_data::<ReflectComponent>(id);
        assert!(found.is_some(), "{id:?}");
    }
    assert!(registry.get(TypeId::of::<MaterialBands>()).is_some());
}
