//! Games that tests play without a window.

use std::path::{Path, PathBuf};

use bevy::prelude::*;
use dolomite::logic::Health;
use dolomite::logic::random::Random;
use dolomite::logic::senses::Sight;
use dolomite_game::bot::game::Game;
use dolomite_game::bot::{Job, Table};
use dolomite_game::input::PlayerInput;
use dolomite_game::level::begin;
use dolomite_game::level::parts::{Cast, Soldier};
use dolomite_game::play::camera::FreeCamera;

/// The assets of this repository.
pub fn assets() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets")
}

/// A folder for temporary files of a test of this name.
pub fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("dolomite-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for temporary files");
    folder
}

/// Games of a level.
pub fn table(level: &'static str, job: Job) -> Table {
    let job = Job {
        level,
        runs: 1,
        ..job
    };
    Table::new(&job, &assets()).expect("the level is good")
}

/// A game whose soldiers see nobody, so that what is looked at is the rest of it.
pub fn quiet(level: &'static str, seed: u64) -> Game {
    let mut game = table(level, Job::default()).game(seed);
    let world = game.app.world_mut();
    let mut soldiers = world.query_filtered::<Entity, With<Soldier>>();
    for soldier in soldiers.iter(world).collect::<Vec<_>>() {
        world.entity_mut(soldier).remove::<Sight>();
    }
    game
}

/// One who acts.
pub fn act() -> PlayerInput {
    PlayerInput {
        act: true,
        ..default()
    }
}

/// So many steps with one input.
pub fn steps(game: &mut Game, input: PlayerInput, count: u32) {
    for _ in 0..count {
        game.step(input);
    }
}

/// Puts the figure somewhere.
pub fn put(game: &mut Game, place: Vec2, above: f64) {
    begin::put_figure(game.app.world_mut(), place.as_dvec2(), 0.0, above);
}

/// The health of the player.
pub fn health(game: &Game) -> f32 {
    let world = game.app.world();
    let player = world.resource::<Cast>().player;
    world.get::<Health>(player).expect("players have it").now
}

/// Turns the view along a direction, (x, z).
pub fn look(game: &mut Game, way: Vec2) {
    let world = game.app.world_mut();
    for mut camera in world.query::<&mut FreeCamera>().iter_mut(world) {
        camera.pose.yaw = bevy::math::ops::atan2(-way.x, -way.y);
        camera.pose.pitch = 0.0;
    }
}

/// What somebody wild does for a third of a second; who has no crossbow fires in vain.
pub fn wild_input(random: &mut Random) -> PlayerInput {
    PlayerInput {
        walk: Vec2::new(random.signed(1.0), random.signed(1.0)),
        look: Vec2::new(random.signed(0.2), random.signed(0.05)),
        fast: random.below(2) == 1,
        jump: random.below(9) == 0,
        act: random.below(3) == 0,
        fire: random.below(5) == 0,
        switch_torch: random.below(40) == 0,
        ..default()
    }
}

/// One update with an input and one without: what a key does in a menu.
pub fn press(game: &mut Game, input: PlayerInput) {
    *game.app.world_mut().resource_mut::<PlayerInput>() = input;
    game.app.update();
    *game.app.world_mut().resource_mut::<PlayerInput>() = PlayerInput::default();
    game.app.update();
}
