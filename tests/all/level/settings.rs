//! What is chosen in the menu is kept, and nothing else.

use crate::support::game::{folder, press, table};
use bevy::prelude::*;
use dolomite_game::bot::Job;
use dolomite_game::input::PlayerInput;
use dolomite_game::level::menu::{self, Menu, Screen};
use dolomite_game::settings::choices::KeepTo;

#[test]
fn who_looks_at_the_settings_and_chooses_nothing_keeps_nothing() {
    let folder = folder("mountain-settings");
    let path = folder.join("menu.ron");
    let mut game = table("mountain", Job::default()).game(1);
    game.app.insert_resource(KeepTo(path.clone()));
    menu::add(&mut game.app);
    let steer = |(x, y): (i32, i32)| PlayerInput {
        navigate: IVec2::new(x, y),
        ..default()
    };
    let confirm = PlayerInput {
        confirm: true,
        ..default()
    };
    let key = PlayerInput {
        menu: true,
        ..default()
    };
    // In and out; a switch there and back again; a choice.
    let visits: [(&[(i32, i32)], bool); 3] = [
        (&[], false),
        (&[(0, 1), (1, 0), (1, 0)], false),
        (&[(1, 0)], true),
    ];
    for (ways, kept) in visits {
        for _ in 0..3 {
            press(&mut game, steer((0, 1)));
        }
        press(&mut game, confirm);
        let screen = |game: &bevy::app::App| game.world().resource::<Menu>().screen;
        assert_eq!(screen(&game.app), Screen::Settings);
        for way in ways {
            press(&mut game, steer(*way));
        }
        press(&mut game, key);
        assert_eq!(screen(&game.app), Screen::Title);
        assert_eq!(path.exists(), kept, "{ways:?}");
    }
    std::fs::remove_dir_all(&folder).expect("it was made");
}
