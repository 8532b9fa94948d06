//! The game's console and inspector: its commands, its views of the frame, its scripts.
//!
//! | file | concern |
//! |---|---|
//! | [`commands`] | `scene`, `go`, `shot`, `bench`, `bot`, `quit` |
//! | [`edit`] | `edit`: brushes, steps, files |
//! | [`bot`] | a hand at the figure's keys |
//! | [`script`] | what `--exec` names |

pub mod bot;
pub mod commands;
pub mod edit;
pub mod script;

use bevy::core_pipeline::Core3d;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::ui_render::ui_pass;
use dolomite::inspector::console::table::Table;
use dolomite::inspector::picture::FramePictureSystems;
use dolomite::inspector::views::{AddFrameView, FrameView};
use dolomite::inspector::{Console, InspectorPlugin};

use crate::play::Switches;
use crate::settings::Settings;
use bot::BotPlugin;
use script::ScriptPlugin;

/// Inspector, console, their commands and views. Closed, nothing of it is drawn or runs.
pub struct ConsolePlugin;

impl Plugin for ConsolePlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((InspectorPlugin, BotPlugin, ScriptPlugin));
        let mut console = app.world_mut().resource_mut::<Console>();
        commands::add(&mut console.table);
        edit::add(&mut console.table);
        dolomite::describe(app);
        dolomite::pictures(app);
        if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
            // What is said over a frame is said over its pictures too.
            render_app.configure_sets(Core3d, FramePictureSystems.before(ui_pass));
        }
        for view in [
            switch(
                "lines",
                "edges of the ground's triangles: wireframe (key L)",
                |switches| &mut switches.lines,
            ),
            switch(
                "fill",
                "the ground's triangles filled (key F)",
                |switches| &mut switches.fill,
            ),
            switch(
                "shapes",
                "what collision knows: shapes, contacts, tiles (key B)",
                |switches| &mut switches.shapes,
            ),
            switch(
                "senses",
                "what logic senses: fields of view, who is seen, memories, ways",
                |switches| &mut switches.senses,
            ),
            FrameView::new(
                "panel",
                "frame times, counts, GPU time of passes",
                |world| world.resource::<Settings>().panel,
                |world, on| {
                    world.resource_mut::<Settings>().panel = on;
                    world.resource_mut::<Switches>().set_changed();
                },
            ),
        ] {
            app.frame_view(view);
        }
    }
}

/// A view that is a switch of the player's.
fn switch(
    name: &'static str,
    about: &'static str,
    field: fn(&mut Switches) -> &mut bool,
) -> FrameView {
    FrameView::new(
        name,
        about,
        move |world| *field(&mut world.resource::<Switches>().clone()),
        move |world, on| *field(&mut world.resource_mut::<Switches>()) = on,
    )
}

/// All commands, without an app: for `--help`.
#[must_use]
pub fn table() -> Table {
    let mut console = Console::default();
    dolomite::inspector::commands::add(&mut console);
    commands::add(&mut console.table);
    edit::add(&mut console.table);
    console.table
}
