//! Study `triggers`: movers that fly through the triggers of collision, and points that go through the zones of logic:
//! what both say of it, held to f64.

mod oracle;
mod wave;
mod zones;

use crate::csv::{ErrorNumbers, Row};
use crate::study::{Asked, Options, Report, Study};
use dolomite_collision::TriggerKind;
use dolomite_testkit::metrics::{ErrorStats, Hash64, median};
use dolomite_testkit::random::{Random, mixed};
use serde_json::json;
use wave::{MOVERS, Said, Wave, crosses};

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "triggers",
    about: "0.1 to 1000 m/s through triggers and zones: crossings missed, doubled, out of order; times",
    run,
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 12] = [
    asked(
        "Crossings of triggers, 0.1 to 1000 m/s",
        "≥ 1e6",
        "/crossings",
        "",
    ),
    asked("Crossings missed", "0", "/missed", ""),
    asked("Crossings told twice", "0", "/doubled", ""),
    asked("Crossings told where there are none", "0", "/invented", ""),
    asked(
        "Messages of a step in another order than in f64",
        "0",
        "/disordered",
        "",
    ),
    asked(
        "Steps of staying, told too often or not at all",
        "0",
        "/stays_wrong",
        "",
    ),
    asked(
        "Time of coming or going, largest error",
        "",
        "/time_max",
        "of a step",
    ),
    asked(
        "Place of coming or going, largest error",
        "",
        "/place_max_m",
        "m",
    ),
    asked(
        "Crossings of zones of logic, 0.1 to 1000 m/s",
        "≥ 1e6",
        "/zones/crossings",
        "",
    ),
    asked("Crossings of zones missed", "0", "/zones/missed", ""),
    asked("Crossings of zones told twice", "0", "/zones/doubled", ""),
    asked(
        "Crossings of zones not when f64 says so",
        "0",
        "/zones/disordered",
        "",
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

/// Nearer to touching than this, in radii, f64 does not say whether it crosses: places 10⁵ m away are held to 1.5e-11 m,
/// and the least radii are 0.3 mm.
const DOUBT: f64 = 1e-7;

/// Times that differ by less, in steps, have no order: what 1.5e-11 m are of the shortest step, 0.8 mm.
const SAME: f64 = 1e-7;

/// Speeds that are told apart, metres a second.
const SPEEDS: [[f64; 2]; 4] = [[0.1, 1.0], [1.0, 10.0], [10.0, 100.0], [100.0, 1000.0]];

#[derive(Default)]
struct Tally {
    crossings: u64,
    missed: u64,
    doubled: u64,
    invented: u64,
    disordered: u64,
    stays_wrong: u64,
    doubtful: u64,
    times: Vec<f64>,
    place: f64,
    ns: Vec<f64>,
    hash: Hash64,
}

impl Tally {
    fn add(&mut self, wave: &Wave, said: &Said) {
        self.ns.push(said.ns);
        let expected: Vec<_> = (0..MOVERS)
            .map(|mover| wave.flight(mover).within(f64::from(wave.steps)))
            .collect();
        // Comings, goings and stays of each mover.
        let mut counts = vec![[0_u64; 3]; MOVERS];
        let mut last: Option<(u32, f64)> = None;
        for (step, mover, message) in &said.messages {
            let kind = match message.kind {
                TriggerKind::Enter => 0,
                TriggerKind::Leave => 1,
                TriggerKind::Stay => 2,
            };
            counts[*mover][kind] += 1;
            self.hash.add(message.time.to_bits() ^ *mover as u64);
            if !crosses(message) {
                continue;
            }
            let Some(times) = expected[*mover].times else {
                continue;
            };
            let true_time = times[kind];
            let time = f64::from(*step) + message.time;
            if (expected[*mover].least - 1.0).abs() > DOUBT {
                self.times.push((time - true_time).abs());
                let flight = wave.flight(*mover);
                let place = wave.place.as_dvec3() + flight.from + flight.way * true_time;
                self.place = self.place.max(message.place.distance(place));
            }
            let disordered =
                last.is_some_and(|(known, before)| known == *step && before > true_time + SAME);
            self.disordered += u64::from(disordered);
            last = Some((*step, true_time));
        }
        for (count, within) in counts.iter().zip(&expected) {
            if (within.least - 1.0).abs() <= DOUBT {
                self.doubtful += 1;
                continue;
            }
            let Some([enter, leave]) = within.times else {
                self.invented += count[0] + count[1] + count[2];
                continue;
            };
            self.crossings += 1;
            self.missed += u64::from(count[0] == 0) + u64::from(count[1] == 0);
            self.doubled += count[0].saturating_sub(1) + count[1].saturating_sub(1);
            // Steps that begin and end within, where it is clear which these are.
            let clear = |time: f64| (time - time.round()).abs() > SAME;
            if clear(enter) && clear(leave) {
                let stays = (leave.floor() - enter.ceil()).max(0.0) as u64;
                self.stays_wrong += stays.abs_diff(count[2]);
            }
        }
    }

    fn join(&mut self, other: Self) {
        self.crossings += other.crossings;
        self.missed += other.missed;
        self.doubled += other.doubled;
        self.invented += other.invented;
        self.disordered += other.disordered;
        self.stays_wrong += other.stays_wrong;
        self.doubtful += other.doubtful;
        self.times.extend(other.times);
        self.place = self.place.max(other.place);
        self.ns.extend(other.ns);
        self.hash.add(other.hash.finish());
    }
}

fn run(options: &Options) -> Report {
    let count = options.count.unwrap_or(20_000).max(1) as u64;
    let mut all = Tally::default();
    let mut rows = Vec::new();
    for (i, [slow, fast]) in SPEEDS.into_iter().enumerate() {
        eprintln!("triggers: {slow} to {fast} m/s");
        let mut random = Random::new(mixed(options.seed, i as u32));
        let mut tally = Tally::default();
        while tally.crossings < count.div_ceil(SPEEDS.len() as u64) {
            let wave = Wave::new(&mut random, slow, fast);
            tally.add(&wave, &wave.fly());
        }
        rows.push(Row {
            sweep: format!("{slow} to {fast} m/s"),
            method: "ours".into(),
            parameter: format!("missed={} doubled={}", tally.missed, tally.doubled),
            parameter_value: tally.crossings as f64,
            quantity: "time of coming or going".into(),
            error: ErrorStats::of(tally.times.iter().copied()).map(ErrorNumbers::from),
            error_unit: "of a step".into(),
            time_ns: median(tally.ns.clone()),
            bytes: None,
            vertices: None,
            hash: Some(tally.hash.finish()),
            device: "all cores".into(),
        });
        all.join(tally);
    }
    let times = ErrorStats::of(all.times.iter().copied());
    Report {
        study: STUDY.name,
        rows,
        figures: Vec::new(),
        notes: vec![
            format!(
                "{MOVERS} movers at a time fly through one box in a Bevy app, 64 steps a second; one of eight boxes is \
                 1e5 m away, and at one of eight steps end where it is touched exactly"
            ),
            format!(
                "movers that pass within {DOUBT:e} of a radius of touching are not judged, and times within {SAME:e} \
                 steps have no order"
            ),
            "times are of a whole step of the app, divided by its movers".into(),
        ],
        summary: json!({
            "crossings": all.crossings,
            "missed": all.missed,
            "doubled": all.doubled,
            "invented": all.invented,
            "disordered": all.disordered,
            "stays_wrong": all.stays_wrong,
            "doubtful": all.doubtful,
            "time_max": times.as_ref().map(|stats| stats.max),
            "time_p99": times.as_ref().map(|stats| stats.p99),
            "place_max_m": all.place,
            "ns_mover_step": median(all.ns),
            "hash": format!("{:016x}", all.hash.finish()),
            "zones": zones::zones(options.seed, count as usize),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_run_misses_and_doubles_nothing() {
        let options = Options {
            count: Some(2000),
            ..Options::default()
        };
        let summary = run(&options).summary;
        for what in ["missed", "doubled", "invented", "disordered", "stays_wrong"] {
            assert_eq!(summary[what], 0, "{what}: {summary}");
        }
        for what in ["missed", "doubled", "disordered"] {
            assert_eq!(summary["zones"][what], 0, "{what}: {summary}");
        }
        assert!(
            summary["zones"]["through_in_a_step"].as_u64() > Some(20),
            "{summary}"
        );
        assert!(summary["crossings"].as_u64().unwrap() >= 2000);
        // Of a mover 1e5 m away f64 knows 1.5e-11 m, of which the shortest step has 0.8 mm.
        assert!(summary["time_max"].as_f64().unwrap() < 1e-6, "{summary}");
    }
    /// Each count sees what it is there for.
    #[test]
    fn wrong_messages_are_seen() {
        let mut random = Random::new(9);
        let wave = Wave::new(&mut random, 1.0, 10.0);
        let said = wave.fly();
        let counted = |change: &dyn Fn(&mut Said)| {
            let mut tally = Tally::default();
            let mut changed = Said {
                messages: said.messages.clone(),
                ns: 0.0,
            };
            change(&mut changed);
            tally.add(&wave, &changed);
            tally
        };
        let right = counted(&|_| {});
        let wrong = |tally: &Tally| {
            let stays = tally.stays_wrong;
            [tally.missed, tally.doubled, tally.invented, stays]
        };
        assert_eq!(wrong(&right), [0; 4]);
        assert!(right.crossings > 10 && said.messages.len() > 20);
        let first = said.messages[0].1;
        let others = counted(&|said| said.messages.retain(|message| message.1 != first));
        assert_eq!(others.missed, 2);
        let twice = counted(&|said| {
            let again = said.messages.clone();
            said.messages.extend(again);
        });
        assert!(twice.doubled > 20);
        let late = counted(&|said| said.messages.iter_mut().for_each(|m| m.2.time += 1e-3));
        assert!(late.times.iter().all(|error| *error > 1e-4));
        // One who stays away comes and goes.
        let beside = (0..MOVERS).find(|mover| {
            let within = wave.flight(*mover).within(f64::from(wave.steps));
            within.times.is_none()
        });
        let beside = beside.expect("some of a wave pass the box");
        let invented = counted(&|said| said.messages.iter_mut().for_each(|m| m.1 = beside));
        assert!(invented.invented > 20);
        let stays = counted(&|said| {
            said.messages
                .retain(|message| crosses(&message.2) || message.1 != first);
            let stay = said.messages[0];
            let kind = dolomite_collision::TriggerKind::Stay;
            let message = dolomite_collision::TriggerMessage { kind, ..stay.2 };
            said.messages.extend([(stay.0, first, message); 1000]);
        });
        assert!(stays.stays_wrong > 100);
    }
}
