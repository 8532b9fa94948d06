//! The study: how much of everything, and what is told of it.

use super::baseline::Baseline;
use super::compare::{PLACES, all_baselines, compare};
use super::cracks;
use super::guarantee::{TAUS, guarantee};
use super::ours::Ours;
use super::passes::passes;
use super::pops::{MOVES, RATE, TAU, pops};
use super::precision::{FAR, far_noise, pairs};
use super::report::{self, Compared, row};
use super::soak;
use super::speed::speed;
use crate::csv;
use crate::scenes::camera::Camera;
use crate::scenes::cameras::{KINDS, ordinary};
use crate::scenes::terrains;
use crate::study::{Asked, Options, Part, Report, Study};
use bevy::math::{DVec3, UVec2};
use dolomite_classic::ClassicHeights;
use dolomite_terrain::Terrain;
use dolomite_testkit::gpu::Gpu;
use serde_json::{Map, Value, json};
use std::path::PathBuf;

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "lod",
    about: "level of detail: is the error bound kept; vertices beside 4 methods; cracks, pops",
    run: |options| run(&Plan::of(options)),
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 10] = [
    Asked {
        what: "Guarantee, CPU reference: places",
        asked: "",
        at: "/guarantee/all/samples",
        unit: "places",
    },
    Asked {
        what: "Guarantee, CPU reference: errors above the tolerance",
        asked: "0",
        at: "/guarantee/all/above",
        unit: "places",
    },
    Asked {
        what: "Guarantee, CPU reference: holes",
        asked: "0",
        at: "/guarantee/all/holes",
        unit: "places",
    },
    Asked {
        what: "Guarantee, CPU reference: largest error over the bound",
        asked: "≤ 1",
        at: "/guarantee/all/max",
        unit: "ratio",
    },
    Asked {
        what: "Guarantee, triangles that the adapter drew: places",
        asked: "",
        at: "/guarantee_drawn/all/samples",
        unit: "places",
    },
    Asked {
        what: "Guarantee, triangles that the adapter drew: errors above the tolerance",
        asked: "0",
        at: "/guarantee_drawn/all/above",
        unit: "places",
    },
    Asked {
        what: "Guarantee, triangles that the adapter drew: holes",
        asked: "0",
        at: "/guarantee_drawn/all/holes",
        unit: "places",
    },
    Asked {
        what: "Guarantee, triangles that the adapter drew: largest error over the bound",
        asked: "≤ 1",
        at: "/guarantee_drawn/all/max",
        unit: "ratio",
    },
    Asked {
        what: "Shared edges that are looked at",
        asked: "≥ 1000000",
        at: "/cracks/shared_edges",
        unit: "edges",
    },
    Asked {
        what: "Of these open",
        asked: "0",
        at: "/cracks/open",
        unit: "edges",
    },
];

/// The classic scene's samples in the shared data.
const CLASSIC: &str = "data/classic/heights_1024_f32le.raw";

/// How much of everything.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Of all inputs.
    pub seed: u32,
    /// Ground of the ordinary cameras.
    pub ground: Terrain,
    /// Cameras of the guarantee.
    pub cameras: usize,
    /// Tolerances, pixels, the finest last.
    pub taus: Vec<f64>,
    /// Places a camera and tolerance.
    pub samples: usize,
    /// Shared edges that are looked at.
    pub edges: u64,
    /// Frames of each move.
    pub frames: usize,
    /// Picture of the moves.
    pub picture: UVec2,
    /// Errors that methods are tuned to, pixels, and at how many places.
    pub wanted: Vec<f64>,
    /// See `wanted`.
    pub places: usize,
    /// Most vertices of the other methods, as a multiple of ours.
    pub most: Option<f64>,
    /// Cameras of each kind over ground that is moved.
    pub rounds: usize,
    /// Tolerance that is timed, pixels.
    pub time_tau: f64,
    /// Timed runs.
    pub repeats: usize,
    /// Where places of the guarantee of what is drawn are kept, to go on from; `None` keeps nothing.
    pub keep: Option<PathBuf>,
    /// What is run; nothing named is all of it.
    pub parts: Vec<Part>,
}

impl Plan {
    /// What the command line asks for.
    #[must_use]
    pub fn of(options: &Options) -> Self {
        Self {
            seed: options.seed,
            ground: terrains::mountain(options.seed),
            cameras: options.cameras,
            taus: TAUS.to_vec(),
            samples: options.samples,
            edges: 1_000_000,
            frames: options.frames / 50,
            picture: UVec2::new(960, 540),
            wanted: options.errors.clone(),
            places: PLACES,
            most: options.most,
            rounds: 2,
            time_tau: 1.0,
            repeats: options.repeats,
            keep: options.out.as_ref().map(|out| out.join("lod_drawn.jsonl")),
            parts: options.parts.clone(),
        }
    }

    /// Whether a part is run.
    #[must_use]
    pub fn has(&self, part: Part) -> bool {
        self.parts.is_empty() || self.parts.contains(&part)
    }
}

/// Runs it.
#[must_use]
pub fn run(plan: &Plan) -> Report {
    let mut rows = Vec::new();
    let mut summary = Map::new();
    let mut tell = |name: &str, value: Value| {
        eprintln!("lod: {name}: {value:#}");
        summary.insert(name.into(), value);
    };
    if plan.has(Part::Guarantee) {
        eprintln!("lod: guarantee");
        let counts = guarantee(plan.cameras, &plan.taus, plan.samples, plan.seed);
        rows.extend(report::guarantee_rows(&counts));
        tell("guarantee", report::guarantee(&counts));
    }
    if plan.has(Part::Drawn) {
        eprintln!("lod: guarantee of what the adapter drew");
        tell("guarantee_drawn", of_drawn(plan));
    }
    if plan.has(Part::Cracks) {
        eprintln!("lod: cracks");
        tell("cracks", edges(plan));
    }
    if plan.has(Part::Precision) {
        tell("precision", precision(plan));
    }
    if plan.has(Part::Time) {
        tell("time", times(plan, &mut rows));
    }
    if plan.has(Part::Passes) {
        tell("passes", on_the_adapter(plan));
    }
    if plan.has(Part::Pops) {
        tell("pops", movements(plan, &mut rows));
    }
    let mut figures = Vec::new();
    if plan.has(Part::Vertices) {
        let compared = beside_others(plan);
        rows.extend(report::compared_rows(&compared));
        figures = report::figures(&compared);
        tell("vertices", report::compared(&compared));
    }
    Report {
        study: STUDY.name,
        rows,
        figures,
        notes: notes(plan),
        summary: Value::Object(summary),
    }
}

/// The guarantee of what the adapter drew; a reason in place of numbers where there is no adapter.
fn of_drawn(plan: &Plan) -> Value {
    let asked = soak::Asked {
        seed: plan.seed,
        cameras: plan.cameras,
        taus: plan.taus.clone(),
        samples: plan.samples,
    };
    let found = Gpu::new()
        .map_err(|error| error.to_string())
        .and_then(|gpu| {
            let counts = soak::soak(&gpu, &asked, plan.keep.as_deref());
            counts.map_err(|error| error.to_string())
        });
    match found {
        Ok(counts) => report::guarantee(&counts),
        Err(reason) => {
            eprintln!("lod: {reason}");
            json!({ "none": reason })
        }
    }
}

fn edges(plan: &Plan) -> Value {
    let found = cracks::cracks(plan.edges, plan.seed);
    json!({
        "views": found.views, "shared_edges": found.shared, "open": found.open,
        "doubled_vertices": found.doubled, "turned_triangles": found.turned,
    })
}

fn beside_others(plan: &Plan) -> Vec<Compared> {
    let ground = &plan.ground;
    let cameras = ordinary(ground);
    let ours = Ours::all()
        .into_iter()
        .map(|ours| Box::new(ours) as Box<dyn Baseline>);
    let methods: Vec<Box<dyn Baseline>> = ours.chain(all_baselines()).collect();
    plan.wanted
        .iter()
        .map(|&wanted| Compared {
            wanted,
            rows: compare(
                &methods,
                ground,
                &cameras,
                (wanted, plan.places),
                plan.most,
                plan.seed,
            ),
        })
        .collect()
}

fn precision(plan: &Plan) -> Value {
    eprintln!("lod: precision");
    let pairs = pairs(plan.rounds, &plan.taus, plan.samples / 8, plan.seed);
    let most =
        |pick: &dyn Fn(&super::precision::Pair) -> f64| pairs.iter().map(pick).fold(0.0, f64::max);
    let noise = far_noise(
        plan.rounds * KINDS.len(),
        &plan.taus,
        plan.samples / 8,
        plan.seed,
    );
    json!({
        "metres": FAR,
        "views": pairs.len(),
        "difference_of_maxima_over_bound": most(&|p| p.difference()),
        "max_near": most(&|p| p.near.tally.max),
        "max_far": most(&|p| p.far.tally.max),
        "above_far": pairs.iter().map(|p| p.far.above()).sum::<u64>(),
        "noise_far": report::guarantee(&noise)["all"],
    })
}

fn times(plan: &Plan, rows: &mut Vec<csv::Row>) -> Value {
    eprintln!("lod: time");
    let mut told = Vec::new();
    // As games have it by default.
    let finest = dolomite_ground::detail::TerrainLod::default().finest;
    for (number, camera) in ordinary(&plan.ground).iter().enumerate() {
        let camera = crate::scenes::camera::Camera {
            size: plan.picture * 2,
            ..*camera
        };
        let Some(found) = speed(&plan.ground, &camera, plan.time_tau, finest, plan.repeats) else {
            continue;
        };
        for (part, time) in [
            ("blocks", found.make),
            ("choice", found.select),
            ("mesh", found.mesh),
        ] {
            rows.push(csv::Row {
                quantity: part.into(),
                time_ns: Some(time * 1e6),
                vertices: Some(found.vertices),
                ..row("time", "ours", format!("camera={number}"), number as f64)
            });
        }
        told.push(json!({
            "make_ms": found.make, "select_ms": found.select, "mesh_ms": found.mesh,
            "blocks": found.blocks, "blocks_drawn": found.drawn_blocks,
            "vertices": found.vertices, "triangles": found.triangles, "held": found.held,
        }));
    }
    json!(told)
}

/// The mountain and, where the shared data are, the classic scene at the first frame of its path.
fn on_the_adapter(plan: &Plan) -> Value {
    eprintln!("lod: passes");
    let gpu = match Gpu::new() {
        Ok(gpu) => gpu,
        Err(error) => return json!({ "not_measured": error.to_string() }),
    };
    let [standing, flying, _] = ordinary(&plan.ground);
    let finest = dolomite_ground::detail::TerrainLod::default().finest;
    let mut views = vec![
        ("standing", plan.ground.clone(), standing, finest),
        ("flying", plan.ground.clone(), flying, finest),
    ];
    let shared = std::env::var_os("DOLOMITE_SHARED").map_or("../shared".into(), PathBuf::from);
    if let Ok(heights) = ClassicHeights::load(&shared.join(CLASSIC)) {
        let orbit = Camera {
            eye: DVec3::new(200.0, 70.0, 0.0),
            yaw: std::f64::consts::PI,
            pitch: (-0.25_f64).atan(),
            roll: 0.0,
            size: UVec2::new(1280, 720),
            fov_y: 60.0_f64.to_radians(),
            near: 0.1,
            orthographic: None,
        };
        views.insert(0, ("classic", heights.terrain(), orbit, 0.25));
    }
    let mut told = Map::new();
    told.insert("device".into(), json!(gpu.name));
    for (name, ground, camera, finest) in views {
        let found = passes(&gpu, &ground, &camera, plan.time_tau, finest);
        let found = found.unwrap_or_else(|error| json!({ "not_measured": error.to_string() }));
        eprintln!("lod: passes: {name}: {found}");
        told.insert(name.into(), found);
    }
    Value::Object(told)
}

fn movements(plan: &Plan, rows: &mut Vec<csv::Row>) -> Value {
    eprintln!("lod: pops");
    let mut told = Map::new();
    let [standing, flying, _] =
        ordinary(&plan.ground).map(|camera| crate::scenes::camera::Camera {
            size: plan.picture,
            ..camera
        });
    for way in MOVES {
        let start = if way == super::pops::Move::Fly {
            flying
        } else {
            standing
        };
        let Some(found) = pops(&plan.ground, way, start, plan.frames) else {
            continue;
        };
        rows.push(csv::Row {
            error: Some(found.seen.into()),
            quantity: "movement a frame".into(),
            ..row("pops", "ours", way.name().into(), TAU)
        });
        told.insert(
            way.name().into(),
            json!({
                "frames": plan.frames, "frames_a_second": RATE, "vertices": found.seen.samples,
                "max": found.seen.max, "p99": found.seen.p99, "rms": found.seen.rms,
                "share_above_a_quarter": found.above, "metres_from_the_eye": found.distance,
                "pixels_from_the_border": found.border, "max_inside": found.inside,
                "max_coming_or_leaving": found.entering,
            }),
        );
    }
    Value::Object(told)
}

fn notes(plan: &Plan) -> Vec<String> {
    vec![
        format!(
            "guarantee: {} cameras over mountains, noise and real elevation, each at four tolerances, \
             {} places each and more where there are more triangles; errors in units of the bound. \
             Cells down to 1/64 m. Pictures of 240 x 135, of a hundred rounds nine 480 x 270 and one 1920 x \
             1080: an error in pixels is the same thing at any size. Where the finest cell is reached, the bound is the \
             one that the choice reports.",
            plan.cameras, plan.samples
        ),
        "vertices: those of triangles that may be seen, each once, also where blocks or grids that meet both store it; of \
         the uniform grid all, as a static mesh has them. A method without a number says why: memory, or the end of its knob."
            .into(),
        format!(
            "pops: pictures of {} x {}, tolerance {TAU} px, at vertices of both frames that both see.",
            plan.picture.x, plan.picture.y
        ),
        "passes: choices of at most 64 blocks each; making: from the roots to a choice that has nothing to make, resting: one \
         more of the same view, moving: one choice each after steps of 10 m."
            .into(),
        "precision: hills and a height map can be moved, noise is another one elsewhere.".into(),
        "time: 1920 x 1080, cells down to 1/8 m; blocks on all cores, choice and mesh on one."
            .into(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gpu_a_small_run_holds_together() {
        let report = run(&Plan {
            ground: terrains::small(1),
            time_tau: 16.0,
            cameras: 10,
            taus: vec![8.0],
            samples: 1500,
            edges: 20_000,
            frames: 1,
            picture: UVec2::new(240, 135),
            wanted: vec![16.0],
            places: 3000,
            rounds: 1,
            repeats: 1,
            ..Plan::of(&Options::default())
        });
        let all = &report.summary["guarantee"]["all"];
        assert_eq!(
            (&all["above"], &all["holes"]),
            (&json!(0), &json!(0)),
            "{all}"
        );
        assert!(all["samples"].as_u64().unwrap() > 10_000, "{all}");
        assert_eq!(report.summary["cracks"]["open"], 0);
        let vertices = &report.summary["vertices"]["16 px"];
        for camera in vertices.as_array().unwrap() {
            assert!(camera["ours"]["ours_over_this"] == 1.0, "{camera}");
            assert!(camera["uniform grid"]["ours_over_this"].as_f64().unwrap() < 1.0);
            assert!(camera["ours"]["max"].as_f64().unwrap() <= 16.0);
        }
        assert_eq!(report.summary["pops"].as_object().unwrap().len(), 3);
        for figure in &report.figures {
            crate::plot::to_svg(&figure.chart).unwrap();
        }
        assert_eq!(report.figures.len(), 3);
    }
}
