//! The inspector over our own plugins: pictures of what they make, what the open panel takes in the game, charts of it.

use crate::support::adapter;
use crate::support::app;
use crate::support::camera;
use crate::support::picture;

use std::time::{Duration, Instant};

use bevy::pbr::DefaultOpaqueRendererMethod;
use bevy::pbr::wireframe::WireframePlugin;
use bevy::prelude::*;
use dolomite::DolomitePlugins;
use dolomite::deferred::{AmbientOcclusion, DeferredLighting, Way};
use dolomite::inspector::chart::Charts;
use dolomite::inspector::panel::state::{Shell, Tab};
use dolomite::inspector::picture::colours::heat;
use dolomite::inspector::picture::{FramePicture, variants};
use dolomite::inspector::views::FrameViews;
use dolomite::inspector::{Console, Inspector, InspectorPlugin};
use dolomite_game::run::Setup;
use dolomite_game::run::offscreen::{Offscreen, STEP};
use dolomite_game::scene::SceneRequest;
use dolomite_game::settings::Settings;
use dolomite_shaders::compose;

#[test]
fn every_variant_that_our_plugins_add_is_valid() {
    let own = variants(&[]).len();
    let all = variants(&dolomite::WAYS);
    assert_eq!(all.len(), own + 2 * dolomite::WAYS.len());
    for defines in &all[own..] {
        compose("inspector/picture.wgsl", defines)
            .unwrap_or_else(|error| panic!("{defines:?}: {error}"));
    }
}

/// The game without a window.
fn game(scene: &str, size: UVec2) -> Option<Offscreen> {
    if !adapter::is_there() {
        return None;
    }
    let request = SceneRequest::new(scene);
    let settings = Settings {
        max_error: Some(8.0),
        ..Settings::default()
    };
    let mut setup = Setup::load(settings, request, None).expect("the scene is good");
    setup.panels = false;
    let mut game = Offscreen::new(setup, size).expect("a device that was found");
    game.settle().expect("it settles");
    Some(game)
}

/// Lets the console do a line, and gives what it said.
fn say(game: &mut Offscreen, line: &str) -> String {
    let faults = game.app.world().resource::<Console>().faults();
    game.app.world_mut().resource_mut::<Console>().enter(line);
    for _ in 0..3000 {
        game.step(STEP).expect("it draws");
        if game.app.world().resource::<Console>().queue.is_empty() {
            break;
        }
    }
    let console = game.app.world().resource::<Console>();
    assert!(console.queue.is_empty(), "{line}: it still waits");
    let said: Vec<_> = console.output().map(|(_, line)| line.to_owned()).collect();
    assert_eq!(console.faults(), faults, "{line}: {said:?}");
    said.join("\n")
}

mod gpu {
    use super::*;

    const WIDTH: u32 = 320;
    const HEIGHT: u32 = 160;

    /// A wall 5 m away over the whole picture, two lamps before its left part, one before its right one, and a sun.
    fn wall(way: Way) -> Option<(App, Handle<Image>)> {
        wall_beside(way, |_| ())
    }

    /// The same, with what `add` adds.
    fn wall_beside(way: Way, add: impl FnOnce(&mut App)) -> Option<(App, Handle<Image>)> {
        let mut app = app::app(Duration::from_millis(16), |app| {
            add(app);
            app.add_plugins((DolomitePlugins, InspectorPlugin))
                .insert_resource(DefaultOpaqueRendererMethod::deferred());
            dolomite::pictures(app);
        })?;
        let (_, target) = camera::camera(
            &mut app,
            UVec2::new(WIDTH, HEIGHT),
            (DeferredLighting { way }, AmbientOcclusion::default()),
        );
        let world = app.world_mut();
        let mesh = world
            .resource_mut::<Assets<Mesh>>()
            .add(Rectangle::new(40.0, 40.0));
        let material = world
            .resource_mut::<Assets<StandardMaterial>>()
            .add(StandardMaterial::default());
        world.spawn((
            Mesh3d(mesh),
            MeshMaterial3d(material),
            Transform::from_xyz(0.0, 0.0, -5.0),
        ));
        for x in [-2.0, -2.0, 2.0] {
            world.spawn((
                PointLight {
                    range: 0.9,
                    ..default()
                },
                Transform::from_xyz(x, 0.0, -4.6),
            ));
        }
        world.spawn((
            DirectionalLight {
                shadow_maps_enabled: true,
                ..default()
            },
            Transform::from_xyz(1.0, 2.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
        ));
        Some((app, target))
    }

    /// The pixel at a place of the wall, metres from its middle.
    fn at(image: &Image, x: f32) -> [u8; 3] {
        // Bevy's usual field of view is a quarter of a turn upwards: half the height over tan 22.5 degrees is a radian.
        let focal = 0.5 * HEIGHT as f32 / bevy::math::ops::tan(std::f32::consts::FRAC_PI_8);
        let column = (0.5 * WIDTH as f32 + x * focal / 5.0) as u32;
        let data = image.data.as_ref().expect("it was read back");
        let first = 4 * (HEIGHT / 2 * WIDTH + column) as usize;
        [data[first], data[first + 1], data[first + 2]]
    }

    fn shown(app: &mut App, target: &Handle<Image>, name: &str) -> Image {
        app.world_mut().resource_mut::<FramePicture>().shown = name.to_owned();
        picture::picture(app, target, 8)
    }

    #[test]
    fn tiles_are_as_hot_as_they_have_lights() {
        let Some((mut app, target)) = wall(Way::Tiled) else {
            return;
        };
        app.world_mut().resource_mut::<FramePicture>().most = 4.0;
        let image = shown(&mut app, &target, "lights");
        for (x, lights) in [(-2.0, 2.0), (2.0, 1.0), (0.0, 0.0), (-3.8, 0.0)] {
            let expected = (heat(lights / 4.0) * 255.0).to_array().map(|c| c as u8);
            assert_eq!(at(&image, x), expected, "{x} m from the middle");
        }
        // By brute force there are no tiles: the frame is shown.
        let Some((mut app, target)) = wall(Way::BruteForce) else {
            return;
        };
        let before = picture::picture(&mut app, &target, 12);
        let image = shown(&mut app, &target, "lights");
        assert_eq!(image.data, before.data);
    }

    #[test]
    fn an_open_wall_is_white_and_its_shadow_map_has_depths() {
        let Some((mut app, target)) = wall(Way::Tiled) else {
            return;
        };
        let image = shown(&mut app, &target, "occlusion");
        // The filter's rounding of a plane that blocks nothing.
        for x in [-2.0, 0.0, 2.0] {
            let pixel = at(&image, x);
            assert!(
                pixel.iter().all(|channel| *channel >= 250),
                "{x}: {pixel:?}"
            );
        }
        let image = shown(&mut app, &target, "shadow_maps");
        let data = image.data.expect("it was read back");
        let drawn = data.chunks_exact(4).filter(|p| p[0] > 0 && p[0] == p[1]);
        let part = drawn.count() as f32 / (WIDTH * HEIGHT) as f32;
        assert!(part > 0.05, "{part} of the maps has depths");
    }

    #[test]
    fn wireframes_are_bevys_where_an_app_has_them() {
        let switch = |app: &mut App, on| {
            let views = app.world().resource::<FrameViews>().clone();
            let view = views.get("wireframe").expect("it was added");
            (view.switch(app.world_mut(), on), view.is_on(app.world()))
        };
        let Some((mut app, _)) = wall(Way::BruteForce) else {
            return;
        };
        let (refused, on) = switch(&mut app, true);
        assert!(refused.unwrap_err().contains("WireframePlugin") && !on);
        let Some((mut app, target)) = wall_beside(Way::BruteForce, |app| {
            app.add_plugins(WireframePlugin::default());
        }) else {
            return;
        };
        let before = picture::picture(&mut app, &target, 12);
        assert_eq!(switch(&mut app, true), (Ok(()), true));
        let lines = picture::picture(&mut app, &target, 12);
        let pairs = |image: &Image| image.data.clone().expect("it was read back");
        let (before, lines) = (pairs(&before), pairs(&lines));
        let pixels = before.chunks_exact(4).zip(lines.chunks_exact(4));
        let differing = pixels.filter(|(a, b)| a != b).count();
        // The diagonal of the wall crosses the picture once; its sides lie outside.
        assert!(
            (100..2000).contains(&differing),
            "{differing} pixels of lines"
        );
        assert_eq!(switch(&mut app, false), (Ok(()), false));
        let after = pairs(&picture::picture(&mut app, &target, 12));
        assert_eq!(after, before);
    }

    /// `DOLOMITE_PICTURES` keeps what is drawn, for the page of the plugin.
    fn keep(game: &mut Offscreen, name: &str) {
        if let Some(folder) = std::env::var_os("DOLOMITE_PICTURES") {
            let picture = game.capture().expect("a picture");
            let file = std::path::Path::new(&folder).join(name);
            picture.save(file).expect("the folder can be written");
        }
    }

    #[test]
    fn the_error_of_the_ground_is_charted_over_its_time_and_the_knob_is_put_back() {
        let Some(mut game) = game("mountain", UVec2::new(160, 90)) else {
            return;
        };
        let said = say(
            &mut game,
            "chart Settings.max_error 2 32 --steps 3 --settle 12 --frames 4 --picture",
        );
        assert!(said.contains("32.000000"), "{said}");
        let charts = game.app.world().resource::<Charts>();
        let chart = charts.list().last().expect("it was made").clone();
        let errors: Vec<f64> = chart
            .points
            .iter()
            .filter_map(|point| point.error)
            .collect();
        println!("{chart:?}");
        assert_eq!(
            (errors.len(), errors[0]),
            (3, 0.0),
            "of the first to itself"
        );
        // A coarser ground is farther from the finest one, and how much is the scene's.
        assert!(errors[2] > errors[1] && errors[1] > 0.0, "{errors:?}");
        assert!(errors[2] < 0.5, "{errors:?}");
        let settings = game.app.world().resource::<Settings>();
        assert_eq!(settings.max_error, Some(8.0));
        assert!(!game.app.world().resource::<Time<Virtual>>().is_paused());
        assert!(game.app.world().resource::<Inspector>() == &Inspector::default());
    }

    /// What the last frame of the main world took.
    #[derive(Resource, Default)]
    struct Took {
        began: Option<Instant>,
        last: Duration,
    }

    fn median(times: &mut [f64]) -> f64 {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    }

    /// Frames of the main world, closed and with each tab open, in turns; and the inspector's own part. Times of a build
    /// for tests: ten to twenty times those of a release.
    #[test]
    #[ignore = "a measurement: it prints what the open panel takes"]
    fn what_an_open_panel_takes() {
        let Some(mut game) = game("mountain", UVec2::new(640, 400)) else {
            return;
        };
        game.app
            .init_resource::<Took>()
            .add_systems(First, |mut took: ResMut<Took>| {
                took.began = Some(Instant::now());
            })
            .add_systems(Last, |mut took: ResMut<Took>| {
                took.last = took.began.map_or(Duration::ZERO, |began| began.elapsed());
            });
        let tabs = [Tab::Settings, Tab::Entities, Tab::Diagnostics, Tab::Views];
        let mut closed = Vec::new();
        let mut open = vec![Vec::new(); tabs.len()];
        for _ in 0..6 {
            for way in 0..=tabs.len() {
                let is_open = way > 0;
                if is_open {
                    game.app.world_mut().resource_mut::<Shell>().tab = tabs[way - 1];
                }
                game.app.world_mut().resource_mut::<Inspector>().panel = is_open;
                // Opening makes a context and its font, closing lets it go.
                for frame in 0..20 {
                    game.step(STEP).expect("it draws");
                    let took = 1e3 * game.app.world().resource::<Took>().last.as_secs_f64();
                    if frame >= 8 {
                        if is_open {
                            open[way - 1].push(took);
                        } else {
                            closed.push(took);
                        }
                    }
                }
            }
        }
        let closed = median(&mut closed);
        println!("main world, closed: {closed:.3} ms");
        for (tab, times) in tabs.iter().zip(&mut open) {
            let open = median(times);
            let ratio = open / closed;
            println!(
                "{tab:?}: {open:.3} ms, {:.3} ms more, {ratio:.2} times",
                open - closed
            );
        }
    }

    #[test]
    #[ignore = "pictures for the page of the plugin: look at them"]
    fn pictures_of_the_open_panel() {
        let Some(mut game) = game("mountain", UVec2::new(1280, 720)) else {
            return;
        };
        for tab in ["settings --filter Sun", "entities", "diagnostics", "views"] {
            say(&mut game, &format!("inspect {tab}"));
            say(&mut game, "wait 4");
            let name = tab.split(' ').next().unwrap_or_default();
            keep(&mut game, &format!("panel-{name}.png"));
        }
        say(&mut game, "inspect off");
        for name in ["base_colour", "normals", "roughness", "depth"] {
            say(&mut game, &format!("views {name} on"));
            say(&mut game, "wait 4");
            keep(&mut game, &format!("picture-{name}.png"));
        }
    }
}
