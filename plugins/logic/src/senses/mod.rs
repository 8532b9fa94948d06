//! Sight, hearing, and a memory that fades.
//!
//! | component | what it is |
//! |---|---|
//! | [`Sight`], [`Visible`] | an eye, and what it may see |
//! | [`Ear`] | hears [`Noise`] |
//! | [`Memory`] | who was seen or heard, where, and how surely |

mod field;
mod hearing;
mod memory;
mod sight;

pub use field::in_field;
pub use hearing::{Ear, Noise};
pub use memory::{Memory, TRACES, Trace};
pub use sight::{Sight, SightCounters, SightSettings, Visible};

use crate::sets::LogicSystems;
use bevy::app::{App, FixedUpdate};
use bevy::ecs::prelude::*;

pub(crate) fn build(app: &mut App) {
    app.init_resource::<SightSettings>()
        .init_resource::<SightCounters>()
        .register_type::<Ear>()
        .register_type::<SightCounters>()
        .register_type::<SightSettings>()
        .register_type::<Visible>()
        .add_message::<Noise>()
        .add_systems(
            FixedUpdate,
            (
                sight::see.run_if(any_with_component::<Sight>),
                hearing::hear.run_if(any_with_component::<Ear>),
                memory::remember.run_if(any_with_component::<Memory>),
            )
                .chain()
                .in_set(LogicSystems::Sense),
        );
}
