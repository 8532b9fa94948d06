//! Rules: objectives, and missions that are won or lost. An entity with these alone is seen by nobody.

use crate::action::{Action, Output};
use crate::names::Key;
use crate::value::Value;
use crate::values::Logic;
use bevy::ecs::prelude::*;
use bevy::reflect::prelude::*;

/// What became of an objective or a mission.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum Outcome {
    /// Nothing yet.
    #[default]
    Open,
    /// Reached.
    Won,
    /// Lost.
    Lost,
}

/// Something to be reached so many times. Actions: [`Key::PROGRESS`] (by a whole number, or 1), [`Key::FAIL`],
/// [`Key::RESET`]. Outputs: [`Key::DONE`], [`Key::FAILED`]. What is decided stays so until it is reset.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, Clone, PartialEq)]
#[require(Logic)]
pub struct Objective {
    /// How often.
    pub need: i32,
    /// How often so far.
    pub have: i32,
    /// What became of it.
    pub outcome: Outcome,
    /// Whether a mission is won without it.
    pub optional: bool,
}

impl Objective {
    /// To be reached `need` times.
    #[must_use]
    pub const fn new(need: i32) -> Self {
        Self {
            need,
            have: 0,
            outcome: Outcome::Open,
            optional: false,
        }
    }
}

/// Won when all its objectives that are not optional are reached; lost when one of them is lost or gone, or by
/// [`Key::FAIL`]. Outputs: [`Key::WON`], [`Key::LOST`]. One without objectives stays open. [`Key::RESET`] opens it.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Logic)]
pub struct Mission {
    /// Entities with an [`Objective`].
    pub objectives: Vec<Entity>,
    /// What became of it.
    pub outcome: Outcome,
}

impl Mission {
    /// Of these objectives.
    #[must_use]
    pub const fn new(objectives: Vec<Entity>) -> Self {
        Self {
            objectives,
            outcome: Outcome::Open,
        }
    }
}

pub(super) fn run(
    mut actions: MessageReader<Action>,
    mut objectives: Query<&mut Objective>,
    mut missions: Query<(Entity, &mut Mission)>,
    mut outputs: MessageWriter<Output>,
) {
    for action in actions.read() {
        if let Ok(mut objective) = objectives.get_mut(action.target) {
            match action.verb {
                Key::RESET => {
                    objective.have = 0;
                    objective.outcome = Outcome::Open;
                }
                Key::FAIL if objective.outcome == Outcome::Open => {
                    objective.outcome = Outcome::Lost;
                    outputs.write(Output::new(action.target, Key::FAILED, ()));
                }
                Key::PROGRESS if objective.outcome == Outcome::Open => {
                    let by = match action.parameter {
                        Value::Int(by) => by,
                        _ => 1,
                    };
                    objective.have = objective.have.saturating_add(by);
                    if objective.have >= objective.need {
                        objective.outcome = Outcome::Won;
                        outputs.write(Output::new(action.target, Key::DONE, ()));
                    }
                }
                _ => (),
            }
        }
        if let Ok((_, mut mission)) = missions.get_mut(action.target) {
            match action.verb {
                Key::RESET => mission.outcome = Outcome::Open,
                Key::FAIL if mission.outcome == Outcome::Open => {
                    mission.outcome = Outcome::Lost;
                    outputs.write(Output::new(action.target, Key::LOST, ()));
                }
                _ => (),
            }
        }
    }
    for (entity, mut mission) in &mut missions {
        if mission.outcome != Outcome::Open || mission.objectives.is_empty() {
            continue;
        }
        let mut outcome = Outcome::Won;
        for &objective in &mission.objectives {
            match objectives.get(objective) {
                Ok(objective) if objective.optional => (),
                Ok(objective) if objective.outcome == Outcome::Won => (),
                Ok(objective) if objective.outcome == Outcome::Open => {
                    if outcome == Outcome::Won {
                        outcome = Outcome::Open;
                    }
                }
                // Lost, or gone: it cannot be reached any more.
                _ => outcome = Outcome::Lost,
            }
        }
        if outcome != Outcome::Open {
            mission.outcome = outcome;
            let name = if outcome == Outcome::Won {
                Key::WON
            } else {
                Key::LOST
            };
            outputs.write(Output::new(entity, name, ()));
        }
    }
}
