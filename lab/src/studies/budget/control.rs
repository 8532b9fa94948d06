//! Who controls: ours, and the baselines that anyone would try first.

use dolomite_geometry::budget::{Budget, BudgetController, NextFrame, TimeSample};

/// Chooses a tolerance for each frame.
pub trait Control {
    /// The next frame's tolerance, pixels; `seen` is what has arrived since the last call.
    fn decide(&mut self, seen: &[TimeSample], next: &NextFrame) -> f32;
}

/// The same tolerance always.
pub struct Fixed(pub f32);

impl Control for Fixed {
    fn decide(&mut self, _: &[TimeSample], _: &NextFrame) -> f32 {
        self.0
    }
}

/// A tolerance for each leg.
pub struct PerLeg {
    /// First frame and tolerance.
    pub taus: Vec<(usize, f32)>,
}

impl Control for PerLeg {
    fn decide(&mut self, _: &[TimeSample], next: &NextFrame) -> f32 {
        let begun = |leg: &&(usize, f32)| leg.0 as u64 <= next.number;
        self.taus.iter().rev().find(begun).map_or(1.0, |leg| leg.1)
    }
}

/// Proportional, integral and differential terms over the logarithm of time, in the form of steps of
/// ln τ. Proportional alone, in this form, is `integral` alone: ln τ moves by a part of the distance.
#[derive(Clone, Copy, Debug)]
pub struct Pid {
    /// Answer to the distance, a frame.
    pub integral: f64,
    /// To its change.
    pub proportional: f64,
    /// To the change of the change.
    pub differential: f64,
    /// Part of the budget that is aimed at.
    pub aim: f64,
}

/// A [`Pid`] at work.
pub struct PidControl {
    gains: Pid,
    budget: Budget,
    ln_tau: f64,
    /// The last two distances.
    past: [f64; 2],
}

impl PidControl {
    /// At rest at the greatest tolerance.
    pub fn new(gains: Pid, budget: Budget) -> Self {
        Self {
            gains,
            budget,
            ln_tau: ln(f64::from(budget.greatest)),
            past: [0.0; 2],
        }
    }
}

#[expect(clippy::disallowed_methods, reason = "a baseline of a study")]
fn ln(x: f64) -> f64 {
    x.ln()
}

#[expect(clippy::disallowed_methods, reason = "a baseline of a study")]
fn exp(x: f64) -> f64 {
    x.exp()
}

impl Control for PidControl {
    fn decide(&mut self, seen: &[TimeSample], _: &NextFrame) -> f32 {
        let Pid {
            integral,
            proportional,
            differential,
            aim,
        } = self.gains;
        for sample in seen {
            let aim = aim * f64::from(self.budget.milliseconds);
            let off = ln(f64::from(sample.milliseconds) / aim);
            let [one, two] = self.past;
            self.ln_tau += integral * off
                + proportional * (off - one)
                + differential * (off - 2.0 * one + two);
            self.past = [off, one];
        }
        let ends = [self.budget.least, self.budget.greatest].map(|tau| ln(f64::from(tau)));
        self.ln_tau = self.ln_tau.clamp(ends[0], ends[1]);
        exp(self.ln_tau) as f32
    }
}

/// [`BudgetController`], with what it may see.
pub struct Ours {
    controller: BudgetController,
    curves: bool,
    counts: bool,
}

impl Ours {
    /// With or without work curves, and counted triangles.
    pub fn new(budget: Budget, curves: bool, counts: bool) -> Self {
        Self {
            controller: BudgetController::new(budget).expect("a budget of the study is one"),
            curves,
            counts,
        }
    }
}

impl Control for Ours {
    fn decide(&mut self, seen: &[TimeSample], next: &NextFrame) -> f32 {
        for sample in seen {
            self.controller.observe(&TimeSample {
                triangles: sample.triangles.filter(|_| self.counts),
                ..*sample
            });
        }
        self.controller.decide(&NextFrame {
            curve: next.curve.filter(|_| self.curves),
            ..*next
        })
    }
}
