//! A stranger's app, and its console.

use bevy::diagnostic::{Diagnostic, DiagnosticPath, RegisterDiagnostic};
use bevy::prelude::*;
use dolomite_inspector::console::Tone;
use dolomite_inspector::settings::described::{Describe, Description, Field};
use dolomite_inspector::views::{AddFrameView, FrameView};
use dolomite_inspector::{Console, InspectorPlugin};

/// A setting of a plugin that knows nothing of ours but one call.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default)]
pub struct Fog {
    pub dust: f32,
    pub near: Option<f32>,
    pub colour: Color,
    pub layers: Vec<u32>,
    pub kind: FogKind,
    pub name: String,
    pub drift: Vec3,
}

#[derive(Reflect, Clone, Debug, Default, PartialEq)]
pub enum FogKind {
    #[default]
    Thin,
    Thick {
        share: f32,
    },
    Banks(u32, bool),
}

impl Default for Fog {
    fn default() -> Self {
        Self {
            dust: 1.0,
            near: None,
            colour: Color::WHITE,
            layers: vec![1, 2, 3],
            kind: FogKind::Thin,
            name: "a fog".to_owned(),
            drift: Vec3::ZERO,
        }
    }
}

/// What the plugin counts.
#[derive(Resource, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Resource, Default)]
pub struct FogCounters {
    pub drawn: u32,
}

/// A switch of the plugin's view.
#[derive(Resource, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Resource)]
pub struct FogLines(pub bool);

pub fn add_fog(app: &mut App) {
    app.register_type::<Fog>()
        .register_type::<FogCounters>()
        .register_type::<FogLines>()
        .init_resource::<FogCounters>()
        .init_resource::<FogLines>()
        .describe::<Fog>(
            Description::new("Fog near the ground").field(
                "dust",
                Field::new("Dust in the air").range(0.0..=100.0).unit("g"),
            ),
        )
        .describe::<FogCounters>(Description::answer("What the fog drew"))
        .frame_view(FrameView::new(
            "fog_lines",
            "the fog as lines",
            |world| world.resource::<FogLines>().0,
            |world, on| world.resource_mut::<FogLines>().0 = on,
        ))
        .register_diagnostic(Diagnostic::new(DiagnosticPath::const_new("fog/drawn")))
        // Twice under one name.
        .register_diagnostic(Diagnostic::new(DiagnosticPath::const_new("fog/drawn")));
}

/// Without a renderer, and with one fog.
pub fn app() -> (App, Entity) {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        bevy::diagnostic::DiagnosticsPlugin,
        InspectorPlugin,
    ));
    add_fog(&mut app);
    app.finish();
    app.cleanup();
    let fog = app
        .world_mut()
        .spawn((Fog::default(), Name::new("valley")))
        .id();
    (app, fog)
}

/// What the console says to a line: its words, or the fault.
pub fn say(app: &mut App, line: &str) -> Result<String, String> {
    let before = app.world().resource::<Console>().lines_said();
    app.world_mut().resource_mut::<Console>().enter(line);
    for _ in 0..1000 {
        app.update();
        if app.world().resource::<Console>().queue.is_empty() {
            break;
        }
    }
    let console = app.world().resource::<Console>();
    let new = (console.lines_said() - before) as usize;
    let lines: Vec<_> = console.output().rev().take(new).collect();
    let mut fault = false;
    let mut text = Vec::new();
    for (tone, line) in lines.into_iter().rev() {
        fault |= tone == Tone::Fault;
        if tone != Tone::Typed {
            text.push(line);
        }
    }
    let text = text.join("\n");
    if fault { Err(text) } else { Ok(text) }
}
