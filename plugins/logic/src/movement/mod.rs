//! Movement: where one can walk, fields for many, paths for few, avoidance, patrols.
//!
//! | | |
//! |---|---|
//! | [`WalkGrid`] | walkable cells: slopes, water and walls are not walked |
//! | [`FlowField`], [`Walker`] | the way to a goal from everywhere; a crowd that follows it and avoids each other |
//! | [`find_path`] | a way from one place to another for one |
//! | [`Route`], [`Patrol`] | a spline, and who goes along it |

mod crowd;
mod flow;
mod ground;
mod orca;
mod path;
mod patrol;
mod sight_line;
mod walk;
mod walker;

pub use flow::{FlowField, NEVER};
pub use ground::{GridError, MOST_CELLS, MOST_SIDE, WalkGrid, WalkGround, WalkLimits};
pub use orca::{Disc, Line, NEIGHBOURS, half_plane, velocity};
pub use path::{PathScratch, find_path, path_length};
pub use patrol::{Patrol, Route, RouteError};
pub use sight_line::{UNITS, is_clear};
pub use walker::{FlowFields, WalkCounters, WalkSettings, WalkTimes, Walker};

use crate::sets::LogicSystems;
use bevy::app::{App, FixedUpdate};
use bevy::ecs::prelude::*;

pub(crate) fn build(app: &mut App) {
    app.init_resource::<FlowFields>()
        .init_resource::<WalkSettings>()
        .init_resource::<WalkCounters>()
        .init_resource::<WalkTimes>()
        .register_type::<Patrol>()
        .register_type::<WalkCounters>()
        .register_type::<WalkSettings>()
        .register_type::<WalkTimes>()
        .register_type::<Walker>()
        .add_systems(
            FixedUpdate,
            (
                walk::walk.run_if(any_with_component::<Walker>),
                patrol::patrol.run_if(any_with_component::<Patrol>),
            )
                .chain()
                .in_set(LogicSystems::Move),
        );
}
