//! The example, drawn by day, at dusk and at night.

use bevy::prelude::*;
use bevy::render::RenderApp;
use dolomite_city::render::CityLamp;
use dolomite_city::{City, CityPlugin, CityView};
use dolomite_geometry::GeometryStats;
use dolomite_geometry::render::census;

use crate::{app, city};

/// Small where nobody looks.
fn size() -> [u32; 2] {
    match std::env::var_os("DOLOMITE_PICTURES") {
        Some(_) => [960, 540],
        None => [320, 180],
    }
}

fn drawn(time: &'static str) -> Option<(App, Handle<Image>)> {
    let mut app = app::app(|app| {
        app::bevys(app);
        app.insert_resource(bevy::pbr::DefaultOpaqueRendererMethod::deferred())
            .add_plugins(CityPlugin)
            .add_systems(Startup, move |commands: Commands| {
                city::setup(commands, time)
            });
    })?;
    app.update();
    let target = app::target(&mut app, size());
    app::retarget(&mut app, &target);
    // Meshes come from a task.
    for _ in 0..400 {
        app::frames(&mut app, 1);
        if app.world().resource::<GeometryStats>().primitives > 1000 {
            break;
        }
    }
    app::frames(&mut app, 12);
    Some((app, target))
}

#[test]
fn the_city_is_drawn_by_day_at_dusk_and_at_night_gpu() {
    for (time, name) in [
        ("day", "day.png"),
        ("dusk", "dusk.png"),
        ("night", "night.png"),
    ] {
        let Some((mut app, target)) = drawn(time) else {
            return;
        };
        let stats = app.world().resource::<GeometryStats>().clone();
        println!("{time}: {stats:?}");
        assert!(
            stats.patches > 5000 && stats.primitives > 10_000,
            "{stats:?}"
        );
        let picture = app::picture(&mut app, &target);
        let [width, height] = size();
        let lit = app::count(&picture, 0, width, |c| c.red + c.green + c.blue > 0.03);
        let share = lit as f32 / (width * height) as f32;
        app::keep(picture, name);
        let world = app.world_mut();
        let lamps = world.query::<&CityLamp>().iter(world).count();
        println!("{time}: {lit} pixels lit, {lamps} lights");
        if time == "day" {
            assert_eq!(lamps, 0);
            assert!(share > 0.7, "{share}");
        } else {
            assert!(lamps > 100, "{lamps}");
            assert!(share > 0.1, "{share}");
        }
    }
}

#[test]
fn without_a_city_nothing_is_there_gpu() {
    let app = app::app(|app| {
        app::bevys(app);
        app.add_plugins(CityPlugin);
    });
    let Some(mut app) = app else { return };
    app.world_mut()
        .spawn((Camera3d::default(), Msaa::Off, CityView::default()));
    app::frames(&mut app, 5);
    let before = census(app.sub_app(RenderApp).world());
    println!("{before:?}");
    let entity = app.world_mut().spawn(City::default()).id();
    app::frames(&mut app, 60);
    let during = census(app.sub_app(RenderApp).world());
    assert_ne!(format!("{before:?}"), format!("{during:?}"));
    app.world_mut().entity_mut(entity).despawn();
    app::frames(&mut app, 20);
    let world = app.world_mut();
    let left = world.query::<&CityLamp>().iter(world).count();
    assert_eq!(left, 0);
}
