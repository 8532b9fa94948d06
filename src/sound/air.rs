//! Wind about the listener's ears, by speed and height; and surf at the nearest shore.

use bevy::math::{DVec2, ops};
use bevy::prelude::*;
use bevy::time::common_conditions::on_timer;
use dolomite::sound::wind::{emitters, speed_at};
use dolomite::sound::{Bus, Loudness, SoundEmitter, SoundListener, built_in};
use dolomite::terrain::{Ground, Terrain};
use std::time::Duration;

use super::GameSoundSystems;
use crate::scene::CurrentScene;

/// Seconds in which wind follows a change by 63 %: gusts, not steps.
const FOLLOWS: f32 = 0.7;

/// Between houses there is less of it.
const IN_TOWN: f32 = 0.45;

/// Faster than this nobody moves through air that is heard, metres a second: a camera may jump.
const FASTEST: f32 = 60.0;

/// Surf is as loud as can be up to here, and not heard from there on, metres.
const NEAR: f32 = 22.0;
const REACH: f32 = 420.0;

/// How often the shore is looked for.
const LOOKS: Duration = Duration::from_millis(400);

/// Directions, and distances that grow by a third, in which it is looked for.
const DIRECTIONS: u32 = 16;
const RINGS: u32 = 13;
const FIRST: f64 = 8.0;

/// Wind and surf.
pub struct AirPlugin;

impl Plugin for AirPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            Update,
            (
                begin.run_if(not(any_with_component::<Wind>)),
                blow,
                (look.run_if(on_timer(LOOKS)), wash).chain(),
            )
                .chain()
                .in_set(GameSoundSystems),
        );
    }
}

/// One of the two emitters of the wind.
#[derive(Component)]
struct Wind(usize);

/// Surf, at the nearest shore: where it is heard, and where it goes.
#[derive(Component)]
struct Surf {
    shore: Option<Vec3>,
}

fn begin(mut commands: Commands) {
    for (number, emitter) in emitters(0.0, Vec3::ZERO, 0.0).into_iter().enumerate() {
        commands.spawn((Wind(number), emitter));
    }
    let loudness = Loudness {
        volume: 0.0,
        reference: NEAR,
        reach: REACH,
        priority: 60,
        bus: Bus::Ambience,
        ..default()
    };
    let sound = built_in::SEA;
    commands.spawn((
        Surf { shore: None },
        SoundEmitter {
            sound,
            loudness,
            everywhere: false,
        },
    ));
}

/// Where the listener was, and how fast the air is about it.
#[derive(Default)]
struct Blown {
    place: Option<Vec3>,
    velocity: Vec3,
}

fn blow(
    time: Res<Time>,
    scene: Res<CurrentScene>,
    ears: Query<&Transform, With<SoundListener>>,
    mut blown: Local<Blown>,
    mut winds: Query<(&Wind, &mut SoundEmitter)>,
) {
    let (Some(ears), seconds) = (ears.iter().next(), time.delta_secs()) else {
        return;
    };
    if seconds <= 0.0 {
        return;
    }
    let place = ears.translation;
    let way = place - blown.place.replace(place).unwrap_or(place);
    let velocity = (way / seconds).clamp_length_max(FASTEST);
    let part = 1.0 - ops::exp(-seconds / FOLLOWS);
    blown.velocity = blown.velocity.lerp(velocity, part);
    let sea = scene.terrain.sea_level().unwrap_or(0.0);
    let share = if scene.city.is_some() { IN_TOWN } else { 1.0 };
    let next = emitters(speed_at(place.y - sea), blown.velocity, share);
    for (wind, mut emitter) in &mut winds {
        if let Some(next) = next.get(wind.0) {
            emitter.set_if_neq(*next);
        }
    }
}

/// The nearest place on rings about `place` where the sea begins, metres.
fn shore(terrain: &Terrain, place: DVec2) -> Option<DVec2> {
    let sea = f64::from(terrain.sea_level()?);
    let wet = |place: DVec2| terrain.height(place) < sea;
    if wet(place) {
        return Some(place);
    }
    let mut radius = FIRST;
    for _ in 0..RINGS {
        for k in 0..DIRECTIONS {
            let (sin, cos) = ops::sin_cos(std::f32::consts::TAU * k as f32 / DIRECTIONS as f32);
            let at = place + DVec2::new(f64::from(cos), f64::from(sin)) * radius;
            if wet(at) {
                return Some(at);
            }
        }
        radius *= 4.0 / 3.0;
    }
    None
}

fn look(
    scene: Res<CurrentScene>,
    ears: Query<&Transform, With<SoundListener>>,
    mut surf: Query<&mut Surf>,
) {
    let (Some(ears), Some(sea)) = (ears.iter().next(), scene.terrain.sea_level()) else {
        for mut surf in &mut surf {
            surf.shore = None;
        }
        return;
    };
    let at = ears.translation;
    for mut surf in &mut surf {
        // High above, nothing of it is heard.
        surf.shore = (at.y - sea < REACH)
            .then(|| shore(&scene.terrain, DVec2::new(f64::from(at.x), f64::from(at.z))))
            .flatten()
            .map(|place| Vec3::new(place.x as f32, sea, place.y as f32));
    }
}

/// Surf goes to where the shore is, in so long that it is not heard to jump.
fn wash(time: Res<Time>, mut surf: Query<(&Surf, &mut SoundEmitter, &mut Transform)>) {
    let part = 1.0 - ops::exp(-time.delta_secs() / FOLLOWS);
    for (surf, mut emitter, mut at) in &mut surf {
        let silent = emitter.loudness.volume == 0.0;
        let Some(shore) = surf.shore else {
            if !silent {
                emitter.loudness.volume = 0.0;
            }
            continue;
        };
        let next = if silent {
            shore
        } else {
            at.translation.lerp(shore, part)
        };
        if silent {
            emitter.loudness.volume = 0.75;
        }
        if at.translation != next {
            at.translation = next;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{SceneRequest, load};
    use crate::settings::paths::assets_dir;
    use dolomite::terrain::TerrainData;

    #[test]
    fn the_shore_is_where_the_sea_begins() {
        let scene = load(&SceneRequest::new("mountain"), &assets_dir().unwrap()).unwrap();
        let terrain = &scene.terrain;
        let mut found = 0;
        for k in 0..200 {
            let place = DVec2::new(f64::from(k % 20) - 10.0, f64::from(k / 20) - 5.0) * 600.0;
            let Some(shore) = shore(terrain, place) else {
                assert!(terrain.height(place) > 0.0);
                continue;
            };
            found += 1;
            assert!(terrain.height(shore) < 0.0);
            // 8 m times (4/3)^12.
            assert!(shore.distance(place) < 260.0, "{place} {shore}");
        }
        assert!(found > 20, "{found}");
        let dry = TerrainData {
            extent: terrain.extent(),
            base: 5.0,
            layers: Vec::new(),
            sea_level: None,
        };
        let dry = Terrain::new(dry).unwrap();
        assert_eq!(shore(&dry, DVec2::ZERO), None, "no sea, no shore");
    }
}
