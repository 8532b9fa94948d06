//! One agent's way through its tree.
//!
//! What an agent keeps is one number: the node that runs. A tick begins at the root and goes down: whatever holds that
//! node goes on there, tests are asked again, and a `Select` or `Choose` may turn elsewhere. A leaf is a system over
//! many agents, so the way stops there ([`Way::At`]) and goes on with the leaf's answer, in the same tick. Each node
//! is passed at most once a tick on the way down, so a tick ends.

use super::mind::{Mind, Status};
use super::program::{Code, Factor, NONE, Op, Program};
use crate::values::Values;

/// Where an agent's way stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Way {
    /// At a node that others answer: a leaf, an action to send, an output to say.
    At(u16),
    /// At the end of the tick.
    Done,
}

/// Of one agent, in one tick.
pub(super) struct Machine<'a> {
    pub program: &'a Program,
    pub mind: &'a mut Mind,
    pub values: &'a mut Values,
    /// Of the clock, its low bits: differences of half of 2^32 steps are told apart.
    pub step: u32,
    /// Seconds of a step.
    pub delta: f32,
}

enum To {
    Down(u16),
    Up(u16, Status),
}

impl Machine<'_> {
    /// From the root.
    pub fn tick(&mut self) -> Way {
        if self.program.is_empty() {
            return Way::Done;
        }
        self.go(To::Down(0))
    }

    /// From a node that has its answer.
    pub fn resume(&mut self, node: u16, status: Status) -> Way {
        if status == Status::Running {
            return self.finish(node, status);
        }
        self.ended(node);
        self.go(To::Up(node, status))
    }

    /// What runs is not this node any more.
    fn ended(&mut self, node: u16) {
        if self.mind.running == node {
            self.mind.running = NONE;
            self.mind.leaf = NONE;
        }
    }

    fn finish(&mut self, reached: u16, status: Status) -> Way {
        if self.mind.running != reached {
            // A leaf that ran and was not reached again is told so.
            self.mind.stopped = (self.mind.leaf, self.mind.running);
            self.mind.leaf = self.program.leaf(reached).unwrap_or(NONE);
            self.mind.running = reached;
            self.mind.since = self.step;
        }
        self.mind.status = status;
        Way::Done
    }

    fn code(&self, node: u16) -> &Code {
        &self.program.nodes[usize::from(node)]
    }

    /// Whether what runs lies below a node.
    fn holds(&self, node: u16) -> bool {
        let running = self.mind.running;
        running != NONE && running > node && running < self.code(node).end
    }

    fn go(&mut self, mut to: To) -> Way {
        loop {
            to = match to {
                To::Down(node) => match self.down(node) {
                    Ok(to) => to,
                    Err(way) => return way,
                },
                To::Up(0, status) => return self.finish(NONE, status),
                To::Up(node, status) => match self.up(node, status) {
                    Ok(to) => to,
                    Err(way) => return way,
                },
            };
        }
    }

    fn down(&mut self, node: u16) -> Result<To, Way> {
        let op = self.code(node).op;
        let test = |yes: bool| {
            let status = if yes {
                Status::Success
            } else {
                Status::Failure
            };
            Ok(To::Up(node, status))
        };
        match op {
            Op::Sequence => {
                if !self.holds(node) {
                    return Ok(To::Down(node + 1));
                }
                let mut child = node + 1;
                while self.code(child).end <= self.mind.running {
                    if self.code(child).op.is_test() && !self.asks(self.code(child).op) {
                        return Ok(To::Up(node, Status::Failure));
                    }
                    child = self.code(child).end;
                }
                Ok(To::Down(child))
            }
            Op::Select | Op::Not | Op::Anyway | Op::Repeat => Ok(To::Down(node + 1)),
            Op::Choose => match self.best(node) {
                Some(child) => Ok(To::Down(child)),
                None => Ok(To::Up(node, Status::Failure)),
            },
            Op::Cooldown(_, slot) => {
                let until = self.mind.slot(slot);
                if !self.holds(node) && until != 0 && until.wrapping_sub(self.step) as i32 > 0 {
                    return Ok(To::Up(node, Status::Failure));
                }
                Ok(To::Down(node + 1))
            }
            Op::Limit(seconds, slot) => {
                if !self.holds(node) {
                    self.mind.set_slot(slot, self.step);
                } else if self.step.wrapping_sub(self.mind.slot(slot)) >= self.steps(seconds) {
                    return Ok(To::Up(node, Status::Failure));
                }
                Ok(To::Down(node + 1))
            }
            Op::Above(..) | Op::Below(..) | Op::Is(..) | Op::Known(_) | Op::Unknown(_) => {
                test(self.asks(op))
            }
            Op::Set(key, value) => test(self.values.set(key, value).is_ok()),
            Op::Wait(seconds) => {
                if self.mind.running != node {
                    return Err(self.finish(node, Status::Running));
                }
                if self.step.wrapping_sub(self.mind.since) < self.steps(seconds) {
                    return Err(self.finish(node, Status::Running));
                }
                self.ended(node);
                Ok(To::Up(node, Status::Success))
            }
            Op::Send(..) | Op::Say(_) | Op::Do(..) => Err(Way::At(node)),
        }
    }

    fn up(&mut self, node: u16, status: Status) -> Result<To, Way> {
        let parent = self.code(node).parent;
        let next = self.code(node).end;
        let more = next < self.code(parent).end;
        Ok(match (self.code(parent).op, status) {
            (Op::Sequence, Status::Success) | (Op::Select, Status::Failure) if more => {
                To::Down(next)
            }
            (Op::Not, Status::Success) => To::Up(parent, Status::Failure),
            (Op::Not, Status::Failure) => To::Up(parent, Status::Success),
            (Op::Anyway, _) => To::Up(parent, Status::Success),
            (Op::Repeat, Status::Failure) => {
                self.ended(parent);
                To::Up(parent, Status::Success)
            }
            // Down again in the next tick: its ancestors see that it runs.
            (Op::Repeat, _) => return Err(self.finish(parent, Status::Running)),
            (Op::Cooldown(seconds, slot), _) => {
                // 0 says that it never ended.
                let until = self.step.wrapping_add(self.steps(seconds)).max(1);
                self.mind.set_slot(slot, until);
                To::Up(parent, status)
            }
            _ => To::Up(parent, status),
        })
    }

    /// At least 1. Differences of half of 2^32 steps are told apart: at 64 a second a time of more than a year is one of
    /// a year.
    fn steps(&self, seconds: f32) -> u32 {
        ((seconds / self.delta).round() as u32).clamp(1, i32::MAX as u32 - 1)
    }

    fn asks(&self, op: Op) -> bool {
        match op {
            Op::Above(key, x) => self.values.get(key).is_some_and(|value| value.number() > x),
            Op::Below(key, x) => self.values.get(key).is_some_and(|value| value.number() < x),
            Op::Is(key, value) => self.values.get(key) == Some(value),
            Op::Known(key) => self.values.get(key).is_some(),
            Op::Unknown(key) => self.values.get(key).is_none(),
            _ => false,
        }
    }

    /// The child with the highest score above 0, of equal ones the first; the one that runs has some more.
    fn best(&self, node: u16) -> Option<u16> {
        let (mut child, end) = (node + 1, self.code(node).end);
        let mut best = (0.0, None);
        while child < end {
            let code = self.code(child);
            let [from, to] = code.factors;
            let factors = &self.program.factors[usize::from(from)..usize::from(to)];
            let mut score = factors.iter().fold(1.0, |score, factor| {
                score
                    * match *factor {
                        Factor::Always(score) => score,
                        Factor::Of(key, curve) => curve.at(self.values.number(key)),
                    }
            });
            let runs = self.mind.running != NONE && (child..code.end).contains(&self.mind.running);
            if runs && score > 0.0 {
                score += self.program.stay;
            }
            if score > best.0 {
                best = (score, Some(child));
            }
            child = code.end;
        }
        best.1
    }
}
