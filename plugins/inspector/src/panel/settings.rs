//! The tab of settings: kinds by crate, the entities that have them, their values.

use bevy::ecs::prelude::*;
use bevy::ecs::reflect::AppTypeRegistry;
use bevy_egui::egui;

use super::state::{Shell, change, copy};
use super::values::{Known, Moved, show as show_value};
use crate::console::{Console, Tone};
use crate::entities::label;
use crate::settings::described::Descriptions;
use crate::settings::edit;
use crate::settings::kinds::{Kind, holders, kinds};
use crate::settings::place::Place;

/// Most entities of a kind that are listed.
const MOST: usize = 64;

pub(super) fn show(ui: &mut egui::Ui, world: &mut World, shell: &mut Shell) {
    let kinds = {
        let registry = world.resource::<AppTypeRegistry>().read();
        kinds(&registry)
    };
    let filter = shell.filter.to_lowercase();
    let found = |kind: &&Kind| {
        (shell.all || !kind.is_of_bevy())
            && (filter.is_empty() || kind.path.to_lowercase().contains(&filter))
    };
    let found: Vec<_> = kinds.iter().filter(found).collect();
    for of_crate in found.chunk_by(|a, b| a.of_crate == b.of_crate) {
        let name = of_crate[0].of_crate;
        egui::CollapsingHeader::new(name.strip_prefix("dolomite_").unwrap_or(name))
            .id_salt(name)
            .default_open(!filter.is_empty())
            .show(ui, |ui| {
                for kind in of_crate {
                    kind_ui(ui, world, shell, kind, !filter.is_empty());
                }
            });
    }
    if found.is_empty() {
        ui.weak("nothing that is registered has this in its name");
    }
}

fn kind_ui(ui: &mut egui::Ui, world: &mut World, shell: &mut Shell, kind: &Kind, open: bool) {
    let holders = holders(world, kind.id);
    let title = match (kind.resource, holders.len()) {
        (true, 1) => kind.name.to_owned(),
        (_, count) => format!("{} ({count})", kind.name),
    };
    let header = egui::CollapsingHeader::new(title)
        .id_salt(kind.path)
        .default_open(open && !holders.is_empty())
        .enabled(!holders.is_empty())
        .show(ui, |ui| {
            for entity in holders.iter().take(MOST) {
                let place = Place::whole(kind.clone(), *entity);
                if holders.len() > 1 {
                    let title = format!("{entity} {}", label(world, *entity));
                    egui::CollapsingHeader::new(title)
                        .id_salt((kind.path, *entity))
                        .show(ui, |ui| place_ui(ui, world, shell, &place));
                } else {
                    place_ui(ui, world, shell, &place);
                }
            }
            if holders.len() > MOST {
                ui.weak(format!(
                    "and {} more: search, or use the console",
                    holders.len() - MOST
                ));
            }
        });
    let about = world
        .resource::<Descriptions>()
        .get(kind.id)
        .map(|description| description.about.clone());
    if let Some(about) = about.filter(|about| !about.is_empty()) {
        header.header_response.on_hover_text(about.as_ref());
    }
}

/// The values of a component, and what can be done with them.
pub(super) fn place_ui(ui: &mut egui::Ui, world: &mut World, shell: &mut Shell, place: &Place) {
    match values(ui, world, place) {
        Ok(Some((path, value))) => {
            let place = Place {
                path,
                ..place.clone()
            };
            change(world, shell, &place, value.as_ref());
        }
        Ok(None) => {}
        Err(error) => {
            ui.colored_label(ui.visuals().error_fg_color, error.to_string());
        }
    }
    ui.horizontal(|ui| {
        if ui.small_button("Copy as RON").clicked() {
            copy(world, place);
        }
        if ui.small_button("Path").clicked() {
            world
                .resource_mut::<Console>()
                .say(Tone::Said, &place.to_string());
        }
    });
}

fn values(
    ui: &mut egui::Ui,
    world: &World,
    place: &Place,
) -> Result<Option<Moved>, edit::EditError> {
    let registry = world.resource::<AppTypeRegistry>().read();
    let description = world.resource::<Descriptions>().get(place.kind.id);
    let component = world.components().get_id(place.kind.id);
    let mutable = component
        .and_then(|component| world.components().get_info(component))
        .is_some_and(|info| info.mutable());
    let known = Known {
        registry: &registry,
        description,
        enabled: mutable && !description.is_some_and(|description| description.read_only),
    };
    edit::look(world, &registry, place, |value| {
        ui.push_id((place.kind.path, place.entity), |ui| {
            show_value(ui, &known, "", "", value)
        })
        .inner
    })
}
