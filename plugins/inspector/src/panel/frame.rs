//! The tab of views of the frame.

use bevy::ecs::prelude::*;
use bevy_egui::egui;

use crate::views::FrameViews;

pub(super) fn show(ui: &mut egui::Ui, world: &mut World) {
    let views = world.resource::<FrameViews>().clone();
    for view in views.list() {
        let mut on = view.is_on(world);
        let changed = ui.checkbox(&mut on, view.name).changed();
        ui.indent(view.name, |ui| ui.weak(view.about));
        if changed {
            view.switch(world, on);
        }
    }
    if views.list().is_empty() {
        ui.weak("this app has no views of the frame");
    }
}
