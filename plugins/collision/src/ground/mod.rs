//! Ground of `dolomite_terrain` under movers.
//!
//! | component | who writes it | what it is |
//! |---|---|---|
//! | [`GroundTiles`] | you | ground as triangles between samples of its heights in f64 |
//! | [`MeetsMovers`] | you, beside it | movers meet it |
//! | [`OnDrawnGround`] | you, on a mover | it is drawn standing on the triangle that a camera drew |
//!
//! A mover is where its steps in f64 lead it, on the samples of the ground, whatever any camera sees: a scene without one
//! takes the same steps. [`OnDrawnGround`] changes where it is drawn, by no more than the camera's stated error and what the
//! samples miss.

mod diagonals;
mod drawn;
mod heights;
mod tiles;

pub use diagonals::Diagonals;
pub use drawn::OnDrawnGround;
pub use heights::{GroundTiles, TileError};

use crate::plugin::{CharacterBody, CollisionSystems, MeetsMovers, gather, go};
use bevy::app::{App, FixedUpdate};
use bevy::ecs::prelude::*;

pub(crate) fn build(app: &mut App) {
    app.init_resource::<tiles::MoverTiles>()
        .register_type::<OnDrawnGround>()
        .add_systems(
            FixedUpdate,
            (
                tiles::lay.run_if(is_met).after(gather),
                tiles::forget.run_if(not(is_met).and_then(tiles::any)),
            )
                .in_set(CollisionSystems::Gather),
        )
        .add_systems(
            FixedUpdate,
            drawn::raise
                .in_set(CollisionSystems::Move)
                .after(go)
                .run_if(any_with_component::<OnDrawnGround>),
        );
}

/// Whether there is ground that movers meet, and a mover.
fn is_met(
    grounds: Query<(), (With<GroundTiles>, With<MeetsMovers>)>,
    movers: Query<(), With<CharacterBody>>,
) -> bool {
    !grounds.is_empty() && !movers.is_empty()
}

/// Bytes of the tiles that are kept for movers; for tests.
#[doc(hidden)]
#[must_use]
pub fn bytes_of_tiles(world: &World) -> usize {
    world.resource::<tiles::MoverTiles>().bytes()
}

/// Tiles that were made for movers since the app began; for tests.
#[doc(hidden)]
#[must_use]
pub fn tiles_made(world: &World) -> u64 {
    world.resource::<tiles::MoverTiles>().made
}
