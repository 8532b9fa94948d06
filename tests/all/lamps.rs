//! Lamps and a torch in the game, lit by both renderers, without a window.

use crate::support::adapter;

use bevy::math::UVec2;
use dolomite::deferred::DeferredStats;
use dolomite_game::input::PlayerInput;
use dolomite_game::run::Setup;
use dolomite_game::run::offscreen::{Offscreen, STEP};
use dolomite_game::scene::SceneRequest;
use dolomite_game::settings::quality::Occlusion;
use dolomite_game::settings::{Renderer, Settings};

/// Few lamps around the camera, small; `None`, after a line that says so, without Vulkan.
fn game(lights: u32) -> Option<Offscreen> {
    if !adapter::is_there() {
        return None;
    }
    let request = SceneRequest {
        lights: Some(lights),
        ..SceneRequest::new("night")
    };
    let settings = Settings {
        renderer: Renderer::Bevy,
        // Bevy's pass has none of it.
        occlusion: Some(Occlusion::Off),
        ..Settings::default()
    };
    let setup = Setup::load(settings, request, None).expect("the scene is good");
    Some(Offscreen::new(setup, UVec2::new(128, 72)).expect("a device that was found"))
}

/// A picture's bytes of colour.
fn picture(game: &mut Offscreen) -> Vec<u8> {
    game.settle().expect("frames");
    game.capture().expect("a picture").into_raw()
}

/// Mean difference of two pictures, of 255.
fn apart(a: &[u8], b: &[u8]) -> f64 {
    let sum: u64 = a
        .iter()
        .zip(b)
        .map(|(a, b)| u64::from(a.abs_diff(*b)))
        .sum();
    sum as f64 / a.len() as f64
}

/// In a module of this name, so that tests which open an adapter run in their group.
mod gpu {
    use super::*;

    #[test]
    fn both_renderers_light_the_lamps_alike_and_the_torch_is_switched() {
        let Some(mut game) = game(40) else { return };
        let bevys = picture(&mut game);
        assert!(
            game.app
                .world()
                .resource::<DeferredStats>()
                .views()
                .is_empty()
        );
        game.app.world_mut().resource_mut::<Settings>().renderer = Renderer::Dolomite;
        let ours = picture(&mut game);
        let views = game.app.world().resource::<DeferredStats>().views();
        assert_eq!(views.len(), 1);
        assert!(views[0].lights > 10, "{views:?}");
        let off = apart(&bevys, &ours);
        eprintln!("{off} of 255 between the renderers");
        assert!(off < 0.5, "{off}");
        // A key is held for a frame.
        let press = |game: &mut Offscreen| {
            game.app
                .world_mut()
                .resource_mut::<PlayerInput>()
                .switch_torch = true;
            game.step(STEP).expect("a frame");
            game.app
                .world_mut()
                .resource_mut::<PlayerInput>()
                .switch_torch = false;
        };
        press(&mut game);
        let lit = picture(&mut game);
        let more = game.app.world().resource::<DeferredStats>().views()[0].lights;
        assert_eq!(more, views[0].lights + 1, "the torch");
        let off = apart(&ours, &lit);
        eprintln!("{off} of 255 by the torch");
        // A thousand times what the renderers are apart.
        assert!(off > 0.05, "{off}");
        press(&mut game);
        picture(&mut game);
        let again = game.app.world().resource::<DeferredStats>().views()[0].lights;
        assert_eq!(again, views[0].lights);
    }
}

#[test]
fn lamps_are_asked_for_where_there_are_some() {
    let load = |scene: &str, lights| {
        let request = SceneRequest {
            lights: Some(lights),
            ..SceneRequest::new(scene)
        };
        Setup::load(Settings::default(), request, None)
    };
    let night = load("night", 3000).expect("as many as are wanted");
    let lamps = night.scene.lamps.expect("lamps");
    assert_eq!(lamps.on(&night.scene.terrain).len(), 3000);
    for (scene, lights, words) in [
        ("mountain", 5, "--scene night"),
        ("night", 1_000_000, "at most"),
    ] {
        let error = load(scene, lights).err().expect("refused").to_string();
        assert!(error.contains(words), "{error}");
    }
}
