//! The plugin, and the system that needs no renderer.

use bevy::prelude::*;
use bevy::transform::TransformSystems;

use crate::components::{Sky, Sun, the_sun};
use crate::seen::SeenSky;
use crate::sets::SkySystems;

/// Sun, moon, stars, sky and haze for cameras with a [`Sky`], where there is a [`Sun`].
///
/// It may be added before Bevy's plugins or after them, with a renderer or without; added again it does
/// nothing. It has no settings of its own: those are fields of [`Sky`].
pub struct SkyPlugin;

/// Says that the plugin was added.
#[derive(Resource)]
struct Added;

impl Plugin for SkyPlugin {
    fn build(&self, app: &mut App) {
        if app.world().contains_resource::<Added>() {
            return;
        }
        app.insert_resource(Added)
            .register_type::<Sun>()
            .register_type::<Sky>()
            .configure_sets(
                PostUpdate,
                (SkySystems::See, SkySystems::Light, SkySystems::Night)
                    .chain()
                    .before(TransformSystems::Propagate),
            )
            .add_systems(
                PostUpdate,
                see.in_set(SkySystems::See)
                    .run_if(any_with_component::<Sky>),
            )
            .add_observer(forget);
        #[cfg(feature = "render")]
        crate::render::build(app);
    }

    fn is_unique(&self) -> bool {
        false
    }
}

/// Writes [`SeenSky`] where sun or sky have changed. Without a sun all stays as it was.
fn see(
    mut commands: Commands,
    suns: Query<(Entity, &Sun)>,
    mut skies: Query<(Entity, &Sky, Option<&mut SeenSky>)>,
) {
    let Some((_, sun)) = the_sun(suns.iter()) else {
        return;
    };
    for (camera, sky, seen) in &mut skies {
        if seen.as_ref().is_some_and(|seen| seen.is_of(sun, sky)) {
            continue;
        }
        match (seen, SeenSky::new(sun, sky)) {
            (Some(mut seen), Some(next)) => *seen = next,
            (None, Some(next)) => {
                commands.entity(camera).insert(next);
            }
            (_, None) => {}
        }
    }
}

/// Takes [`SeenSky`] away with the sky.
fn forget(removed: On<Remove, Sky>, mut commands: Commands) {
    if let Ok(mut camera) = commands.get_entity(removed.entity) {
        camera.try_remove::<SeenSky>();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn app() -> App {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, SkyPlugin));
        app
    }

    fn seen(app: &mut App, camera: Entity) -> Option<SeenSky> {
        app.update();
        app.world().get::<SeenSky>(camera).copied()
    }

    #[test]
    fn a_sky_is_seen_where_there_is_a_sun_and_is_kept_while_nothing_changes() {
        let mut app = app();
        let camera = app.world_mut().spawn(Sky::default()).id();
        assert_eq!(seen(&mut app, camera), None, "no sun yet");
        let place = Sun::default();
        let sun = app.world_mut().spawn(place).id();
        assert_eq!(seen(&mut app, camera).expect("a sky").sun, place);
        let changed = |app: &App| {
            let seen = app.world().entity(camera).get_ref::<SeenSky>();
            seen.expect("a sky").last_changed()
        };
        let then = changed(&app);
        app.update();
        app.world_mut()
            .get_mut::<Sun>(sun)
            .expect("there")
            .set_changed();
        app.update();
        assert_eq!(changed(&app), then, "the same sun");
        app.world_mut()
            .get_mut::<Sun>(sun)
            .expect("there")
            .elevation = -30.0;
        let night = seen(&mut app, camera).expect("a sky");
        assert!(night.heavens.stars == 1.0 && night.ev100 == night.sky.night_ev100);
        assert_ne!(changed(&app), then);
        app.world_mut().entity_mut(camera).remove::<Sky>();
        assert_eq!(seen(&mut app, camera), None, "it goes with its sky");
    }

    #[test]
    fn a_sun_that_is_nowhere_leaves_all_as_it_was() {
        let mut app = app();
        let camera = app.world_mut().spawn(Sky::default()).id();
        let sun = app.world_mut().spawn(Sun::default()).id();
        let before = seen(&mut app, camera);
        assert!(before.is_some());
        app.world_mut().get_mut::<Sun>(sun).expect("there").azimuth = f32::NAN;
        assert_eq!(seen(&mut app, camera), before);
    }

    #[test]
    fn of_two_suns_the_first_lights_the_sky() {
        let mut app = app();
        let camera = app.world_mut().spawn(Sky::default()).id();
        let at = |elevation| Sun {
            elevation,
            ..Sun::default()
        };
        let first = app.world_mut().spawn(at(20.0)).id();
        app.world_mut().spawn(at(-20.0));
        assert_eq!(seen(&mut app, camera).expect("a sky").sun, at(20.0));
        app.world_mut().despawn(first);
        assert_eq!(seen(&mut app, camera).expect("a sky").sun, at(-20.0));
    }

    #[test]
    fn two_cameras_have_a_sky_each_or_none() {
        let mut app = app();
        app.world_mut().spawn(Sun::default());
        let land = app.world_mut().spawn(Sky::default()).id();
        let sea = Sky {
            sea: true,
            ..Sky::default()
        };
        let coast = app.world_mut().spawn(sea).id();
        let without = app.world_mut().spawn_empty().id();
        assert_eq!(seen(&mut app, land).expect("a sky").sky, Sky::default());
        assert_eq!(seen(&mut app, coast).expect("a sky").sky, sea);
        assert_eq!(seen(&mut app, without), None);
    }

    #[test]
    fn added_twice_it_is_there_once() {
        let mut app = app();
        app.add_plugins(SkyPlugin);
        app.world_mut().spawn((Sun::default(), Sky::default()));
        app.update();
        let world = app.world_mut();
        assert_eq!(world.query::<&SeenSky>().iter(world).count(), 1);
    }
}
