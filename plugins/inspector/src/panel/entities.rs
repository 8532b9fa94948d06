//! The tab of entities: the tree, and what the chosen one is to render, physics and logic.

use bevy::ecs::prelude::*;
use bevy_egui::egui;

use super::settings::place_ui;
use super::state::Shell;
use crate::entities::{Answer, components, label, tree};
use crate::settings::place::Place;

/// Most lines of the tree that are drawn.
const MOST: usize = 400;

pub(super) fn show(ui: &mut egui::Ui, world: &mut World, shell: &mut Shell) {
    let (lines, count) = tree(world, &shell.filter, MOST, |entity| {
        shell.open.contains(&entity)
    });
    let height = (ui.available_height() * 0.5).max(120.0);
    egui::ScrollArea::vertical()
        .id_salt("tree")
        .max_height(height)
        .auto_shrink([false, true])
        .show(ui, |ui| {
            for line in &lines {
                ui.horizontal(|ui| {
                    ui.add_space(12.0 * line.depth as f32);
                    if line.children > 0 && shell.filter.is_empty() {
                        let open = shell.open.contains(&line.entity);
                        if ui.small_button(if open { "-" } else { "+" }).clicked()
                            && !shell.open.remove(&line.entity)
                        {
                            shell.open.insert(line.entity);
                        }
                    } else {
                        ui.add_space(18.0);
                    }
                    let chosen = shell.chosen == Some(line.entity);
                    let text = format!("{} {}", line.entity, line.label);
                    if ui.selectable_label(chosen, text).clicked() {
                        shell.chosen = Some(line.entity);
                    }
                });
            }
            if count > lines.len() {
                ui.weak(format!(
                    "and {} more: search for a part of a name",
                    count - lines.len()
                ));
            }
        });
    ui.separator();
    match shell.chosen {
        Some(entity) => chosen(ui, world, shell, entity),
        None => {
            ui.weak(format!("{count} entities"));
        }
    }
}

fn chosen(ui: &mut egui::Ui, world: &mut World, shell: &mut Shell, entity: Entity) {
    let components = match components(world, entity) {
        Ok(components) => components,
        // It was there when it was chosen.
        Err(gone) => {
            ui.colored_label(ui.visuals().error_fg_color, gone.to_string());
            return;
        }
    };
    ui.strong(format!("{entity} {}", label(world, entity)));
    for answer in Answer::ALL {
        let of_it: Vec<_> = components.iter().filter(|c| c.answer == answer).collect();
        if of_it.is_empty() {
            continue;
        }
        egui::CollapsingHeader::new(format!("{} ({})", answer.name(), of_it.len()))
            .id_salt(answer.name())
            .default_open(answer != Answer::Other)
            .show(ui, |ui| {
                for component in of_it {
                    let Some(kind) = component.kind.clone() else {
                        match &component.text {
                            // A tree keeps its columns.
                            Some(text) if text.contains('\n') => {
                                ui.label(&component.name);
                                ui.monospace(text.trim_end())
                            }
                            Some(text) => ui.label(format!("{} {text}", component.name)),
                            None => ui.weak(&component.name),
                        };
                        continue;
                    };
                    egui::CollapsingHeader::new(&component.name)
                        .id_salt(kind.path)
                        .show(ui, |ui| {
                            place_ui(ui, world, shell, &Place::whole(kind, entity));
                        });
                }
            });
    }
}
