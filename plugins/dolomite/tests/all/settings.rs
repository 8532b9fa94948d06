//! The inspector reaches every setting of every plugin, and what it is told of them is of fields that exist.

use crate::sources::settings;

use std::sync::Arc;

use bevy::prelude::*;
use bevy::reflect::{PartialReflect, ReflectRef};
use dolomite::DolomitePlugins;
use dolomite::collision::rapier::RapierBridgePlugin;
use dolomite::inspector::InspectorPlugin;
use dolomite::inspector::settings::described::{Descriptions, number};
use dolomite::inspector::settings::edit;
use dolomite::inspector::settings::kinds::{Kind, kinds};
use dolomite::inspector::settings::place::Place;
use dolomite::logic::movement::{Patrol, Route, Walker};
use dolomite::logic::{LogicTimer, Objective};

/// Without a renderer: all plugins register their settings all the same.
fn app() -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        bevy::asset::AssetPlugin::default(),
        bevy::transform::TransformPlugin,
        bevy::diagnostic::DiagnosticsPlugin,
    ))
    .init_asset::<Image>()
    .init_asset::<Mesh>()
    .add_plugins((DolomitePlugins, RapierBridgePlugin, InspectorPlugin));
    dolomite::describe(&mut app);
    // What has no default.
    let route = Route::new(vec![Vec3::ZERO, Vec3::X]).expect("two points");
    app.world_mut().spawn((
        LogicTimer::every(1.0),
        Objective::new(1),
        Patrol::new(Arc::new(route), 1.0),
        Walker::new(Vec2::ZERO, 0),
    ));
    app
}

fn ours(app: &App) -> Vec<Kind> {
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let mut kinds = kinds(&registry);
    kinds.retain(|kind| kind.of_crate.starts_with("dolomite_"));
    kinds
}

/// Ways to all numbers, switches and texts of a value.
fn leaves(path: &str, value: &dyn PartialReflect, found: &mut Vec<String>) {
    let parts: Vec<(String, &dyn PartialReflect)> = match value.reflect_ref() {
        ReflectRef::Struct(fields) => (0..fields.field_len())
            .filter_map(|k| {
                Some((
                    format!("{path}.{}", fields.name_at(k)?),
                    fields.field_at(k)?,
                ))
            })
            .collect(),
        ReflectRef::TupleStruct(fields) => (0..fields.field_len())
            .filter_map(|k| Some((format!("{path}.{k}"), fields.field(k)?)))
            .collect(),
        ReflectRef::List(items) => items
            .iter()
            .enumerate()
            .map(|(k, item)| (format!("{path}[{k}]"), item))
            .collect(),
        ReflectRef::Array(items) => items
            .iter()
            .enumerate()
            .map(|(k, item)| (format!("{path}[{k}]"), item))
            .collect(),
        ReflectRef::Enum(fields) => {
            found.push(path.to_owned());
            (0..fields.field_len())
                .filter_map(|k| {
                    let name = fields
                        .name_at(k)
                        .map_or_else(|| k.to_string(), str::to_owned);
                    Some((format!("{path}.{name}"), fields.field_at(k)?))
                })
                .collect()
        }
        _ => {
            found.push(path.to_owned());
            return;
        }
    };
    for (path, part) in parts {
        leaves(&path, part, found);
    }
}

#[test]
fn every_setting_that_has_a_default_is_read_and_written_by_the_inspector() {
    let mut app = app();
    let (mut reached, mut without) = (0, Vec::new());
    for kind in ours(&app) {
        let holders = dolomite::inspector::settings::kinds::holders(app.world(), kind.id);
        let entity = if let Some(entity) = holders.first() {
            *entity
        } else if kind.resource {
            continue;
        } else {
            let registry = app.world().resource::<AppTypeRegistry>().clone();
            let registry = registry.read();
            let (Some(default), Some(component)) = (
                registry.get_type_data::<ReflectDefault>(kind.id),
                registry.get_type_data::<ReflectComponent>(kind.id),
            ) else {
                without.push(kind.name);
                continue;
            };
            let value = default.default();
            let mut entity = app.world_mut().spawn_empty();
            component.insert(&mut entity, value.as_partial_reflect(), &registry);
            entity.id()
        };
        let whole = Place::whole(kind.clone(), entity);
        let mut found = Vec::new();
        {
            let registry = app.world().resource::<AppTypeRegistry>().read();
            edit::look(app.world(), &registry, &whole, |value| {
                leaves("", value, &mut found);
            })
            .unwrap_or_else(|error| panic!("{}: {error}", kind.path));
        }
        let descriptions = app.world().resource::<Descriptions>();
        let read_only = descriptions
            .get(kind.id)
            .is_some_and(|description| description.read_only);
        for path in found {
            let place = Place {
                path,
                ..whole.clone()
            };
            let value = {
                let registry = app.world().resource::<AppTypeRegistry>().read();
                edit::look(app.world(), &registry, &place, PartialReflect::to_dynamic)
                    .unwrap_or_else(|error| panic!("{place}: {error}"))
            };
            // A default is in its own range, and what was read can be written.
            match edit::write(app.world_mut(), &place, value.as_ref()) {
                Ok(_) => reached += 1,
                Err(edit::EditError::ReadOnly(_)) if read_only => reached += 1,
                Err(error) => panic!("{place}: {error}"),
            }
        }
    }
    println!("{reached} values reached; without a default: {without:?}");
    assert!(reached >= 250, "{reached}");
    // A plugin makes it.
    assert_eq!(without, ["TerrainRelief"]);
}

#[test]
fn every_setting_in_the_sources_is_known_to_the_inspector() {
    let app = app();
    let known = ours(&app);
    let all = settings();
    let unknown: Vec<_> = all
        .iter()
        .filter(|setting| {
            let is = |kind: &Kind| kind.of_crate == setting.of_crate && kind.name == setting.name;
            !setting.reflects || !known.iter().any(is)
        })
        .map(|setting| format!("{}::{}", setting.of_crate, setting.name))
        .collect();
    println!(
        "{} settings in the sources, {} unknown",
        all.len(),
        unknown.len()
    );
    // As many as there were when this was written; those that go are taken off here.
    assert!(all.len() >= 59, "{}", all.len());
    assert!(
        unknown.is_empty(),
        "derive Reflect and register_type: {unknown:?}"
    );
}

#[test]
fn what_is_described_exists_and_numbers_out_of_range_are_refused() {
    let mut app = app();
    let mut fields = 0;
    for kind in ours(&app) {
        let Some(description) = app.world().resource::<Descriptions>().get(kind.id).cloned() else {
            continue;
        };
        assert!(!description.about.is_empty(), "{}", kind.path);
        let registry = app.world().resource::<AppTypeRegistry>().clone();
        let registry = registry.read();
        let Some(default) = registry.get_type_data::<ReflectDefault>(kind.id) else {
            continue;
        };
        let component = registry.get_type_data::<ReflectComponent>(kind.id).unwrap();
        let value = default.default();
        let entity = {
            let mut entity = app.world_mut().spawn_empty();
            if kind.resource {
                continue;
            }
            component.insert(&mut entity, value.as_partial_reflect(), &registry);
            entity.id()
        };
        for path in description.paths() {
            let field = description.get(path).unwrap();
            let range = field
                .range
                .clone()
                .unwrap_or_else(|| panic!("{path} has no range"));
            let place = Place {
                path: format!(".{path}"),
                ..Place::whole(kind.clone(), entity)
            };
            let now = edit::look(app.world(), &registry, &place, |value| {
                (number(value), value.reflect_short_type_path().to_owned())
            });
            // Lists are empty by default, and colours are arrays.
            let Ok((Some(now), name)) = now else { continue };
            fields += 1;
            assert!(range.contains(&now), "{place} is {now}");
            if name == "f32"
                && !description.read_only
                && range.start().is_finite()
                && *range.start() > -1e9
            {
                let below = *range.start() as f32 - 1.0 - range.start().abs() as f32;
                let error = edit::write(app.world_mut(), &place, &below).unwrap_err();
                assert!(
                    matches!(error, edit::EditError::Range(_)),
                    "{place}: {error}"
                );
            }
        }
    }
    assert!(fields >= 15, "{fields}");
}
