//! A brush on the ground, while the inspector's panel is open: what it is in a window of the inspector, and the pointer on
//! the landscape. Closed, or switched off, nothing of it runs.

use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use dolomite::inspector::panel::{EguiContext, InspectorCamera, InspectorPass, egui};
use dolomite::inspector::{Inspector, InspectorWants};
use dolomite::terrain::{Edit, EditKind};

use crate::play::camera::FreeCamera;
use crate::play::edits;
use crate::scene::CurrentScene;

/// Farthest that the pointer reaches, metres.
const FAR: f64 = 20_000.0;

/// What a brush does.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BrushKind {
    /// Raises the ground.
    #[default]
    Raise,
    /// Lowers it.
    Lower,
    /// Levels it at the height of the place where a stroke begins.
    Flatten,
    /// Brings it to the mean of what is around.
    Smooth,
}

const KINDS: [BrushKind; 4] = [
    BrushKind::Raise,
    BrushKind::Lower,
    BrushKind::Flatten,
    BrushKind::Smooth,
];

/// The brush in the hand.
#[derive(Resource, Reflect, Clone, Debug, PartialEq)]
#[reflect(Resource, Default, PartialEq)]
pub struct GroundBrush {
    /// Whether the pointer edits the ground.
    pub on: bool,
    /// What it does.
    pub kind: BrushKind,
    /// How far it reaches, metres.
    pub radius: f64,
    /// Metres a second in its middle. Levelling and smoothing go half as many times the whole way in a second.
    pub strength: f64,
    /// The outer share of the radius over which it fades.
    pub falloff: f64,
    /// What was said last.
    pub said: String,
}

impl Default for GroundBrush {
    fn default() -> Self {
        Self {
            on: false,
            kind: BrushKind::Raise,
            radius: 20.0,
            strength: 4.0,
            falloff: 0.8,
            said: String::new(),
        }
    }
}

impl GroundBrush {
    /// What it does at a place in so many seconds; `level` is the height at which a stroke began.
    #[must_use]
    pub fn edit(&self, place: DVec2, level: f64, seconds: f64) -> Edit {
        let metres = self.strength * seconds;
        let share = (metres * 0.5).clamp(0.0, 1.0);
        let (kind, strength) = match self.kind {
            BrushKind::Raise => (EditKind::Raise, metres),
            BrushKind::Lower => (EditKind::Lower, metres),
            BrushKind::Flatten => (
                EditKind::Flatten {
                    height: Some(level),
                },
                share,
            ),
            BrushKind::Smooth => (EditKind::Smooth, share),
        };
        Edit {
            kind,
            place,
            radius: self.radius,
            strength,
            falloff: self.falloff,
        }
    }
}

/// The stroke that is being made: the height at which it began.
#[derive(Resource, Default)]
struct Stroke(Option<f64>);

/// The brush, its window and its keys.
pub struct BrushPlugin;

impl Plugin for BrushPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<GroundBrush>()
            .init_resource::<Stroke>()
            .register_type::<GroundBrush>()
            .add_systems(
                Update,
                paint.run_if(
                    |inspector: Option<Res<Inspector>>, brush: Res<GroundBrush>| {
                        brush.on && inspector.is_some_and(|inspector| inspector.panel)
                    },
                ),
            );
    }

    fn finish(&self, app: &mut App) {
        // There is no such schedule where nothing is drawn.
        if app.get_schedule(InspectorPass).is_some() {
            app.add_systems(InspectorPass, window);
        }
    }
}

fn window(world: &mut World) {
    let mut contexts = world.query_filtered::<&mut EguiContext, With<InspectorCamera>>();
    let context = contexts.iter_mut(world).next();
    let Some(context) = context.map(|mut context| context.get_mut().clone()) else {
        return;
    };
    let open = world
        .get_resource::<Inspector>()
        .is_some_and(|inspector| inspector.panel);
    if !open || world.resource::<CurrentScene>().own.is_some() {
        return;
    }
    let mut brush = world.resource::<GroundBrush>().clone();
    let mut wanted = None;
    egui::Window::new("Ground brush")
        .default_pos([400.0, 8.0])
        .default_open(false)
        .fade_in(false)
        .show(&context, |ui| {
            ui.checkbox(&mut brush.on, "the pointer edits the ground");
            ui.horizontal_wrapped(|ui| {
                for kind in KINDS {
                    ui.selectable_value(&mut brush.kind, kind, format!("{kind:?}"));
                }
            });
            let slider = |ui: &mut egui::Ui, value: &mut f64, ends, name: &str| {
                ui.add(egui::Slider::new(value, ends).text(name));
            };
            slider(ui, &mut brush.radius, 1.0..=200.0, "radius, m");
            slider(ui, &mut brush.strength, 0.1..=50.0, "strength, m/s");
            slider(ui, &mut brush.falloff, 0.0..=1.0, "falloff");
            ui.horizontal(|ui| {
                for (name, key) in [("Undo", "Ctrl+Z"), ("Redo", "Ctrl+Y"), ("Save", "")] {
                    if ui.button(name).on_hover_text(key).clicked() {
                        wanted = Some(name);
                    }
                }
            });
            ui.label(&brush.said);
        });
    if let Some(wanted) = wanted {
        brush.said = step(world, wanted);
    }
    world.resource_mut::<GroundBrush>().set_if_neq(brush);
}

/// Undoes, redoes or saves; what is to be said of it.
fn step(world: &mut World, wanted: &str) -> String {
    let done = match wanted {
        "Undo" => edits::undo(world).map(|()| String::new()),
        "Redo" => edits::redo(world).map(|()| String::new()),
        _ => edits::save(world, None).map(|path| format!("wrote {}", path.display())),
    };
    done.unwrap_or_else(|error| error.to_string())
}

/// The direction of the pointer on the window, from a camera.
fn ray(world: &mut World) -> Option<(DVec3, DVec3)> {
    let mut windows = world.query_filtered::<&Window, With<PrimaryWindow>>();
    let window = windows.iter(world).next()?;
    let (size, at) = (window.size(), window.cursor_position()?);
    let mut cameras = world.query::<&FreeCamera>();
    let camera = cameras.iter(world).next()?;
    let tangent = f64::from(bevy::math::ops::tan(0.5 * camera.fov.to_radians()));
    let on = DVec2::new(
        f64::from(2.0 * at.x / size.x - 1.0) * f64::from(size.x / size.y),
        f64::from(1.0 - 2.0 * at.y / size.y),
    ) * tangent;
    let turn = camera.pose.rotation().as_dquat();
    Some((camera.pose.position, turn * DVec3::new(on.x, on.y, -1.0)))
}

fn paint(world: &mut World) {
    let wants = world
        .get_resource::<InspectorWants>()
        .copied()
        .unwrap_or_default();
    if !wants.keyboard
        && let Some(keys) = world.get_resource::<ButtonInput<KeyCode>>()
        && keys.any_pressed([KeyCode::ControlLeft, KeyCode::ControlRight])
    {
        let undo = keys.just_pressed(KeyCode::KeyZ);
        let redo = keys.just_pressed(KeyCode::KeyY);
        if undo || redo {
            let said = step(world, if undo { "Undo" } else { "Redo" });
            world.resource_mut::<GroundBrush>().said = said;
        }
    }
    let pressed = world
        .get_resource::<ButtonInput<MouseButton>>()
        .is_some_and(|buttons| buttons.pressed(MouseButton::Left));
    if !pressed || wants.pointer {
        world.resource_mut::<Stroke>().0 = None;
        return;
    }
    let Some((from, along)) = ray(world) else {
        return;
    };
    let terrain = world.resource::<CurrentScene>().terrain.clone();
    let Some(place) = edits::seen(&terrain, from, along, FAR) else {
        return;
    };
    let goes_on = world.resource::<Stroke>().0.is_some();
    let level = *world
        .resource_mut::<Stroke>()
        .0
        .get_or_insert_with(|| terrain.sample_f64(place).height);
    let seconds = f64::from(world.resource::<Time>().delta_secs()).min(0.1);
    let edit = world.resource::<GroundBrush>().edit(place, level, seconds);
    if let Err(error) = edits::edit(world, &edit, goes_on) {
        world.resource_mut::<GroundBrush>().said = error.to_string();
    }
}
