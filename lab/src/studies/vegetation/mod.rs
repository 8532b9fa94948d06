//! Study `vegetation`: roots, density, cover and colour by distance, popping and speed, on the CPU.

mod look;
mod roots;
mod rows;

use crate::csv::Row;
use crate::study::{Asked, Options, Report, Study};
use dolomite_testkit::metrics::Hash64;
use dolomite_vegetation::kind::{Blade, Shape};
use dolomite_vegetation::{Growth, Kinds, Law};
use serde_json::json;

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "vegetation",
    about: "what grows: roots that move, density, cover and colour by distance against all blades at many samples",
    run,
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 13] = [
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
        "Cover by ring, 5 to 1000 m, law and far-field term, largest difference to all blades",
        "≤ 1 %",
        "/rings/cover_percent",
        "%",
    ),
    asked(
        "The same of blades alone, in rings where none has ended",
        "≤ 1 %",
        "/rings/near_percent",
        "%",
    ),
    asked(
        "The same of blades alone, in all rings",
        "",
        "/rings/blades_percent",
        "%",
    ),
    asked(
        "Mean colour by ring before light, law and far-field term, largest difference",
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

/// The grass of the crate's small set, and its law in a picture of 1080 lines.
fn grass(seed: u32) -> (Blade, Growth, Law) {
    let kinds = Kinds::small_set();
    let (_, kind) = kinds.find("grass").expect("one of them");
    let Shape::Blade(blade) = kind.shape else {
        unreachable!("grass has blades")
    };
    let law = Law::new(blade.width, look::PIXELS, kind.reach);
    (blade, Growth::new(kind, seed), law)
}

/// Squares that each ring is the mean of, in a run of the usual number of cameras and in a smaller one.
const FIELDS: [i32; 2] = [8, 1];

fn run(options: &Options) -> Report {
    let (blade, growth, law) = grass(options.seed);
    let cameras = options.count.unwrap_or(10_000);
    eprintln!("vegetation: roots");
    let moved = roots::moved(growth.lattice, options.seed, cameras);
    let density = roots::density(growth);
    eprintln!("vegetation: cover by share");
    let share = roots::shares(growth.lattice);
    let speed = roots::speed(growth, options.repeats);
    eprintln!("vegetation: cover and colour by ring");
    let fields = FIELDS[usize::from(cameras < 10_000)];
    let rings = look::rings(&blade, (growth, law), options.seed, fields);
    let popping = look::popping(&blade, law);
    let mut rows: Vec<Row> = rings.iter().map(look::Ring::row).collect();
    rows.extend(share.iter().map(roots::Share::row));
    let mut hash = Hash64::default();
    hash.add(moved.hash);
    let largest = |of: fn(&look::Ring) -> f64| rings.iter().map(of).fold(0.0, f64::max);
    let near = rings.iter().filter(|ring| ring.is_near(law));
    let near = near.map(look::Ring::blades_error).fold(0.0, f64::max);
    let lost = |of: fn(&roots::Share) -> f64| share.iter().map(of).fold(0.0, f64::max);
    Report {
        study: STUDY.name,
        rows,
        figures: Vec::new(),
        notes: vec![
            format!(
                "rings: a flat meadow seen from 1.7 m, 8 m and 60 m above it; parallel rays at the elevation of each ring; all \
                 blades at 512² samples for {} m of ground a side, the mean of {} such squares; against them blades by the law that \
                 is drawn, with its levels of detail and its calm colours, and where they end, from {} m to {} m, the far field's \
                 table for what is missing, which is fitted on other ground",
                look::SIDE, fields, law.fade, law.reach
            ),
            "rings under an elevation of 0.29° (sine 0.005) are measured at that one: all of the ground is covered".into(),
            "law, shapes and colours are the functions in Rust that tests hold those in WGSL to; no wind, level ground, no light".into(),
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
                "near_percent": 100.0 * near,
                "blades_percent": 100.0 * largest(look::Ring::blades_error),
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
