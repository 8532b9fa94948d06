//! The sun of the scene, or the player's; and the colours of the picture by day and by night.

use bevy::prelude::*;
use bevy::render::view::ColorGrading;
use dolomite::sky::{SeenSky, Sky, SkySystems, Sun};

use super::start::Starting;
use super::{city, quality};
use crate::scene::CurrentScene;
use crate::settings::Settings;
use crate::settings::quality::Quality;

/// AgX trades saturation for highlights; by day this gives grass and sky theirs back.
pub const SATURATION: f32 = 1.3;

/// Saturation of the picture by night: eyes see little colour then.
const NIGHT_SATURATION: f32 = 1.1;

/// Puts the sun where scene and settings want it.
pub struct DaylightPlugin;

impl Plugin for DaylightPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Startup, spawn)
            .add_systems(
                Update,
                turn_sun.run_if(
                    resource_changed::<CurrentScene>
                        .or_else(resource_changed::<Settings>)
                        .or_else(resource_removed::<Starting>),
                ),
            )
            .add_systems(PostUpdate, fade.after(SkySystems::See));
    }
}

fn spawn(
    mut commands: Commands,
    scene: Res<CurrentScene>,
    settings: Res<Settings>,
    chosen: Res<Quality>,
) {
    commands.spawn((place(&scene, &settings), quality::cascades(&chosen)));
}

/// Where the sun stands.
fn place(scene: &CurrentScene, settings: &Settings) -> Sun {
    settings
        .sun
        .map_or(scene.sun, |(azimuth, elevation)| Sun { azimuth, elevation })
}

/// Side of the sky's maps below the start screen, texels. The frame that makes them, in which the window answers nobody, takes 0.1
/// to 0.2 s of two cores with all else that it does, where by the usual ones it takes 0.55 to 0.8 s (tests' profile); those are
/// made in the background once there is a picture.
const FIRST_SIDE: u32 = 32;

/// The sky of the scene's cameras: whether there is a sea, and how dark nights are. While the start screen is shown it is
/// coarse.
pub fn sky(scene: &CurrentScene, starting: bool) -> Sky {
    let usual = Sky::default();
    let (night_ev100, stars) = match scene.city {
        Some(_) => (city::NIGHT_EV100, city::STARS),
        None => (usual.night_ev100, usual.stars),
    };
    Sky {
        sea: scene.terrain.sea_level().is_some(),
        night_ev100,
        stars,
        side: if starting { FIRST_SIDE } else { usual.side },
        ..usual
    }
}

fn turn_sun(
    scene: Res<CurrentScene>,
    settings: Res<Settings>,
    mut suns: Query<&mut Sun>,
    mut skies: Query<&mut Sky>,
    starting: Option<Res<Starting>>,
    mut last: Local<Option<Sun>>,
) {
    // A sun that was turned otherwise, as by the console, stays where it is while the settings change in other things.
    let wanted = place(&scene, &settings);
    if last.replace(wanted) != Some(wanted) {
        for mut sun in &mut suns {
            sun.set_if_neq(wanted);
        }
    }
    for mut seen in &mut skies {
        seen.set_if_neq(sky(&scene, starting.is_some()));
    }
}

/// Takes colour from the picture as the stars come out.
fn fade(mut cameras: Query<(&SeenSky, &mut ColorGrading), Changed<SeenSky>>) {
    for (seen, mut grading) in &mut cameras {
        grading.global.post_saturation =
            SATURATION + (NIGHT_SATURATION - SATURATION) * seen.heavens.stars;
    }
}
