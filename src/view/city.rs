//! The city of a scene in the picture: which windows are lit and whether lamps burn follows from the sun.

use bevy::prelude::*;
use dolomite::city::{City, CityDetail, CityView};
use dolomite::sky::{SeenSky, SkySystems, Sun};

use super::{Dress, DressSystems, SceneTextures};
use crate::level::{Level, LevelState};
use crate::play::camera::FreeCamera;
use crate::scene::CurrentScene;
use crate::scene::city::CityScene;

/// Exposure of a night with lamps, EV at ISO 100: a street under lamps is read, and a lit window is not burnt out.
pub const NIGHT_EV100: f32 = 3.2;

/// Brightness of the stars against the true one: at the exposure of lit streets the usual one shows none.
pub const STARS: f32 = 100.0;

/// Elevations of the sun at which lamps begin to burn, and at which all of them do, degrees.
const FIRST_LAMP: f32 = 1.0;
const LAST_LAMP: f32 = -3.0;

/// Shows the city of the scene, and another one when it is loaded anew.
pub struct CityScenePlugin;

impl Plugin for CityScenePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            Dress,
            build.in_set(DressSystems::Scene).after(super::dress_camera),
        )
        .add_systems(
            Update,
            build
                .run_if(resource_exists::<SceneTextures>)
                .run_if(resource_changed::<CurrentScene>),
        )
        .add_systems(
            PostUpdate,
            light
                .after(SkySystems::See)
                .before(dolomite::city::CitySystems::Look)
                .run_if(any_with_component::<City>),
        );
    }
}

/// The scene's city, and what it was made of.
#[derive(Component)]
struct Shown(CityScene);

fn build(
    mut commands: Commands,
    scene: Res<CurrentScene>,
    old: Query<(Entity, &Shown)>,
    cameras: Query<Entity, With<FreeCamera>>,
) {
    let stands = |(_, shown): (Entity, &Shown)| scene.city.as_ref() == Some(&shown.0);
    let same = old.iter().any(stands);
    for (entity, _) in old.iter().filter(|_| !same) {
        commands.entity(entity).despawn();
    }
    for camera in &cameras {
        let mut camera = commands.entity(camera);
        match scene.city {
            Some(_) => camera.insert_if_new(CityView::default()),
            None => camera.remove::<CityView>(),
        };
    }
    if let Some(city) = scene.city.as_ref().filter(|_| !same) {
        commands.spawn((
            Shown(city.clone()),
            City {
                rules: city.rules.clone(),
                detail: CityDetail::default(),
                ..default()
            },
            Transform::from_translation(city.origin.as_vec3()),
        ));
    }
}

/// Hour of the day and share of the lamps for a place of the sun: it is in the south at noon, and goes on by 15
/// degrees an hour.
fn time(sun: Sun) -> (f32, f32) {
    let hour = (sun.azimuth / 15.0).rem_euclid(24.0);
    let lamps = ((sun.elevation - FIRST_LAMP) / (LAST_LAMP - FIRST_LAMP)).clamp(0.0, 1.0);
    (
        if hour.is_finite() { hour } else { 12.0 },
        if lamps.is_finite() { lamps } else { 0.0 },
    )
}

fn light(
    skies: Query<&SeenSky, With<CityView>>,
    level: Option<Res<Level>>,
    state: Option<Res<LevelState>>,
    mut cities: Query<&mut City, With<Shown>>,
) {
    let Some(seen) = skies.iter().next() else {
        return;
    };
    let (hour, lamps) = time(seen.sun);
    // In a level as many of them burn as circuits are on.
    let share = level.zip(state).map_or(1.0, |(level, state)| {
        state.lit as f32 / level.file.beacons.len().max(1) as f32
    });
    let lamps = lamps * share;
    for mut city in &mut cities {
        if (city.hour, city.lamps) != (hour, lamps) {
            (city.hour, city.lamps) = (hour, lamps);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lamps_burn_at_night_and_the_hour_is_that_of_the_sun() {
        let at = |azimuth, elevation| time(Sun { azimuth, elevation });
        assert_eq!(at(180.0, 40.0), (12.0, 0.0));
        assert_eq!(at(285.0, -6.0), (19.0, 1.0));
        assert_eq!(at(-45.0, -20.0), (21.0, 1.0));
        assert_eq!(at(270.0, -1.0), (18.0, 0.5));
        assert_eq!(at(f32::NAN, f32::NAN), (12.0, 0.0));
    }
}
