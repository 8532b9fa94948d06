//! What can be set in an app: every component and every resource that its registry knows how to reflect.

use std::any::TypeId;

use bevy::ecs::prelude::*;
use bevy::ecs::reflect::{ReflectComponent, ReflectResource};
use bevy::reflect::{TypeRegistration, TypeRegistry};

/// A component or a resource that can be read by reflection. Resources are components of an entity of their own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kind {
    /// Its type.
    pub id: TypeId,
    /// The whole name, such as `dolomite_sky::components::Sky`.
    pub path: &'static str,
    /// The last part of the name.
    pub name: &'static str,
    /// The crate that it is of.
    pub of_crate: &'static str,
    /// There is one in the app, not one an entity.
    pub resource: bool,
}

impl Kind {
    /// What `registration` says, where it is a component or a resource.
    #[must_use]
    pub fn of(registration: &TypeRegistration) -> Option<Self> {
        registration.data::<ReflectComponent>()?;
        let info = registration.type_info();
        let table = info.type_path_table();
        Some(Self {
            id: registration.type_id(),
            path: table.path(),
            name: table.short_path(),
            of_crate: table.crate_name().unwrap_or("no crate"),
            resource: registration.data::<ReflectResource>().is_some(),
        })
    }

    /// Whether it is one of Bevy's own.
    #[must_use]
    pub fn is_of_bevy(&self) -> bool {
        self.of_crate == "bevy" || self.of_crate.starts_with("bevy_")
    }
}

/// All kinds, by crate and name.
#[must_use]
pub fn kinds(registry: &TypeRegistry) -> Vec<Kind> {
    let mut kinds: Vec<_> = registry.iter().filter_map(Kind::of).collect();
    kinds.sort_by(|a, b| (a.of_crate, a.name, a.path).cmp(&(b.of_crate, b.name, b.path)));
    kinds
}

/// The kinds that a name means: its whole name, else the last part of it, whatever the case.
#[must_use]
pub fn named<'a>(kinds: &'a [Kind], name: &str) -> Vec<&'a Kind> {
    let whole: Vec<_> = kinds.iter().filter(|kind| kind.path == name).collect();
    if !whole.is_empty() {
        return whole;
    }
    let exact: Vec<_> = kinds.iter().filter(|kind| kind.name == name).collect();
    if !exact.is_empty() {
        return exact;
    }
    let same = |kind: &&Kind| kind.name.eq_ignore_ascii_case(name);
    kinds.iter().filter(same).collect()
}

/// The entities that have it, in the order of their numbers; for a resource the one that holds it.
///
/// Looks through the archetypes, not through the entities.
#[must_use]
pub fn holders(world: &World, kind: TypeId) -> Vec<Entity> {
    let Some(component) = world.components().get_id(kind) else {
        return Vec::new();
    };
    let mut holders: Vec<_> = world
        .archetypes()
        .iter()
        .filter(|archetype| archetype.contains(component))
        .flat_map(|archetype| archetype.entities().iter().map(|entity| entity.id()))
        .collect();
    holders.sort_unstable_by_key(|entity| (entity.index_u32(), entity.to_bits()));
    holders
}

/// How many entities have it.
#[must_use]
pub fn count(world: &World, kind: TypeId) -> usize {
    world.components().get_id(kind).map_or(0, |component| {
        let with = world.archetypes().iter();
        with.filter(|archetype| archetype.contains(component))
            .map(|archetype| archetype.len() as usize)
            .sum()
    })
}
