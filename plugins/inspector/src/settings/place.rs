//! Where a value is, and how that is written: `Sky.dust`, `Sky@12v0.dust`, `Sky@camera`, `dolomite_sky::components::Sky`.

use std::any::TypeId;

use bevy::ecs::entity::{EntityGeneration, EntityIndex};
use bevy::ecs::prelude::*;
use bevy::prelude::Name;
use bevy::reflect::TypeRegistry;
use thiserror::Error;

use super::kinds::{Kind, holders, kinds, named};

/// Most names that a message lists.
const LISTED: usize = 8;

/// A value of an entity's component.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The component.
    pub kind: Kind,
    /// The entity that has it.
    pub entity: Entity,
    /// The way to the value within it, as Bevy's reflection writes it: `.dust`, `.sea[2].0`; empty for all of it.
    pub path: String,
}

impl Place {
    /// The whole component of an entity.
    #[must_use]
    pub const fn whole(kind: Kind, entity: Entity) -> Self {
        Self {
            kind,
            entity,
            path: String::new(),
        }
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.kind.name)?;
        if !self.kind.resource {
            write!(f, "@{}", self.entity)?;
        }
        f.write_str(&self.path)
    }
}

/// Why a place was not found.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PlaceError {
    /// No component or resource has the name.
    #[error("`{name}` is no component or resource that this app has registered{near}")]
    Unknown {
        /// As it was written.
        name: String,
        /// Names like it.
        near: String,
    },
    /// Several have it.
    #[error("`{name}` may be {paths}: write the whole name")]
    Several {
        /// As it was written.
        name: String,
        /// Their whole names.
        paths: String,
    },
    /// No entity has the component.
    #[error("no entity has a {name} now")]
    Nowhere {
        /// The component.
        name: &'static str,
    },
    /// Several have it, and none was named.
    #[error(
        "{count} entities have a {name}: say which, for instance {name}@{example}; there are {list}"
    )]
    WhichEntity {
        /// The component.
        name: &'static str,
        /// How many.
        count: usize,
        /// The first.
        example: Entity,
        /// The first few.
        list: String,
    },
    /// What stands behind `@` is no entity.
    #[error("`{text}` is no entity: write its number, as in 12v0, or its name")]
    NoEntity {
        /// As it was written.
        text: String,
    },
    /// The entity is not there any more.
    #[error("the entity {entity} is gone")]
    Gone {
        /// Which.
        entity: Entity,
    },
    /// The entity has none.
    #[error("the entity {entity} has no {name}")]
    Without {
        /// Which.
        entity: Entity,
        /// The component.
        name: &'static str,
    },
}

/// Finds the place that a text means. Where no entity is named there has to be one alone that has the component.
///
/// # Errors
/// [`PlaceError`].
pub fn find(world: &World, registry: &TypeRegistry, text: &str) -> Result<Place, PlaceError> {
    let (head, path) = split_path(text);
    let (name, entity) = match head.split_once('@') {
        Some((name, entity)) => (name, Some(entity)),
        None => (head, None),
    };
    let kind = find_kind(registry, name)?;
    let entity = match entity {
        Some(text) => find_entity(world, text)?,
        None => the_one(world, &kind)?,
    };
    if world.get_entity(entity).is_err() {
        return Err(PlaceError::Gone { entity });
    }
    has(world, entity, &kind)?;
    Ok(Place {
        kind,
        entity,
        path: path.to_owned(),
    })
}

/// The kind that a name means.
///
/// # Errors
/// [`PlaceError::Unknown`], [`PlaceError::Several`].
pub fn find_kind(registry: &TypeRegistry, name: &str) -> Result<Kind, PlaceError> {
    let kinds = kinds(registry);
    match named(&kinds, name).as_slice() {
        [kind] => Ok((*kind).clone()),
        [] => {
            let like = name.to_lowercase();
            let near = kinds
                .iter()
                .filter(|kind| !like.is_empty() && kind.name.to_lowercase().contains(&like))
                .map(|kind| kind.name);
            let near = list(near);
            Err(PlaceError::Unknown {
                name: name.to_owned(),
                near: if near.is_empty() {
                    near
                } else {
                    format!("; there are {near}")
                },
            })
        }
        several => Err(PlaceError::Several {
            name: name.to_owned(),
            paths: list(several.iter().map(|kind| kind.path)),
        }),
    }
}

/// The entity that a text means: `12v0`, or the name of one alone.
///
/// # Errors
/// [`PlaceError::NoEntity`], [`PlaceError::Gone`].
pub fn find_entity(world: &World, text: &str) -> Result<Entity, PlaceError> {
    if let Some(entity) = number(text) {
        return match world.get_entity(entity) {
            Ok(_) => Ok(entity),
            Err(_) => Err(PlaceError::Gone { entity }),
        };
    }
    let mut with = holders(world, TypeId::of::<Name>())
        .into_iter()
        .filter(|entity| {
            let name = world.get::<Name>(*entity);
            name.is_some_and(|name| name.as_str() == text)
        });
    match (with.next(), with.next()) {
        (Some(entity), None) => Ok(entity),
        _ => Err(PlaceError::NoEntity {
            text: text.to_owned(),
        }),
    }
}

/// `12v0` as an entity, whether it is there or not.
fn number(text: &str) -> Option<Entity> {
    let (index, generation) = text.split_once('v')?;
    let index = EntityIndex::from_raw_u32(index.parse().ok()?)?;
    let generation = EntityGeneration::from_bits(generation.parse().ok()?);
    Some(Entity::from_index_and_generation(index, generation))
}

fn the_one(world: &World, kind: &Kind) -> Result<Entity, PlaceError> {
    let name = kind.name;
    match holders(world, kind.id).as_slice() {
        [] => Err(PlaceError::Nowhere { name }),
        [entity] => Ok(*entity),
        several => Err(PlaceError::WhichEntity {
            name,
            count: several.len(),
            example: several[0],
            list: list(several.iter().map(ToString::to_string)),
        }),
    }
}

fn has(world: &World, entity: Entity, kind: &Kind) -> Result<(), PlaceError> {
    let component = world.components().get_id(kind.id);
    let there = component.is_some_and(|component| {
        let entity = world.get_entity(entity);
        entity.is_ok_and(|entity| entity.contains_id(component))
    });
    if there {
        Ok(())
    } else {
        Err(PlaceError::Without {
            entity,
            name: kind.name,
        })
    }
}

/// What stands before the way into a component, and the way: from the first `.`, `[` or `#` on that is of no name of an
/// entity in brackets or generics.
fn split_path(text: &str) -> (&str, &str) {
    let mut angles = 0_i32;
    for (at, c) in text.char_indices() {
        match c {
            '<' => angles += 1,
            '>' => angles -= 1,
            '.' | '[' | '#' if angles <= 0 => return text.split_at(at),
            _ => {}
        }
    }
    (text, "")
}

/// Up to [`LISTED`] texts, and how many more there are.
fn list<T: AsRef<str>>(texts: impl Iterator<Item = T>) -> String {
    let texts: Vec<_> = texts.collect();
    let shown: Vec<_> = texts.iter().take(LISTED).map(AsRef::as_ref).collect();
    let mut text = shown.join(", ");
    if texts.len() > LISTED {
        text += &format!(" and {} more", texts.len() - LISTED);
    }
    text
}
