//! Study `rays`: rays at vertices and edges of closed meshes, and rays a second, ours and others'.

mod meshes;
mod method;
mod speed;
mod truth;

use crate::csv::{ErrorNumbers, Row};
use crate::plot::{Axes, Chart, Curve};
use crate::studies::beside::NOTE;
use crate::study::{Asked, Figure, Options, Report, Study};
use dolomite_collision::TreeKind;
use dolomite_testkit::metrics::{ErrorStats, median};
use dolomite_testkit::random::Random;
use method::NAMES;
use serde_json::{Map, Value, json};
use speed::{LEAVES, Speed};
use truth::Wrong;

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "rays",
    about: "rays at edges and vertices of closed meshes: leaks, and rays a second; octree, BVH, parry",
    run,
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 14] = [
    asked(
        "Rays at edges and vertices of closed meshes",
        "≥ 1e8",
        "/rays",
        "",
    ),
    asked("Leaks", "0", "/leaks/bvh", ""),
    asked("Leaks, octree", "0", "/leaks/octree", ""),
    asked("Leaks, parry 0.30", "", "/leaks/parry", ""),
    asked(
        "Hits that brute force in f64 does not have, or the other way round",
        "0",
        "/disagree/bvh",
        "",
    ),
    asked(
        "Place that is hit, largest error against brute force, meshes of 2 m",
        "",
        "/error_max_m/bvh",
        "m",
    ),
    asked(
        "Place that is hit, largest error, parry 0.30",
        "",
        "/error_max_m/parry",
        "m",
    ),
    asked(
        "Rays a second over parry 0.30, bumpy sphere",
        "≥ 1.5",
        "/over_parry/bumpy sphere/bvh",
        "ratio",
    ),
    asked(
        "Rays a second over parry 0.30, terrain",
        "≥ 1.5",
        "/over_parry/terrain/bvh",
        "ratio",
    ),
    asked(
        "Rays a second over parry 0.30, soup",
        "≥ 1.5",
        "/over_parry/soup/bvh",
        "ratio",
    ),
    asked(
        "Rays a second of the BVH over the octree, bumpy sphere",
        "",
        "/bvh_over_octree/bumpy sphere",
        "ratio",
    ),
    asked(
        "Rays a second of the BVH over the octree, terrain",
        "",
        "/bvh_over_octree/terrain",
        "ratio",
    ),
    asked(
        "Rays a second of the BVH over the octree, soup",
        "",
        "/bvh_over_octree/soup",
        "ratio",
    ),
    asked(
        "Triangles of a leaf that are quickest over all meshes, BVH",
        "",
        "/best_leaf/bvh",
        "triangles",
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

fn kind_name(kind: TreeKind) -> &'static str {
    match kind {
        TreeKind::Bvh => NAMES[0],
        TreeKind::Octree => NAMES[1],
        TreeKind::List => "list",
    }
}

/// The size of leaf with the least sum of times, each as a multiple of its mesh's least.
fn best_leaf(curves: &[Vec<f64>]) -> usize {
    let least = |curve: &[f64]| curve.iter().copied().fold(f64::INFINITY, f64::min);
    let sums = (0..LEAVES.len()).map(|i| {
        let times = curves.iter().map(|curve| curve[i] / least(curve));
        times.sum::<f64>()
    });
    let best = sums.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
    best.map_or(0, |(i, _)| LEAVES[i])
}

fn run(options: &Options) -> Report {
    let count = options.count.unwrap_or(1_000_000).max(1);
    let mut random = Random::new(options.seed);
    let wrong = truth::wrong(&mut random, count, NAMES.len());
    let mut rows = Vec::new();
    let mut summary = Map::new();
    summary.insert("rays".into(), json!(count));
    let mut all: Vec<(&str, Vec<Speed>)> = Vec::new();
    let mut curves: Vec<(TreeKind, &str, Vec<f64>)> = Vec::new();
    for scene in meshes::scenes(&mut random) {
        eprintln!("rays: {}, {} triangles", scene.name, scene.mesh.1.len());
        let rays = scene.rays(&mut random, (count / 10).clamp(1000, 100_000));
        let speeds = speed::methods(&scene, &rays, options.repeats);
        rows.extend(speeds.iter().map(|speed| row(scene.name, speed)));
        for (kind, curve) in speed::leaves(&scene, &rays, options.repeats) {
            curves.push((kind, scene.name, curve));
        }
        all.push((scene.name, speeds));
    }
    let by_method = |pick: &dyn Fn(usize, &Wrong) -> Value| {
        let asked = wrong.iter().enumerate().take(all[0].1.len());
        let values = asked.map(|(i, wrong)| (NAMES[i].to_owned(), pick(i, wrong)));
        Value::from(values.collect::<Map<_, _>>())
    };
    let worst = |wrong: &Wrong| ErrorStats::of(wrong.errors.iter().copied());
    summary.insert("leaks".into(), by_method(&|_, wrong| json!(wrong.leaks)));
    summary.insert(
        "disagree".into(),
        by_method(&|_, wrong| json!(wrong.disagree)),
    );
    summary.insert(
        "error_max_m".into(),
        by_method(&|_, wrong| json!(worst(wrong).map(|stats| stats.max))),
    );
    let by_scene = |pick: &dyn Fn(&[Speed]) -> Value| {
        let scenes = all.iter();
        Value::from(
            scenes
                .map(|(name, speeds)| ((*name).to_owned(), pick(speeds)))
                .collect::<Map<_, _>>(),
        )
    };
    let each = |speeds: &[Speed], pick: &dyn Fn(&Speed) -> Value| {
        let methods = speeds.iter();
        Value::from(
            methods
                .map(|speed| (speed.name.to_owned(), pick(speed)))
                .collect::<Map<_, _>>(),
        )
    };
    summary.insert(
        "ns".into(),
        by_scene(&|speeds| each(speeds, &|speed| json!(speed.ns))),
    );
    summary.insert(
        "build_ms".into(),
        by_scene(&|speeds| each(speeds, &|speed| json!(speed.build_ms))),
    );
    summary.insert(
        "bvh_over_octree".into(),
        by_scene(&|speeds| json!(speeds[1].ns / speeds[0].ns)),
    );
    summary.insert(
        "over_parry".into(),
        by_scene(&|speeds| {
            let parry = speeds.get(2).map(|speed| speed.ns);
            each(speeds, &|speed| json!(parry.map(|parry| parry / speed.ns)))
        }),
    );
    let of_kind = |kind| {
        let these = curves.iter().filter(move |curve| curve.0 == kind);
        these.map(|curve| curve.2.clone()).collect::<Vec<_>>()
    };
    let leaves = curves.iter().map(|(kind, scene, times)| {
        let times = LEAVES.iter().zip(times);
        let named = times.map(|(leaf, ns)| (leaf.to_string(), json!(ns)));
        let name = format!("{}, {scene}", kind_name(*kind));
        (name, Value::from(named.collect::<Map<_, _>>()))
    });
    summary.insert("leaf_ns".into(), leaves.collect::<Map<_, _>>().into());
    summary.insert(
        "best_leaf".into(),
        json!({
            "bvh": best_leaf(&of_kind(TreeKind::Bvh)),
            "octree": best_leaf(&of_kind(TreeKind::Octree)),
        }),
    );
    for (i, wrong) in wrong.iter().enumerate().take(all[0].1.len()) {
        rows.push(Row {
            sweep: "closed meshes".into(),
            quantity: "place that is hit".into(),
            error: worst(wrong).map(ErrorNumbers::from),
            error_unit: "m".into(),
            parameter: format!("leaks={} disagree={}", wrong.leaks, wrong.disagree),
            parameter_value: wrong.leaks as f64,
            time_ns: median(all.iter().map(|(_, speeds)| speeds[i].ns).collect()),
            ..row("", &all[0].1[i])
        });
    }
    Report {
        study: STUDY.name,
        rows,
        figures: vec![figure(&curves)],
        notes: vec![
            "times are of one core, first hits, some 100 000 triangles".into(),
            NOTE.into(),
        ],
        summary: summary.into(),
    }
}

fn row(scene: &str, speed: &Speed) -> Row {
    Row {
        sweep: scene.into(),
        method: speed.name.into(),
        parameter: String::new(),
        parameter_value: 0.0,
        quantity: "first hit".into(),
        error: None,
        error_unit: String::new(),
        time_ns: Some(speed.ns),
        bytes: speed.bytes,
        vertices: None,
        hash: Some(speed.hash),
        device: "one core".into(),
    }
}

fn figure(curves: &[(TreeKind, &str, Vec<f64>)]) -> Figure {
    let drawn = curves.iter().enumerate();
    Figure {
        name: "rays_leaves".into(),
        caption: "Time of a first hit by the most triangles that a leaf may hold, one core.".into(),
        chart: Chart {
            title: "Size of leaves".into(),
            x_label: "triangles of a leaf, at most".into(),
            y_label: "ns / ray".into(),
            axes: Axes::Logarithmic,
            curves: drawn
                .map(|(colour, (kind, scene, times))| Curve {
                    name: format!("{}, {scene}", kind_name(*kind)),
                    colour,
                    points: LEAVES
                        .iter()
                        .map(|&leaf| leaf as f64)
                        .zip(times.iter().copied())
                        .collect(),
                })
                .collect(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_run_does_not_leak() {
        let options = Options {
            count: Some(20_000),
            repeats: 1,
            ..Options::default()
        };
        let report = run(&options);
        for kind in ["bvh", "octree"] {
            assert_eq!(report.summary["leaks"][kind], 0, "{}", report.summary);
            assert_eq!(report.summary["disagree"][kind], 0, "{}", report.summary);
            let error = report.summary["error_max_m"][kind].as_f64().unwrap();
            assert!(error < 1e-5, "{}", report.summary);
        }
        // The counterpart: what leaks is seen. Parry's are 3.5 % of 100 000 rays.
        let leaks = report.summary["leaks"]["parry"].as_u64().unwrap();
        assert!(leaks > 100, "{}", report.summary);
        // Both trees give the same answers.
        assert_eq!(report.rows[0].hash, report.rows[1].hash);
    }

    #[test]
    fn the_best_leaf_is_that_of_all_meshes() {
        let curves = [
            vec![9.0, 9.0, 1.0, 2.0, 9.0, 9.0],
            vec![9.0, 9.0, 9.0, 2.0, 2.0, 9.0],
        ];
        assert_eq!(best_leaf(&curves), 8);
    }
}
