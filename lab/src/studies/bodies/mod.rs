//! Study `bodies`: Rapier's bodies on tiles of the ground, and beside our movers Rapier's character controller and, by a
//! program of its own (`lab/avian`), avian's `MoveAndSlide`.

mod asked;
mod controller;
mod curve;
pub mod messages;
mod method;
mod movers;
mod program;
mod roll;
mod terrain;
mod walkers;

use crate::csv::{ErrorNumbers, Row};
use crate::plot::{Axes, Chart, Curve as Line};
use crate::study::{Figure, Options, Report, Study};
use asked::ASKED;
use bevy::math::{DVec2, Vec3};
use curve::{Curve, ITERATIONS, curve};
use dolomite_collision::rapier::Diagonals;
use dolomite_testkit::metrics::ErrorStats;
use dolomite_testkit::random::{Random, mixed};
use messages::{BUILD, ProgramError};
use program::Program;
use roll::{GROUNDS, Under, apart, beside, fast, path};
use serde_json::{Map, Value, json};
use std::path::Path;
use terrain::Terrain;
use walkers::{Walked, all, places};

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "bodies",
    about: "Rapier's balls over borders of tiles; its character controller and avian's beside our movers",
    run,
    asked: &ASKED,
};

/// Balls of each ground, each from another place and at another speed.
const BALLS: usize = 4;

/// Steps of a walk.
const STEPS: u32 = 60;

/// Farthest apart of the paths of each ball, metres.
#[derive(Default)]
struct Rolled {
    /// Tiles against one unbroken tile, cells cut in turns.
    unbroken: Vec<f64>,
    /// Tiles against parry's field, cells cut alike.
    parry: Vec<f64>,
    /// Parry's field against itself from another origin: what f32 makes of the same ground.
    parry_itself: Vec<f64>,
    /// From the straight line: of tiles, and of parry's field. Of flat ground alone it says anything.
    beside: [Vec<f64>; 2],
}

fn rolled(random: &mut Random, height: roll::Height) -> Rolled {
    let mut found = Rolled::default();
    for _ in 0..BALLS {
        let start = DVec2::new(16.0 + 8.0 * random.unit(), 100.0 + 8.0 * random.unit());
        let velocity = Vec3::new(random.range(3.0, 5.0), 0.0, random.range(-0.8, 0.8));
        let go = |under| path(height, under, start, velocity).0;
        let [whole, turns] = [256, 8].map(|cells| go(Under::Tiles(cells, Diagonals::Alternating)));
        let alike = go(Under::Tiles(8, Diagonals::Alike));
        let [parry, moved] = [0, 8].map(|first| go(Under::Parry(first)));
        found.unbroken.push(apart(&whole, &turns, start));
        found.parry.push(apart(&parry, &alike, start));
        found.parry_itself.push(apart(&parry, &moved, start));
        for (beside_line, path) in found.beside.iter_mut().zip([alike, parry]) {
            beside_line.push(beside(&path, start, velocity));
        }
    }
    found
}

/// What a program that moves balls says that it is.
///
/// # Errors
/// [`ProgramError`]: there is none, or it is none of those.
pub fn program(path: &Path) -> Result<String, ProgramError> {
    Ok(Program::start(path)?.about())
}

fn run(options: &Options) -> Report {
    let program = options.avian.as_deref();
    let about = program.map(self::program);
    // Who does not greet is not asked for anything else.
    let program = program.filter(|_| matches!(about, Some(Ok(_))));
    let mut faults = Vec::new();
    if let Some(Err(fault)) = &about {
        faults.push(fault.to_string());
    }
    let count = options.count.unwrap_or(1000).max(1);
    let mut random = Random::new(mixed(options.seed, 0));
    let (mut rows, mut roll) = (Vec::new(), Map::new());
    for (name, height) in GROUNDS {
        eprintln!("bodies: a ball rolls, {name}");
        let found = rolled(&mut random, height);
        let worst = |errors: &[f64]| errors.iter().copied().fold(0.0, f64::max);
        let [ours, theirs] = &found.beside;
        roll.insert(
            name.into(),
            json!({
                "unbroken_m": worst(&found.unbroken),
                "parry_m": worst(&found.parry),
                "parry_itself_m": worst(&found.parry_itself),
                "beside_m": { "ours": worst(ours), "parry": worst(theirs) },
            }),
        );
        rows.push(rolled_row(name, "an unbroken tile", &found.unbroken));
        rows.push(rolled_row(name, "parry's height field", &found.parry));
    }
    eprintln!("bodies: 100 m/s");
    let fast = fast(options.seed, count.div_ceil(16));
    let (mut over, mut still, mut airborne) = (Map::new(), Map::new(), Map::new());
    let (mut iterations, mut lost) = (Map::new(), Map::new());
    let mut depth: Map<String, Value> = Map::new();
    let mut curves = Vec::new();
    for terrain in Terrain::all() {
        eprintln!("bodies: {count} walk, {}", terrain.name);
        let from = places(&terrain, count, options.seed);
        let compared = all(&terrain, &from, STEPS, program);
        for (method, fault) in compared.faults {
            let fault = format!("{method}, {}: {fault}", terrain.name);
            eprintln!("bodies: left out: {fault}");
            faults.push(fault);
        }
        let walked = compared.walked;
        let each = |what: &dyn Fn(&Walked) -> f64| {
            let named = walked
                .iter()
                .map(|(name, walked)| ((*name).to_owned(), json!(what(walked))));
            Value::from(named.collect::<Map<_, _>>())
        };
        let ours = walked[0].1.ns;
        over.insert(terrain.name.into(), each(&|walked| walked.ns / ours));
        still.insert(terrain.name.into(), each(&|walked| walked.still));
        airborne.insert(terrain.name.into(), each(&|walked| walked.airborne));
        lost.insert(terrain.name.into(), each(&|walked| walked.lost as f64));
        for (name, walked) in &walked {
            let known = depth.get(*name).and_then(Value::as_f64).unwrap_or(0.0);
            depth.insert((*name).into(), json!(known.max(walked.depth)));
            rows.push(walked_row(terrain.name, name, walked));
        }
        let found = curve(&terrain, &from[..from.len().min(2000)], STEPS);
        iterations.insert(
            terrain.name.into(),
            json!({
                "ns": found.ns,
                "error_mean_m": found.mean,
                "error_max_m": found.max,
                "wrong": found.wrong,
            }),
        );
        curves.push((terrain.name, found));
    }
    let by_program = match about {
        None => format!(
            "avian3d is not asked: built by `{BUILD}`, it is given as `--avian \
             lab/avian/target/release/dolomite_avian`; a dependency of this workspace it would change Bevy for all"
        ),
        Some(Ok(about)) => format!(
            "avian: {about}, in a program of its own that measures its moves itself, in turns with the others; as it is \
             given, and (avian_snaps) with ground held within 0.3 m below who stood, what presses onto the ground left \
             out, and slopes above 50° as walls"
        ),
        Some(Err(_)) => "avian3d was not asked".into(),
    };
    let left_out = faults.iter().map(|fault| format!("left out: {fault}"));
    Report {
        study: STUDY.name,
        rows,
        figures: vec![figure(&curves)],
        notes: [
            format!(
                "a ball of 0.5 m rolls 100 m over tiles of 8 m from {BALLS} places at 3 to 5 m/s, and over one tile of \
                 256 m, or over parry's height field of 256 m with FIX_INTERNAL_EDGES and cells cut all alike"
            ),
            "balls of 0.4 m walk at 4 m/s over 20 000 triangles, one core, all methods in turns in one run; Rapier's \
             controller as it is given, and with steps of 0.35 m, ground held within 0.3 m and slopes to 50° as ours"
                .into(),
            "errors of a slide are against 64 advances from the same place; the index of a list of `iterations` is \
             the number of advances less 1"
                .into(),
            by_program,
        ]
        .into_iter()
        .chain(left_out)
        .collect(),
        summary: json!({
            "walkers": count,
            "steps": STEPS,
            "roll": roll,
            "fast": { "balls": fast.balls, "below": fast.below, "replaced": fast.replaced },
            "over": over,
            "still": still,
            "airborne": airborne,
            "lost": lost,
            "depth_max_m": depth,
            "iterations": iterations,
            "left_out": faults,
        }),
    }
}

fn rolled_row(ground: &str, against: &str, errors: &[f64]) -> Row {
    Row {
        sweep: ground.into(),
        method: "tiles of 8 m".into(),
        parameter: format!("against {against}"),
        parameter_value: errors.len() as f64,
        quantity: "path of a ball over 100 m".into(),
        error: ErrorStats::of(errors.iter().copied()).map(ErrorNumbers::from),
        error_unit: "m".into(),
        time_ns: None,
        bytes: None,
        vertices: None,
        hash: None,
        device: "Rapier".into(),
    }
}

fn walked_row(terrain: &str, method: &str, walked: &Walked) -> Row {
    Row {
        sweep: terrain.into(),
        method: method.into(),
        parameter: format!(
            "still={:.4} airborne={:.4} lost={} depth={:.2e}",
            walked.still, walked.airborne, walked.lost, walked.depth
        ),
        parameter_value: walked.depth,
        quantity: "distance of standing balls from the surface".into(),
        error: ErrorStats::of(walked.gaps.iter().copied()).map(ErrorNumbers::from),
        error_unit: "m".into(),
        time_ns: Some(walked.ns),
        bytes: None,
        vertices: None,
        hash: Some(walked.hash),
        device: "one core".into(),
    }
}

fn figure(curves: &[(&str, Curve)]) -> Figure {
    let lines = curves
        .iter()
        .enumerate()
        .map(|(colour, (name, curve))| Line {
            name: (*name).into(),
            colour,
            // A logarithm of no error is none: a nanometre stands for it.
            points: (0..ITERATIONS.len())
                .map(|i| (curve.ns[i], curve.mean[i].max(1e-9)))
                .collect(),
        });
    Figure {
        name: "bodies_iterations".into(),
        caption:
            "Mean error of one to five advances of a slide, from left to right, by time; one core."
                .into(),
        chart: Chart {
            title: "Advances of a slide".into(),
            x_label: "ns / move".into(),
            y_label: "mean error, m".into(),
            axes: Axes::Logarithmic,
            curves: lines.collect(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_run_rolls_walks_and_loses_nobody() {
        let options = Options {
            count: Some(40),
            ..Options::default()
        };
        let summary = run(&options).summary;
        for ground in ["flat", "slope", "waves"] {
            let rolled = &summary["roll"][ground];
            // Not nearly: to the bit, whatever holds the samples.
            assert_eq!(rolled["unbroken_m"], 0.0, "{ground}: {summary}");
            // The counterpart: other ways of the same ball differ, by what f32 makes of them.
            assert!(
                rolled["parry_m"].as_f64().unwrap() > 0.0,
                "{ground}: {summary}"
            );
        }
        assert_eq!(summary["fast"]["below"], 0, "{summary}");
        for terrain in ["hills", "gravel"] {
            assert_eq!(summary["lost"][terrain]["ours"], 0.0, "{summary}");
            // The more advances, the nearer to the end.
            let errors = &summary["iterations"][terrain]["error_mean_m"];
            let mean = |i: usize| errors[i].as_f64().unwrap();
            assert!(mean(0) > mean(2) && mean(2) >= mean(4), "{summary}");
            assert_eq!(summary["over"][terrain]["avian"], Value::Null);
        }
        assert_eq!(summary["left_out"], json!([]));
        assert!(
            summary["depth_max_m"]["ours"].as_f64().unwrap() <= 1e-4,
            "{summary}"
        );
    }
}
