//! The night sky in the game, drawn without a window: what it needs, and that it rests.

use crate::support::adapter;

use bevy::math::UVec2;
use bevy::render::RenderApp;
use dolomite::sky::render::Star;
use dolomite::tessellation::Patches;
use dolomite::tessellation::render::{GeometryCensus, GeometryStats, census};
use dolomite_game::run::Setup;
use dolomite_game::run::offscreen::Offscreen;
use dolomite_game::scene::SceneRequest;
use dolomite_game::settings::Settings;
use std::time::Duration;

/// The mountain, small; `None`, after a line that says so, without Vulkan.
fn game() -> Option<Offscreen> {
    if !adapter::is_there() {
        return None;
    }
    let request = SceneRequest::new("mountain");
    let setup = Setup::load(Settings::default(), request, None).expect("the scene is good");
    Some(Offscreen::new(setup, UVec2::new(128, 72)).expect("a device that was found"))
}

/// What the stage holds, and its counters.
fn found(game: &Offscreen) -> (GeometryCensus, GeometryStats) {
    let world = game.app.world();
    let stats = world.get_resource::<GeometryStats>().cloned();
    (
        census(game.app.sub_app(RenderApp).world()),
        stats.unwrap_or_default(),
    )
}

/// In a module of this name, so that tests which open an adapter run in their group.
mod gpu {
    use super::*;

    #[test]
    fn stars_and_moon_are_there_by_night_alone_and_rest_with_the_camera() {
        let Some(mut game) = game() else { return };
        game.settle().expect("a day");
        let (day, counted) = found(&game);
        let world = game.app.world_mut();
        assert_eq!(world.query::<&Patches<Star>>().iter(world).count(), 0);

        world.resource_mut::<Settings>().sun = Some((300.0, -25.0));
        game.settle().expect("a night");
        let (night, stats) = found(&game);
        assert_eq!(night.kinds, day.kinds + 2, "stars and moon");
        assert!(night.pipelines > day.pipelines, "{night:?}");
        // Four faces of some of the stars are in view.
        let drawn = stats.primitives - counted.primitives;
        assert!((100..24_000).contains(&drawn), "{stats:?}");
        for _ in 0..5 {
            game.step(Duration::ZERO).expect("a frame");
            assert_eq!(found(&game).1.dispatches, 0, "nothing moves");
        }

        game.app.world_mut().resource_mut::<Settings>().sun = None;
        game.settle().expect("a day again");
        let (again, _) = found(&game);
        assert_eq!((again.kinds, again.views), (day.kinds, day.views));
    }
}
