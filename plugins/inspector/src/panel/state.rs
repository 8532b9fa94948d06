//! What the windows remember, and what widgets ask for.

use bevy::ecs::entity::Entity;
use bevy::ecs::prelude::*;
use bevy::platform::collections::HashSet;

use super::clip::Clip;
use crate::console::{Console, Tone};
use crate::settings::edit::{self, Undo};
use crate::settings::place::Place;

/// Which tab is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tab {
    /// Settings by plugin.
    #[default]
    Settings,
    /// The tree of entities, and what the chosen one is.
    Entities,
    /// Diagnostics: plots, passes, sums by plugin.
    Diagnostics,
    /// Views of the frame.
    Views,
}

/// What the windows remember.
#[derive(Resource, Default)]
pub struct Shell {
    /// The tab.
    pub tab: Tab,
    /// What is searched for in it.
    pub filter: String,
    /// Bevy's own settings are listed too.
    pub all: bool,
    /// The entity that is shown.
    pub chosen: Option<Entity>,
    pub(super) open: HashSet<Entity>,
    pub(super) line: String,
    pub(super) seen: u64,
    /// The setting that is being dragged, so that one pull is one change to take back.
    pub(super) hand: Option<Place>,
}

/// Does something; a refusal is said in the console.
pub(super) fn said(
    world: &mut World,
    does: impl FnOnce(&mut World) -> Result<(), edit::EditError>,
) {
    if let Err(error) = does(world) {
        world
            .resource_mut::<Console>()
            .say(Tone::Fault, &error.to_string());
    }
}

/// Makes the change that was asked for in a widget.
pub(super) fn change(
    world: &mut World,
    shell: &mut Shell,
    place: &Place,
    value: &dyn bevy::reflect::PartialReflect,
) {
    let same_hand = shell.hand.as_ref() == Some(place);
    said(world, |world| {
        let change = edit::write(world, place, value)?;
        world.resource_mut::<Undo>().push(change, same_hand);
        Ok(())
    });
    shell.hand = Some(place.clone());
}

/// Copies all of a setting as RON, to the clipboard and into the console.
pub(super) fn copy(world: &mut World, place: &Place) {
    said(world, |world| {
        let text = edit::read_pretty(world, place)?;
        let copied = world.get_resource_or_init::<Clip>().copy(&text);
        let mut console = world.resource_mut::<Console>();
        match copied {
            Ok(()) => console.say(Tone::Said, &format!("copied {place}:")),
            Err(error) => console.say(Tone::Fault, &format!("no clipboard: {error}")),
        }
        console.say(Tone::Said, &text);
        Ok(())
    });
}
