//! Settings by their names.

use bevy::ecs::prelude::*;
use bevy::ecs::reflect::AppTypeRegistry;
use bevy::reflect::{TypeInfo, TypeRegistry};
use clap::Command;

use super::{joined, needed, rest, text};
use crate::console::table::{Mistake, Step, Table};
use crate::settings::described::Descriptions;
use crate::settings::edit::{self, Undo};
use crate::settings::kinds::{Kind, count, kinds};
use crate::settings::place::{Place, find};

pub(super) fn add(table: &mut Table) {
    table.add(
        Command::new("get")
            .about("Say what a setting is, as RON: Sky, Sky.dust, Sky@12v0.dust")
            .arg(needed("setting", "SETTING")),
        |world, matches| {
            let place = place(world, text(matches, "setting").unwrap_or_default())?;
            let value = edit::read(world, &place).map_err(Mistake::of)?;
            Ok(Step::Said(format!(
                "{place} {value}{}",
                known(world, &place)
            )))
        },
    );
    table.add(
        Command::new("set")
            .about("Set a setting to a value of RON: set Sky.dust 20")
            .arg(needed("setting", "SETTING"))
            .arg(rest("value", "VALUE").required(true)),
        |world, matches| {
            let place = place(world, text(matches, "setting").unwrap_or_default())?;
            let change =
                edit::write_ron(world, &place, &joined(matches, "value")).map_err(Mistake::of)?;
            world.get_resource_or_init::<Undo>().push(change, false);
            let value = edit::read(world, &place).map_err(Mistake::of)?;
            Ok(Step::Said(format!("{place} {value}")))
        },
    );
    table.add(
        Command::new("copy")
            .about("Say all of a setting as RON, a field a line, for a file")
            .arg(needed("setting", "SETTING")),
        |world, matches| {
            let place = place(world, text(matches, "setting").unwrap_or_default())?;
            edit::read_pretty(world, &place)
                .map(Step::Said)
                .map_err(Mistake::of)
        },
    );
    table.add(
        Command::new("undo").about("Take the last change of a setting back"),
        |world, _| taken(edit::undo(world), "nothing to take back"),
    );
    table.add(
        Command::new("redo").about("Make a change again that was taken back"),
        |world, _| taken(edit::redo(world), "nothing was taken back"),
    );
    table.add(
        Command::new("settings")
            .about("List what can be set, and how many entities have it")
            .arg(rest("filter", "COMPONENT").help("Part of a name, or of a crate's")),
        |world, matches| {
            let filter = joined(matches, "filter").to_lowercase();
            let registry = world.resource::<AppTypeRegistry>().read();
            let descriptions = world.get_resource::<Descriptions>();
            let mut text = String::new();
            for kind in kinds(&registry) {
                let found = if filter.is_empty() {
                    !kind.is_of_bevy()
                } else {
                    kind.path.to_lowercase().contains(&filter)
                };
                if found {
                    let about = descriptions
                        .and_then(|all| all.get(kind.id))
                        .map_or("", |description| description.about.as_ref());
                    let count = count(world, kind.id);
                    text += &format!("{:<24} {count:>5}  {about}\n", kind.name);
                }
            }
            Ok(Step::Said(text))
        },
    );
}

fn place(world: &World, text: &str) -> Result<Place, Mistake> {
    let registry = world.resource::<AppTypeRegistry>().read();
    find(world, &registry, text).map_err(Mistake::of)
}

fn taken(step: Result<Option<Place>, edit::EditError>, none: &str) -> Result<Step, Mistake> {
    match step.map_err(Mistake::of)? {
        Some(place) => Ok(Step::Said(place.to_string())),
        None => Err(Mistake(none.to_owned())),
    }
}

/// Range and unit, where they are known.
fn known(world: &World, place: &Place) -> String {
    let descriptions = world.get_resource::<Descriptions>();
    let description = descriptions.and_then(|all| all.get(place.kind.id));
    let path = crate::settings::described::described_path(&place.path);
    let Some(field) = description.and_then(|description| description.of_value(&path)) else {
        return String::new();
    };
    let mut text = String::new();
    if !field.unit.is_empty() {
        text += &format!(" {}", field.unit);
    }
    if let Some(range) = &field.range {
        text += &format!(", {} to {}", range.start(), range.end());
    }
    if !field.about.is_empty() {
        text += &format!(": {}", field.about);
    }
    text
}

/// Names of a kind's fields, and of theirs, with the kind's before them.
pub(super) fn fields(registry: &TypeRegistry, kind: &Kind) -> Vec<String> {
    let mut names = Vec::new();
    // A few steps are as far as people type, and end types that hold themselves.
    let mut stack = vec![(kind.name.to_owned(), kind.id, 0)];
    while let Some((name, id, depth)) = stack.pop() {
        let Some(TypeInfo::Struct(info)) = registry.get_type_info(id) else {
            continue;
        };
        for field in info.iter().filter(|_| depth < 3) {
            let name = format!("{name}.{}", field.name());
            names.push(name.clone());
            stack.push((name, field.type_id(), depth + 1));
        }
    }
    names
}
