//! Study `platforms`: movers that ride lifts, held to where the lifts are in f64.

mod ride;

use crate::csv::{ErrorNumbers, Row};
use crate::study::{Asked, Options, Report, Study};
use dolomite_collision::{MoveOutcome, Scratch, advance};
use dolomite_testkit::metrics::{ErrorStats, Hash64, median};
use dolomite_testkit::random::{Random, mixed};
use ride::{FASTEST, KINDS, Ride, STEPS, lifts, ride};
use serde_json::json;
use std::time::Instant;

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "platforms",
    about: "movers on lifts at up to 10 m/s in steps of varying length: gaps, falls, drift",
    run,
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 5] = [
    asked("Rides on lifts, 32 steps each", "≥ 1e6", "/rides", ""),
    asked(
        "Steps in which a rider does not stand on the lift",
        "0",
        "/falls",
        "",
    ),
    asked(
        "Largest gap between foot and lift",
        "≤ 1e-3",
        "/gap_max_m",
        "m",
    ),
    asked("Deepest foot in a lift", "≤ 1e-4", "/depth_max_m", "m"),
    asked(
        "Farthest from where lift and walk lead, level, at the end of a ride",
        "",
        "/beside_max_m",
        "m",
    ),
];

const fn asked(
    what: &'static str,
    asked: &'static str,
    at: &'static str,
    unit: &'static str,
) -> Asked {
    Asked {
        what,
        asked,
        at,
        unit,
    }
}

/// Rides of one kind.
#[derive(Default)]
struct Tally {
    rides: Vec<Ride>,
    ns: f64,
    hash: Hash64,
}

impl Tally {
    fn falls(&self) -> u64 {
        self.rides.iter().map(|ride| u64::from(ride.falls)).sum()
    }

    fn most(&self, what: impl Fn(&Ride) -> f64) -> f64 {
        self.rides.iter().map(what).fold(0.0, f64::max)
    }
}

fn run(options: &Options) -> Report {
    let count = options.count.unwrap_or(20_000).max(1).div_ceil(KINDS.len());
    let lifts = lifts();
    let (mut scratch, mut outcome) = (Scratch::default(), MoveOutcome::default());
    let tallies: Vec<Tally> = (0..KINDS.len())
        .map(|kind| {
            eprintln!("platforms: {}", KINDS[kind]);
            let mut random = Random::new(mixed(options.seed, kind as u32));
            let mut tally = Tally::default();
            let begun = Instant::now();
            for i in 0..count {
                let lift = &lifts[i % lifts.len()];
                let ride = ride(&mut random, kind, lift, &mut scratch, &mut outcome, advance);
                tally.hash.add(ride.bits);
                tally.rides.push(ride);
            }
            let steps = count as f64 * f64::from(STEPS + 1);
            tally.ns = begun.elapsed().as_secs_f64() * 1e9 / steps;
            tally
        })
        .collect();
    let mut hash = Hash64::default();
    for tally in &tallies {
        hash.add(tally.hash.finish());
    }
    let most = |what: fn(&Ride) -> f64| {
        tallies
            .iter()
            .map(|tally| tally.most(what))
            .fold(0.0, f64::max)
    };
    Report {
        study: STUDY.name,
        rows: tallies
            .iter()
            .zip(KINDS)
            .map(|(tally, kind)| row(tally, kind))
            .collect(),
        figures: Vec::new(),
        notes: vec![format!(
            "lifts at up to {FASTEST} m/s; steps of 1/240 to 1/15 s in one ride; half of the riders walk at up to 3 m/s; \
             times are of a step, with what makes the ride"
        )],
        summary: json!({
            "rides": count * KINDS.len(),
            "steps": count * KINDS.len() * STEPS as usize,
            "falls": tallies.iter().map(Tally::falls).sum::<u64>(),
            "gap_max_m": most(|ride| ride.gap),
            "depth_max_m": most(|ride| ride.depth),
            "beside_max_m": most(|ride| ride.beside),
            "ns_step": median(tallies.iter().map(|tally| tally.ns).collect()),
            "hash": format!("{:016x}", hash.finish()),
        }),
    }
}

fn row(tally: &Tally, kind: &str) -> Row {
    let gaps = tally.rides.iter().map(|ride| ride.gap);
    Row {
        sweep: kind.into(),
        method: "ours".into(),
        parameter: format!("falls={}", tally.falls()),
        parameter_value: tally.rides.len() as f64,
        quantity: "gap between foot and lift".into(),
        error: ErrorStats::of(gaps).map(ErrorNumbers::from),
        error_unit: "m".into(),
        time_ns: Some(tally.ns),
        bytes: None,
        vertices: None,
        hash: Some(tally.hash.finish()),
        device: "one core".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ride::Advance;

    #[test]
    fn small_run_holds_what_is_promised() {
        let options = Options {
            count: Some(600),
            ..Options::default()
        };
        let summary = run(&options).summary;
        assert_eq!(summary["falls"], 0, "{summary}");
        assert!(summary["gap_max_m"].as_f64().unwrap() <= 1e-3, "{summary}");
        assert!(
            summary["depth_max_m"].as_f64().unwrap() <= 1e-4,
            "{summary}"
        );
        assert!(
            summary["beside_max_m"].as_f64().unwrap() <= 1e-3,
            "{summary}"
        );
    }
    /// Each count sees what it is there for.
    #[test]
    fn wrong_riders_are_seen() {
        let rides = |go: Advance| {
            let (mut scratch, mut outcome) = (Scratch::default(), MoveOutcome::default());
            let (mut random, lifts) = (Random::new(7), lifts());
            let mut tally = Tally::default();
            for number in 0..120 {
                let (kind, lift) = (number % KINDS.len(), &lifts[number % lifts.len()]);
                let ride = ride(&mut random, kind, lift, &mut scratch, &mut outcome, go);
                tally.rides.push(ride);
            }
            tally
        };
        let right = rides(advance);
        assert_eq!(right.falls(), 0);
        assert!(right.most(|ride| ride.gap) <= 1e-3 && right.most(|ride| ride.beside) <= 1e-3);
        // Whoever is not carried stays behind.
        let left = rides(|world, mover, wish, settings, scratch, outcome| {
            mover.stands_on = None;
            advance(world, mover, wish, settings, scratch, outcome);
        });
        assert!(left.falls() > 100 && left.most(|ride| ride.beside) > 0.1);
        let above = rides(|world, mover, wish, settings, scratch, outcome| {
            advance(world, mover, wish, settings, scratch, outcome);
            mover.center.y += 2e-3;
        });
        assert!(above.most(|ride| ride.gap) > 1e-3);
        let below = rides(|world, mover, wish, settings, scratch, outcome| {
            advance(world, mover, wish, settings, scratch, outcome);
            mover.center.y -= 2e-4;
        });
        assert!(below.most(|ride| ride.depth) > 1e-4);
    }
}
