//! The tab of diagnostics: watched ones as plots, GPU passes as bars, sums by plugin, what was skipped, and all.

use bevy::diagnostic::DiagnosticsStore;
use bevy::ecs::prelude::*;
use bevy_egui::egui;

use super::plot::{line, short};
use super::state::Shell;
use crate::measures::{Measure, Watched, history, measures, skipped, totals, view_totals};

/// Most passes that are drawn as bars, the longest first.
const PASSES: usize = 16;

pub(super) fn show(ui: &mut egui::Ui, world: &mut World, shell: &Shell) {
    let Some(store) = world.get_resource::<DiagnosticsStore>() else {
        ui.weak("this app has no diagnostics: it lacks Bevy's DiagnosticsPlugin");
        return;
    };
    let mut watched = world.resource::<Watched>().clone();
    let all = measures(store, &shell.filter);
    for path in watched.paths().to_owned() {
        ui.horizontal(|ui| {
            let newest = all.iter().find(|measure| measure.path == path);
            let value = newest.map_or_else(String::new, value);
            ui.label(format!("{path}  {value}"));
            if ui.small_button("x").clicked() {
                // It is one of those that are watched.
                let _ = watched.forget(&path);
            }
        });
        let width = ui.available_width().clamp(60.0, 600.0);
        line(ui, &history(store, &path), egui::vec2(width, 64.0));
    }
    super::chart::show(ui, world);
    let Some(store) = world.get_resource::<DiagnosticsStore>() else {
        return;
    };
    passes(ui, store);
    sums(ui, store);
    of_views(ui, store);
    egui::CollapsingHeader::new("Skipped").show(ui, |ui| {
        for (measure, reason) in skipped(store) {
            ui.monospace(format!("{}  {}", measure.path, value(&measure)));
            ui.indent(&measure.path, |ui| ui.weak(reason));
        }
    });
    let open = (!shell.filter.is_empty()).then_some(true);
    for group in all.chunk_by(|a, b| a.group == b.group) {
        egui::CollapsingHeader::new(format!("{} ({})", group[0].group, group.len()))
            .id_salt(&group[0].group)
            .open(open)
            .show(ui, |ui| {
                for measure in group {
                    ui.horizontal(|ui| row(ui, store, &mut watched, measure));
                }
            });
    }
    world.resource_mut::<Watched>().set_if_neq(watched);
}

fn row(ui: &mut egui::Ui, store: &DiagnosticsStore, watched: &mut Watched, measure: &Measure) {
    line(ui, &history(store, &measure.path), egui::vec2(70.0, 16.0));
    ui.monospace(format!("{:>9}", value(measure)));
    let known = watched.paths().contains(&measure.path);
    let clicked = ui
        .selectable_label(known, &measure.path)
        .on_hover_text("Click: as a large plot")
        .clicked();
    if clicked {
        // Either is what the click asks for, and neither can be refused now.
        let _ = if known {
            watched.forget(&measure.path)
        } else {
            watched.watch(store, &measure.path)
        };
    }
}

fn value(measure: &Measure) -> String {
    let value = measure.value.map_or_else(|| "-".to_owned(), short);
    format!("{value} {}", measure.unit).trim_end().to_owned()
}

/// The time of each pass as a bar: of the GPU where it says any, else of the CPU that records it.
fn passes(ui: &mut egui::Ui, store: &DiagnosticsStore) {
    for (clock, title) in [
        ("/elapsed_gpu", "Passes, time of the GPU"),
        ("/elapsed_cpu", "Passes, time of recording"),
    ] {
        let mut passes: Vec<_> = measures(store, clock)
            .into_iter()
            .filter(|measure| measure.group == "render")
            .filter_map(|measure| Some((measure.average?, measure.path)))
            .collect();
        if passes.is_empty() {
            continue;
        }
        passes.sort_by(|a, b| b.0.total_cmp(&a.0));
        let most = passes[0].0.max(1e-6);
        egui::CollapsingHeader::new(title).show(ui, |ui| {
            for (time, path) in passes.iter().take(PASSES) {
                ui.horizontal(|ui| {
                    let size = egui::vec2(120.0, 14.0);
                    let (response, painter) = ui.allocate_painter(size, egui::Sense::hover());
                    let mut bar = response.rect;
                    painter.rect_filled(bar, 2.0, ui.visuals().extreme_bg_color);
                    bar.set_width(bar.width() * (time / most) as f32);
                    painter.rect_filled(bar, 2.0, ui.visuals().hyperlink_color);
                    line(ui, &history(store, path), egui::vec2(70.0, 14.0));
                    ui.monospace(format!("{time:>8.3} ms"));
                    let name = path.strip_prefix("render/").unwrap_or(path);
                    ui.label(name.strip_suffix(clock).unwrap_or(name));
                });
            }
        });
    }
}

fn sums(ui: &mut egui::Ui, store: &DiagnosticsStore) {
    egui::CollapsingHeader::new("By plugin")
        .default_open(true)
        .show(ui, |ui| {
            egui::Grid::new("sums").striped(true).show(ui, |ui| {
                for name in [
                    "plugin",
                    "dispatches",
                    "primitives",
                    "bytes",
                    "allocated",
                    "GPU ms",
                ] {
                    ui.weak(name);
                }
                ui.end_row();
                for row in totals(store) {
                    ui.label(&row.group);
                    let values = [
                        row.dispatches,
                        row.primitives,
                        row.bytes,
                        row.allocated,
                        row.gpu,
                    ];
                    for value in values {
                        ui.monospace(value.map_or_else(|| "-".to_owned(), short));
                    }
                    ui.end_row();
                }
            });
        });
}

fn of_views(ui: &mut egui::Ui, store: &DiagnosticsStore) {
    let views = view_totals(store);
    if views.is_empty() {
        return;
    }
    egui::CollapsingHeader::new("By view").show(ui, |ui| {
        egui::Grid::new("views").striped(true).show(ui, |ui| {
            for name in ["view", "plugin", "of it", "passes", "primitives", "bytes"] {
                ui.weak(name);
            }
            ui.end_row();
            for row in &views {
                ui.label(&row.view);
                ui.label(&row.group);
                ui.label(&row.kind);
                for value in [row.passes, row.primitives, row.bytes] {
                    ui.monospace(value.map_or_else(|| "-".to_owned(), short));
                }
                ui.end_row();
            }
        });
    });
}
