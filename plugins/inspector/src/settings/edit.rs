//! Values are read and written, as RON and by reflection, and what was written can be taken back.

use bevy::ecs::prelude::*;
use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy::reflect::serde::{TypedReflectDeserializer, TypedReflectSerializer};
use bevy::reflect::{
    GetPath, PartialReflect, Reflect, ReflectFromReflect, ReflectRef, TypeRegistry,
};
use ron::extensions::Extensions;
use serde::de::DeserializeSeed;
use thiserror::Error;

use super::described::{Descriptions, RangeError, check, described_path};
use super::place::{Place, PlaceError};

/// Why a value was not read or not written.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum EditError {
    /// The place is not there.
    #[error(transparent)]
    Place(#[from] PlaceError),
    /// The way into the component leads nowhere.
    #[error("{place}: {reason}")]
    Path {
        /// As it was written.
        place: String,
        /// What Bevy's reflection says.
        reason: String,
    },
    /// The text is no value of this type.
    #[error("`{text}` is no {kind}: {reason}")]
    Text {
        /// As it was written.
        text: String,
        /// The type.
        kind: String,
        /// Column and reason.
        reason: String,
    },
    /// A number may not be set.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// It is an answer of a plugin.
    #[error("{0} is what a plugin answers: it is read, not set")]
    ReadOnly(&'static str),
    /// Bevy lets nobody change it in place.
    #[error("{0} is immutable")]
    Immutable(&'static str),
    /// Reflection cannot make or read such a value.
    #[error("{place}: {reason}")]
    Opaque {
        /// What.
        place: String,
        /// What Bevy's reflection says.
        reason: String,
    },
}

/// A change that was made.
#[derive(Debug)]
pub struct Change {
    /// Where.
    pub place: Place,
    before: Box<dyn PartialReflect>,
    after: Box<dyn PartialReflect>,
}

/// Values without names of types, `None` and values written plainly: as people type them.
fn options() -> ron::Options {
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME | Extensions::UNWRAP_VARIANT_NEWTYPES)
}

/// Lets `read` look at the value at `place`.
///
/// # Errors
/// [`EditError::Place`], [`EditError::Path`].
pub fn look<T>(
    world: &World,
    registry: &TypeRegistry,
    place: &Place,
    read: impl FnOnce(&dyn PartialReflect) -> T,
) -> Result<T, EditError> {
    let entity = place.entity;
    let entity = world
        .get_entity(entity)
        .map_err(|_| PlaceError::Gone { entity })?;
    let without = || PlaceError::Without {
        entity: place.entity,
        name: place.kind.name,
    };
    let component = registry
        .get_type_data::<ReflectComponent>(place.kind.id)
        .ok_or_else(without)?
        .reflect(entity)
        .ok_or_else(without)?;
    let value = component
        .reflect_path(place.path.as_str())
        .map_err(|error| path_error(place, &error))?;
    Ok(read(value))
}

fn path_error(place: &Place, error: &impl ToString) -> EditError {
    EditError::Path {
        place: place.to_string(),
        reason: error.to_string(),
    }
}

/// The value as RON, on one line.
///
/// # Errors
/// [`EditError`].
pub fn read(world: &World, place: &Place) -> Result<String, EditError> {
    let registry = world.resource::<AppTypeRegistry>().read();
    look(world, &registry, place, |value| {
        let serializer = TypedReflectSerializer::new(value, &registry);
        options()
            .to_string(&serializer)
            .map_err(|error| opaque(place, error))
    })?
}

/// The value as RON, a field a line: for files.
///
/// # Errors
/// [`EditError`].
pub fn read_pretty(world: &World, place: &Place) -> Result<String, EditError> {
    let registry = world.resource::<AppTypeRegistry>().read();
    look(world, &registry, place, |value| {
        let serializer = TypedReflectSerializer::new(value, &registry);
        let pretty = ron::ser::PrettyConfig::default();
        options()
            .to_string_pretty(&serializer, pretty)
            .map_err(|error| opaque(place, error))
    })?
}

fn opaque(place: &Place, reason: impl ToString) -> EditError {
    EditError::Opaque {
        place: place.to_string(),
        reason: reason.to_string(),
    }
}

/// Sets the value to what RON in `text` says; where it is a text, also to `text` as it is.
///
/// # Errors
/// [`EditError`]; then nothing has changed.
pub fn write_ron(world: &mut World, place: &Place, text: &str) -> Result<Change, EditError> {
    let value = {
        let registry = world.resource::<AppTypeRegistry>().read();
        look(world, &registry, place, |now| parse(&registry, now, text))??
    };
    write(world, place, value.as_ref())
}

/// What `text` says, of the type that `now` has.
fn parse(
    registry: &TypeRegistry,
    now: &dyn PartialReflect,
    text: &str,
) -> Result<Box<dyn PartialReflect>, EditError> {
    let info = now.get_represented_type_info();
    let kind = info.map_or("value", |info| info.type_path_table().short_path());
    let error = |reason: String| EditError::Text {
        text: text.to_owned(),
        kind: kind.to_owned(),
        reason,
    };
    let registration = info
        .and_then(|info| registry.get(info.type_id()))
        .ok_or_else(|| error("its type is not registered".to_owned()))?;
    if now.try_downcast_ref::<String>().is_some() && !text.starts_with('"') {
        return Ok(Box::new(text.to_owned()));
    }
    let mut deserializer = ron::Deserializer::from_str_with_options(text, &options())
        .map_err(|wrong| error(wrong.to_string()))?;
    let value = TypedReflectDeserializer::new(registration, registry)
        .deserialize(&mut deserializer)
        .map_err(|wrong| error(deserializer.span_error(wrong).to_string()))?;
    deserializer
        .end()
        .map_err(|wrong| error(deserializer.span_error(wrong).to_string()))?;
    Ok(value)
}

/// Sets the value at `place`.
///
/// # Errors
/// [`EditError`]; then nothing has changed.
pub fn write(
    world: &mut World,
    place: &Place,
    value: &dyn PartialReflect,
) -> Result<Change, EditError> {
    let descriptions = world.get_resource::<Descriptions>();
    let description = descriptions.and_then(|all| all.get(place.kind.id));
    if description.is_some_and(|description| description.read_only) {
        return Err(EditError::ReadOnly(place.kind.name));
    }
    check(description, &described_path(&place.path), value)?;
    let registry = world.resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let before = look(world, &registry, place, |value| snapshot(place, value))??;
    put(world, &registry, place, value)?;
    let after = look(world, &registry, place, |value| snapshot(place, value))??;
    Ok(Change {
        place: place.clone(),
        before,
        after,
    })
}

/// A copy, in parts where it cannot be had whole.
fn snapshot(
    place: &Place,
    value: &dyn PartialReflect,
) -> Result<Box<dyn PartialReflect>, EditError> {
    if let Ok(whole) = value.reflect_clone() {
        return Ok(whole.into_partial_reflect());
    }
    // `to_dynamic` clones what has no parts, and panics where that cannot be done.
    if !has_copyable_parts(value) {
        return Err(opaque(place, "it has parts that cannot be copied"));
    }
    Ok(value.to_dynamic())
}

fn has_copyable_parts(value: &dyn PartialReflect) -> bool {
    match value.reflect_ref() {
        ReflectRef::Struct(value) => value
            .iter_fields()
            .all(|(_, part)| has_copyable_parts(part)),
        ReflectRef::TupleStruct(value) => value.iter_fields().all(has_copyable_parts),
        ReflectRef::Tuple(value) => value.iter_fields().all(has_copyable_parts),
        ReflectRef::List(value) => value.iter().all(has_copyable_parts),
        ReflectRef::Array(value) => value.iter().all(has_copyable_parts),
        ReflectRef::Enum(value) => value
            .iter_fields()
            .all(|part| has_copyable_parts(part.value())),
        ReflectRef::Map(value) => value
            .iter()
            .all(|(key, part)| has_copyable_parts(key) && has_copyable_parts(part)),
        ReflectRef::Set(value) => value.iter().all(has_copyable_parts),
        _ => value.reflect_clone().is_ok(),
    }
}

fn put(
    world: &mut World,
    registry: &TypeRegistry,
    place: &Place,
    value: &dyn PartialReflect,
) -> Result<(), EditError> {
    let info = world.components().get_id(place.kind.id);
    let mutable = info
        .and_then(|component| world.components().get_info(component))
        .is_some_and(|info| info.mutable());
    if !mutable {
        return Err(EditError::Immutable(place.kind.name));
    }
    let entity = place.entity;
    let component = registry
        .get_type_data::<ReflectComponent>(place.kind.id)
        .ok_or(PlaceError::Without {
            entity,
            name: place.kind.name,
        })?
        .clone();
    let entity_mut = world
        .get_entity_mut(entity)
        .map_err(|_| PlaceError::Gone { entity })?;
    let mut component = component
        .reflect_mut(entity_mut)
        .ok_or(PlaceError::Without {
            entity,
            name: place.kind.name,
        })?;
    let target = component
        .reflect_path_mut(place.path.as_str())
        .map_err(|error| path_error(place, &error))?;
    // A whole value of the type takes the place of the other, lists with their lengths; what reflection cannot make
    // whole is applied part by part.
    match concrete(registry, target, value) {
        Some(whole) => match target.try_as_reflect_mut() {
            Some(target) => target.set(whole).map_err(|_| opaque(place, "another type")),
            None => target
                .try_apply(whole.as_partial_reflect())
                .map_err(|error| opaque(place, error)),
        },
        None => target
            .try_apply(value)
            .map_err(|error| opaque(place, error)),
    }
}

fn concrete(
    registry: &TypeRegistry,
    target: &dyn PartialReflect,
    value: &dyn PartialReflect,
) -> Option<Box<dyn Reflect>> {
    let id = target.get_represented_type_info()?.type_id();
    registry
        .get_type_data::<ReflectFromReflect>(id)?
        .from_reflect(value)
}

/// What was changed, and what was taken back.
#[derive(Resource, Debug, Default)]
pub struct Undo {
    done: Vec<Change>,
    undone: Vec<Change>,
}

/// Most changes that can be taken back.
const MOST: usize = 256;

impl Undo {
    /// Keeps a change. `same_hand`: it goes on with the last one where that is of the same place, as a slider does that is
    /// being dragged.
    pub fn push(&mut self, change: Change, same_hand: bool) {
        self.undone.clear();
        if same_hand
            && let Some(last) = self.done.last_mut()
            && last.place == change.place
        {
            last.after = change.after;
            return;
        }
        if self.done.len() == MOST {
            self.done.remove(0);
        }
        self.done.push(change);
    }

    /// How many changes can be taken back, and how many made again.
    #[must_use]
    pub const fn len(&self) -> (usize, usize) {
        (self.done.len(), self.undone.len())
    }
}

/// Takes the last change back; where it was, or `None` where there is none.
///
/// # Errors
/// [`EditError`], where the entity is gone or has lost the component: that change is forgotten.
pub fn undo(world: &mut World) -> Result<Option<Place>, EditError> {
    step(world, |undo| undo.done.pop(), true)
}

/// Makes the change again that was taken back last.
///
/// # Errors
/// As [`undo`].
pub fn redo(world: &mut World) -> Result<Option<Place>, EditError> {
    step(world, |undo| undo.undone.pop(), false)
}

fn step(
    world: &mut World,
    take: impl FnOnce(&mut Undo) -> Option<Change>,
    back: bool,
) -> Result<Option<Place>, EditError> {
    let mut undo = world.get_resource_or_init::<Undo>();
    let Some(change) = take(&mut undo) else {
        return Ok(None);
    };
    let registry = world.resource::<AppTypeRegistry>().clone();
    let value = if back { &change.before } else { &change.after };
    put(world, &registry.read(), &change.place, value.as_ref())?;
    let place = change.place.clone();
    let mut undo = world.resource_mut::<Undo>();
    if back {
        undo.undone.push(change);
    } else {
        undo.done.push(change);
    }
    Ok(Some(place))
}
