//! Lamps near the camera as lights. By day there is none.

use std::collections::HashMap;

use bevy::light::PointLight;
use bevy::prelude::*;

use super::shown_city;
use crate::components::{City, CityBlocks, CityView};
use crate::lamp::lamps;
use crate::streets::{Cell, cell_at, has_cell};

/// From which share of the distance on a light fades into the light of far lamps.
pub(super) const FADE: f32 = 0.7;

/// How far a lamp's light reaches, metres: 9 000 lm give 1 lux at 27 m.
const RANGE: f32 = 27.0;

/// How far a camera goes before lights come and go, metres.
const STEP: f32 = 1.0;

/// A light of a city's lamp: its cell, and its number there.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CityLamp {
    /// Cell of its block.
    pub cell: Cell,
    /// Number among the block's lamps.
    pub number: u32,
}

/// Lights that are there, and what for.
#[derive(Resource, Default)]
pub(super) struct Lit {
    lights: HashMap<CityLamp, Entity>,
    at: Option<(Vec3, f32, CityView)>,
}

/// Lights come and go, nearest first, and fade where they end.
pub(super) fn light(
    mut commands: Commands,
    mut lit: ResMut<Lit>,
    cities: Query<(Entity, &City, &CityBlocks, &Transform)>,
    changed: Query<(), (With<City>, Or<(Changed<City>, Changed<CityBlocks>)>)>,
    views: Query<(Entity, &CityView, &Transform), Without<City>>,
) {
    let first = views.iter().min_by_key(|(entity, ..)| entity.index_u32());
    let shown = shown_city(&cities).filter(|(_, city, ..)| city.lamps > 0.0);
    let (Some((_, city, blocks, place)), Some((_, view, camera))) = (shown, first) else {
        for (_, entity) in lit.lights.drain() {
            commands.entity(entity).despawn();
        }
        lit.at = None;
        return;
    };
    let Some(rules) = &blocks.rules else {
        return;
    };
    let eye = camera.translation;
    let rests = lit.at.is_some_and(|(at, lamps, of)| {
        at.distance(eye) < STEP && lamps == city.lamps && of == *view
    });
    if rests && changed.is_empty() {
        return;
    }
    lit.at = Some((eye, city.lamps, *view));
    let away = (eye - place.translation).as_dvec3();
    let Some(middle) = cell_at(rules, [away.x, away.z]) else {
        return;
    };
    let most = view.lights.clamp(1.0, 2000.0);
    let reach = (most / rules.pitch).ceil() as i32;
    let mut wanted: Vec<(f32, CityLamp, PointLight, Vec3)> = Vec::new();
    for x in middle[0] - reach..=middle[0] + reach {
        for z in middle[1] - reach..=middle[1] + reach {
            if !has_cell(rules, [x, z]) {
                continue;
            }
            let corner = super::cell_corner(Some(rules), place, [x, z]).translation;
            for (number, lamp) in (0..).zip(lamps(rules, [x, z])) {
                let at = corner + Vec3::from_array(lamp.light(rules));
                let distance = at.distance(eye);
                if distance > most {
                    continue;
                }
                let start = FADE * most;
                let t = ((distance - start) / (most - start)).clamp(0.0, 1.0);
                // What is taken from it here is what the ground shines by there.
                let share = 1.0 - t * t * (3.0 - 2.0 * t);
                let [r, g, b] = lamp.colour;
                let light = PointLight {
                    color: Color::linear_rgb(r, g, b),
                    intensity: lamp.lumens * city.lamps.min(1.0) * share,
                    range: RANGE,
                    radius: lamp.globe,
                    shadow_maps_enabled: false,
                    ..default()
                };
                let key = CityLamp {
                    cell: [x, z],
                    number,
                };
                wanted.push((distance, key, light, at));
            }
        }
    }
    wanted.sort_by(|a, b| a.0.total_cmp(&b.0));
    wanted.truncate(view.most_lights);
    let mut old = std::mem::take(&mut lit.lights);
    for (_, key, light, at) in wanted {
        let bundle = (key, light, Transform::from_translation(at));
        let entity = match old.remove(&key) {
            Some(entity) => {
                commands.entity(entity).insert(bundle);
                entity
            }
            None => commands.spawn(bundle).id(),
        };
        lit.lights.insert(key, entity);
    }
    for (_, entity) in old {
        commands.entity(entity).despawn();
    }
}
