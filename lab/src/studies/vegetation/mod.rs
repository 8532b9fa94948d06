//! Study `vegetation`: roots, density, cover and colour by distance, popping and speed, on the CPU.

mod look;
mod roots;
mod rows;

use crate::csv::Row;
use crate::study::{Asked, Options, Report, Study};
use dolomite_testkit::metrics::Hash64;
use dolomite_vegetation::kind::{Blade, Shape};
use dolomite_vegetation::{Growth, Kinds};
use serde_json::json;

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "vegetation",
    about: "what grows: roots that move, density, cover and colour by distance against all blades at many samples",
    run,
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 11] = [
    asked("Roots moved by 10⁴ cameras", "0", "/roots/moved", ""),
    asked("Roots outside of their bands", "0", "/density/outside", ""),
    asked(
        "Roots against the integral of the density",
        "≤ 0.5 %",
        "/density/error_percent",
        "%",
    ),
    asked(
        "Cover lost at a share of 1/16, nested rank, largest of three densities",
        "≤ 3 %",
        "/share/nested_percent",
        "%",
    ),
    asked("The same by random rank", "", "/share/random_percent", "%"),
    asked(
        "Cover by ring, 5 to 1000 m, largest difference to all blades",
        "≤ 1 %",
        "/rings/cover_percent",
        "%",
    ),
    asked(
        "Mean colour by ring, largest difference",
        "≤ 1",
        "/rings/colour_255",
        "1/255",
    ),
    asked(
        "Width that changes in a frame at 2 m/s",
        "≤ 0.1",
        "/popping/walking_px",
        "px",
    ),
    asked("The same at 50 m/s", "≤ 0.5", "/popping/flying_px", "px"),
    asked("Candidates on one core", "", "/speed/candidates_ms", "a ms"),
    asked(
        "Bytes stored for what does not stand",
        "0",
        "/bytes/of_candidate",
        "bytes",
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

/// The kinds that come with the crate, as its tests use them.
const KINDS: &str = include_str!("../../../../plugins/vegetation/assets/kinds.ron");

/// The grass among them.
fn grass(seed: u32) -> (Blade, Growth) {
    let kinds = Kinds::parse(KINDS, "kinds.ron".as_ref()).expect("it comes with the crate");
    let (_, kind) = kinds.find("grass").expect("one of them");
    let Shape::Blade(blade) = kind.shape else {
        unreachable!("grass has blades")
    };
    (blade, Growth::new(kind, seed))
}

fn run(options: &Options) -> Report {
    let (blade, growth) = grass(options.seed);
    let cameras = options.count.unwrap_or(10_000);
    eprintln!("vegetation: roots");
    let moved = roots::moved(growth.lattice, options.seed, cameras);
    let density = roots::density(growth);
    eprintln!("vegetation: cover by share");
    let share = roots::shares(growth.lattice);
    let speed = roots::speed(growth, options.repeats);
    eprintln!("vegetation: cover and colour by ring");
    let rings = look::rings(&blade, growth, options.seed);
    let popping = look::popping();
    let mut rows: Vec<Row> = rings.iter().map(look::Ring::row).collect();
    rows.extend(share.iter().map(roots::Share::row));
    let mut hash = Hash64::default();
    hash.add(moved.hash);
    let largest = |of: fn(&look::Ring) -> f64| rings.iter().map(of).fold(0.0, f64::max);
    let lost = |of: fn(&roots::Share) -> f64| share.iter().map(of).fold(0.0, f64::max);
    Report {
        study: STUDY.name,
        rows,
        figures: Vec::new(),
        notes: vec![
            format!(
                "rings: a flat meadow seen from 1.7 m, 8 m and 60 m above it; parallel rays at the elevation of each ring; all \
                 blades at 512² samples for {} m of ground a side, the mean of {} such squares; {} m and nearer blades by rank and width, beyond \
                 the far field's table, which is fitted on other ground",
                look::SIDE,
                look::FIELDS,
                look::HAND_OVER
            ),
            "rings under an elevation of 0.29° (sine 0.005) are measured at that one: all of the ground is covered".into(),
            "what is drawn by the GPU, floating roots, draws and dispatches are not part of this study yet; neither are \
             the geometry shader's blades and instances placed on the CPU"
                .into(),
        ],
        summary: json!({
            "roots": {
                "moved": moved.moved,
                "cameras": cameras,
                "looked_at": moved.looked_at,
                "far_m": roots::FAR,
                "hash": format!("{:016x}", hash.finish()),
            },
            "density": {
                "error_percent": 100.0 * density.error,
                "outside": density.outside,
                "roots": density.count,
            },
            "share": {
                "nested_percent": 100.0 * lost(|share| share.nested_lost()),
                "random_percent": 100.0 * lost(|share| share.random_lost()),
            },
            "rings": {
                "cover_percent": 100.0 * largest(look::Ring::cover_error),
                "colour_255": 255.0 * largest(look::Ring::colour_error),
                "each": rings.iter().map(look::Ring::summary).collect::<Vec<_>>(),
            },
            "popping": {
                "walking_px": popping.walking,
                "flying_px": popping.flying,
                "entering_px": popping.entering,
            },
            "speed": {
                "candidates_ms": speed.candidates_ms,
                "standing_ms": speed.standing_ms,
            },
            "bytes": {"of_candidate": 0, "of_kind": size_of::<Growth>() + size_of::<dolomite_vegetation::shade::FarField>()},
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_run_moves_no_root() {
        let options = Options {
            count: Some(200),
            repeats: 1,
            ..Options::default()
        };
        let summary = run(&options).summary;
        assert_eq!(summary["roots"]["moved"], 0);
        assert_eq!(summary["density"]["outside"], 0);
        assert!(
            summary["density"]["error_percent"].as_f64().unwrap() <= 0.5,
            "{summary}"
        );
        assert!(summary["roots"]["looked_at"].as_u64().unwrap() > 10_000);
        assert!(
            summary["share"]["random_percent"].as_f64()
                > summary["share"]["nested_percent"].as_f64()
        );
    }
}
