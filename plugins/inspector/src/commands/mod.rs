//! The commands that every app has.
//!
//! | file | commands |
//! |---|---|
//! | [`settings`] | `get`, `set`, `copy`, `undo`, `redo`, `settings` |
//! | [`entities`] | `entities`, `entity`, `spawn`, `despawn` |
//! | [`frame`] | `stat`, `watch`, `views` |
//! | [`chart`] | `chart` |
//! | `panel` | `inspect` (feature `panel`) |
//! | [`own`] | `exec`, `wait`, `history`, `clear` |

pub mod chart;
pub mod entities;
pub mod frame;
pub mod own;
#[cfg(feature = "panel")]
pub mod panel;
pub mod settings;

use bevy::diagnostic::DiagnosticsStore;
use bevy::ecs::prelude::*;
use bevy::ecs::reflect::AppTypeRegistry;
use clap::{Arg, ArgMatches};

use crate::console::Console;
use crate::settings::kinds::kinds;
use crate::views::FrameViews;

/// Adds them to a console.
pub fn add(console: &mut Console) {
    let table = &mut console.table;
    settings::add(table);
    entities::add(table);
    frame::add(table);
    chart::add(table);
    #[cfg(feature = "panel")]
    panel::add(table);
    own::add(table);
}

/// An argument that has to be there. `value` names what it is, in help and for completion.
fn needed(id: &'static str, value: &'static str) -> Arg {
    Arg::new(id).value_name(value).required(true)
}

/// All words from here on; they may begin with a minus.
fn rest(id: &'static str, value: &'static str) -> Arg {
    Arg::new(id)
        .value_name(value)
        .num_args(1..)
        .allow_hyphen_values(true)
        .trailing_var_arg(true)
}

fn text<'a>(matches: &'a ArgMatches, id: &str) -> Option<&'a str> {
    matches.get_one::<String>(id).map(String::as_str)
}

fn joined(matches: &ArgMatches, id: &str) -> String {
    let words = matches.get_many::<String>(id).into_iter().flatten();
    words.map(String::as_str).collect::<Vec<_>>().join(" ")
}

/// What a value may be that is known of the app alone: for completion. `name` is that of the value in the help.
#[must_use]
pub fn known(world: &World, name: &str) -> Vec<String> {
    match name {
        "SETTING" | "COMPONENT" => {
            let Some(registry) = world.get_resource::<AppTypeRegistry>() else {
                return Vec::new();
            };
            let registry = registry.read();
            let kinds = kinds(&registry);
            let own = kinds.into_iter().filter(|kind| !kind.is_of_bevy());
            own.flat_map(|kind| {
                let fields = if name == "SETTING" {
                    settings::fields(&registry, &kind)
                } else {
                    Vec::new()
                };
                std::iter::once(kind.name.to_owned()).chain(fields)
            })
            .collect()
        }
        "DIAGNOSTIC" => world
            .get_resource::<DiagnosticsStore>()
            .map(|store| store.iter().map(|d| d.path().as_str().to_owned()).collect())
            .unwrap_or_default(),
        "VIEW" => world
            .get_resource::<FrameViews>()
            .map(|views| views.list().iter().map(|v| v.name.to_owned()).collect())
            .unwrap_or_default(),
        _ => Vec::new(),
    }
}
