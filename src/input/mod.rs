//! What the player wants this frame ([`PlayerInput`]), how it is read from devices ([`devices`]), and the
//! table of keys ([`keys`]).
//!
//! The simulation reads only this resource, so tests, the bench and recordings can write it in
//! place of a player.

pub mod devices;
pub mod keys;

use bevy::prelude::*;

/// What keys and buttons mean now.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InputMode {
    /// Flying and walking over a scene, with all its switches.
    #[default]
    Explore,
    /// Playing a level: Esc and start open its menu, and the buttons of a gamepad act.
    Play,
    /// In a menu: arrows, W and S, and the directional pad choose, and nobody walks.
    Menu,
}

/// What the player wants. Levels (`fly`, `walk`, `fast`) hold while a key is held; steps (`look`,
/// `zoom`, the switches) are of one frame.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub struct PlayerInput {
    /// Camera motion, −1 to 1 each: x right, y up, z forward.
    pub fly: Vec3,
    /// Figure motion as the camera sees it, −1 to 1 each: x right, y away from the camera.
    pub walk: Vec2,
    /// Moves faster.
    pub fast: bool,
    /// The figure leaps, in this frame.
    pub jump: bool,
    /// The figure waves a hand, in this frame.
    pub wave: bool,
    /// The figure does what there is to do where it stands, as long as this is held: it lights a beacon, or presses a
    /// button.
    pub act: bool,
    /// The figure shoots where the camera looks, in a level and with a weapon, as often as that can.
    pub fire: bool,
    /// Opens a level's menu, or closes it, in this frame.
    pub menu: bool,
    /// Steps in a menu in this frame: x to the right, y downwards.
    pub navigate: IVec2,
    /// Takes what is chosen in a menu, in this frame.
    pub confirm: bool,
    /// Turn of the view in this frame, radians: x to the right, y upwards.
    pub look: Vec2,
    /// Zoom in this frame, in wheel steps; positive zooms in.
    pub zoom: f32,
    /// Switches lines on or off.
    pub switch_lines: bool,
    /// Switches fill on or off.
    pub switch_fill: bool,
    /// Switches the point that detail follows.
    pub switch_focus: bool,
    /// Switches who makes the triangles, in scenes where several can.
    pub switch_mode: bool,
    /// Switches the rule by which the ground is refined.
    pub switch_metric: bool,
    /// Switches the drawing of what collision knows.
    pub switch_shapes: bool,
    /// Switches between a camera that follows the figure and one that flies free.
    pub switch_follow: bool,
    /// Switches the figure's torch.
    pub switch_torch: bool,
    /// Switches between Bevy's lighting and Dolomite's.
    pub switch_renderer: bool,
    /// Switches what grows.
    pub switch_vegetation: bool,
    /// Switches the panel of keys.
    pub switch_keys: bool,
    /// Steps of the resolution in this frame: above 0 more pixels are drawn.
    pub resolution_steps: i32,
    /// Leaves the game.
    pub leave: bool,
}
