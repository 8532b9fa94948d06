//! Ready-made parts of a game's logic, each a component that works alone.
//!
//! | component | what it is |
//! |---|---|
//! | [`LogicTimer`] | says when its time is over |
//! | [`Button`] | is pressed |
//! | [`Door`], [`Slide`] | opens and closes; moves its entity as it does |
//! | [`Lift`] | goes from floor to floor as it is called, with doors and waiting time |
//! | [`Health`], [`Team`] | is hurt, healed, dies; who belongs together |
//! | [`Zone`], [`Visitor`] | a box that says who comes and goes |
//! | [`PickUp`], [`Collector`] | what lies about and is taken |
//! | [`Weapon`] | shoots; [`Shots`] are swept |
//! | [`Objective`], [`Mission`] | rules |
//! | [`Lamp`], [`DayClock`] | lamps, and the hour that switches them |

mod button;
mod door;
mod health;
mod lamp;
mod lift;
mod pickup;
mod rules;
mod sum;
mod timer;
mod weapon;
mod zone;

pub use button::Button;
pub use door::{Door, DoorState, Slide};
pub use health::{Health, Team};
pub use lamp::{DayClock, Lamp};
pub use lift::{FLOORS, Lift, LiftError, LiftState};
pub use pickup::{Collector, PickUp};
pub use rules::{Mission, Objective, Outcome};
pub use timer::LogicTimer;
pub use weapon::{Shot, ShotMessage, Shots, Weapon};
pub(crate) use zone::Inside;
pub use zone::{Visitor, Zone, ZoneKind, ZoneMessage, crossing, inside_times};

use crate::bodies::{BodyIndex, Hitbox, any_body, gather};
use crate::sets::LogicSystems;
use bevy::app::{App, FixedUpdate};
use bevy::ecs::prelude::*;

pub(crate) fn build(app: &mut App) {
    app.init_resource::<Inside>()
        .init_resource::<Shots>()
        .init_resource::<BodyIndex>()
        .register_type::<Collector>()
        .register_type::<Door>()
        .register_type::<Health>()
        .register_type::<Lamp>()
        .register_type::<LogicTimer>()
        .register_type::<Mission>()
        .register_type::<Objective>()
        .register_type::<Shots>()
        .register_type::<Slide>()
        .register_type::<Team>()
        .register_type::<Weapon>()
        .add_message::<ZoneMessage>()
        .add_message::<ShotMessage>()
        .add_systems(
            FixedUpdate,
            (
                button::run.run_if(any_with_component::<Button>),
                timer::run.run_if(any_with_component::<LogicTimer>),
                lamp::run_clocks.run_if(any_with_component::<DayClock>),
                lamp::run_lamps.run_if(any_with_component::<Lamp>),
                lift::run.run_if(any_with_component::<Lift>),
                door::run.run_if(any_with_component::<Door>),
                health::run.run_if(any_with_component::<Health>),
                health::tell.run_if(any_with_component::<Health>),
                weapon::fire.run_if(any_with_component::<Weapon>),
            )
                .chain()
                .in_set(LogicSystems::Act),
        )
        .add_systems(
            FixedUpdate,
            (
                zone::run.run_if(any_with_component::<Visitor>.or_else(zone::any_inside)),
                pickup::run.run_if(any_with_component::<PickUp>),
                gather.run_if(any_with_component::<Hitbox>.or_else(any_body)),
                weapon::fly.run_if(weapon::any_shot),
            )
                .chain()
                .in_set(LogicSystems::Touch),
        )
        .add_systems(
            FixedUpdate,
            rules::run
                .run_if(any_with_component::<Objective>.or_else(any_with_component::<Mission>))
                .in_set(LogicSystems::Rules),
        );
}
