//! The level `city` without a window: the bot wins it, and loses where it must; the gate opens when all burns; games
//! replay to the same hash; what makes no sense is refused.

mod arms;
mod lifts;
mod saves;

use std::process::Command;

use crate::support::game::{
    act, assets, folder, look, press, put, quiet, steps, table, wild_input,
};
use bevy::math::Vec3Swizzles as _;
use bevy::prelude::*;
use dolomite::collision::Blocker;
use dolomite::logic::random::Random;
use dolomite::logic::{Door, Weapon};
use dolomite_game::bot::Job;
use dolomite_game::bot::game::Game;
use dolomite_game::bot::pilot::Pilot;
use dolomite_game::input::PlayerInput;
use dolomite_game::level::gate::Bars;
use dolomite_game::level::lifts::RoofLift;
use dolomite_game::level::menu::{Item, Menu, Screen};
use dolomite_game::level::parts::{
    Beacon, Cast, Fallen, Level, Numbered, Player, Soldier, ground_of,
};
use dolomite_game::level::town::Roof;
use dolomite_game::level::{Verdict, begin, load, menu};
use dolomite_game::play::figure::Figure;
use dolomite_game::scene::{CurrentScene, SceneRequest};
use dolomite_game::settings::paths::AssetsDir;

const TEXT: &str = include_str!("../../assets/levels/city.ron");

fn roof(game: &Game, number: usize) -> Roof {
    let level = game.app.world().resource::<Level>();
    level.built.roofs[number].clone().expect("it is on a roof")
}

/// Height of the figure's feet above the ground, metres.
fn above(game: &mut Game) -> f64 {
    let world = game.app.world_mut();
    let figure = world.query::<&Figure>().single(world);
    figure.expect("there is one figure").now.jump.lift()
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

fn rounds(game: &Game) -> u32 {
    let world = game.app.world();
    let player = world.resource::<Cast>().player;
    let weapon = world.get::<Weapon>(player).expect("the player has one");
    weapon.rounds.expect("they are counted")
}

#[test]
fn the_bot_wins_and_its_input_replays_to_the_same_hash() {
    let table = table("city", Job::default());
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
    let table = table("city", Job::default());
    for seed in [1, 2, 3] {
        let (game, _) = table.play(seed);
        assert_eq!(game.reason, Verdict::Won, "{game:?}");
    }
}

#[test]
fn with_a_circuit_behind_the_wall_no_game_is_won() {
    let table = table(
        "city",
        Job {
            unreachable: true,
            limit: Some(60.0),
            ..Job::default()
        },
    );
    for seed in [1, 2] {
        let (game, _) = table.play(seed);
        assert!(!game.won && game.beacons < 6, "{game:?}");
    }
}

#[test]
fn one_thread_and_two_play_the_same_game() {
    let folder = folder("city-threads");
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
    let mut game = quiet("city", 3);
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
fn what_makes_no_sense_in_a_city_is_refused_with_its_line() {
    let folder = folder("city-wrong");
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
    let mut game = table("city", Job::default()).game(3);
    let mut random = Random::new(7);
    let mut pilot = Pilot::new(3);
    let mut input = PlayerInput::default();
    for step in 0..2 * 3600 {
        // Half of the time the bot plays: it comes to lifts and roofs.
        let plays = step / 600 % 2 == 0;
        if plays {
            input = pilot.decide(game.app.world_mut());
        } else if step % 20 == 0 {
            input = wild_input(&mut random);
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
    let mut game = table("city", Job::default()).game(6);
    game.app.insert_resource(AssetsDir(assets()));
    menu::add(&mut game.app);
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

#[test]
fn a_level_that_cannot_begin_leaves_this_one_as_it_is() {
    let folder = folder("city-other");
    let levels = folder.join("levels");
    std::fs::create_dir_all(&levels).expect("a folder for temporary files");
    let mut game = table("city", Job::default()).game(6);
    game.app.insert_resource(AssetsDir(folder.clone()));
    menu::add(&mut game.app);
    // What soldiers do was broken meanwhile.
    let broken = "(root: \"nothing\", trees: {})";
    std::fs::write(levels.join("soldier.ron"), broken).expect("the folder is there");
    let down = PlayerInput {
        navigate: IVec2::Y,
        ..default()
    };
    let confirm = PlayerInput {
        confirm: true,
        ..default()
    };
    let request = |game: &Game| game.app.world().resource::<SceneRequest>().scene.clone();
    let asked = request(&game);
    for _ in 0..2 {
        press(&mut game, down);
    }
    press(&mut game, confirm);
    let world = game.app.world();
    let note = &world.resource::<Menu>().note;
    assert!(
        note.contains("soldier.ron") && note.contains("nothing"),
        "{note}"
    );
    assert_eq!(world.resource::<Level>().name, "city");
    assert!(world.resource::<CurrentScene>().city.is_some());
    assert_eq!(request(&game), asked);
    std::fs::remove_dir_all(&folder).expect("it was made");
}
