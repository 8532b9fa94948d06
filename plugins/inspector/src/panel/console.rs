//! The console: what was said, and the line that is being typed.

use bevy::ecs::prelude::*;
use bevy_egui::egui;

use super::state::Shell;
use crate::commands::known;
use crate::console::complete::complete;
use crate::console::{Console, Tone};

/// What its key types where it is a letter: not into the line.
const KEY_TYPES: [char; 3] = ['`', '~', '^'];

pub(super) fn show(context: &egui::Context, world: &mut World, shell: &mut Shell) {
    let screen = context.content_rect();
    let height = (screen.height() * 0.4).clamp(90.0, 320.0);
    egui::Window::new("Console")
        .anchor(egui::Align2::LEFT_BOTTOM, [0.0, 0.0])
        .title_bar(false)
        .fade_in(false)
        .resizable(false)
        .fixed_size([screen.width() - 14.0, height])
        .show(context, |ui| {
            output(ui, world, shell, height - 34.0);
            input(ui, world, shell);
        });
}

fn output(ui: &mut egui::Ui, world: &World, shell: &mut Shell, height: f32) {
    let console = world.resource::<Console>();
    let new = console.lines_said() != shell.seen;
    shell.seen = console.lines_said();
    let row = ui.text_style_height(&egui::TextStyle::Monospace);
    let count = console.output().len();
    egui::ScrollArea::both()
        .id_salt("said")
        .max_height(height)
        .min_scrolled_height(height)
        .auto_shrink([false, false])
        .stick_to_bottom(true)
        .show_rows(ui, row, count, |ui, rows| {
            for (tone, line) in console.output().skip(rows.start).take(rows.len()) {
                let colour = match tone {
                    Tone::Typed => ui.visuals().strong_text_color(),
                    Tone::Said => ui.visuals().text_color(),
                    Tone::Fault => ui.visuals().error_fg_color,
                };
                let line = if tone == Tone::Typed {
                    format!("> {line}")
                } else {
                    line.to_owned()
                };
                let text = egui::RichText::new(line).monospace().color(colour);
                ui.add(egui::Label::new(text).extend());
            }
            if new {
                ui.scroll_to_cursor(Some(egui::Align::BOTTOM));
            }
        });
}

fn input(ui: &mut egui::Ui, world: &mut World, shell: &mut Shell) {
    let pressed = |key| ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, key));
    let (up, down, tab) = (
        pressed(egui::Key::ArrowUp),
        pressed(egui::Key::ArrowDown),
        pressed(egui::Key::Tab),
    );
    let mut moved = false;
    if up || down {
        let mut console = world.resource_mut::<Console>();
        let line = if up {
            console.history.back(&shell.line)
        } else {
            console.history.forward()
        };
        if let Some(line) = line {
            line.clone_into(&mut shell.line);
            moved = true;
        }
    }
    if tab {
        let completion = complete(&world.resource::<Console>().table, &shell.line, |name| {
            known(world, name)
        });
        if completion.candidates.len() > 1 {
            let list = completion.candidates.join("  ");
            world.resource_mut::<Console>().say(Tone::Said, &list);
        }
        let line = completion.complete(&shell.line);
        moved |= line != shell.line;
        shell.line = line;
    }
    let edit = egui::TextEdit::singleline(&mut shell.line)
        .font(egui::TextStyle::Monospace)
        .hint_text("help lists the commands")
        .desired_width(f32::INFINITY)
        .lock_focus(true);
    let mut output = edit.show(ui);
    if moved {
        let end = egui::text::CCursor::new(shell.line.chars().count());
        let range = egui::text::CCursorRange::one(end);
        output.state.cursor.set_char_range(Some(range));
        output.state.store(ui.ctx(), output.response.id);
    }
    let entered =
        output.response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
    if entered {
        let line = std::mem::take(&mut shell.line);
        if !line.trim().is_empty() {
            world.resource_mut::<Console>().enter(line.trim());
        }
    }
    // The key that opened it is typed as well.
    if shell.line.chars().all(|c| KEY_TYPES.contains(&c)) {
        shell.line.clear();
    }
    if !output.response.has_focus() {
        output.response.request_focus();
    }
}
