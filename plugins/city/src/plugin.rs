//! The plugin, and the system that needs no renderer.

use bevy::prelude::*;

use crate::components::{City, CityBlocks, CityView};
use crate::sets::CitySystems;
use crate::streets::cell_at;

/// Cities around the cameras that see them. May be added before Bevy's plugins or after them, with a renderer or
/// without; added again it does nothing.
pub struct CityPlugin;

#[derive(Resource)]
struct Added;

impl Plugin for CityPlugin {
    fn build(&self, app: &mut App) {
        if app.world().contains_resource::<Added>() {
            return;
        }
        app.insert_resource(Added)
            .register_type::<City>()
            .register_type::<CityView>()
            .configure_sets(
                PostUpdate,
                (CitySystems::Look, CitySystems::Draw)
                    .chain()
                    .before(bevy::transform::TransformSystems::Propagate),
            )
            .add_systems(
                PostUpdate,
                look.in_set(CitySystems::Look)
                    .run_if(any_with_component::<City>),
            );
        #[cfg(feature = "render")]
        crate::render::build(app);
    }

    fn is_unique(&self) -> bool {
        false
    }
}

/// Keeps [`CityBlocks`] around the first camera. Writes nothing where nothing changes.
fn look(
    mut cities: Query<(Ref<City>, &Transform, &mut CityBlocks), Without<CityView>>,
    views: Query<(Entity, &CityView, &Transform)>,
) {
    let first = views.iter().min_by_key(|(entity, ..)| entity.index_u32());
    for (city, place, mut blocks) in &mut cities {
        if city.is_changed() && blocks.rules.as_ref() != Some(&city.rules) {
            match city.rules.clone().checked() {
                Ok(rules) => {
                    blocks.rules = Some(rules);
                    blocks.fault = None;
                    blocks.around.clear();
                    blocks.known = false;
                }
                Err(fault) => blocks.fault = Some(fault),
            }
        }
        let Some((_, view, camera)) = first else {
            continue;
        };
        let away = (camera.translation - place.translation).as_dvec3();
        let Some(rules) = &blocks.rules else {
            continue;
        };
        let Some(middle) = cell_at(rules, [away.x, away.z]) else {
            continue;
        };
        let reach = (view.near.clamp(0.0, 1000.0) / rules.pitch).ceil() as u32;
        if blocks.known && blocks.middle == middle && blocks.reach == reach {
            continue;
        }
        let blocks = &mut *blocks;
        if let Some(rules) = &blocks.rules {
            blocks.around.look(rules, [away.x, away.z], reach);
            (blocks.middle, blocks.reach, blocks.known) = (middle, reach, true);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn app() -> (App, Entity, Entity) {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, CityPlugin, CityPlugin));
        let city = app.world_mut().spawn(City::default()).id();
        let camera = app.world_mut().spawn(CityView::default()).id();
        app.update();
        (app, city, camera)
    }

    fn blocks(app: &App, city: Entity) -> &CityBlocks {
        app.world().get::<CityBlocks>(city).expect("required")
    }

    #[test]
    fn blocks_follow_the_camera_and_rest_with_it() {
        let (mut app, city, camera) = app();
        assert_eq!(blocks(&app, city).around.len(), 25);
        let changed = |app: &App| {
            let blocks = app.world().entity(city).get_ref::<CityBlocks>();
            blocks.expect("required").last_changed()
        };
        app.update();
        let then = changed(&app);
        app.update();
        assert_eq!(changed(&app), then, "nothing moved");
        let mut place = app.world_mut().get_mut::<Transform>(camera).expect("there");
        place.translation.x = 40.0;
        app.update();
        assert_eq!(blocks(&app, city).around.made(), 25 + 5);
        assert_eq!(blocks(&app, city).middle, [1, 0]);
    }

    #[test]
    fn wrong_rules_are_named_and_the_last_good_city_stays() {
        let (mut app, city, _) = app();
        let good = blocks(&app, city).rules.clone();
        app.world_mut()
            .get_mut::<City>(city)
            .expect("there")
            .rules
            .pitch = 0.0;
        app.update();
        let blocks = blocks(&app, city);
        assert!(
            blocks
                .fault
                .as_ref()
                .is_some_and(|f| f.to_string().contains("pitch"))
        );
        assert_eq!((&blocks.rules, blocks.around.len()), (&good, 25));
        app.world_mut()
            .get_mut::<City>(city)
            .expect("there")
            .rules
            .pitch = 40.0;
        app.update();
        let blocks = app.world().get::<CityBlocks>(city).expect("required");
        assert!(blocks.fault.is_none() && blocks.rules.as_ref().is_some_and(|r| r.pitch == 40.0));
    }
}
