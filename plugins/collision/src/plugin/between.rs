//! What steps move is drawn between them.

use bevy::app::{App, FixedFirst, FixedLast, RunFixedMainLoop, RunFixedMainLoopSystems};
use bevy::ecs::prelude::*;
use bevy::time::{Fixed, Time};
use bevy::transform::components::Transform;

/// On an entity that steps of `FixedUpdate` move, a mover, a lift or a body of Rapier's: between steps its `Transform` is
/// the share of the way from the step before to the last that time has gone since, so that it does not move by jerks
/// where frames and steps are not one to one. Drawing is a step behind by that.
///
/// In steps the `Transform` is where the last step left it, to the bit: whatever works in `FixedFirst` to `FixedLast` sees
/// nothing of this. A `Transform` that somebody writes outside of steps counts at once, and what was before is
/// forgotten.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[require(Transform)]
pub struct BetweenSteps {
    before: Option<Transform>,
    now: Option<Transform>,
    drawn: Option<Transform>,
}

impl BetweenSteps {
    /// Where the last step left it, while its `Transform` is drawn elsewhere; `None` before the first step.
    #[must_use]
    pub const fn now(&self) -> Option<Transform> {
        self.now
    }
}

pub(super) fn build(app: &mut App) {
    let any = any_with_component::<BetweenSteps>;
    app.add_systems(
        RunFixedMainLoop,
        (
            restore.in_set(RunFixedMainLoopSystems::BeforeFixedMainLoop),
            draw.in_set(RunFixedMainLoopSystems::AfterFixedMainLoop),
        )
            .run_if(any),
    )
    .add_systems(FixedFirst, begin.run_if(any))
    .add_systems(FixedLast, end.run_if(any));
}

/// Back to where the last step left it, if it is still where it was drawn.
fn restore(mut all: Query<(&mut BetweenSteps, &mut Transform)>) {
    for (mut state, mut place) in &mut all {
        let Some(drawn) = state.drawn else { continue };
        match state.now {
            Some(now) if drawn == *place => {
                place.set_if_neq(now);
            }
            _ => *state = BetweenSteps::default(),
        }
    }
}

fn begin(mut all: Query<(&mut BetweenSteps, &Transform)>) {
    for (mut state, place) in &mut all {
        state.before = Some(*place);
    }
}

fn end(mut all: Query<(&mut BetweenSteps, &Transform)>) {
    for (mut state, place) in &mut all {
        state.now = Some(*place);
    }
}

fn draw(time: Res<Time<Fixed>>, mut all: Query<(&mut BetweenSteps, &mut Transform)>) {
    let share = time.overstep_fraction();
    for (mut state, mut place) in &mut all {
        if let (Some(before), Some(now)) = (state.before, state.now) {
            let drawn = between(before, now, share);
            place.set_if_neq(drawn);
            if state.drawn != Some(drawn) {
                state.drawn = Some(drawn);
            }
        }
    }
}

/// A share of the way. Of no way it is the place itself: rounding would move what lies still.
fn between(before: Transform, now: Transform, share: f32) -> Transform {
    if before == now {
        return now;
    }
    Transform {
        translation: before.translation.lerp(now.translation, share),
        rotation: before.rotation.slerp(now.rotation, share),
        scale: before.scale.lerp(now.scale, share),
    }
}
