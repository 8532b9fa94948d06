//! The decision: which tolerance the next frame is drawn with.

use bevy::math::ops;

use super::estimate::{CostModel, Learnt, Work};
use super::settings::{Budget, BudgetError, BudgetLimit, BudgetReport};
use super::times::TimeSample;
use super::work_curve::WorkCurve;

/// Standard deviations above the mean that 99 % of a normal distribution keep below.
const ONE_IN_HUNDRED: f64 = 2.326;
/// Most of the budget that is left free for noise and ignorance: measurements soon end the latter.
const MOST_SPARED: f64 = 0.2;
/// Work that changes by more than this factor between two frames, with the same tolerance, is a cut.
const CUT_WORK: f32 = 1.5;
/// While a view or a load is new, a step from a measured tolerance changes ln τ by at most so many times
/// what the time is off by, in logarithms: time is taken to follow τ by an exponent of at least 1 over it.
/// The split of the time is a guess then, and a step too far costs three frames to learn of.
const REACH: f32 = 2.0;
/// Measurements after which neither is new.
const SETTLED: u32 = 8;
/// Range of counted over predicted work that is believed.
const BELIEVED: [f64; 2] = [1.0 / 16.0, 16.0];
/// Frames whose work is remembered; measurements come back two or three frames late.
const REMEMBERED: usize = 16;

/// The frame about to be drawn.
#[derive(Clone, Copy, Debug)]
pub struct NextFrame<'a> {
    /// Its number, greater than the last one's.
    pub number: u64,
    /// What its view asks for; without, work is taken as 1/τ.
    pub curve: Option<&'a WorkCurve>,
    /// Whether the view is another one than the last frame's: a teleport, a cut. With a work curve a
    /// great change of work counts as one too.
    pub cut: bool,
}

/// One frame that was decided.
#[derive(Clone, Copy, Debug)]
struct Decided {
    number: u64,
    tau: f32,
    /// Counts cuts.
    view: u64,
    curve: Option<WorkCurve>,
}

/// Holds a measured time at a budget by the error tolerance; see the [module](super).
///
/// A call costs some 2 µs with a work curve, 1 µs without, and allocates nothing.
#[derive(Clone, Debug)]
pub struct BudgetController {
    budget: Budget,
    tau: f32,
    model: Option<CostModel>,
    /// Counted over predicted work, once counts have come.
    counted: Option<f64>,
    view: u64,
    decided: [Option<Decided>; REMEMBERED],
    /// The last measurement of the present view and load: τ, and time over the budget.
    measured: Option<(f32, f32)>,
    /// How many there have been.
    measurements: u32,
    /// Whether tau is on its way.
    moving: bool,
    /// Whether the last measurement said that the load has changed.
    leap: bool,
    report: BudgetReport,
}

impl BudgetController {
    /// τ stands while the time that is provided for is so near to the budget, as a part of it.
    pub const REST: f32 = 0.02;
    /// Once τ moves, it goes on until the time is so near.
    const ARRIVED: f32 = 0.005;
    /// Largest relative change of τ in a frame while the time is at rest. It is what a still view may
    /// show by noise alone: half a percent of an error of one pixel is below a hundredth of a pixel.
    pub const SLOWEST: f32 = 0.005;
    /// Beyond this distance from the budget, as a part of it, τ goes to its goal at once.
    pub const FAR: f32 = 0.06;
    /// Largest relative change of τ in a frame just below [`FAR`](Self::FAR).
    const FASTEST: f32 = 0.04;

    /// A controller that starts at the greatest tolerance: the first frames are cheap, and it comes to
    /// the budget from below.
    ///
    /// # Errors
    /// [`BudgetError`].
    pub fn new(budget: Budget) -> Result<Self, BudgetError> {
        budget.check()?;
        Ok(Self {
            budget,
            tau: budget.greatest,
            model: None,
            counted: None,
            view: 0,
            decided: [None; REMEMBERED],
            measured: None,
            measurements: 0,
            moving: false,
            leap: false,
            report: BudgetReport::default(),
        })
    }

    /// Another budget from now on; what was learnt is kept.
    ///
    /// # Errors
    /// [`BudgetError`]; nothing has changed then.
    pub fn set_budget(&mut self, budget: Budget) -> Result<(), BudgetError> {
        budget.check()?;
        if budget != self.budget {
            self.budget = budget;
            self.leap = true;
        }
        Ok(())
    }

    /// What has been reached.
    #[must_use]
    pub fn report(&self) -> BudgetReport {
        self.report
    }

    /// Takes in what was measured, if anything was, and decides the next frame's tolerance, pixels.
    pub fn step(&mut self, sample: Option<TimeSample>, next: &NextFrame) -> f32 {
        if let Some(sample) = sample {
            self.observe(&sample);
        }
        self.decide(next)
    }

    /// Takes in a measured frame; in the order of frames, each once.
    pub fn observe(&mut self, sample: &TimeSample) {
        let milliseconds = f64::from(sample.milliseconds);
        if !(milliseconds.is_finite() && milliseconds > 0.0) {
            return;
        }
        let frame = self.decided.iter().flatten();
        let Some(frame) = frame.copied().find(|frame| frame.number == sample.frame) else {
            return;
        };
        // Frames from before a cut say nothing of the view that is drawn now.
        if frame.view != self.view {
            return;
        }
        let tau = if sample.tau.is_finite() && sample.tau > 0.0 {
            sample.tau
        } else {
            frame.tau
        };
        let kind = kind_of(frame.curve.as_ref());
        if let (Some(curve), Some(count)) = (frame.curve, sample.triangles) {
            self.count(f64::from(curve.at(tau)), f64::from(count));
        }
        let amount = self.amount(frame.curve.as_ref(), tau);
        match &mut self.model {
            Some(model) if model.work() == kind => match model.learn(amount, milliseconds) {
                Learnt::Refined => {}
                Learnt::Outlier => self.report.outliers += 1,
                Learnt::LoadChanged => {
                    self.report.load_changes += 1;
                    self.leap = true;
                    self.measurements = 0;
                }
            },
            _ => self.model = Some(CostModel::new(kind, amount, milliseconds)),
        }
        self.measured = Some((tau, sample.milliseconds / self.budget.milliseconds));
        self.measurements = self.measurements.saturating_add(1);
    }

    /// Corrects what is predicted by what was counted. Counts are exact: half of the way each time,
    /// since they are of views some frames ago.
    fn count(&mut self, predicted: f64, counted: f64) {
        let ratio = counted / predicted;
        if !(BELIEVED[0]..=BELIEVED[1]).contains(&ratio) {
            return;
        }
        match &mut self.counted {
            Some(known) => *known += 0.5 * (ratio - *known),
            None => {
                self.counted = Some(ratio);
                if let Some(model) = &mut self.model {
                    model.rescale(ratio);
                }
            }
        }
    }

    fn amount(&self, curve: Option<&WorkCurve>, tau: f32) -> f64 {
        let amount = match curve {
            Some(curve) => f64::from(curve.at(tau)) * self.counted.unwrap_or(1.0),
            None => f64::from(WorkCurve::inverse(tau)),
        };
        amount.max(f64::from(f32::MIN_POSITIVE))
    }

    /// Decides the tolerance of a frame, pixels.
    pub fn decide(&mut self, next: &NextFrame) -> f32 {
        let Budget {
            milliseconds,
            least,
            greatest,
        } = self.budget;
        let cut = next.cut || self.work_jumps(next);
        let kind = kind_of(next.curve);
        if cut {
            self.view += 1;
            (self.measured, self.measurements) = (None, 0);
            if let Some(model) = &mut self.model {
                model.cut(f64::from(milliseconds));
            }
        }
        let mut tau = self.tau.clamp(least, greatest);
        let model = self.model.filter(|model| model.work() == kind);
        if let Some(model) = model {
            let provided = |tau: f32| {
                (self.provided(&model, next.curve, tau) / f64::from(milliseconds)) as f32
            };
            let goal = goal(least, greatest, provided);
            let now = provided(tau);
            let distance = (now - 1.0).abs();
            let known_cut = cut && kind == Work::Known;
            if self.leap || known_cut || distance > Self::FAR {
                tau = self.within_reach(goal, &model).clamp(least, greatest);
                self.moving = false;
            } else {
                let near = if self.moving {
                    Self::ARRIVED
                } else {
                    Self::REST
                };
                self.moving = distance > near;
                if self.moving {
                    tau = towards(tau, goal, Self::step_at(distance));
                }
            }
            self.leap = false;
        }
        self.tau = tau;
        let slot = (next.number % REMEMBERED as u64) as usize;
        self.decided[slot] = Some(Decided {
            number: next.number,
            tau,
            view: self.view,
            curve: next.curve.copied(),
        });
        self.report.frame = next.number;
        self.tell(model, next.curve);
        tau
    }

    /// `goal`, or what lies on the way to it and can be trusted.
    fn within_reach(&self, goal: f32, model: &CostModel) -> f32 {
        let Some((tau, time)) = self.measured else {
            return goal;
        };
        if self.measurements > SETTLED {
            return goal;
        }
        // What the time is off by, the noise that it may hide included.
        let noise = model.noise() as f32;
        let off = ops::ln(time * (1.0 + ONE_IN_HUNDRED as f32 * noise)).abs() + noise;
        let factor = ops::exp(REACH * off);
        goal.clamp(tau / factor, tau * factor)
    }

    /// Largest relative change of τ, `distance` from the budget.
    fn step_at(distance: f32) -> f32 {
        let part = (distance - Self::REST) / (Self::FAR - Self::REST);
        Self::SLOWEST + part.clamp(0.0, 1.0) * (Self::FASTEST - Self::SLOWEST)
    }

    /// Time to provide for a frame, milliseconds, so that 99 in 100 keep to it.
    fn provided(&self, model: &CostModel, curve: Option<&WorkCurve>, tau: f32) -> f64 {
        let amount = self.amount(curve, tau);
        let spared = ONE_IN_HUNDRED * model.deviation(amount);
        let most = MOST_SPARED * f64::from(self.budget.milliseconds);
        model.expected(amount) + spared.min(most)
    }

    /// Whether this frame's view asks for much more or less than the last frame's.
    fn work_jumps(&self, next: &NextFrame) -> bool {
        let last = self
            .decided
            .iter()
            .flatten()
            .max_by_key(|frame| frame.number);
        let (Some(last), Some(now)) = (last, next.curve) else {
            return false;
        };
        last.curve.is_some_and(|before| {
            let (before, now) = (before.at(last.tau), now.at(last.tau));
            now > before * CUT_WORK || before > now * CUT_WORK
        })
    }

    fn tell(&mut self, model: Option<CostModel>, curve: Option<&WorkCurve>) {
        let Budget {
            milliseconds,
            least,
            greatest,
        } = self.budget;
        self.report.tau = self.tau;
        self.report.limit = if self.tau >= greatest {
            Some(BudgetLimit::Greatest)
        } else if self.tau <= least {
            Some(BudgetLimit::Least)
        } else {
            None
        };
        self.report.fault = None;
        let Some(model) = model else {
            (self.report.held, self.report.expected) = (false, 0.0);
            return;
        };
        let expected = model.expected(self.amount(curve, self.tau)) as f32;
        self.report.expected = expected;
        self.report.noise = model.noise() as f32;
        self.report.held = expected <= milliseconds;
    }
}

fn kind_of(curve: Option<&WorkCurve>) -> Work {
    if curve.is_some() {
        Work::Known
    } else {
        Work::Assumed
    }
}

/// The finest tolerance whose time, as a part of the budget, is within it; the greatest if none is.
/// Time falls with τ. Thirty halvings leave less than an f32 can tell apart.
fn goal(least: f32, greatest: f32, provided: impl Fn(f32) -> f32) -> f32 {
    if provided(least) <= 1.0 {
        return least;
    }
    if provided(greatest) > 1.0 {
        return greatest;
    }
    let (mut fine, mut coarse) = (ops::ln(least), ops::ln(greatest));
    for _ in 0..30 {
        let middle = 0.5 * (fine + coarse);
        if provided(ops::exp(middle)) > 1.0 {
            fine = middle;
        } else {
            coarse = middle;
        }
    }
    ops::exp(coarse).clamp(least, greatest)
}

/// `tau` on its way to `goal`, by at most `step` of itself.
fn towards(tau: f32, goal: f32, step: f32) -> f32 {
    goal.clamp(tau * (1.0 - step), tau * (1.0 + step))
}

#[cfg(test)]
mod tests;
