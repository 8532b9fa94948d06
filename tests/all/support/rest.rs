//! Ground that has come to rest: what a view asks for is made over some frames, some dozens at most in these tests.

use bevy::prelude::*;
use dolomite::ground::render::GroundProgress;

/// Most frames that are waited for.
const MOST: usize = 400;

/// Whether all that the views ask for is there and drawn.
pub fn is_settled(app: &App) -> bool {
    let ground = app.world().resource::<GroundProgress>().all();
    ground.is_some_and(|ground| ground.settled)
}

/// Frames until so many on end were at rest, as `frame` says of each; whether that was so in time. Counters come three frames
/// late.
pub fn comes_to_rest(on_end: usize, mut frame: impl FnMut() -> bool) -> bool {
    let mut calm = 0;
    (0..MOST).any(|_| {
        calm = if frame() { calm + 1 } else { 0 };
        calm == on_end
    })
}
