//! Study `budget`: a time budget held by the error tolerance, beside what else could hold it.

pub mod control;
pub mod fly;
pub mod plant;
pub mod tune;

use crate::csv::{ErrorNumbers, Row};
use crate::plot::{Axes, Chart, Curve};
use crate::study::{Figure, Options, Report, Study};
use control::{Control, Ours, PidControl};
use dolomite_ground::detail::budget::Budget;
use fly::{BAND, START, Trace, Verdict, demands, fly, judge};
use plant::{MadeUp, NOISE, Plant};
use serde_json::{Map, Value, json};
use tune::{Course, best_fixed, best_per_leg, tuned};

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "budget",
    about: "a time budget held by the error tolerance: p99, recovery, turns; beside PID and others",
    run,
    asked: &[],
};

/// Budgets, milliseconds.
const BUDGETS: [f32; 3] = [1.0, 2.0, 4.0];
/// The one that is drawn.
const DRAWN: f32 = 2.0;
/// Frames that are drawn: two teleports and a change of load.
const WINDOW: core::ops::Range<usize> = 1080..2040;
/// Every so many frames of a flight go into the JSON object.
const TRACED: usize = 12;
/// Added to the seed of the flight on which gains are tuned.
const TUNING_SEED: u32 = 1000;

/// Steps of τ, of which 99 in 100 are smaller, that a rival may make in a calm view where it is tuned
/// for one: what ours keeps to.
const CALM: f64 = 0.01;

/// Gains that are tried.
const INTEGRALS: [f64; 8] = [0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
const PROPORTIONALS: [f64; 3] = [0.0, 0.2, 0.5];
const DIFFERENTIALS: [f64; 2] = [0.0, 0.2];

const OURS: &str = "ours";
const PER_LEG: &str = "best fixed per leg (offline)";

fn run(options: &Options) -> Report {
    let mut report = Report {
        study: STUDY.name,
        rows: Vec::new(),
        figures: Vec::new(),
        notes: notes(),
        summary: Value::Null,
    };
    let plant = MadeUp::new(options.seed);
    let other = MadeUp::new(options.seed.wrapping_add(TUNING_SEED));
    let (curves, other_curves) = (demands(&plant), demands(&other));
    let mut summary = Map::new();
    for milliseconds in BUDGETS {
        eprintln!("{}: {milliseconds} ms", STUDY.name);
        let budget = Budget {
            milliseconds,
            least: 0.25,
            greatest: 64.0,
        };
        let on = |plant, demands| Course {
            plant,
            demands,
            budget,
        };
        let course = on(&plant, &curves);
        let training = on(&other, &other_curves);
        let any = f64::INFINITY;
        let part = tuned(&training, [&INTEGRALS, &[0.0], &[0.0]], any);
        let calm = tuned(&training, [&INTEGRALS, &[0.0], &[0.0]], CALM);
        let pid = tuned(&training, [&INTEGRALS, &PROPORTIONALS, &DIFFERENTIALS], any);
        let methods: [(&str, Box<dyn Control>); 8] = [
            (OURS, Box::new(Ours::new(budget, true, true))),
            (
                "ours, nothing counted",
                Box::new(Ours::new(budget, true, false)),
            ),
            (
                "ours, no demand curve",
                Box::new(Ours::new(budget, false, false)),
            ),
            ("proportional", Box::new(PidControl::new(part, budget))),
            (
                "proportional, calm",
                Box::new(PidControl::new(calm, budget)),
            ),
            ("PID", Box::new(PidControl::new(pid, budget))),
            ("best fixed (offline)", Box::new(best_fixed(&course))),
            (PER_LEG, Box::new(best_per_leg(&course))),
        ];
        let flown = methods.map(|(name, mut control)| {
            let trace = fly(course.plant, course.demands, &budget, control.as_mut());
            let verdict = judge(course.plant, &budget, &trace);
            (name, trace, verdict)
        });
        let reference = flown
            .iter()
            .find(|(name, ..)| *name == PER_LEG)
            .map_or(f64::NAN, |(.., verdict)| verdict.tau);
        let mut of_budget = Map::new();
        for (name, trace, verdict) in &flown {
            report.rows.push(row(milliseconds, name, trace, verdict));
            let mut told = told(verdict, trace, reference);
            if *name == OURS {
                told["trace"] = traced(trace);
            }
            of_budget.insert((*name).to_owned(), told);
        }
        of_budget.insert("gains, proportional".into(), gains(&part));
        of_budget.insert("gains, proportional, calm".into(), gains(&calm));
        of_budget.insert("gains, PID".into(), gains(&pid));
        summary.insert(format!("{milliseconds} ms"), Value::Object(of_budget));
        if milliseconds == DRAWN {
            report.figures = figures(&flown);
        }
    }
    report.summary = json!({
        "seconds": plant.frames() as f64 / plant::RATE,
        "teleports": plant.legs().len() - 1,
        "noise": NOISE,
        "budgets": summary,
    });
    report
}

fn notes() -> Vec<String> {
    vec![
        format!(
            "Times are divided by the budget. Measured times have {} % of noise and spikes of 20 % in \
             3 frames of a thousand, and arrive 2 or 3 frames late. Recovery, frames out of the band \
             and overshoot are of noise-free time; the band is {} to {}. The first {START} frames are \
             not judged.",
            NOISE * 100.0,
            BAND.0,
            BAND.1
        ),
        "The ground is made up: two power laws, hard edges, a finest level; time is not proportional \
         to vertices; demand curves are off by up to 10 %, differently in each place."
            .into(),
        "Gains of proportional and PID are the best of a grid on another flight; of the calm one, the \
         best whose steps of the tolerance in a calm view stay below 1 %. The offline \
         tolerances are the finest that keep p99 to the budget, found with the flight known."
            .into(),
        "tau_over_best_per_leg: geometric mean of the tolerance over that of the best one for each \
         leg; below 1 is finer. Where the load changes within a leg, the best one is that of the \
         higher load."
            .into(),
    ]
}

fn row(milliseconds: f32, method: &str, trace: &Trace, verdict: &Verdict) -> Row {
    Row {
        sweep: "budget".into(),
        method: method.into(),
        parameter: format!("budget={milliseconds} ms"),
        parameter_value: f64::from(milliseconds),
        quantity: "measured time".into(),
        error: Some(ErrorNumbers::from(verdict.measured)),
        error_unit: "budget".into(),
        time_ns: Some(trace.nanoseconds),
        bytes: None,
        vertices: None,
        hash: Some(verdict.hash),
        device: "CPU".into(),
    }
}

fn told(verdict: &Verdict, trace: &Trace, reference: f64) -> Value {
    json!({
        "p99": verdict.measured.p99,
        "median": verdict.median,
        "p99_noise_free": verdict.clean_p99,
        "overshoot": verdict.overshoot,
        "outside": verdict.outside,
        "recovery_teleport_worst": verdict.teleport.0,
        "recovery_teleport_mean": verdict.teleport.1,
        "recovery_load_worst": verdict.load.0,
        "recovery_load_mean": verdict.load.1,
        "turns_a_second_calm": verdict.turns,
        "step_calm_p99": verdict.steps.0,
        "step_calm_max": verdict.steps.1,
        "tau": verdict.tau,
        "tau_over_best_per_leg": verdict.tau / reference,
        "nanoseconds_a_frame": trace.nanoseconds,
    })
}

fn gains(pid: &control::Pid) -> Value {
    json!({
        "integral": pid.integral,
        "proportional": pid.proportional,
        "differential": pid.differential,
        "aim": pid.aim,
    })
}

fn traced(trace: &Trace) -> Value {
    let frames: Vec<usize> = (0..trace.taus.len()).step_by(TRACED).collect();
    let of = |pick: &dyn Fn(usize) -> f64| frames.iter().map(|f| pick(*f)).collect::<Vec<_>>();
    json!({
        "frame": frames,
        "measured": of(&|frame| trace.measured[frame]),
        "noise_free": of(&|frame| trace.clean[frame]),
        "tau": of(&|frame| f64::from(trace.taus[frame])),
    })
}

/// Time and tolerance over the frames of the window.
fn figures(flown: &[(&str, Trace, Verdict)]) -> Vec<Figure> {
    let curves = |pick: &dyn Fn(&Trace, usize) -> f64| {
        let drawn = flown.iter().enumerate();
        drawn
            .filter(|(_, (name, ..))| ![PER_LEG, "ours, nothing counted"].contains(name))
            .map(|(colour, (name, trace, _))| Curve {
                name: (*name).to_owned(),
                colour,
                points: WINDOW.map(|f| (f as f64, pick(trace, f))).collect(),
            })
            .collect::<Vec<_>>()
    };
    let chart = |title: &str, y_label: &str, curves| Chart {
        title: title.into(),
        x_label: "frame".into(),
        y_label: y_label.into(),
        axes: Axes::Linear,
        curves,
    };
    let events = "A teleport at frame 1200, 35 % more load from 1500 on, a teleport at 1800.";
    vec![
        Figure {
            name: "budget_time".into(),
            caption: format!("Noise-free time over a budget of {DRAWN} ms. {events}"),
            chart: chart(
                "Time over the budget",
                "time / budget",
                curves(&|trace, frame| trace.clean[frame]),
            ),
        },
        Figure {
            name: "budget_tau".into(),
            caption: format!("The tolerance that holds it. {events}"),
            chart: chart(
                "Tolerance",
                "tolerance (px)",
                curves(&|trace, frame| f64::from(trace.taus[frame])),
            ),
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_shows_that_the_budget_is_held_and_by_whom_it_is_not() {
        let report = run(&Options::default());
        assert_eq!(report.rows.len(), BUDGETS.len() * 8);
        assert_eq!(report.figures.len(), 2);
        for budget in BUDGETS {
            let all = &report.summary["budgets"][format!("{budget} ms")];
            let number = |method: &str, what: &str| all[method][what].as_f64().unwrap();
            assert!((0.8..=1.05).contains(&number(OURS, "p99")));
            assert!(number(OURS, "recovery_teleport_worst") <= 6.0);
            assert!(number(OURS, "recovery_load_worst") <= 6.0);
            assert!(number(OURS, "turns_a_second_calm") < 1.0);
            assert!(number("PID", "turns_a_second_calm") > 1.0);
            // As calm as ours, it takes more than twice as long.
            let ours = number(OURS, "recovery_teleport_worst");
            assert!(number("proportional, calm", "recovery_teleport_worst") > 2.0 * ours);
            assert!(number("best fixed (offline)", "outside") > 0.2);
            assert_eq!(all[OURS]["trace"]["tau"].as_array().unwrap().len(), 600);
        }
        for figure in &report.figures {
            crate::plot::to_svg(&figure.chart).unwrap();
        }
    }
}
