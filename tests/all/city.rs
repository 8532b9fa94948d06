//! The level `city` without a window: the bot wins it, and loses where it must; lifts carry, falls hurt, bolts hit, the
//! gate opens when all burns; games replay to the same hash; saved games are whole or refused.

use std::path::{Path, PathBuf};
use std::process::Command;

use bevy::math::{DVec2, Vec3Swizzles as _};
use bevy::prelude::*;
use dolomite::collision::Blocker;
use dolomite::logic::parts::{Lift, LiftState};
use dolomite::logic::random::Random;
use dolomite::logic::senses::Sight;
use dolomite::logic::{Action, Button, Door, Health, Key, Lamp, Weapon};
use dolomite_game::bot::game::Game;
use dolomite_game::bot::pilot::Pilot;
use dolomite_game::bot::{Job, Table};
use dolomite_game::input::PlayerInput;
use dolomite_game::level::begin;
use dolomite_game::level::gate::Bars;
use dolomite_game::level::lifts::{Panel, RoofLift};
use dolomite_game::level::menu::{self, Item, Menu, Screen};
use dolomite_game::level::parts::{
    Beacon, Cast, Fallen, Level, Numbered, Player, Soldier, ground_of,
};
use dolomite_game::level::save::{self, SAVE};
use dolomite_game::level::sealed::{self, SealedError};
use dolomite_game::level::town::{PLATE, Roof};
use dolomite_game::level::{Verdict, load};
use dolomite_game::play::camera::FreeCamera;
use dolomite_game::play::figure::Figure;
use dolomite_game::settings::paths::AssetsDir;

const TEXT: &str = include_str!("../../assets/levels/city.ron");

fn assets() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets")
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("dolomite-city-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for temporary files");
    folder
}

fn table(job: Job) -> Table {
    let job = Job {
        level: "city",
        runs: 1,
        ..job
    };
    Table::new(&job, &assets()).expect("the level is good")
}

/// A game whose soldiers see nobody, so that what is looked at is the rest of it.
fn quiet(seed: u64) -> Game {
    let mut game = table(Job::default()).game(seed);
    let world = game.app.world_mut();
    let soldiers = world.query_filtered::<Entity, With<Soldier>>();
    let mut soldiers = soldiers;
    for soldier in soldiers.iter(world).collect::<Vec<_>>() {
        world.entity_mut(soldier).remove::<Sight>();
    }
    game
}

fn act() -> PlayerInput {
    PlayerInput {
        act: true,
        ..default()
    }
}

fn steps(game: &mut Game, input: PlayerInput, count: u32) {
    for _ in 0..count {
        game.step(input);
    }
}

fn roof(game: &Game, number: usize) -> Roof {
    let level = game.app.world().resource::<Level>();
    level.built.roofs[number].clone().expect("it is on a roof")
}

fn lift(game: &mut Game, number: u32) -> Lift {
    let world = game.app.world_mut();
    let mut lifts = world.query_filtered::<(&Numbered, &Lift), With<RoofLift>>();
    let mut found = lifts.iter(world).filter(|(own, _)| own.0 == number);
    found.next().expect("it has a lift").1.clone()
}

/// Height of the figure's feet above the ground, metres.
fn above(game: &mut Game) -> f64 {
    let world = game.app.world_mut();
    let figure = world.query::<&Figure>().single(world);
    figure.expect("there is one figure").now.jump.lift()
}

fn put(game: &mut Game, place: Vec2, above: f64) {
    begin::put_figure(game.app.world_mut(), place.as_dvec2(), 0.0, above);
}

fn health(game: &Game) -> f32 {
    let world = game.app.world();
    let player = world.resource::<Cast>().player;
    world.get::<Health>(player).expect("players have it").now
}

/// Turns the view along a direction, (x, z).
fn look(game: &mut Game, way: Vec2) {
    let world = game.app.world_mut();
    for mut camera in world.query::<&mut FreeCamera>().iter_mut(world) {
        camera.pose.yaw = bevy::math::ops::atan2(-way.x, -way.y);
        camera.pose.pitch = 0.0;
    }
}

#[test]
fn the_bot_wins_and_its_input_replays_to_the_same_hash() {
    let table = table(Job::default());
    let (game, record) = table.play(11);
    assert_eq!(game.reason, Verdict::Won, "{game:?}");
    assert_eq!(game.beacons, 6);
    assert_eq!(record.inputs.len() as u64, game.steps);
    let again = table.replay(&record);
    assert_eq!(again, game);
    // Another input is another game.
    let mut other = record;
    for input in other.inputs.iter_mut().skip(200).take(30) {
        input.walk = -input.walk;
    }
    assert_ne!(table.replay(&other).hash, game.hash);
}

#[test]
fn the_bot_wins_other_seeds_too() {
    let table = table(Job::default());
    for seed in [1, 2, 3] {
        let (game, _) = table.play(seed);
        assert_eq!(game.reason, Verdict::Won, "{game:?}");
    }
}

#[test]
fn with_a_circuit_behind_the_wall_no_game_is_won() {
    let table = table(Job {
        unreachable: true,
        limit: Some(60.0),
        ..Job::default()
    });
    for seed in [1, 2] {
        let (game, _) = table.play(seed);
        assert!(!game.won && game.beacons < 6, "{game:?}");
    }
}

#[test]
fn one_thread_and_two_play_the_same_game() {
    let folder = folder("threads");
    let file = folder.join("game.play");
    let dolomite = || Command::new(env!("CARGO_BIN_EXE_dolomite"));
    let limit = ["--limit", "20"];
    let played = dolomite()
        .args(["bot", "--level", "city", "--seed", "5", "--record"])
        .arg(&file)
        .args(limit)
        .output()
        .expect("the command runs");
    assert!(played.status.success(), "{played:?}");
    let replayed = dolomite()
        .args(["bot", "--replay"])
        .arg(&file)
        .args(limit)
        .output()
        .expect("the command runs");
    let said = String::from_utf8_lossy(&replayed.stdout);
    assert!(
        replayed.status.success() && said.contains("the same"),
        "{replayed:?}"
    );
    std::fs::remove_dir_all(&folder).expect("it was made");
}

#[test]
fn a_lift_is_called_ridden_and_sent_away() {
    let mut game = quiet(1);
    let roof = roof(&game, 0);
    put(&mut game, roof.shaft, 0.5);
    steps(&mut game, PlayerInput::default(), 60);
    assert!(
        (above(&mut game) - 0.05).abs() < 0.03,
        "it stands on the plate"
    );
    let world = game.app.world();
    let button = game.state().button.expect("the button of the plate");
    assert_eq!(world.get::<Panel>(button), Some(&Panel::Rides));
    // Held for long it is pressed once.
    let mut highest = 0.0_f64;
    for step in 0..20 * 60 {
        game.step(if step < 90 {
            act()
        } else {
            PlayerInput::default()
        });
        highest = highest.max(above(&mut game));
    }
    let world = game.app.world_mut();
    let presses = world.get::<Button>(button).expect("it is there").presses;
    assert_eq!(presses, 1);
    let top = f64::from(roof.floors[1] - roof.floors[0]) + 0.05;
    assert!(
        (above(&mut game) - top).abs() < 0.05,
        "{}",
        above(&mut game)
    );
    assert!(
        highest < top + 0.05,
        "{highest}: it is carried, and not thrown"
    );
    // Over the bridge, without a fall.
    look(&mut game, -roof.out);
    let north = PlayerInput {
        walk: Vec2::Y,
        ..default()
    };
    for _ in 0..4 * 60 {
        game.step(north);
        assert!(above(&mut game) > top - 0.1, "it fell");
    }
    let player = game.app.world().resource::<Cast>().player;
    let at = game.app.world().get::<Transform>(player).expect("it is");
    let place = ground_of(at);
    assert!(place.distance(roof.middle()) < 4.5, "{place} on the roof");
    // The parapet holds whoever runs against it.
    for (way, count) in [(roof.along(), 180), (-roof.along(), 300), (-roof.out, 180)] {
        look(&mut game, way);
        steps(
            &mut game,
            PlayerInput {
                fast: true,
                jump: count % 7 == 0,
                ..north
            },
            count,
        );
        assert!(above(&mut game) > top - 0.1, "over the parapet");
    }
    // From below it is called down, and comes.
    put(&mut game, roof.before(), 0.0);
    steps(&mut game, PlayerInput::default(), 5);
    let button = game.state().button.expect("the button on the street");
    assert_eq!(game.app.world().get::<Panel>(button), Some(&Panel::Calls));
    steps(&mut game, act(), 1);
    steps(&mut game, PlayerInput::default(), 20 * 60);
    let lift = lift(&mut game, 0);
    assert_eq!(lift.state(), LiftState::Idle);
    assert!((lift.height() + PLATE.y - roof.floors[0]).abs() < 1e-3);
    assert!((health(&game) - 100.0).abs() < 1e-3, "nobody was hurt");
}

#[test]
fn who_stands_below_a_lift_that_comes_down_stays_on_the_ground() {
    let mut game = quiet(1);
    let roof = roof(&game, 0);
    let world = game.app.world_mut();
    let mut lifts = world.query_filtered::<(&Numbered, Entity), With<RoofLift>>();
    let (_, entity) = lifts
        .iter(world)
        .find(|(number, _)| number.0 == 0)
        .expect("it has a lift");
    world.write_message(Action::new(entity, Key::CALL, 1));
    steps(&mut game, PlayerInput::default(), 20 * 60);
    put(&mut game, roof.shaft, 0.0);
    game.app
        .world_mut()
        .write_message(Action::new(entity, Key::CALL, 0));
    for _ in 0..20 * 60 {
        game.step(PlayerInput::default());
        let above = above(&mut game);
        assert!((0.0..0.5).contains(&above), "{above}");
        let world = game.app.world_mut();
        let figure = world.query::<&Figure>().single(world);
        let place = figure.expect("there is one figure").now.place;
        assert!(place.is_finite() && place.distance(roof.shaft.as_dvec2()) < 3.0);
    }
    // And walks away from there.
    look(&mut game, roof.out);
    let north = PlayerInput {
        walk: Vec2::Y,
        ..default()
    };
    steps(&mut game, north, 180);
    let world = game.app.world_mut();
    let figure = world.query::<&Figure>().single(world);
    let place = figure.expect("there is one figure").now.place.as_vec2();
    assert!(place.distance(roof.shaft) > 2.0, "{place}");
}

#[test]
fn a_fall_from_a_roof_hurts_and_a_leap_does_not() {
    let mut game = quiet(1);
    let jump = PlayerInput {
        jump: true,
        ..default()
    };
    game.step(jump);
    steps(&mut game, PlayerInput::default(), 120);
    assert_eq!(health(&game), 100.0);
    let place = DVec2::new(50.0, -78.0).as_vec2();
    // From h metres one lands at sqrt(2 g h): 8.86 m/s from 4 m, which takes (8.86 - 7) · 18 = 33.
    put(&mut game, place, 4.0);
    steps(&mut game, PlayerInput::default(), 60);
    let hurt = 100.0 - health(&game);
    // It lands within a step, in which speed grows by 9.81 / 60 m/s, which take 2.9; the rest is rounding.
    assert!((hurt - 33.4).abs() < 3.1, "{hurt}");
    put(&mut game, place, 14.0);
    steps(&mut game, PlayerInput::default(), 150);
    assert_eq!(game.state().verdict, Some(Verdict::Fell));
}

/// Puts a soldier so many metres ahead of the player, who looks there; nobody sees.
fn before_a_soldier(game: &mut Game, far: f32) -> Entity {
    let place = Vec2::new(0.0, 48.0);
    put(game, place, 0.0);
    let world = game.app.world_mut();
    let mut soldiers = world.query_filtered::<(&Numbered, Entity), With<Soldier>>();
    let (_, soldier) = soldiers.iter(world).min().expect("there are soldiers");
    let mut at = world
        .get_mut::<Transform>(soldier)
        .expect("it is somewhere");
    at.translation.x = place.x;
    at.translation.z = place.y - far;
    look(game, Vec2::NEG_Y);
    soldier
}

#[test]
fn two_bolts_fell_a_soldier_and_there_are_twelve() {
    let mut game = quiet(2);
    let soldier = before_a_soldier(&mut game, 12.0);
    let fire = PlayerInput {
        fire: true,
        ..default()
    };
    let mut shots = 0;
    for _ in 0..5 * 60 {
        game.step(fire);
        shots = shots.max(12 - rounds(&game));
        if game.app.world().get::<Fallen>(soldier).is_some() {
            break;
        }
    }
    assert!(game.app.world().get::<Fallen>(soldier).is_some());
    // Who is hit turns and walks: a third bolt may be needed.
    assert!((2..=4).contains(&shots), "{shots}");
    assert_eq!(game.state().fallen, 1);
    let place = |game: &Game| {
        let at = game.app.world().get::<Transform>(soldier);
        at.expect("it lies there").translation
    };
    let fell = place(&game);
    steps(&mut game, fire, 20 * 60);
    assert_eq!(place(&game), fell, "who fell goes nowhere");
    assert_eq!(rounds(&game), 0);
    // Shots are heard, and others may have come and been hit; nobody falls twice.
    let world = game.app.world_mut();
    let lying = world.query::<&Fallen>().iter(world).count();
    assert_eq!(game.state().fallen as usize, lying);
}

fn rounds(game: &Game) -> u32 {
    let world = game.app.world();
    let player = world.resource::<Cast>().player;
    let weapon = world.get::<Weapon>(player).expect("the player has one");
    weapon.rounds.expect("they are counted")
}

#[test]
fn no_bolt_passes_a_house() {
    let mut game = quiet(2);
    let soldier = before_a_soldier(&mut game, 12.0);
    // On the other side of the block: houses stand between.
    let world = game.app.world_mut();
    let mut at = world
        .get_mut::<Transform>(soldier)
        .expect("it is somewhere");
    (at.translation.x, at.translation.z) = (32.0, 44.0);
    begin::put_figure(world, DVec2::new(0.5, 44.0), 0.0, 0.0);
    look(&mut game, Vec2::X);
    let fire = PlayerInput {
        fire: true,
        ..default()
    };
    for _ in 0..10 {
        // It stays there.
        let world = game.app.world_mut();
        let mut at = world
            .get_mut::<Transform>(soldier)
            .expect("it is somewhere");
        (at.translation.x, at.translation.z) = (32.0, 44.0);
        steps(&mut game, fire, 30);
    }
    assert!(rounds(&game) < 12, "it shot");
    let health = game.app.world().get::<Health>(soldier).expect("it lives");
    assert_eq!(health.part(), 1.0);
}

fn light_all(game: &mut Game, but: usize) {
    let world = game.app.world_mut();
    let mut beacons = world.query_filtered::<(&Numbered, &Transform), With<Beacon>>();
    let mut all: Vec<_> = beacons.iter(world).map(|(n, at)| (*n, *at)).collect();
    all.sort_by_key(|(number, _)| *number);
    let ground = world.resource::<Level>().grid.height(Vec2::ZERO);
    let count = all.len() - but;
    for (_, at) in all.into_iter().take(count) {
        let above = f64::from(at.translation.y - ground);
        let beside = at.translation.xz() + Vec2::new(0.9, 0.0);
        put(game, beside, above + 0.05);
        steps(game, PlayerInput::default(), 30);
        steps(game, act(), 150);
    }
}

#[test]
fn the_gate_opens_when_all_burns_and_beyond_it_is_won() {
    let mut game = quiet(3);
    let gate = game.app.world().resource::<Level>().built.gate;
    let gate = gate.expect("there is one");
    light_all(&mut game, 1);
    assert_eq!(game.state().lit, 5);
    let door = |game: &mut Game| {
        let world = game.app.world_mut();
        *world
            .query_filtered::<&Door, With<Bars>>()
            .single(world)
            .expect("there is one gate")
    };
    let inside = gate.closed.xz() + Vec2::new(0.0, -3.0);
    let south = PlayerInput {
        walk: Vec2::Y,
        fast: true,
        ..default()
    };
    put(&mut game, inside, 0.0);
    look(&mut game, Vec2::Y);
    steps(&mut game, south, 240);
    let at = |game: &Game| {
        let world = game.app.world();
        let player = world.resource::<Cast>().player;
        ground_of(world.get::<Transform>(player).expect("it is somewhere"))
    };
    assert!(at(&game).y < gate.closed.z, "it is closed: {}", at(&game));
    assert_eq!(door(&mut game).open, 0.0);
    assert!(!game.state().open);
    // Beyond it nothing is won as long as a circuit is dark.
    put(&mut game, gate.beyond.0.xz(), 0.0);
    steps(&mut game, PlayerInput::default(), 60);
    assert_eq!(game.state().verdict, None);
    light_all(&mut game, 0);
    assert!(game.state().open);
    put(&mut game, inside, 0.0);
    steps(&mut game, PlayerInput::default(), 5 * 60);
    assert_eq!(door(&mut game).open, 1.0);
    assert_eq!(game.state().verdict, None);
    look(&mut game, Vec2::Y);
    steps(&mut game, south, 240);
    assert_eq!(game.state().verdict, Some(Verdict::Won));
}

#[test]
fn a_game_that_was_saved_on_a_roof_goes_on_there_and_is_whole_or_refused() {
    let mut game = quiet(4);
    let roof = roof(&game, 1);
    light_all(&mut game, 4);
    let soldier = before_a_soldier(&mut game, 12.0);
    let fire = PlayerInput {
        fire: true,
        ..default()
    };
    for _ in 0..6 * 60 {
        game.step(fire);
        if game.app.world().get::<Fallen>(soldier).is_some() {
            break;
        }
    }
    // On the way up.
    put(&mut game, roof.shaft, 0.3);
    steps(&mut game, PlayerInput::default(), 30);
    steps(&mut game, act(), 1);
    steps(&mut game, PlayerInput::default(), 180);
    let state = game.state();
    assert!(state.lit == 2 && state.fallen == 1, "{state:?}");
    let saved = save::take(game.app.world_mut()).expect("a level is played");
    assert_eq!(saved.beacons, [true, true, false, false, false, false]);
    assert_eq!(saved.lifts, [0, 1, 0]);
    assert_eq!(saved.soldiers[0].health, 0.0);
    assert_eq!(saved.rounds, Some(rounds(&game)));
    let folder = folder("save");
    let path = folder.join("city.save");
    save::write(&path, &saved).expect("the folder is there");
    let (read, damage) = save::read(&path).expect("it is whole");
    assert!(read == saved && damage.is_none());

    // Into a game that was begun anew: numbers of entities are others.
    let mut other = quiet(9);
    begin::begin(other.app.world_mut()).expect("the level is good");
    save::put(other.app.world_mut(), &read).expect("it is of this level");
    steps(&mut other, PlayerInput::default(), 90);
    let state = other.state();
    assert!(state.lit == 2 && state.fallen == 1, "{state:?}");
    let world = other.app.world_mut();
    let mut lit: Vec<_> = world
        .query::<(&Beacon, &Lamp)>()
        .iter(world)
        .filter(|(_, lamp)| lamp.lit)
        .map(|(beacon, _)| beacon.name.clone())
        .collect();
    lit.sort();
    assert_eq!(lit, ["East Row", "Mill Lane"]);
    let fallen = world.query_filtered::<&Numbered, With<Fallen>>();
    let mut fallen = fallen;
    assert_eq!(fallen.single(world).expect("one fell").0, 0);
    assert_eq!(rounds(&other), read.rounds.expect("they are counted"));
    let top = f64::from(roof.floors[1] - roof.floors[0]) + 0.05;
    let feet = above(&mut other);
    assert!(
        (feet - top).abs() < 0.05,
        "{feet}: who rode is on the plate above"
    );
    assert_eq!(health(&other), 100.0, "and did not fall");

    // What nobody could have saved.
    for (change, word) in [
        (
            Box::new(|s: &mut save::Saved| s.lifts.truncate(2)) as Box<dyn Fn(&mut save::Saved)>,
            "2 lifts",
        ),
        (Box::new(|s| s.lifts[0] = 7), "lift"),
        (Box::new(|s| s.rounds = Some(13)), "rounds"),
        (Box::new(|s| s.above = f64::NAN), "above"),
        (Box::new(|s| s.soldiers[1].health = 1.5), "health"),
        (Box::new(|s| s.level = "mountain".into()), "mountain"),
    ] {
        let mut wrong = saved.clone();
        change(&mut wrong);
        let before = save::take(other.app.world_mut());
        let error = save::put(other.app.world_mut(), &wrong)
            .expect_err(word)
            .to_string();
        assert!(error.contains(word), "{error}");
        assert_eq!(save::take(other.app.world_mut()), before, "nothing changed");
    }

    // Cut at any byte it is refused.
    let whole = std::fs::read(&path).expect("it was written");
    for cut in 0..whole.len() {
        let error = sealed::open(SAVE, &whole[..cut], &path).expect_err("it is cut");
        assert!(
            matches!(error, SealedError::Length { .. }),
            "{cut}: {error}"
        );
    }
    std::fs::remove_dir_all(&folder).expect("it was made");
}

#[test]
fn a_game_that_was_saved_before_the_open_gate_is_won_beyond_it() {
    let mut game = quiet(5);
    light_all(&mut game, 0);
    assert!(game.state().open);
    let saved = save::take(game.app.world_mut()).expect("a level is played");
    let mut other = quiet(5);
    save::put(other.app.world_mut(), &saved).expect("it is of this level");
    steps(&mut other, PlayerInput::default(), 10);
    assert!(other.state().open);
    let gate = other.app.world().resource::<Level>().built.gate;
    put(&mut other, gate.expect("there is one").beyond.0.xz(), 0.0);
    steps(&mut other, PlayerInput::default(), 10);
    assert_eq!(other.state().verdict, Some(Verdict::Won));
}

#[test]
fn what_makes_no_sense_in_a_city_is_refused_with_its_line() {
    let folder = folder("wrong");
    let levels = folder.join("levels");
    std::fs::create_dir_all(&levels).expect("a folder for temporary files");
    let at = "\"Mill Lane\", at: (-20.6, -43.4), lift: West";
    for (from, to, needle, word) in [
        (
            at,
            "\"Mill Lane\", at: (0.0, 0.0), lift: West",
            "Mill Lane",
            "no house",
        ),
        (
            at,
            "\"Mill Lane\", at: (-11.1, -43.7), lift: West",
            "Mill Lane",
            "no street",
        ),
        (
            at,
            "\"Mill Lane\", at: (-20.6, -43.4)",
            "Mill Lane",
            "nobody can come",
        ),
        ("side: 256.0", "side: 1400.0", "area:", "beyond the city"),
        ("along: -64.0", "along: -127.0", "along:", "`along`"),
        ("bolt: 60.0", "bolt: NaN", "bolt: 60", "`weapon.bolt`"),
        ("falls: 18.0", "falls: -1.0", "falls: 18", "`falls`"),
        ("bears: 100.0", "bears: 0.0", "bears:", "`bears`"),
        (
            "scene: \"city\"",
            "scene: \"mountain\"",
            "gate:",
            "needs a scene with a city",
        ),
    ] {
        assert!(TEXT.contains(from), "{from}");
        let line = TEXT.lines().position(|line| {
            line.split("//")
                .next()
                .is_some_and(|code| code.contains(needle))
        });
        let place = format!("city.ron:{}:", line.expect(needle) + 1);
        let text = TEXT.replacen(from, to, 1);
        std::fs::write(levels.join("city.ron"), &text).expect("the folder is there");
        let error = load::load("city", 1, &folder).err().expect(to).to_string();
        assert!(
            error.contains(&place) && error.contains(word),
            "{to}: {error}"
        );
    }
    std::fs::remove_dir_all(&folder).expect("it was made");
}

#[test]
fn minutes_of_wild_input_break_nothing() {
    let mut game = table(Job::default()).game(3);
    let mut random = Random::new(7);
    let mut pilot = Pilot::new(3);
    let mut input = PlayerInput::default();
    for step in 0..2 * 3600 {
        // Half of the time the bot plays: it comes to lifts and roofs.
        let plays = step / 600 % 2 == 0;
        if plays {
            input = pilot.decide(game.app.world_mut());
        } else if step % 20 == 0 {
            input = PlayerInput {
                walk: Vec2::new(random.signed(1.0), random.signed(1.0)),
                look: Vec2::new(random.signed(0.2), random.signed(0.05)),
                fast: random.below(2) == 1,
                jump: random.below(9) == 0,
                act: random.below(3) == 0,
                fire: random.below(5) == 0,
                switch_torch: random.below(40) == 0,
                ..default()
            };
        }
        game.step(input);
        if step % 60 != 0 {
            continue;
        }
        let world = game.app.world_mut();
        for at in world.query::<&Transform>().iter(world) {
            assert!(at.is_finite(), "step {step}: {at:?}");
        }
        let level = world.resource::<Level>().clone();
        let mut soldiers = world.query_filtered::<&Transform, (With<Soldier>, Without<Fallen>)>();
        for at in soldiers.iter(world) {
            let place = ground_of(at);
            assert!(level.grid.is_open(place), "step {step}: one at {place}");
        }
        // Nobody is inside of a house or a wall.
        let player = world.resource::<Cast>().player;
        let at = world.get::<Transform>(player).expect("it is somewhere");
        let middle = at.translation;
        let inside = |low: Vec3, high: Vec3| low.cmplt(middle).all() && middle.cmplt(high).all();
        for [low, high] in &level.built.hides[1..] {
            assert!(
                !inside(*low, *high),
                "step {step}: {middle} in {low}..{high}"
            );
        }
        if game.state().verdict.is_some() {
            begin::begin(game.app.world_mut()).expect("the level is good");
        }
    }
    let world = game.app.world_mut();
    let walls = world.query::<&Blocker>().iter(world).count();
    assert!(walls > 10);
    assert_eq!(world.query::<&Player>().iter(world).count(), 1);
}

#[test]
fn the_menu_leads_from_one_level_to_the_other_and_back() {
    let mut game = table(Job::default()).game(6);
    game.app.insert_resource(AssetsDir(assets()));
    menu::add(&mut game.app);
    let press = |game: &mut Game, input: PlayerInput| {
        *game.app.world_mut().resource_mut::<PlayerInput>() = input;
        game.app.update();
        *game.app.world_mut().resource_mut::<PlayerInput>() = PlayerInput::default();
        game.app.update();
    };
    let confirm = PlayerInput {
        confirm: true,
        ..default()
    };
    let down = PlayerInput {
        navigate: IVec2::Y,
        ..default()
    };
    for name in ["mountain", "city"] {
        while game.app.world().resource::<Menu>().items()
            [game.app.world().resource::<Menu>().chosen]
            != Item::Other
        {
            press(&mut game, down);
        }
        press(&mut game, confirm);
        let world = game.app.world_mut();
        let level = world.resource::<Level>().clone();
        assert_eq!((level.name, level.seed), (name, 6));
        let menu = world.resource::<Menu>();
        assert_eq!((menu.screen, menu.note.as_str()), (Screen::Title, ""));
        let beacons = world.query::<&Beacon>().iter(world).count();
        assert_eq!(beacons, level.file.beacons.len());
        // The figure stands at its start, on its ground.
        let figure = world.query::<&Figure>().single(world);
        let place = figure.expect("there is one figure").now.place.as_vec2();
        let start = Vec2::new(level.file.start.0, level.file.start.1);
        assert!(place.distance(start) < 1.0, "{place}");
        let lifts = world.query::<&RoofLift>().iter(world).count();
        assert_eq!(lifts, if name == "city" { 3 } else { 0 });
    }
}
