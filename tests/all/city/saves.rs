//! Games that were saved on a roof, and before the open gate.

use super::{above, before_a_soldier, light_all, roof, rounds};
use crate::support::game::{act, folder, health, put, quiet, steps};
use bevy::math::Vec3Swizzles as _;
use bevy::prelude::*;
use dolomite::logic::Lamp;
use dolomite_game::input::PlayerInput;
use dolomite_game::level::parts::{Beacon, Fallen, Level, Numbered};
use dolomite_game::level::save::SAVE;
use dolomite_game::level::sealed::SealedError;
use dolomite_game::level::{Verdict, begin, save, sealed};

#[test]
fn a_game_that_was_saved_on_a_roof_goes_on_there_and_is_whole_or_refused() {
    let mut game = quiet("city", 4);
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
    let folder = folder("city-save");
    let path = folder.join("city.save");
    save::write(&path, &saved).expect("the folder is there");
    let (read, damage) = save::read(&path).expect("it is whole");
    assert!(read == saved && damage.is_none());

    // Into a game that was begun anew: numbers of entities are others.
    let mut other = quiet("city", 9);
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
    let mut game = quiet("city", 5);
    light_all(&mut game, 0);
    assert!(game.state().open);
    let saved = save::take(game.app.world_mut()).expect("a level is played");
    let mut other = quiet("city", 5);
    save::put(other.app.world_mut(), &saved).expect("it is of this level");
    steps(&mut other, PlayerInput::default(), 10);
    assert!(other.state().open);
    let gate = other.app.world().resource::<Level>().built.gate;
    put(&mut other, gate.expect("there is one").beyond.0.xz(), 0.0);
    steps(&mut other, PlayerInput::default(), 10);
    assert_eq!(other.state().verdict, Some(Verdict::Won));
}
