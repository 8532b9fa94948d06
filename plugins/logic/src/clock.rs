//! Steps, and systems that run at a rate of their own.

use crate::sets::LogicSystems;
use crate::values::Logic;
use bevy::app::{App, FixedUpdate};
use bevy::ecs::prelude::*;
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::system::ScheduleSystem;
use bevy::reflect::prelude::*;
use bevy::time::Time;

/// How many steps there were. Steps are those of `FixedUpdate`; while nothing has logic, none is counted.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct LogicClock {
    /// Of the step that runs, from 1 on.
    pub step: u64,
    /// Seconds of a step.
    pub delta: f32,
}

impl Default for LogicClock {
    /// Bevy's own step of 1/64 s.
    fn default() -> Self {
        Self {
            step: 0,
            delta: 1.0 / 64.0,
        }
    }
}

impl LogicClock {
    /// Steps in some seconds, rounded, at least 1; none of a time that is not above 0, or NaN. An endless time has
    /// [`u32::MAX`] steps, at 64 a second more than two years.
    #[must_use]
    pub fn steps(&self, seconds: f32) -> Option<u32> {
        let steps = seconds / self.delta;
        // Also refuses NaN; a conversion stops at the greatest number.
        (steps > 0.0).then(|| (steps.round() as u32).max(1))
    }
}

/// One step more.
pub(crate) fn advance(mut clock: ResMut<LogicClock>, time: Option<Res<Time>>) {
    clock.step += 1;
    if let Some(seconds) = time.map(|time| time.delta_secs())
        && seconds > 0.0
    {
        clock.delta = seconds;
    }
}

/// A run condition: in every n-th step, where n is the whole number next to the steps of a `hertz`-th second, or in
/// every step where there are fewer. So the rate is one that divides that of steps: of 64 a second 20 become 21.3, 40
/// become 32, and 50 become 64. Never for a rate that is not above 0.
pub fn at_rate(hertz: f32) -> impl Fn(Res<LogicClock>, Query<(), With<Logic>>) -> bool + Clone {
    move |clock: Res<LogicClock>, logic: Query<(), With<Logic>>| {
        hertz > 0.0
            && !logic.is_empty()
            // Of an endless rate a period is 0.
            && (hertz.is_infinite()
                || clock
                    .steps(1.0 / hertz)
                    .is_some_and(|every| clock.step.is_multiple_of(u64::from(every))))
    }
}

/// Adds systems of logic to an app.
pub trait LogicAppExt {
    /// Runs systems about `hertz` times a second in [`LogicSystems::Update`], in steps of `FixedUpdate`; [`at_rate`]
    /// says how often exactly.
    fn add_update<M>(
        &mut self,
        hertz: f32,
        systems: impl IntoScheduleConfigs<ScheduleSystem, M>,
    ) -> &mut Self;
}

impl LogicAppExt for App {
    fn add_update<M>(
        &mut self,
        hertz: f32,
        systems: impl IntoScheduleConfigs<ScheduleSystem, M>,
    ) -> &mut Self {
        let systems = systems.in_set(LogicSystems::Update);
        self.add_systems(FixedUpdate, systems.run_if(at_rate(hertz)))
    }
}
