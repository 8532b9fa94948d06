//! The figure of the game on the ground that is drawn, without a window.

use crate::support::adapter;

use bevy::diagnostic::{DiagnosticPath, DiagnosticsStore};
use bevy::math::{DVec2, UVec2};
use bevy::prelude::*;
use dolomite::ground::render::DrawnProbeStats;
use dolomite::terrain::{GroundProbe, ProbeBatch, Terrain};
use dolomite_game::input::PlayerInput;
use dolomite_game::play::figure::Figure;
use dolomite_game::run::Setup;
use dolomite_game::run::offscreen::{Offscreen, STEP};
use dolomite_game::scene::SceneRequest;
use dolomite_game::settings::Settings;

/// The mountain, small, as `--max-error` plays it; `None`, after a line that says so, without Vulkan.
fn game(max_error: f32) -> Option<Offscreen> {
    if !adapter::is_there() {
        return None;
    }
    let request = SceneRequest::new("mountain");
    let settings = Settings {
        max_error: Some(max_error),
        ..Settings::default()
    };
    let mut setup = Setup::load(settings, request, None).expect("the scene is good");
    setup.start_behind_figure();
    Some(Offscreen::new(setup, UVec2::new(160, 90)).expect("a device that was found"))
}

/// The feet, and what was drawn below them.
fn figure(game: &mut Offscreen) -> (Transform, GroundProbe) {
    let world = game.app.world_mut();
    let mut figures = world.query_filtered::<(&Transform, &GroundProbe), With<Figure>>();
    let (place, probe) = figures.single(world).expect("there is one figure");
    (*place, *probe)
}

fn age(game: &Offscreen) -> f64 {
    let diagnostics = game.app.world().resource::<DiagnosticsStore>();
    diagnostics
        .get(&DiagnosticPath::const_new("dolomite/probes/age"))
        .and_then(|age| age.value())
        .expect("measured")
}

mod gpu {
    use super::*;

    #[test]
    fn feet_stand_on_the_drawn_ground_and_answers_are_fresh() {
        // Coarse enough that drawn and true ground are seen to be two.
        let Some(mut game) = game(16.0) else { return };
        game.settle().expect("a day");
        let world = game.app.world_mut();
        let terrain: Terrain = world
            .query::<&Terrain>()
            .single(world)
            .expect("one")
            .clone();
        world.resource_mut::<PlayerInput>().walk = Vec2::Y;
        let (mut on_drawn, mut largest, mut apart) = (0, 0.0_f64, 0.0_f64);
        let mut before = figure(&mut game).0.translation;
        for frame in 0..40 {
            let (_, known) = figure(&mut game);
            game.step(STEP).expect("a frame");
            let (feet, probe) = figure(&mut game);
            let now = game.app.world().resource::<ProbeBatch>().frame();
            assert!(age(&game) <= 3.0, "frame {frame}: {}", age(&game));
            let place = DVec2::new(feet.translation.x.into(), feet.translation.z.into());
            let truth = terrain.sample_f64(place).height;
            let height = f64::from(feet.translation.y);
            // The answer that the feet were put by: the one that came in this frame.
            let drawn = probe.drawn.expect("the figure is in the picture");
            assert!(drawn.age(now) <= 3, "frame {frame}: {drawn:?}");
            assert!(known.drawn.is_none_or(|known| known.frame < drawn.frame));
            let on_triangle = drawn.height_at(place);
            if (on_triangle - truth).abs() <= drawn.bound {
                // Feet are f32: half a step at 600 m is 3e-5 m, of place and of height.
                assert!(
                    (height - on_triangle).abs() < 2e-4,
                    "{height} {on_triangle}"
                );
                on_drawn += 1;
                apart = apart.max((on_triangle - truth).abs());
            } else {
                assert!((height - truth).abs() < 2e-4);
            }
            assert!((height - truth).abs() <= drawn.bound + 2e-4);
            largest = largest.max(drawn.bound);
            let step = feet.translation - before;
            before = feet.translation;
            // 1.5 m of a walk a second at most, up and down a slope of 1: no jump from triangle to truth.
            assert!(step.y.abs() < 0.25, "frame {frame}: {step}");
        }
        println!(
            "{on_drawn} of 40 frames on triangles, {apart} m from the truth, bound {largest} m"
        );
        assert!(on_drawn >= 36, "{on_drawn} of 40 frames");
        assert!(apart > 1e-3, "the two surfaces are two: {apart}");

        // At rest nothing is dispatched, and the answer stays fresh.
        game.app.world_mut().resource_mut::<PlayerInput>().walk = Vec2::ZERO;
        for _ in 0..20 {
            game.step(STEP).expect("a frame");
        }
        let asked = game.app.world().resource::<DrawnProbeStats>().dispatches;
        for _ in 0..5 {
            game.step(STEP).expect("a frame");
            assert!(age(&game) <= 3.0);
        }
        assert_eq!(
            game.app.world().resource::<DrawnProbeStats>().dispatches,
            asked
        );
    }
}
