//! The tab of views of the frame: a list for each group of which one is on, a switch for each of the others.

use bevy::ecs::prelude::*;
use bevy_egui::egui;

use crate::console::{Console, Tone};
use crate::views::{FrameView, FrameViews};

pub(super) fn show(ui: &mut egui::Ui, world: &mut World) {
    let views = world.resource::<FrameViews>().clone();
    let mut groups: Vec<&str> = Vec::new();
    for group in views.list().iter().filter_map(|view| view.group) {
        if !groups.contains(&group) {
            groups.push(group);
        }
    }
    for name in groups {
        let list: Vec<_> = views
            .list()
            .iter()
            .filter(|view| view.group == Some(name))
            .collect();
        group(ui, world, name, &list);
    }
    for view in views.list().iter().filter(|view| view.group.is_none()) {
        let mut on = view.is_on(world);
        let changed = ui.checkbox(&mut on, view.name).changed();
        ui.indent(view.name, |ui| ui.weak(view.about));
        if changed {
            switch(world, view, on);
        }
    }
    if views.list().is_empty() {
        ui.weak("this app has no views of the frame");
    }
}

/// A list of which one, or none, is on.
fn group(ui: &mut egui::Ui, world: &mut World, name: &str, list: &[&FrameView]) {
    let on = list.iter().find(|view| view.is_on(world)).copied();
    let mut chosen = None;
    egui::ComboBox::from_label(name)
        .selected_text(on.map_or("none", |view| view.name))
        .height(400.0)
        .show_ui(ui, |ui| {
            if ui.selectable_label(on.is_none(), "none").clicked() {
                chosen = Some(None);
            }
            for view in list {
                let is = on.is_some_and(|on| on.name == view.name);
                let label = ui.selectable_label(is, view.name);
                if label.on_hover_text(view.about).clicked() {
                    chosen = Some(Some(*view));
                }
            }
        });
    match (chosen, on) {
        (Some(Some(view)), _) => switch(world, view, true),
        (Some(None), Some(view)) => switch(world, view, false),
        _ => {}
    }
    if let Some(view) = on {
        ui.weak(view.about);
    }
}

/// Switches it; a refusal is said in the console.
fn switch(world: &mut World, view: &FrameView, on: bool) {
    if let Err(refusal) = view.switch(world, on) {
        world.resource_mut::<Console>().say(Tone::Fault, &refusal);
    }
}
