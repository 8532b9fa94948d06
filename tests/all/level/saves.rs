//! Saved games are whole or refused.

use std::f32::consts::TAU;

use super::played;
use crate::support::game::{folder, press, table};
use bevy::prelude::*;
use dolomite::logic::{Health, Lamp};
use dolomite_game::bot::Job;
use dolomite_game::bot::game::Game;
use dolomite_game::input::PlayerInput;
use dolomite_game::level::menu::{Menu, SaveTo, Screen};
use dolomite_game::level::parts::{Beacon, Cast};
use dolomite_game::level::save::{SAVE, SaveError};
use dolomite_game::level::sealed::SealedError;
use dolomite_game::level::{menu, save, sealed};
use dolomite_game::play::figure::Figure;

/// Lights one beacon.
fn light(game: &mut Game) {
    let world = game.app.world_mut();
    let lamp = world
        .query::<(Entity, &Beacon)>()
        .iter(world)
        .find(|(_, beacon)| beacon.name == "Shepherd's Knoll")
        .expect("it is in the file")
        .0;
    world.get_mut::<Lamp>(lamp).expect("beacons have lamps").lit = true;
}

#[test]
fn a_saved_game_goes_on_where_it_was_and_is_whole_or_refused() {
    let mut game = played(20);
    light(&mut game);
    let saved = save::take(game.app.world_mut()).expect("a level is played");
    assert_eq!(saved.beacons, [true, false, false, false]);
    assert!((saved.passed - 20.0).abs() < 0.1, "{}", saved.passed);
    let folder = folder("mountain-save");
    let path = folder.join("mountain.save");
    save::write(&path, &saved).expect("the folder is there");
    let (read, damage) = save::read(&path).expect("it is whole");
    assert!(read == saved && damage.is_none());

    // Into a game that has gone elsewhere.
    let mut other = played(3);
    save::put(other.app.world_mut(), &read).expect("it is of this level");
    let mut again = save::take(other.app.world_mut()).expect("a level is played");
    for (soldier, before) in again.soldiers.iter_mut().zip(&saved.soldiers) {
        // A turn becomes a quaternion, of two roundings, and a turn again.
        let (yaw, was) = (&mut soldier.place.2, before.place.2);
        assert!((*yaw - was).abs() < 1e-3, "{yaw} {was}");
        *yaw = was;
    }
    assert_eq!(again, saved);
    for _ in 0..120 {
        other.step(PlayerInput::default());
    }
    let state = other.state();
    assert!(state.lit == 1 && state.verdict.is_none(), "{state:?}");
    let world = other.app.world_mut();
    for (beacon, lamp) in world.query::<(&Beacon, &Lamp)>().iter(world) {
        assert_eq!(lamp.lit, beacon.name == "Shepherd's Knoll", "{beacon:?}");
    }

    // Another level's, and what nobody could have saved.
    for (change, word) in [
        (
            Box::new(|s: &mut save::Saved| s.level = "harbour".into())
                as Box<dyn Fn(&mut save::Saved)>,
            "harbour",
        ),
        (Box::new(|s| s.soldiers.truncate(6)), "6 patrols"),
        (Box::new(|s| s.health = -3.0), "health"),
        (Box::new(|s| s.health = 0.0), "health"),
        (Box::new(|s| s.soldiers[0].place.0 = f32::NAN), "soldier"),
        (Box::new(|s| s.figure.0 = f64::INFINITY), "figure"),
        (Box::new(|s| s.soldiers[2].next = 99), "next"),
    ] {
        let mut wrong = saved.clone();
        change(&mut wrong);
        let before = save::take(other.app.world_mut());
        let error = save::put(other.app.world_mut(), &wrong)
            .expect_err(word)
            .to_string();
        assert!(error.contains(word), "{error}");
        assert_eq!(
            save::take(other.app.world_mut()),
            before,
            "nothing has changed"
        );
    }

    // Cut at any byte it is refused, and the one before is read.
    save::write(&path, &read).expect("the folder is there");
    let whole = std::fs::read(&path).expect("it was written");
    for cut in 0..whole.len() {
        let error = sealed::open(SAVE, &whole[..cut], &path).expect_err("it is cut");
        assert!(
            matches!(error, SealedError::Length { .. }),
            "{cut}: {error}"
        );
    }
    std::fs::write(&path, &whole[..whole.len() / 2]).expect("the folder is there");
    let (last, damage) = save::read(&path).expect("the one before is whole");
    assert!(last == saved && damage.is_some());
    std::fs::remove_file(sealed::before(&path)).expect("it was kept");
    assert!(matches!(
        save::read(&path),
        Err(SaveError::File(SealedError::Length { .. }))
    ));
    std::fs::remove_dir_all(&folder).expect("it was made");
}

#[test]
fn what_is_loaded_is_not_saved_again_and_damage_is_said() {
    let mut game = played(20);
    light(&mut game);
    let saved = save::take(game.app.world_mut()).expect("a level is played");
    let folder = folder("mountain-damage");
    let path = folder.join("mountain.save");
    for _ in 0..2 {
        save::write(&path, &saved).expect("the folder is there");
    }
    let whole = std::fs::read(&path).expect("it was written");
    std::fs::write(&path, &whole[..whole.len() - 9]).expect("the folder is there");
    let mut game = table("mountain", Job::default()).game(1);
    game.app.insert_resource(SaveTo(path.clone()));
    menu::add(&mut game.app);
    let (down, confirm) = (
        PlayerInput {
            navigate: IVec2::Y,
            ..default()
        },
        PlayerInput {
            confirm: true,
            ..default()
        },
    );
    press(&mut game, down);
    press(&mut game, confirm);
    for _ in 0..10 {
        press(&mut game, PlayerInput::default());
    }
    let menu = game.app.world().resource::<Menu>();
    assert_eq!(menu.screen, Screen::Play);
    assert!(menu.note.contains("damaged"), "{}", menu.note);
    assert!(game.state().lit == 1 && game.state().steps > 0);
    let kept = std::fs::read(sealed::before(&path)).expect("it is kept");
    assert_eq!(kept, whole, "the last whole one is as it was");
    std::fs::remove_dir_all(&folder).expect("it was made");
}

#[test]
fn who_turned_about_for_hours_is_saved_and_the_dead_are_not() {
    let mut game = played(1);
    let world = game.app.world_mut();
    for mut figure in world.query::<&mut Figure>().iter_mut(world) {
        figure.now.yaw = -2e4;
    }
    let saved = save::take(world).expect("a level is played");
    let yaw = saved.figure.2;
    assert!((0.0..=TAU).contains(&yaw), "{yaw}");
    save::put(world, &saved).expect("it is our own");
    let player = world.resource::<Cast>().player;
    let mut health = world.get_mut::<Health>(player);
    health.as_mut().expect("players have it").now = 0.0;
    assert_eq!(save::take(world), None);
}
