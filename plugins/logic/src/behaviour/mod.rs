//! Behaviours as data: trees with scores, written in RON, run over arrays of agents.
//!
//! | | |
//! |---|---|
//! | [`Mind`] | an agent that follows a behaviour |
//! | [`BehaviourAppExt`] | adds leaves, which are systems, and behaviours, which are texts or files |
//! | [`LeafBatch`] | everybody who is at a leaf |
//! | [`Behaviours`] | what was read, and why something was not |
//! | [`tree_of`] | the tree of an agent as text, with what runs |
//!
//! The nodes of a tree: `Sequence`, `Select`, `Choose` (by scores), `Not`, `Anyway`, `Repeat`, `Cooldown`, `Limit`,
//! `If`, `Set`, `Wait`, `Send`, `Say`, `Do`, `DoWith`, `Use`. The README says what each does.

mod compile;
mod error;
mod leaf;
mod machine;
mod mind;
mod program;
mod shown;
mod spec;
mod store;
mod think;

pub use compile::compile;
pub use error::{BehaviourError, Reason};
pub use leaf::{LeafBatch, LeafCall, Leaves, Parameters, Phase};
pub use mind::{BehaviourId, Mind, Status};
pub use program::Program;
pub use shown::tree_of;
pub use spec::Curve;
pub use store::{BehaviourAppExt, BehaviourMessage, Behaviours, add_behaviour, load_behaviour};
pub use think::ThoughtCounters;

use crate::sets::LogicSystems;
use bevy::app::{App, FixedUpdate};
use bevy::ecs::prelude::*;

pub(crate) fn build(app: &mut App) {
    app.init_resource::<Leaves>()
        .init_resource::<Behaviours>()
        .init_resource::<ThoughtCounters>()
        .register_type::<ThoughtCounters>()
        .add_message::<BehaviourMessage>()
        .add_systems(
            FixedUpdate,
            (store::reload.run_if(store::looks), think::think)
                .chain()
                .run_if(any_with_component::<Mind>)
                .in_set(LogicSystems::Think),
        );
}
