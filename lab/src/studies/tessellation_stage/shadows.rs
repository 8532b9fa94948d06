//! Shadow views: what four of them add to a frame whose patches are all tessellated anew, for vertices
//! that are stored once and for draws that evaluate them again.

use super::functions::{CHEAPEST, COSTLY};
use super::gbuffer::{Draws, Emission, Frame, MAIN, Parts};
use super::report::{Section, figure, row};
use super::scene::{MOST, PLACES, camera, entity, light, pools};
use crate::csv::Row;
use crate::study::{Figure, Options};
use dolomite_shaders::ShaderFile;
use dolomite_tessellation::{Drawing, Tessellator, shapes};
use dolomite_testkit::gpu::Gpu;
use dolomite_testkit::metrics::median;
use dolomite_testkit::stage::{StageError, StagePasses, StageRun};
use serde_json::{Value, json};
use std::sync::Arc;

/// What the frame with four shadow views may take of the one without.
pub const ASKED: f64 = 1.5;

/// The number of shadow views that the ratio is asked for.
const VIEWS: usize = 4;

/// Repeats of a frame that are worth their time: whole sweeps are repeated.
const REPEATS: usize = 9;

/// Side of a shadow map that figures show, pixels: Bevy's default.
const SIDE: u32 = 2048;

/// Levels of every edge, each four times the triangles of the one before, and sides of shadow maps.
const SWEEP: [(f32, u32); 4] = [(8.0, SIDE), (16.0, 1024), (16.0, SIDE), (32.0, SIDE)];

/// An evaluate function, and what goes with it.
#[derive(Clone, Copy)]
struct Evaluation {
    name: &'static str,
    functions: &'static [ShaderFile],
}

const EVALUATIONS: [Evaluation; 2] = [
    Evaluation {
        name: "flat",
        functions: CHEAPEST,
    },
    Evaluation {
        name: "rock",
        functions: COSTLY,
    },
];

/// What is emitted and how often: the stage's two ways, and what both save.
const WAYS: [(Drawing, Emission, &str); 3] = [
    (Drawing::Stored, Emission::Once, "stored"),
    (
        Drawing::Evaluated,
        Emission::Once,
        "evaluated by every draw",
    ),
    (
        Drawing::Stored,
        Emission::EveryView,
        "tessellated for every view",
    ),
];

/// One place of the sweep.
#[derive(Debug, Clone)]
pub struct Measured {
    /// Of all five entities.
    triangles: u32,
    covered: usize,
    dispatches: Vec<usize>,
    draws: Vec<usize>,
    /// Medians, ms: the passes, the main draw, one shadow draw, each in a submission of its own.
    parts: [f64; 3],
    /// Medians, ms: whole frames with 0 to [`MOST`] shadow views.
    frames: Vec<f64>,
    /// The least of the repeats, ms: what other work on the machine adds is least in it.
    least: Vec<f64>,
    /// Medians over the repeats of each repeat's ratio to its frame without shadow views.
    ratios: Vec<f64>,
    /// Least and greatest of the ratios with [`VIEWS`].
    spread: [f64; 2],
}

/// Measures the sweep.
pub fn run(options: &Options, gpu: Option<&Gpu>) -> Section {
    sweep(options, gpu, &SWEEP)
}

fn sweep(options: &Options, gpu: Option<&Gpu>, places: &[(f32, u32)]) -> Section {
    let mut section = Section::open(
        "shadows",
        "five tessellated entities, four shadow views: emission once; at most 1.5 times the frame \
         without shadow views, main draw included",
    );
    let Some(gpu) = gpu else {
        section
            .notes
            .push("Nothing was drawn: there is no adapter.".into());
        return section;
    };
    let mut found = Vec::new();
    for evaluation in EVALUATIONS {
        for (level, side) in places {
            for (drawing, emission, way) in WAYS {
                let name = format!("{}, {way}", evaluation.name);
                eprintln!("tessellation-stage: shadows, {name}, level {level}, maps of {side}");
                let way = (drawing, emission);
                match measure(gpu, options, evaluation, way, (*level, *side)) {
                    Ok(measured) => found.push((name, evaluation, way, *level, *side, measured)),
                    Err(reason) => section
                        .notes
                        .push(format!("{name} at level {level} is left out: {reason}")),
                }
            }
        }
    }
    let mut details = json!({
        "asked_ratio": ASKED,
        "main_view_pixels": MAIN,
        "at": [],
    });
    let mut curves = Vec::new();
    let mut within = Vec::new();
    let mut once = true;
    for (name, evaluation, way, level, side, measured) in &found {
        section
            .rows
            .extend(rows(name, *level, *side, measured, &gpu.name));
        if let Some(list) = details["at"].as_array_mut() {
            list.push(describe(name, *level, *side, measured));
        }
        let curve: Vec<(f64, f64)> = (0_u32..)
            .zip(&measured.ratios)
            .map(|(views, ratio)| (f64::from(views), *ratio))
            .collect();
        if *side == SIDE {
            let method = name
                .trim_start_matches(evaluation.name)
                .trim_start_matches(", ");
            let points = curve.into_iter().skip(1).collect();
            curves.push((
                evaluation.name,
                (format!("{method}, level {level}"), points),
            ));
        }
        if *way == (Drawing::Stored, Emission::Once) {
            let same = measured
                .dispatches
                .iter()
                .all(|n| *n == measured.dispatches[0]);
            once = once && same;
            let least = measured.least[VIEWS] / measured.least[0];
            within.push((evaluation.name, least, measured.ratios[VIEWS]));
        }
    }
    let of = |evaluation: &str| {
        let own = || within.iter().filter(|(name, ..)| *name == evaluation);
        let ratios = || own().map(|(.., ratio)| *ratio);
        let of_least = || own().map(|(_, least, _)| *least);
        json!({
            "over_the_sweep": [ratios().reduce(f64::min), ratios().reduce(f64::max)],
            "of_least_times": [of_least().reduce(f64::min), of_least().reduce(f64::max)],
        })
    };
    section.reached = json!({
        "emission_once": once,
        "ratio_with_4_rock_stored": of("rock"),
        "ratio_with_4_flat_stored": of("flat"),
    });
    section.holds =
        (!within.is_empty()).then(|| once && within.iter().all(|(.., ratio)| *ratio <= ASKED));
    section.details = details;
    section.figures.extend(EVALUATIONS.map(|evaluation| {
        let own = curves.iter().filter(|(of, _)| *of == evaluation.name);
        let own = own.map(|(_, curve)| curve.clone()).collect();
        ratio_figure(evaluation.name, own, &gpu.name)
    }));
    section.notes.extend(standing_notes());
    section
}

fn ratio_figure(
    evaluation: &str,
    mut curves: Vec<(String, Vec<(f64, f64)>)>,
    adapter: &str,
) -> Figure {
    curves.push((
        "asked with 4: 1.5".to_owned(),
        vec![(1.0, ASKED), (6.0, ASKED)],
    ));
    figure(
        &format!("tessellation_shadows_{evaluation}"),
        format!(
            "Time of (stage + main draw + shadow draws) over (stage + main draw), by the number of \
             shadow views of 2048 x 2048, all patches of five entities tessellated anew in every \
             frame; evaluate function: {evaluation}. Stored: emitted and evaluated once. Evaluated by \
             every draw: emitted once as patch and coordinate. Tessellated for every view: the passes \
             run again before each shadow draw. On {adapter}."
        ),
        [
            &format!("Shadow views: time of a frame, evaluate function `{evaluation}`"),
            "shadow views",
            "time over that without shadow views",
        ],
        curves,
    )
}

fn standing_notes() -> [String; 4] {
    [
        "Wall time from submission to completion of one submission; a repeat measures the frame with \
         0 to 6 shadow views one after the other, the ratio is the median of the repeats' ratios. \
         ratio_of_least: of the least times of all repeats, to which other work on the machine adds least. \
         Nothing rests: a still camera and still patches pay for the draws alone."
            .into(),
        "Main draw: 1280 x 720, the stage's own draw.wgsl with GBUFFER into Rgba32Uint, R8Uint and \
         Depth32Float, as Bevy's deferred prepass without normals and motion; three modules of Bevy \
         that it imports are stood in for by the same arithmetic (functions/gbuffer_*.wgsl). Lighting \
         is not in it: with it the ratio would be less."
            .into(),
        "Shadow draws: the same vertex shader, no fragment shader, one depth map each; orthographic, \
         half extents 4 to 24 m around the middle of the scene, back faces left out as the stage does. \
         No bounds function: every view draws all."
            .into(),
        "flat: shaders/src/stage/user.wgsl, three control points mixed. rock: evaluate and material \
         of assets/shaders/rock.wgsl, eight octaves of gradient noise with slopes. Five entities of \
         one mesh of 32 triangle patches, equal spacing."
            .into(),
    ]
}

fn rows(name: &str, level: f32, side: u32, measured: &Measured, device: &str) -> Vec<Row> {
    let method = format!("{name}, level {level}, maps of {side}");
    let mut rows = Vec::new();
    for (views, (ms, ratio)) in (0_u32..).zip(measured.frames.iter().zip(&measured.ratios)) {
        let mut row = row(
            "shadows",
            &method,
            ("shadow views", f64::from(views)),
            ("time over that without shadow views", *ratio, ""),
            device,
        );
        row.time_ns = Some(ms * 1e6);
        rows.push(row);
    }
    rows
}

fn describe(name: &str, level: f32, side: u32, measured: &Measured) -> Value {
    let [stage, main, shadow] = measured.parts;
    json!({
        "method": name,
        "level": level,
        "shadow_map_side": side,
        "triangles": measured.triangles,
        "covered_pixels": measured.covered,
        "stage_ms": stage,
        "main_draw_ms": main,
        "one_shadow_draw_ms": shadow,
        "frame_ms_by_shadow_views": measured.frames,
        "ratio_by_shadow_views": measured.ratios,
        "ratio_with_4": measured.ratios[VIEWS],
        "least_frame_ms_by_shadow_views": measured.least,
        "ratio_of_least_with_4": measured.least[VIEWS] / measured.least[0],
        "ratio_with_4_least_greatest": measured.spread,
        "dispatches_by_shadow_views": measured.dispatches,
        "draws_by_shadow_views": measured.draws,
    })
}

fn measure(
    gpu: &Gpu,
    options: &Options,
    evaluation: Evaluation,
    (drawing, emission): (Drawing, Emission),
    (level, side): (f32, u32),
) -> Result<Measured, StageError> {
    let tessellator = Tessellator::default();
    let passes = StagePasses::with_functions(gpu, tessellator, drawing, evaluation.functions)?;
    let mesh = Arc::new(shapes::octahedron(2));
    let entities = PLACES.map(|place| (mesh.clone(), entity(place, level)));
    let run = StageRun::new(
        gpu,
        &passes,
        mesh.layout(),
        &entities,
        pools(tessellator, &mesh, level),
    )?;
    let lights: Vec<_> = (0..MOST).map(light).collect();
    let draws = Draws::new(
        gpu,
        &passes,
        &run,
        evaluation.functions,
        camera(),
        side,
        &lights,
    )?;
    let frame = |stage, main, shadows| {
        let parts = Parts {
            stage,
            main,
            shadows,
        };
        draws.frame(&run, parts)
    };
    // Pages of fresh buffers and maps, and the adapter's own compilation.
    frame(emission, true, MOST)?;
    let head = run.head()?;
    let covered = draws.covered()?;
    let ms = |frame: Frame| frame.time.as_secs_f64() * 1e3;
    let repeats = options.repeats.clamp(1, REPEATS);
    let mut parts = [const { Vec::new() }; 3];
    let mut frames = vec![Vec::new(); MOST + 1];
    let mut ratios = vec![Vec::new(); MOST + 1];
    let mut counted = Vec::new();
    for _ in 0..repeats {
        let of = [
            (Emission::Once, false, 0),
            (Emission::Never, true, 0),
            (Emission::Never, false, 1),
        ];
        for (list, (stage, main, shadows)) in parts.iter_mut().zip(of) {
            list.push(ms(frame(stage, main, shadows)?));
        }
        let all: Vec<Frame> = (0..=MOST)
            .map(|views| frame(emission, true, views))
            .collect::<Result<_, _>>()?;
        for (views, found) in all.iter().enumerate() {
            frames[views].push(ms(*found));
            ratios[views].push(ms(*found) / ms(all[0]));
        }
        counted = all.iter().map(|f| (f.dispatches, f.draws)).collect();
    }
    let middle = |numbers: Vec<f64>| median(numbers).unwrap_or(f64::NAN);
    let spread = ratios[VIEWS]
        .iter()
        .fold([f64::MAX, 0.0_f64], |[a, b], r| [a.min(*r), b.max(*r)]);
    let least = frames
        .iter()
        .map(|times| times.iter().copied().fold(f64::MAX, f64::min))
        .collect();
    Ok(Measured {
        least,
        triangles: head.primitives,
        covered,
        dispatches: counted.iter().map(|(dispatches, _)| *dispatches).collect(),
        draws: counted.iter().map(|(_, draws)| *draws).collect(),
        parts: parts.map(middle),
        frames: frames.into_iter().map(middle).collect(),
        ratios: ratios.into_iter().map(middle).collect(),
        spread,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gpu_small_sweep_measures_everything() {
        let Some(gpu) = dolomite_testkit::gpu::for_test() else {
            return;
        };
        let options = Options {
            repeats: 1,
            ..Options::default()
        };
        let section = sweep(&options, Some(&gpu), &[(4.0, 256)]);
        let list = section.details["at"].as_array().expect("a list");
        assert_eq!(list.len(), 6, "{:?}", section.notes);
        for found in list {
            assert_eq!(found["triangles"], 5 * 32 * 24);
            // The count can grow: it does where the passes are recorded for every view.
            let method = found["method"].as_str().expect("a name");
            let dispatches = if method.ends_with("tessellated for every view") {
                json!([7, 14, 21, 28, 35, 42, 49])
            } else {
                json!([7, 7, 7, 7, 7, 7, 7])
            };
            assert_eq!(found["dispatches_by_shadow_views"], dispatches);
            assert_eq!(found["draws_by_shadow_views"], json!([1, 2, 3, 4, 5, 6, 7]));
            // Five bodies of a radius of a metre, 7 m away, in 921 600 pixels.
            let covered = found["covered_pixels"].as_u64().expect("a number");
            assert!((100_000..400_000).contains(&covered), "{found}");
            assert!(found["ratio_with_4"].as_f64() > Some(0.0));
        }
        assert_eq!(section.reached["emission_once"], true);
        assert_eq!(section.rows.len(), 6 * (MOST + 1));
    }
}
