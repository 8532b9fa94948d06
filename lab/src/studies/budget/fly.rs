//! A flight under a controller, and what became of it.

use super::control::Control;
use super::plant::{Event, Plant, RATE};
use dolomite_geometry::budget::{Budget, NextFrame, TimeSample, WorkCurve};
use dolomite_testkit::metrics::{ErrorStats, Hash64};
use std::time::Instant;

/// The band of noise-free time over the budget in which a frame counts as held.
pub const BAND: (f64, f64) = (0.8, 1.05);
/// Frames at the beginning that are not judged: every controller starts at the greatest tolerance.
pub const START: usize = 60;

/// All frames of a flight.
pub struct Trace {
    /// Tolerances, pixels.
    pub taus: Vec<f32>,
    /// Noise-free and measured time over the budget.
    pub clean: Vec<f64>,
    /// With noise and spikes.
    pub measured: Vec<f64>,
    /// Of the controller, nanoseconds a frame.
    pub nanoseconds: f64,
}

/// Work curves of all frames, which every controller sees alike.
pub fn curves(plant: &dyn Plant) -> Vec<WorkCurve> {
    (0..plant.frames())
        .map(|frame| plant.curve(frame))
        .collect()
}

/// Flies. A frame's time arrives two or three frames later, by turns without rule.
pub fn fly(
    plant: &dyn Plant,
    curves: &[WorkCurve],
    budget: &Budget,
    control: &mut dyn Control,
) -> Trace {
    let frames = plant.frames();
    let mut trace = Trace {
        taus: Vec::with_capacity(frames),
        clean: Vec::with_capacity(frames),
        measured: Vec::with_capacity(frames),
        nanoseconds: 0.0,
    };
    let whole = f64::from(budget.milliseconds);
    let mut arrived = 0;
    let mut seen = Vec::new();
    for (frame, curve) in curves.iter().enumerate().take(frames) {
        seen.clear();
        // Never out of order; the odd bits of a hash say whether it takes three frames.
        let late = 2 + (frame.wrapping_mul(0x9e37_79b9) >> 13) % 2;
        while arrived + late <= frame {
            seen.push(TimeSample {
                milliseconds: (trace.measured[arrived] * whole) as f32,
                tau: trace.taus[arrived],
                triangles: Some(plant.triangles(arrived, f64::from(trace.taus[arrived])) as u32),
                frame: arrived as u64,
            });
            arrived += 1;
        }
        let next = NextFrame {
            number: frame as u64,
            curve: Some(curve),
            cut: plant.event(frame) == Some(Event::Teleport),
        };
        let begun = Instant::now();
        let tau = control.decide(&seen, &next);
        trace.nanoseconds += begun.elapsed().as_nanos() as f64 / frames as f64;
        let tau = tau.clamp(budget.least, budget.greatest);
        let time = plant.milliseconds(frame, f64::from(tau)) / whole;
        trace.taus.push(tau);
        trace.clean.push(time);
        trace.measured.push(time * plant.disturbance(frame));
    }
    trace
}

/// What a flight is judged by.
#[derive(Clone, Copy, Debug)]
pub struct Verdict {
    /// Of measured time over the budget.
    pub measured: ErrorStats,
    /// Median of it.
    pub median: f64,
    /// 99th percentile and greatest of noise-free time over the budget.
    pub clean_p99: f64,
    /// Greatest.
    pub overshoot: f64,
    /// Part of the frames outside of the band.
    pub outside: f64,
    /// Most frames out of the band after a teleport, and their mean.
    pub teleport: (usize, f64),
    /// The same after a change of load.
    pub load: (usize, f64),
    /// Changes of the direction of τ a second, where the camera stands or walks.
    pub turns: f64,
    /// The 99th percentile and the greatest of relative changes of τ in a frame there, two seconds and
    /// more after an event.
    pub steps: (f64, f64),
    /// Geometric mean of τ.
    pub tau: f64,
    /// Over all tolerances.
    pub hash: u64,
}

/// Judges a flight. A frame at an end of the range of tolerances, with time on that side of the band,
/// counts as held: nothing better is possible.
pub fn judge(plant: &dyn Plant, budget: &Budget, trace: &Trace) -> Verdict {
    let frames = plant.frames();
    let held = |frame: usize| {
        let (time, tau) = (trace.clean[frame], trace.taus[frame]);
        (BAND.0..=BAND.1).contains(&time)
            || (time < BAND.0 && tau <= budget.least)
            || (time > BAND.1 && tau >= budget.greatest)
    };
    let (mut teleports, mut loads) = (Vec::new(), Vec::new());
    let mut since = 0;
    let mut calm = Vec::new();
    for frame in 1..frames {
        since += 1;
        if let Some(event) = plant.event(frame) {
            since = 0;
            let out = recovery(frame, frames, held);
            match event {
                Event::Teleport => teleports.push(out),
                Event::Load => loads.push(out),
            }
        }
        if frame > START && plant.is_calm(frame) {
            let step = f64::from(trace.taus[frame] / trace.taus[frame - 1] - 1.0);
            calm.push((step, since >= 120));
        }
    }
    let rest = calm.iter().filter(|(_, rest)| *rest);
    let steps = ErrorStats::of(rest.map(|(step, _)| *step));
    let signs: Vec<bool> = calm
        .iter()
        .filter(|(step, _)| *step != 0.0)
        .map(|(step, _)| *step > 0.0)
        .collect();
    let turns = signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
    let clean = ErrorStats::of(trace.clean[START..].iter().copied());
    let mut sorted = trace.measured[START..].to_vec();
    sorted.sort_by(f64::total_cmp);
    let outside = (START..frames).filter(|frame| !held(*frame)).count();
    let mut hash = Hash64::default();
    for tau in &trace.taus {
        hash.add(u64::from(tau.to_bits()));
    }
    let nothing = ErrorStats {
        max: 0.0,
        rms: 0.0,
        p99: 0.0,
        samples: 0,
    };
    Verdict {
        measured: ErrorStats::of(sorted.iter().copied()).unwrap_or(nothing),
        median: sorted[sorted.len() / 2],
        clean_p99: clean.map_or(0.0, |stats| stats.p99),
        overshoot: clean.map_or(0.0, |stats| stats.max),
        outside: outside as f64 / (frames - START) as f64,
        teleport: worst_and_mean(&teleports),
        load: worst_and_mean(&loads),
        turns: turns as f64 * RATE / calm.len().max(1) as f64,
        steps: steps.map_or((0.0, 0.0), |stats| (stats.p99, stats.max)),
        tau: geometric_mean(&trace.taus[START..]),
        hash: hash.finish(),
    }
}

/// Frames after an event until ten in sequence are held.
fn recovery(from: usize, frames: usize, held: impl Fn(usize) -> bool) -> usize {
    const IN_SEQUENCE: usize = 10;
    let settled = |start: &usize| (*start..(*start + IN_SEQUENCE).min(frames)).all(&held);
    (from..frames)
        .find(settled)
        .map_or(frames - from, |frame| frame - from)
}

fn worst_and_mean(frames: &[usize]) -> (usize, f64) {
    let sum: usize = frames.iter().sum();
    (
        frames.iter().copied().max().unwrap_or(0),
        sum as f64 / frames.len().max(1) as f64,
    )
}

#[expect(clippy::disallowed_methods, reason = "a metric of a study")]
fn geometric_mean(taus: &[f32]) -> f64 {
    let logs: f64 = taus.iter().map(|tau| f64::from(*tau).ln()).sum();
    (logs / taus.len() as f64).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::budget::control::{Fixed, Ours, Pid, PidControl};
    use crate::studies::budget::plant::MadeUp;

    fn budget() -> Budget {
        Budget {
            milliseconds: 4.0,
            least: 0.25,
            greatest: 64.0,
        }
    }

    fn flown(control: &mut dyn Control) -> Verdict {
        let plant = MadeUp::new(11);
        let trace = fly(&plant, &curves(&plant), &budget(), control);
        judge(&plant, &budget(), &trace)
    }

    /// The judge must see what is wrong: no control at all, and a controller that swings.
    #[test]
    fn bad_controllers_are_found_out() {
        let fixed = flown(&mut Fixed(1.0));
        assert!(fixed.outside > 0.3, "{fixed:?}");
        assert!(fixed.teleport.0 > 100);
        assert_eq!((fixed.turns, fixed.steps.1), (0.0, 0.0));
        let wild = Pid {
            integral: 0.9,
            proportional: 0.0,
            differential: 0.0,
            aim: 0.93,
        };
        let wild = flown(&mut PidControl::new(wild, budget()));
        assert!(wild.turns > 5.0, "{wild:?}");
    }

    /// The numbers to reach.
    #[test]
    fn ours_holds_the_budget() {
        let ours = flown(&mut Ours::new(budget(), true, true));
        assert!((0.8..=1.05).contains(&ours.measured.p99), "{ours:?}");
        assert!(ours.teleport.0 <= 6 && ours.load.0 <= 6, "{ours:?}");
        assert!(ours.turns < 1.0, "{ours:?}");
        assert!(ours.steps.0 < 0.01, "{ours:?}");
    }

    #[test]
    fn recovery_counts_from_the_event_to_the_first_of_ten() {
        let held = |frame: usize| frame >= 15 || frame == 12;
        assert_eq!(recovery(10, 100, held), 5);
        assert_eq!(recovery(20, 100, held), 0);
        assert_eq!(recovery(10, 100, |_| false), 90);
    }
}
