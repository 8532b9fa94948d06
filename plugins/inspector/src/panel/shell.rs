//! Windows and tabs.

use bevy::ecs::prelude::*;
use bevy_egui::{EguiContext, egui};

use super::state::{Shell, Tab, said};
use super::{InspectorCamera, console, entities, frame, measures, settings};
use crate::settings::edit::{self, Undo};
use crate::{Inspector, InspectorWants};

/// Draws all that is open.
pub(super) fn show(world: &mut World) {
    let mut contexts = world.query_filtered::<&mut EguiContext, With<InspectorCamera>>();
    let Some(context) = contexts
        .iter_mut(world)
        .next()
        .map(|mut context| context.get_mut().clone())
    else {
        return;
    };
    let inspector = *world.resource::<Inspector>();
    world.resource_scope(|world, mut shell: Mut<Shell>| {
        if !context.input(|input| input.pointer.any_down()) {
            shell.hand = None;
        }
        if inspector.panel {
            panel(&context, world, &mut shell);
        }
        if inspector.console {
            console::show(&context, world, &mut shell);
        }
    });
    world
        .resource_mut::<InspectorWants>()
        .set_if_neq(InspectorWants {
            keyboard: context.egui_wants_keyboard_input(),
            pointer: context.egui_wants_pointer_input(),
        });
}

fn panel(context: &egui::Context, world: &mut World, shell: &mut Shell) {
    let height = context.content_rect().height();
    egui::Window::new("Inspector")
        .default_pos([8.0, 8.0])
        .default_width(380.0)
        .default_height((height - 110.0).max(120.0))
        .fade_in(false)
        .show(context, |ui| {
            ui.horizontal_wrapped(|ui| {
                for (tab, name) in [
                    (Tab::Settings, "Settings"),
                    (Tab::Entities, "Entities"),
                    (Tab::Diagnostics, "Diagnostics"),
                    (Tab::Views, "Views"),
                ] {
                    ui.selectable_value(&mut shell.tab, tab, name);
                }
                let (back, again) = world.resource::<Undo>().len();
                let button = |ui: &mut egui::Ui, name, count: usize| {
                    let button = egui::Button::new(format!("{name} {count}"));
                    ui.add_enabled(count > 0, button).clicked()
                };
                if button(ui, "Undo", back) {
                    said(world, |world| edit::undo(world).map(drop));
                }
                if button(ui, "Redo", again) {
                    said(world, |world| edit::redo(world).map(drop));
                }
            });
            ui.horizontal(|ui| {
                ui.label("Filter");
                ui.add(egui::TextEdit::singleline(&mut shell.filter).desired_width(160.0));
                if shell.tab == Tab::Settings {
                    ui.checkbox(&mut shell.all, "Bevy's too");
                }
            });
            ui.separator();
            egui::ScrollArea::vertical()
                .auto_shrink([false, false])
                .show(ui, |ui| match shell.tab {
                    Tab::Settings => settings::show(ui, world, shell),
                    Tab::Entities => entities::show(ui, world, shell),
                    Tab::Diagnostics => measures::show(ui, world, shell),
                    Tab::Views => frame::show(ui, world),
                });
        });
}
