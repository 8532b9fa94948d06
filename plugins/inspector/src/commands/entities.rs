//! Entities by their numbers and names.

use bevy::ecs::prelude::*;
use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy::prelude::ReflectDefault;
use bevy::reflect::TypeRegistry;
use clap::Command;

use super::{joined, needed, rest, text};
use crate::console::table::{Mistake, Step, Table};
use crate::entities::{describe, tree};
use crate::settings::edit;
use crate::settings::kinds::Kind;
use crate::settings::place::{Place, find_entity, find_kind};

/// Most lines that `entities` says.
const MOST: usize = 100;

pub(super) fn add(table: &mut Table) {
    table.add(
        Command::new("entities")
            .about("List entities, as a tree or by a part of their label")
            .arg(rest("filter", "TEXT")),
        |world, matches| {
            let (lines, count) = tree(world, &joined(matches, "filter"), MOST, |_| true);
            let mut text: String = lines
                .iter()
                .map(|line| {
                    let indent = 2 * line.depth as usize;
                    format!("{:indent$}{} {}\n", "", line.entity, line.label)
                })
                .collect();
            text += &format!("{count} entities");
            if count > lines.len() {
                text += &format!(", {} shown", lines.len());
            }
            Ok(Step::Said(text))
        },
    );
    table.add(
        Command::new("entity")
            .about("Say what an entity is to render, physics and logic")
            .arg(needed("entity", "ENTITY").help("Its number, such as 12v0, or its name")),
        |world, matches| {
            let entity = find_entity(world, text(matches, "entity").unwrap_or_default());
            let entity = entity.map_err(Mistake::of)?;
            describe(world, entity).map(Step::Said).map_err(Mistake::of)
        },
    );
    table.add(
        Command::new("spawn")
            .about(
                "Spawn an entity with these components, as they are by default or by RON after =",
            )
            .arg(
                rest("components", "COMPONENT")
                    .required(true)
                    .help("Such as: Sun, or 'Sun=(azimuth: 90.0, elevation: 5.0)'"),
            ),
        |world, matches| {
            let words = matches.get_many::<String>("components");
            let words: Vec<_> = words.into_iter().flatten().map(String::as_str).collect();
            spawn(world, &words).map(|entity| Step::Said(format!("{entity} spawned")))
        },
    );
    table.add(
        Command::new("despawn")
            .about("Despawn an entity and its children")
            .arg(needed("entity", "ENTITY").help("Its number, such as 12v0, or its name")),
        |world, matches| {
            let entity = find_entity(world, text(matches, "entity").unwrap_or_default());
            let entity = entity.map_err(Mistake::of)?;
            if world
                .get::<bevy::ecs::resource::IsResource>(entity)
                .is_some()
            {
                return Err(Mistake(format!("{entity} holds a resource: it stays")));
            }
            world.despawn(entity);
            Ok(Step::Said(format!("{entity} despawned")))
        },
    );
}

/// All words are understood before anything is spawned; a value that is refused takes the entity with it.
fn spawn(world: &mut World, words: &[&str]) -> Result<Entity, Mistake> {
    let registry = world.resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let mut parts = Vec::new();
    for word in words {
        let (name, value) = match word.split_once('=') {
            Some((name, value)) => (name, Some(value)),
            None => (*word, None),
        };
        let kind = find_kind(&registry, name).map_err(Mistake::of)?;
        if kind.resource {
            return Err(Mistake(format!(
                "{} is a resource, not a component",
                kind.name
            )));
        }
        let (component, default) = makers(&registry, &kind)?;
        parts.push((kind, component, default, value));
    }
    let entity = world.spawn_empty().id();
    for (_, component, default, _) in &parts {
        let value = default.default();
        let mut entity = world.entity_mut(entity);
        component.insert(&mut entity, value.as_partial_reflect(), &registry);
    }
    for (kind, _, _, value) in parts {
        if let Some(value) = value {
            let place = Place::whole(kind, entity);
            if let Err(error) = edit::write_ron(world, &place, value) {
                world.despawn(entity);
                return Err(Mistake::of(error));
            }
        }
    }
    Ok(entity)
}

fn makers(
    registry: &TypeRegistry,
    kind: &Kind,
) -> Result<(ReflectComponent, ReflectDefault), Mistake> {
    let registration = registry.get(kind.id);
    let component = registration.and_then(|r| r.data::<ReflectComponent>());
    let default = registration.and_then(|r| r.data::<ReflectDefault>());
    match (component, default) {
        (Some(component), Some(default)) => Ok((component.clone(), default.clone())),
        _ => Err(Mistake(format!(
            "{} has no default that reflection knows: it cannot be spawned from here",
            kind.name
        ))),
    }
}
