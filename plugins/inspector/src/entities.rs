//! Entities: their tree, and what each is to those who draw it, move it and decide for it.

use std::any::TypeId;
use std::sync::Arc;

use bevy::app::App;
use bevy::ecs::prelude::*;
use bevy::ecs::reflect::AppTypeRegistry;
use bevy::ecs::resource::IsResource;
use bevy::platform::collections::HashMap;
use bevy::prelude::{ChildOf, Children, Name};

use crate::settings::edit;
use crate::settings::kinds::Kind;
use crate::settings::place::{Place, PlaceError};

/// Who a component answers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Answer {
    /// What is seen of it.
    Render,
    /// How it meets others.
    Physics,
    /// What it does.
    Logic,
    /// Its place, its name, its parents; and what none of the crates below is known to have.
    Other,
}

impl Answer {
    /// All, in the order in which they are shown.
    pub const ALL: [Self; 4] = [Self::Render, Self::Physics, Self::Logic, Self::Other];

    /// For headings.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Render => "render",
            Self::Physics => "physics",
            Self::Logic => "logic",
            Self::Other => "other",
        }
    }

    /// By the crate that a component is of.
    #[must_use]
    pub fn of_crate(name: &str) -> Self {
        const RENDER: [&str; 22] = [
            "bevy_anti_alias",
            "bevy_camera",
            "bevy_core_pipeline",
            "bevy_light",
            "bevy_mesh",
            "bevy_pbr",
            "bevy_post_process",
            "bevy_render",
            "bevy_sprite",
            "bevy_sprite_render",
            "bevy_text",
            "bevy_ui",
            "bevy_ui_render",
            "bevy_egui",
            "dolomite_character",
            "dolomite_city",
            "dolomite_deferred",
            "dolomite_geometry",
            "dolomite_ground",
            "dolomite_sky",
            "dolomite_tessellation",
            "dolomite_vegetation",
        ];
        const PHYSICS: [&str; 4] = [
            "avian3d",
            "bevy_rapier3d",
            "dolomite_collision",
            "dolomite_terrain",
        ];
        if RENDER.contains(&name) {
            Self::Render
        } else if PHYSICS.contains(&name) {
            Self::Physics
        } else if name == "dolomite_logic" {
            Self::Logic
        } else {
            Self::Other
        }
    }
}

/// A component of an entity.
#[derive(Clone, Debug)]
pub struct Component {
    /// Its name, without its modules.
    pub name: String,
    /// Who it answers to.
    pub answer: Answer,
    /// Where it can be read, if reflection knows it.
    pub kind: Option<Kind>,
    /// What it is now, where reflection does not know it and somebody said how it is read.
    pub text: Option<String>,
}

/// How components are read that reflection does not know: as text, for the entity tree and the command `entity`.
#[derive(Resource, Clone, Default)]
pub struct Readers(HashMap<TypeId, Reader>);

type Reader = Arc<dyn Fn(&World, Entity) -> Option<String> + Send + Sync>;

impl Readers {
    /// What a component of an entity is now, if somebody said how it is read.
    #[must_use]
    pub fn read(&self, world: &World, entity: Entity, component: TypeId) -> Option<String> {
        self.0.get(&component)?(world, entity)
    }
}

/// Says how components are read that reflection does not know.
pub trait ReadComponents {
    /// By a function.
    fn read_component<T: bevy::prelude::Component>(
        &mut self,
        read: impl Fn(&World, &T) -> String + Send + Sync + 'static,
    ) -> &mut Self;

    /// As it is written for debugging.
    fn read_debug<T: bevy::prelude::Component + std::fmt::Debug>(&mut self) -> &mut Self {
        self.read_component::<T>(|_, component| format!("{component:?}"))
    }
}

impl ReadComponents for App {
    fn read_component<T: bevy::prelude::Component>(
        &mut self,
        read: impl Fn(&World, &T) -> String + Send + Sync + 'static,
    ) -> &mut Self {
        self.init_resource::<Readers>();
        let reader: Reader = Arc::new(move |world, entity| {
            let component = world.get::<T>(entity)?;
            Some(read(world, component))
        });
        let mut readers = self.world_mut().resource_mut::<Readers>();
        readers.0.insert(TypeId::of::<T>(), reader);
        self
    }
}

/// A line of the tree.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// The entity.
    pub entity: Entity,
    /// Its name, or the component that says most of it.
    pub label: String,
    /// How many parents are above it.
    pub depth: u32,
    /// How many children it has.
    pub children: u32,
}

/// What an entity is called: its name, else those of its first components.
#[must_use]
pub fn label(world: &World, entity: Entity) -> String {
    if let Some(name) = world.get::<Name>(entity) {
        return name.to_string();
    }
    const PLAIN: [&str; 4] = ["Transform", "GlobalTransform", "ChildOf", "Children"];
    let Ok(components) = world.inspect_entity(entity) else {
        return "gone".to_owned();
    };
    let mut names: Vec<_> = components
        .map(|component| short(&component.name().to_string()))
        .filter(|name| !PLAIN.contains(&name.as_str()))
        .collect();
    // By what is least common, that of the app's own crates; the names alone keep an order from frame to frame.
    names.sort_by_key(|name| (name.contains("Visib"), name.starts_with("Sync")));
    names.truncate(3);
    if names.is_empty() {
        "empty".to_owned()
    } else {
        names.join(", ")
    }
}

/// A name of a type without the modules, also within `<` and `>`.
#[must_use]
pub fn short(path: &str) -> String {
    let mut name = String::new();
    let mut part = String::new();
    for c in path.chars() {
        if c.is_alphanumeric() || c == '_' {
            part.push(c);
        } else if c == ':' {
            part.clear();
        } else {
            name.push_str(&part);
            part.clear();
            name.push(c);
        }
    }
    name + &part
}

/// The tree as lines, parents before children, roots in the order of their numbers; at most `most`, of those whose label
/// contains `filter` in whichever case, with all above them left out. The second number is how many there are in all.
/// Observers, of which an app has hundreds, are listed where they are searched for.
///
/// `open` says of an entity whether its children are listed.
#[must_use]
pub fn tree(
    world: &mut World,
    filter: &str,
    most: usize,
    open: impl Fn(Entity) -> bool,
) -> (Vec<Line>, usize) {
    let mut roots: Vec<_> = world
        .query_filtered::<(Entity, Has<Observer>), (Without<ChildOf>, Without<IsResource>)>()
        .iter(world)
        .filter(|(_, observer)| !observer || !filter.is_empty())
        .map(|(entity, _)| entity)
        .collect();
    roots.sort_unstable_by_key(|entity| (entity.index_u32(), entity.to_bits()));
    let filter = filter.to_lowercase();
    let mut lines = Vec::new();
    let mut count = 0;
    let mut stack: Vec<_> = roots.into_iter().rev().map(|root| (root, 0)).collect();
    while let Some((entity, depth)) = stack.pop() {
        let children = world.get::<Children>(entity);
        let number = children.map_or(0, |children| children.len() as u32);
        if let Some(children) = children
            && (!filter.is_empty() || open(entity))
        {
            stack.extend(children.iter().rev().map(|child| (child, depth + 1)));
        }
        // Names are made for the lines that are shown alone, where nothing has to be searched.
        if filter.is_empty() && lines.len() >= most {
            count += 1;
            continue;
        }
        let label = label(world, entity);
        let found = filter.is_empty()
            || label.to_lowercase().contains(&filter)
            || entity.to_string() == filter;
        if found {
            count += 1;
            if lines.len() < most {
                lines.push(Line {
                    entity,
                    label,
                    depth: if filter.is_empty() { depth } else { 0 },
                    children: number,
                });
            }
        }
    }
    (lines, count)
}

/// The components of an entity, by whom they answer to and by name.
///
/// # Errors
/// [`PlaceError::Gone`].
pub fn components(world: &World, entity: Entity) -> Result<Vec<Component>, PlaceError> {
    let registry = world.resource::<AppTypeRegistry>().read();
    let readers = world.get_resource::<Readers>();
    let infos = world
        .inspect_entity(entity)
        .map_err(|_| PlaceError::Gone { entity })?;
    let mut components: Vec<_> = infos
        .map(|info| {
            let path = info.name().to_string();
            let registration = info.type_id().and_then(|id| registry.get(id));
            let kind = registration.and_then(Kind::of);
            let text = match (&kind, info.type_id()) {
                (None, Some(id)) => readers.and_then(|readers| readers.read(world, entity, id)),
                _ => None,
            };
            let of_crate = path.split("::").next().unwrap_or_default();
            Component {
                name: short(&path),
                answer: Answer::of_crate(of_crate),
                kind,
                text,
            }
        })
        .collect();
    components.sort_by(|a, b| (a.answer, &a.name).cmp(&(b.answer, &b.name)));
    Ok(components)
}

/// All that is known of an entity, as text: a heading for each answer, a component a line with its value, where
/// reflection knows it.
///
/// # Errors
/// [`PlaceError::Gone`].
pub fn describe(world: &World, entity: Entity) -> Result<String, PlaceError> {
    let components = components(world, entity)?;
    let mut text = format!("{entity} {}\n", label(world, entity));
    for answer in Answer::ALL {
        let of_it: Vec<_> = components.iter().filter(|c| c.answer == answer).collect();
        if of_it.is_empty() {
            continue;
        }
        text += &format!("{}:\n", answer.name());
        for component in of_it {
            let value = component
                .kind
                .clone()
                .and_then(|kind| edit::read(world, &Place::whole(kind, entity)).ok())
                .or_else(|| component.text.clone())
                .unwrap_or_default();
            // What has lines of its own stands below its name.
            let value = value.trim_end().replace('\n', "\n    ");
            text += &format!("  {} {value}\n", component.name);
        }
    }
    Ok(text)
}
