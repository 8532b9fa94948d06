//! Study `moves`: movers in hostile rooms, on a floor of many tiles, and what overlaps volumes.

mod floors;
mod many;
mod queries;
mod rooms;

use crate::csv::Row;
use crate::study::{Asked, Options, Report, Study};
use bevy::math::DVec3;
use dolomite_collision::advance;
use dolomite_testkit::random::{Random, mixed};
use rooms::{KINDS, MOVES, Tally, room};
use serde_json::json;
use std::time::Instant;

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "moves",
    about: "movers in hostile rooms and on a floor of tiles: tunnels, penetration, stuck; queries by volume",
    run,
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 13] = [
    asked("Moves in hostile rooms", "≥ 1e7", "/moves", ""),
    asked("Moves that went through a surface", "0", "/tunnels", ""),
    asked("Deepest penetration", "≤ 1e-4", "/depth_max_m", "m"),
    asked(
        "Moves that say that they are crushed, whose depth is not judged",
        "≤ 1e-3",
        "/crushed_part",
        "of the moves",
    ),
    asked("Moves that were stuck", "0", "/stuck", ""),
    asked("Moves that are not finite", "0", "/wrong", ""),
    asked("Most advances of a slide", "≤ 3", "/iterations_max", ""),
    asked(
        "Steps on a flat floor over seams of triangles and tiles",
        "≥ 1e6",
        "/floor/steps",
        "",
    ),
    asked(
        "Its height, largest change",
        "≤ 1e-5",
        "/floor/height_max_m",
        "m",
    ),
    asked(
        "Steps after which it does not stand",
        "0",
        "/floor/flips",
        "",
    ),
    asked(
        "Sideways of a step, largest",
        "0",
        "/floor/sideways_max_m",
        "m",
    ),
    asked(
        "The same 1e5 m away: height, largest change",
        "≤ 1e-5",
        "/floor_far/height_max_m",
        "m",
    ),
    asked(
        "Queries by volume that a tree answers unlike a list, of a tenth of the moves",
        "0",
        "/queries/wrong",
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

fn run(options: &Options) -> Report {
    let count = options.count.unwrap_or(100_000).max(1);
    let rooms = count.div_ceil(MOVES).max(KINDS.len());
    let mut all = Tally::default();
    let mut rows = Vec::new();
    for (kind, name) in KINDS.into_iter().enumerate() {
        eprintln!("moves: {name}");
        let begun = Instant::now();
        let mut tally = Tally::default();
        for number in (kind..rooms).step_by(KINDS.len()) {
            let mut random = Random::new(mixed(options.seed, number as u32));
            tally.join(&room(&mut random, kind, advance));
        }
        let ns = begun.elapsed().as_secs_f64() * 1e9 / tally.moves.max(1) as f64;
        rows.push(row(name, &tally, ns));
        all.join(&tally);
    }
    eprintln!("moves: floors");
    let mut random = Random::new(mixed(options.seed, 1 << 30));
    let steps = (count / 10).max(1) as u64;
    let floor = floors::walk(&mut random, DVec3::ZERO, steps);
    let far = floors::walk(&mut random, DVec3::new(1e5, -1e5, 1e5), steps);
    eprintln!("moves: many");
    let (hash_of_many, standing) = many::hash(&mut Random::new(mixed(options.seed, 1 << 29)));
    eprintln!("moves: queries");
    let (wrong, found) = queries::differences(&mut random, (count / 10).max(1));
    let floor_json = |floor: &floors::Floor| {
        json!({
            "steps": floor.steps,
            "height_max_m": floor.height,
            "flips": floor.flips,
            "sideways_max_m": floor.sideways,
        })
    };
    Report {
        study: STUDY.name,
        rows,
        figures: Vec::new(),
        notes: vec![
            format!("rooms of 8 m that are closed, {MOVES} wishes of 0.1 mm to 10 m each; one core, with what is judged"),
            "stuck is who went less than a millionth of a wish although the planes of all that was touched leave a \
             thousandth of it and more than two gaps, but for who stands and for slopes that are walls"
                .into(),
            format!(
                "`many` is {} movers that walk at once on all cores: `taskset -c 0` gives the same hash",
                many::MOVERS
            ),
        ],
        summary: json!({
            "moves": all.moves,
            "tunnels": all.tunnels,
            "depth_max_m": all.depth,
            "crushed": all.crushed,
            "crushed_part": all.crushed as f64 / all.moves.max(1) as f64,
            "stuck": all.stuck,
            "wrong": all.wrong,
            "iterations_max": all.iterations,
            "casts_per_move": all.casts as f64 / all.moves.max(1) as f64,
            "holds": all.holds(),
            "floor": floor_json(&floor),
            "floor_far": floor_json(&far),
            "queries": { "asked": (count / 10).max(1), "wrong": wrong, "found": found },
            "many": {
                "movers": many::MOVERS,
                "steps": many::STEPS,
                "standing": standing,
                "hash": format!("{hash_of_many:016x}"),
            },
            "hash": format!("{:016x}", all.hash.finish()),
        }),
    }
}

fn row(kind: &str, tally: &Tally, ns: f64) -> Row {
    Row {
        sweep: kind.into(),
        method: "ours".into(),
        parameter: format!(
            "tunnels={} stuck={} crushed={} depth={:.2e}",
            tally.tunnels, tally.stuck, tally.crushed, tally.depth
        ),
        parameter_value: tally.depth,
        quantity: "moves".into(),
        error: None,
        error_unit: "m".into(),
        time_ns: Some(ns),
        bytes: None,
        vertices: None,
        hash: Some(tally.hash.finish()),
        device: "one core".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_run_holds_what_is_promised() {
        let options = Options {
            count: Some(10_000),
            ..Options::default()
        };
        let summary = run(&options).summary;
        assert_eq!(summary["holds"], true, "{summary}");
        for floor in ["floor", "floor_far"] {
            let floor = &summary[floor];
            assert_eq!(floor["flips"], 0, "{summary}");
            assert!(floor["height_max_m"].as_f64().unwrap() <= 1e-5, "{summary}");
            assert!(
                floor["sideways_max_m"].as_f64().unwrap() <= 1e-9,
                "{summary}"
            );
        }
        // On any number of cores: one and two were tried.
        assert_eq!(summary["many"]["hash"], "c99910a4e45add2c", "{summary}");
        assert!(
            summary["many"]["standing"].as_u64().unwrap() > 3000,
            "{summary}"
        );
        assert_eq!(summary["queries"]["wrong"], 0, "{summary}");
        assert!(
            summary["queries"]["found"].as_u64().unwrap() > 100,
            "{summary}"
        );
    }
}
