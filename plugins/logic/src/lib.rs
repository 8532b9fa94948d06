//! Logic: what an entity does, as render says what is seen of it and physics how it meets others.
//!
//! Each of the three is optional: a rule has logic alone, a chair none. Input speaks to logic alone, and logic asks
//! physics and render. See [`LogicPlugin`], and the README for a first example.
//!
//! | module | holds |
//! |---|---|
//! | [`names`], [`value`], [`values`], [`access`] | typed values that are queried and set by name |
//! | [`action`] | actions with target and parameter; outputs and wires |
//! | [`clock`], [`need`] | steps, systems with a rate; who is worked on how often |
//! | [`parts`] | timers, buttons, doors, lifts, health, zones, pick-ups, weapons, rules, lamps |
//! | [`behaviour`] | behaviours as data |
//! | [`senses`] | sight, hearing, memory |
//! | [`movement`] | grids of ground, flow fields, paths, avoidance, patrols |
//! | [`rays`], [`bodies`], [`grid`] | what hides and is hit, and which of many points are near |
//! | [`hash`] | a number of the state |
//!
//! Metres, seconds and radians; +Y is up, −Z is forward.

pub mod access;
pub mod action;
pub mod behaviour;
pub mod bodies;
pub mod clock;
#[cfg(feature = "collision")]
pub mod collision;
mod diagnostics;
pub mod grid;
pub mod hash;
pub mod movement;
pub mod names;
pub mod need;
pub mod parts;
mod plugin;
pub mod random;
pub mod rays;
pub mod senses;
mod sets;
pub mod value;
pub mod values;

pub use access::LogicAccess;
pub use action::{Action, Output, Wire, Wires};
pub use behaviour::{BehaviourAppExt, BehaviourError, LeafBatch, Mind, Phase, Status};
pub use bodies::Hitbox;
pub use clock::{LogicAppExt, LogicClock, at_rate};
pub use diagnostics::LogicCounters;
pub use hash::state_hash;
pub use names::{Key, Names};
pub use need::{Asleep, Attention, AttentionSettings, Focus};
pub use parts::{
    Button, Collector, DayClock, Door, Health, Lamp, Lift, LogicTimer, Mission, Objective, PickUp,
    Slide, Team, Visitor, Weapon, Zone,
};
pub use plugin::LogicPlugin;
pub use rays::{RayWorld, Rays};
pub use sets::LogicSystems;
pub use value::{Kind, Typed, Value, ValueError};
pub use values::{Logic, Values};
