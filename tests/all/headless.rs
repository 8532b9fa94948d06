//! The game without renderer and window: figure, camera and switches, stepped by hand under `MinimalPlugins`.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::time::Duration;

use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use dolomite::DolomiteMinimalPlugins;
use dolomite::character::CharacterMotion;
use dolomite::character::gait::Motion;
use dolomite::terrain::{Ground, ProbeAnswer, ProbeBatch, Terrain};
use dolomite_game::input::PlayerInput;
use dolomite_game::play::camera::FreeCamera;
use dolomite_game::play::figure::{EDGE, Figure, WADING_DEPTH, depth};
use dolomite_game::play::jump::Jump;
use dolomite_game::play::{DetailFocus, SimulationPlugin, Switches};
use dolomite_game::scene::{self, CLEARANCE, CurrentScene, PITCH_LIMIT, SceneRequest};
use dolomite_game::settings::Settings;
use dolomite_game::settings::paths::AssetsDir;

/// Greatest distance of the drawn feet from the f64 ground, metres.
pub const FEET: f64 = 1e-3;

fn assets() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets")
}

pub fn game(name: &str) -> App {
    let request = SceneRequest::new(name);
    let loaded = scene::load(&request, &assets()).expect("the scene is good");
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, DolomiteMinimalPlugins))
        .insert_resource(AssetsDir(assets()))
        .insert_resource(request)
        .insert_resource(CurrentScene(loaded))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(
            23,
        )))
        .add_plugins(SimulationPlugin);
    app.finish();
    app.cleanup();
    app.update();
    app
}

fn wish(app: &mut App, input: PlayerInput) {
    *app.world_mut().resource_mut::<PlayerInput>() = input;
}

pub fn terrain(app: &mut App) -> Terrain {
    app.world().resource::<CurrentScene>().terrain.clone()
}

pub fn figure(app: &mut App) -> (Figure, Transform) {
    let world = app.world_mut();
    let (figure, transform) = world
        .query::<(&Figure, &Transform)>()
        .single(world)
        .expect("there is one figure");
    (*figure, *transform)
}

fn camera(app: &mut App) -> FreeCamera {
    let world = app.world_mut();
    *world
        .query::<&FreeCamera>()
        .single(world)
        .expect("there is one camera")
}

/// Puts the figure somewhere, as after a jump.
fn put(app: &mut App, place: DVec2) {
    let terrain = terrain(app);
    let world = app.world_mut();
    let mut figure = world
        .query::<&mut Figure>()
        .single_mut(world)
        .expect("there is one figure");
    *figure = Figure::at(place, &terrain);
}

/// A reproducible sequence of numbers in [0, 1): a linear congruential generator with the
/// constants of Knuth's MMIX, upper 32 bits.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 32) as f64 / 4_294_967_296.0
    }
}

/// Random walks from random places: in every frame drawn, the feet are on the f64 ground, the
/// figure is inside the extent, and the water is not too deep.
fn walk_about(scene: &str) {
    let mut app = game(scene);
    let terrain = terrain(&mut app);
    let extent = terrain.extent();
    // Faster than the game's: farther.
    let mut settings = app.world_mut().resource_mut::<Settings>();
    (settings.walk_speed, settings.run_speed) = (8.0, 64.0);
    let mut numbers = Numbers(7);
    let mut worst: f64 = 0.0;
    let mut walked = 0.0;
    for _ in 0..60 {
        let share = DVec2::new(numbers.next(), numbers.next());
        put(&mut app, extent.min + (extent.max - extent.min) * share);
        for _ in 0..8 {
            let angle = (numbers.next() * TAU) as f32;
            wish(
                &mut app,
                PlayerInput {
                    walk: Vec2::from_angle(angle),
                    fast: numbers.next() < 0.5,
                    ..default()
                },
            );
            let from = figure(&mut app).0.now.place;
            for _ in 0..12 {
                app.update();
                let (figure, transform) = figure(&mut app);
                let feet = transform.translation.as_dvec3();
                worst = worst.max((terrain.height(feet.xz()) - feet.y).abs());
                assert!(depth(figure.now.place, &terrain) <= WADING_DEPTH);
                let inside = figure.now.place.clamp(extent.min + EDGE, extent.max - EDGE);
                assert_eq!(inside, figure.now.place);
            }
            walked += figure(&mut app).0.now.place.distance(from);
        }
    }
    println!(
        "{scene}: {walked:.0} m walked, feet at most {:.4} mm off the ground",
        worst * 1e3
    );
    assert!(worst <= FEET, "feet {worst} m off the ground");
    // Each of 480 walks of a quarter of a second speeds up by 9 m/s²: standing still would prove nothing.
    assert!(walked > 200.0, "only {walked} m walked");
}

#[test]
fn feet_stay_on_the_mountain() {
    walk_about("mountain");
}

#[test]
fn feet_stay_on_jacksboro() {
    walk_about("jacksboro");
}

#[test]
fn the_figure_wades_but_does_not_swim() {
    let mut app = game("mountain");
    let terrain = terrain(&mut app);
    // As far as the sea in a few minutes.
    app.world_mut().resource_mut::<Settings>().run_speed = 32.0;
    let start = figure(&mut app).0.now.place;
    // Outwards from the middle: an island ends in the sea.
    let away = start.normalize().as_vec2();
    let yaw = camera(&mut app).pose.yaw;
    let (sin, cos) = bevy::math::ops::sin_cos(yaw);
    // The wish is as the camera sees it: right is (cos, -sin), away (-sin, -cos) on the ground.
    let walk = Vec2::new(
        away.dot(Vec2::new(cos, -sin)),
        away.dot(Vec2::new(-sin, -cos)),
    );
    wish(
        &mut app,
        PlayerInput {
            walk,
            fast: true,
            ..default()
        },
    );
    let mut deepest = f64::NEG_INFINITY;
    for _ in 0..6000 {
        app.update();
        deepest = deepest.max(depth(figure(&mut app).0.now.place, &terrain));
    }
    assert!(deepest > 0.0, "never reached the water ({deepest} m)");
    assert!(deepest <= WADING_DEPTH, "{deepest} m deep");
}

#[test]
fn the_figure_faces_where_it_walks_and_says_so() {
    let mut app = game("mountain");
    let before = figure(&mut app).0.now.place;
    wish(
        &mut app,
        PlayerInput {
            walk: Vec2::X,
            ..default()
        },
    );
    for _ in 0..120 {
        app.update();
    }
    let (figure, transform) = figure(&mut app);
    let went = (figure.now.place - before).normalize();
    let faces = (transform.rotation * Vec3::Z).as_dvec3();
    assert!(
        faces.xz().normalize().dot(went) > 0.95,
        "faces {faces}, went {went}"
    );
    assert!((transform.rotation * Vec3::Y).distance(Vec3::Y) < 1e-6);
    let walk_speed = app.world().resource::<Settings>().walk_speed;
    let world = app.world_mut();
    let mut doing = world.query::<&CharacterMotion>();
    let Motion {
        speed, airborne, ..
    } = doing.single(world).expect("one figure").0;
    // Along the surface as fast as it is set; over the plane slower, by up to the steepest slope here.
    assert!(
        speed > 0.6 * walk_speed && speed <= walk_speed * 1.001,
        "{speed}"
    );
    assert!(!airborne);
}

#[test]
fn a_leap_leaves_the_ground_and_comes_back() {
    let mut app = game("mountain");
    let terrain = terrain(&mut app);
    for _ in 0..10 {
        app.update();
    }
    wish(
        &mut app,
        PlayerInput {
            jump: true,
            ..default()
        },
    );
    app.update();
    wish(&mut app, PlayerInput::default());
    let (mut highest, mut air) = (0.0_f64, 0);
    for _ in 0..120 {
        app.update();
        let (_, transform) = figure(&mut app);
        let feet = transform.translation.as_dvec3();
        highest = highest.max(feet.y - terrain.height(feet.xz()));
        let world = app.world_mut();
        let mut doing = world.query::<&CharacterMotion>();
        air += usize::from(doing.single(world).expect("one figure").0.airborne);
    }
    // v²/2g; fixed steps of a 64th of a second miss the top by less than a centimetre.
    assert!((highest - 0.459).abs() < 0.01, "{highest} m");
    assert!(air > 30 && air < 90, "{air} frames");
    assert_eq!(figure(&mut app).0.now.jump, Jump::None);
}

#[test]
fn a_camera_that_follows_keeps_the_figure_before_it() {
    let mut app = game("mountain");
    let input = PlayerInput {
        switch_follow: true,
        ..default()
    };
    wish(&mut app, input);
    app.update();
    // What flies a free camera walks the figure.
    let input = PlayerInput {
        fly: Vec3::Z,
        fast: true,
        ..default()
    };
    wish(&mut app, input);
    let before = figure(&mut app).0.now.place;
    for _ in 0..120 {
        app.update();
        let pose = camera(&mut app).pose;
        let (_, transform) = figure(&mut app);
        let to = transform.translation.as_dvec3() + bevy::math::DVec3::Y - pose.position;
        let ahead = (pose.rotation() * Vec3::NEG_Z).as_dvec3();
        assert!(to.length() < 7.0, "{to}");
        assert!(to.normalize().dot(ahead) > 0.8, "{to} {ahead}");
    }
    let walked = figure(&mut app).0.now.place.distance(before);
    assert!(walked > 4.0, "{walked} m");
}

#[test]
fn a_standing_figure_and_a_still_camera_do_not_change() {
    let mut app = game("mountain");
    for _ in 0..200 {
        app.update();
    }
    let (figure_before, camera_before) = (figure(&mut app), camera(&mut app));
    let tick = app.world_mut().change_tick();
    app.update();
    assert_eq!(
        (figure(&mut app), camera(&mut app)),
        (figure_before, camera_before)
    );
    let world = app.world_mut();
    let mut transforms = world.query::<Ref<Transform>>();
    for transform in transforms.iter(world) {
        assert!(
            !transform
                .last_changed()
                .is_newer_than(tick, world.read_change_tick())
        );
    }
}

#[test]
fn the_camera_stays_above_ground_and_sea_and_within_its_pitch() {
    let mut app = game("mountain");
    let terrain = terrain(&mut app);
    let sea = f64::from(terrain.sea_level().expect("the mountain has a sea"));
    let mut numbers = Numbers(3);
    for _ in 0..400 {
        let input = PlayerInput {
            fly: Vec3::new(
                numbers.next() as f32 * 2.0 - 1.0,
                -1.0,
                numbers.next() as f32 * 2.0 - 1.0,
            ),
            fast: numbers.next() < 0.5,
            look: Vec2::new(
                numbers.next() as f32 - 0.5,
                numbers.next() as f32 * 4.0 - 2.0,
            ),
            ..default()
        };
        wish(&mut app, input);
        app.update();
        let pose = camera(&mut app).pose;
        let floor = terrain.height(pose.position.xz()).max(sea);
        assert!(
            pose.position.y >= floor + CLEARANCE,
            "{} under {floor}",
            pose.position.y
        );
        assert!(pose.pitch.abs() <= PITCH_LIMIT);
    }
}

#[test]
fn the_rule_of_detail_goes_round() {
    let mut app = game("mountain");
    let mut bounds = Vec::new();
    for _ in 0..3 {
        let input = PlayerInput {
            switch_metric: true,
            // There is one way to make the triangles here.
            switch_mode: true,
            ..default()
        };
        wish(&mut app, input);
        app.update();
        bounds.push(app.world().resource::<Settings>().max_error);
    }
    assert_eq!(bounds, [None, Some(1.0), None]);
}

#[test]
fn switches_switch_and_switch_back() {
    let mut app = game("mountain");
    let start = Switches::default();
    let input = PlayerInput {
        switch_lines: true,
        switch_fill: true,
        switch_focus: true,
        switch_keys: true,
        switch_shapes: true,
        switch_torch: true,
        switch_follow: true,
        ..default()
    };
    wish(&mut app, input);
    app.update();
    let switched = *app.world().resource::<Switches>();
    assert_eq!(
        switched,
        Switches {
            lines: true,
            fill: false,
            focus: DetailFocus::Figure,
            keys: true,
            shapes: true,
            senses: false,
            follow: true,
            torch: true,
        }
    );
    app.update();
    assert_eq!(*app.world().resource::<Switches>(), start);
}

#[test]
fn settings_shape_the_speed() {
    let mut app = game("jacksboro");
    let distance = |app: &mut App| {
        put(app, DVec2::ZERO);
        let from = figure(app).0.now.place;
        for _ in 0..50 {
            app.update();
        }
        figure(app).0.now.place.distance(from)
    };
    wish(
        &mut app,
        PlayerInput {
            walk: Vec2::Y,
            ..default()
        },
    );
    let slow = distance(&mut app);
    app.world_mut().resource_mut::<Settings>().walk_speed *= 3.0;
    let quick = distance(&mut app);
    // The slope differs along the way; the speed along the surface does not.
    assert!(
        (2.0..4.0).contains(&(quick / slow)),
        "{slow} m, then {quick} m"
    );
}

/// The renderer's answers, made up: the drawn ground lies 5 cm above the true one.
#[test]
fn feet_stand_on_the_drawn_ground_while_it_is_known() {
    let mut app = game("mountain");
    app.update();
    let (_, at_rest) = figure(&mut app);
    let answered = |app: &mut App, lifted: f64, bound: f32| {
        let terrain = terrain(app);
        let mut batch = app.world_mut().resource_mut::<ProbeBatch>();
        let question = batch.question();
        let answers = question.places.iter().map(|place| {
            let truth = terrain.sample_f64(place.to_dvec2());
            ProbeAnswer {
                height: (truth.height + lifted) as f32,
                gradient: [truth.gradient.x as f32, truth.gradient.y as f32],
                bound,
                ..ProbeAnswer::default()
            }
        });
        let answers = answers.collect();
        batch.fill(question, answers).expect("one answer a place");
        app.update();
        f64::from(figure(app).1.translation.y - at_rest.translation.y)
    };
    let lifted = answered(&mut app, 0.05, 0.1);
    assert!((lifted - 0.05).abs() < FEET, "{lifted}");
    for _ in 0..3 {
        app.update();
    }
    let after = figure(&mut app).1.translation.y - at_rest.translation.y;
    assert_eq!(after, 0.0, "the answer is too old");
    let too_far = answered(&mut app, 0.05, 0.04);
    assert_eq!(too_far, 0.0, "farther from the truth than it may be");
}
