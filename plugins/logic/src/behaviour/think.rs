//! One tick of every agent that is due.
//!
//! First every agent goes from its root to the first leaf, on all threads, since none of them touches another. Then,
//! leaf by leaf in the order in which leaves were added, each leaf's system gets all agents that are there, in the
//! order of the world, and they go on with its answers, until nobody is at a leaf any more. So a leaf is called a few
//! times a tick, however many agents there are, and the order of everything is the same for any number of threads.

use super::leaf::{LeafBatch, LeafCall, Leaves, Phase};
use super::machine::{Machine, Way};
use super::mind::{BehaviourId, Mind, Status};
use super::program::{NONE, Op, Program};
use super::store::Behaviours;
use crate::action::{Action, Output};
use crate::clock::LogicClock;
use crate::need::{Asleep, Attention};
use crate::value::Value;
use crate::values::Values;
use bevy::ecs::prelude::*;
use bevy::reflect::prelude::*;
use std::sync::Arc;

/// What the last step of behaviours did.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct ThoughtCounters {
    /// Agents that were due.
    pub agents: u32,
    /// Agents handed to leaves, each as often as it was.
    pub calls: u32,
    /// Times that a leaf's system ran.
    pub batches: u32,
}

/// Lists that steps use again.
#[derive(Default)]
pub(super) struct Lists {
    programs: Vec<(Arc<Program>, u32)>,
    /// By leaf: who is at it in this round, and in the next one.
    now: Vec<Vec<LeafCall>>,
    next: Vec<Vec<LeafCall>>,
    actions: Vec<Action>,
    outputs: Vec<Output>,
}

type Agents = QueryState<
    (
        Entity,
        &'static mut Mind,
        &'static mut Values,
        Option<&'static Attention>,
    ),
    Without<Asleep>,
>;

/// A step's share of every agent: what it needs beside itself.
#[derive(Clone, Copy)]
struct Step<'a> {
    programs: &'a [(Arc<Program>, u32)],
    step: u32,
    delta: f32,
}

impl Step<'_> {
    fn with<T>(
        &self,
        mind: &mut Mind,
        values: &mut Mut<Values>,
        work: impl FnOnce(&mut Machine) -> T,
    ) -> Option<T> {
        let (program, _) = self.programs.get(usize::from(mind.behaviour.0))?;
        let before = values.changes();
        let mut machine = Machine {
            program,
            mind,
            values: values.bypass_change_detection(),
            step: self.step,
            delta: self.delta,
        };
        let result = work(&mut machine);
        if values.changes() != before {
            values.set_changed();
        }
        Some(result)
    }

    /// From the root to the first leaf.
    fn first(&self, mind: &mut Mind, values: &mut Mut<Values>) {
        let Some((program, edition)) = self.programs.get(usize::from(mind.behaviour.0)) else {
            return;
        };
        if mind.edition != *edition {
            mind.restart(*edition, program.slots);
            for &(key, value) in &program.start {
                if values.get(key).is_none() {
                    // It is finite and new, so that nothing refuses it.
                    let _ = values.set(key, value);
                }
            }
            // A leaf of the edition before is told to stop first; the way begins in the next tick.
            if mind.stopped.0 != NONE {
                return;
            }
        }
        if let Some(Way::At(node)) = self.with(mind, values, |machine| machine.tick()) {
            mind.way = node;
        }
    }
}

impl Lists {
    /// Goes on from where a way stopped until it is at a leaf or ends.
    fn follow(
        &mut self,
        step: &Step,
        agent: Entity,
        mind: &mut Mind,
        values: &mut Mut<Values>,
        mut way: Way,
    ) {
        while let Way::At(node) = way {
            let program = &step.programs[usize::from(mind.behaviour.0)].0;
            let status = match program.nodes[usize::from(node)].op {
                Op::Do(leaf, _) => {
                    let phase = match mind.running == node {
                        true => Phase::Continue,
                        false => Phase::Start,
                    };
                    self.call(leaf, agent, phase, mind.behaviour, node);
                    return;
                }
                Op::Send(verb, target) => match values.get(target) {
                    Some(Value::Entity(target)) => {
                        self.actions.push(Action {
                            target,
                            source: agent,
                            verb,
                            parameter: Value::Entity(agent),
                        });
                        Status::Success
                    }
                    _ => Status::Failure,
                },
                Op::Say(name) => {
                    self.outputs.push(Output::new(agent, name, agent));
                    Status::Success
                }
                _ => Status::Failure,
            };
            way = step
                .with(mind, values, |machine| machine.resume(node, status))
                .unwrap_or(Way::Done);
        }
        self.stop(agent, mind);
    }

    /// Tells the leaf that was left.
    fn stop(&mut self, agent: Entity, mind: &mut Mind) {
        let (leaf, node) = std::mem::replace(&mut mind.stopped, (NONE, NONE));
        if leaf != NONE {
            self.call(leaf, agent, Phase::Stop, mind.behaviour, node);
        }
    }

    fn call(&mut self, leaf: u16, agent: Entity, phase: Phase, behaviour: BehaviourId, node: u16) {
        let leaf = usize::from(leaf);
        if self.next.len() <= leaf {
            self.next.resize_with(leaf + 1, Vec::new);
        }
        self.next[leaf].push(LeafCall {
            agent,
            phase,
            status: Status::Running,
            behaviour,
            node,
        });
    }
}

/// One tick.
pub(super) fn think(world: &mut World, agents: &mut Agents, mut lists: Local<Lists>) {
    let clock = *world.resource::<LogicClock>();
    let mut counters = ThoughtCounters::default();
    let mut programs = std::mem::take(&mut lists.programs);
    programs.clear();
    let behaviours = world.resource::<Behaviours>();
    programs.extend(
        behaviours
            .programs()
            .map(|(p, edition)| (Arc::clone(p), edition)),
    );
    let step = Step {
        programs: &programs,
        // Differences of steps are all that counts.
        step: clock.step as u32,
        delta: clock.delta,
    };
    agents
        .par_iter_mut(world)
        .for_each(|(_, mut mind, mut values, attention)| {
            let mind = mind.bypass_change_detection();
            mind.way = NONE;
            if attention.is_none_or(|attention| attention.is_due(clock.step)) {
                step.first(mind, &mut values);
            }
        });
    for (agent, mut mind, mut values, attention) in agents.iter_mut(world) {
        counters.agents += u32::from(attention.is_none_or(|a| a.is_due(clock.step)));
        let mind = mind.bypass_change_detection();
        if mind.way == NONE {
            if mind.stopped.0 != NONE {
                lists.stop(agent, mind);
            }
            continue;
        }
        let way = Way::At(mind.way);
        lists.follow(&step, agent, mind, &mut values, way);
    }
    let mut batch = LeafBatch {
        calls: Vec::new(),
        programs: programs
            .iter()
            .map(|(program, _)| Arc::clone(program))
            .collect(),
        seconds: clock.delta,
    };
    loop {
        let Lists { now, next, .. } = &mut *lists;
        std::mem::swap(now, next);
        if now.iter().all(Vec::is_empty) {
            break;
        }
        for leaf in 0..lists.now.len() {
            if lists.now[leaf].is_empty() {
                continue;
            }
            std::mem::swap(&mut batch.calls, &mut lists.now[leaf]);
            counters.calls += batch.calls.len() as u32;
            counters.batches += 1;
            let system = world.resource::<Leaves>().systems.get(leaf).copied();
            let ran = system.map(|system| world.run_system_with(system, &mut batch));
            if !matches!(ran, Some(Ok(()))) {
                // A leaf whose system cannot run fails, and its agents do something else.
                for call in &mut batch.calls {
                    call.status = Status::Failure;
                }
            }
            for call in batch.calls.drain(..) {
                if call.phase == Phase::Stop {
                    continue;
                }
                // A leaf may have removed the agent, or given it another behaviour.
                let Ok((_, mut mind, mut values, _)) = agents.get_mut(world, call.agent) else {
                    continue;
                };
                let mind = mind.bypass_change_detection();
                if mind.behaviour != call.behaviour || mind.edition == 0 {
                    continue;
                }
                let way = step.with(mind, &mut values, |machine| {
                    machine.resume(call.node, call.status)
                });
                let way = way.unwrap_or(Way::Done);
                lists.follow(&step, call.agent, mind, &mut values, way);
            }
            std::mem::swap(&mut batch.calls, &mut lists.now[leaf]);
        }
    }
    if !lists.actions.is_empty() {
        world.write_message_batch(lists.actions.drain(..).collect::<Vec<_>>());
    }
    if !lists.outputs.is_empty() {
        world.write_message_batch(lists.outputs.drain(..).collect::<Vec<_>>());
    }
    programs.clear();
    lists.programs = programs;
    *world.resource_mut::<ThoughtCounters>() = counters;
}
