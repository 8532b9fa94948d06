//! Study `tessellation-speed`: what the passes of the tessellation stage cost, for each domain and
//! spacing, beside copying the bytes that they emit.

use crate::csv::Row;
use crate::plot::{Axes, Chart, Curve};
use crate::study::{Figure, Options, Report, Study};
use dolomite_tessellation::tables::Instance;
use dolomite_tessellation::{
    Domain, Drawing, PatchLayout, PatchMesh, Spacing, Tessellator, shapes,
};
use dolomite_testkit::draw::Draw;
use dolomite_testkit::gpu::Gpu;
use dolomite_testkit::metrics::median;
use dolomite_testkit::stage::{StageError, StagePasses, StageRun};
use serde_json::{Map, Value, json};
use std::sync::Arc;

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "tessellation-speed",
    about: "the stage's passes: ms a million triangles and bytes each, beside copying them",
    run,
    asked: &[],
};

const DOMAINS: [(Domain, &str); 3] = [
    (Domain::Triangles, "triangles"),
    (Domain::Quads, "quads"),
    (Domain::Isolines, "isolines"),
];

const SPACINGS: [(Spacing, &str); 3] = [
    (Spacing::Equal, "equal"),
    (Spacing::FractionalEven, "fractional even"),
    (Spacing::FractionalOdd, "fractional odd"),
];

/// Where the knob stands: the level of all edges. Patches are added until the triangles are enough.
const LEVELS: [f32; 5] = [1.5, 4.5, 11.5, 30.5, 63.0];

/// The level of the summary.
const USUAL: f32 = 11.5;

/// Runs in one submission, of which the mean is taken.
const TOGETHER: u32 = 3;

/// One measurement.
struct Measured {
    primitives: u32,
    /// ms a million primitives.
    stage: f64,
    copy: f64,
    /// One draw of it into a depth buffer of few pixels.
    draw: f64,
    bytes: f64,
}

fn run(options: &Options) -> Report {
    let mut report = Report {
        study: STUDY.name,
        rows: Vec::new(),
        figures: Vec::new(),
        notes: vec![
            "Wall time from submission to completion, median over the repeats, each the mean of \
             three runs in one submission. Patches are flat: evaluation is the cheapest there is."
                .into(),
            "Copying: copy_buffer_to_buffer of the vertices and indices that were emitted, in the \
             same run."
                .into(),
            "Drawing: into a depth buffer of 64 x 64 pixels, so that vertices count; stored \
             vertices are what a stored mesh of the same size would be drawn from. Evaluated: the \
             draw runs the evaluate function, the stage writes patch and coordinate."
                .into(),
        ],
        summary: Value::Null,
    };
    let gpu = match Gpu::new() {
        Ok(gpu) => gpu,
        Err(reason) => {
            report.notes.push(format!("Nothing was measured: {reason}"));
            return report;
        }
    };
    let mut curves = Vec::new();
    let mut summary = Map::new();
    for (domain, domain_name) in DOMAINS {
        for (spacing, spacing_name) in SPACINGS {
            let name = format!("{domain_name}, {spacing_name}");
            eprintln!("{}: {name}", STUDY.name);
            let tessellator = Tessellator {
                domain,
                spacing,
                ..Default::default()
            };
            let mut points = Vec::new();
            let mut copies = Vec::new();
            for level in LEVELS {
                let measured = match measure(&gpu, tessellator, Drawing::Stored, level, options) {
                    Ok(measured) => measured,
                    Err(reason) => {
                        report
                            .notes
                            .push(format!("{name} at level {level} is left out: {reason}"));
                        continue;
                    }
                };
                let stored = [
                    ("stage", measured.stage),
                    ("copy", measured.copy),
                    ("draw", measured.draw),
                ];
                for (method, time) in stored {
                    report
                        .rows
                        .push(row(&name, method, level, time, &measured, &gpu.name));
                }
                points.push((f64::from(level), measured.stage));
                copies.push((f64::from(level), measured.copy));
                if level == USUAL {
                    // A draw that evaluates, of the same patches in the same run.
                    let evaluated =
                        measure(&gpu, tessellator, Drawing::Evaluated, level, options).ok();
                    for (method, time) in evaluated
                        .iter()
                        .flat_map(|e| [("stage, evaluated", e.stage), ("draw, evaluated", e.draw)])
                    {
                        report
                            .rows
                            .push(row(&name, method, level, time, &measured, &gpu.name));
                    }
                    summary.insert(
                        name.clone(),
                        json!({
                            "primitives": measured.primitives,
                            "ms_per_million": measured.stage,
                            "copy_ms_per_million": measured.copy,
                            "times_copy": measured.stage / measured.copy,
                            "bytes_per_primitive": measured.bytes,
                            "draw_ms_per_million": measured.draw,
                            "evaluated": evaluated.map(|e| json!({
                                "ms_per_million": e.stage,
                                "bytes_per_primitive": e.bytes,
                                "draw_ms_per_million": e.draw,
                            })),
                        }),
                    );
                }
            }
            let colour = curves.len();
            if spacing == Spacing::FractionalOdd {
                curves.push(Curve {
                    name: format!("copy, {domain_name}"),
                    colour: colour + 1,
                    points: copies,
                });
            }
            curves.push(Curve {
                name,
                colour,
                points,
            });
        }
    }
    report.figures.push(Figure {
        name: "tessellation_speed".into(),
        caption: format!(
            "All passes of the stage for a million triangles or segments over the level of their \
             patches, beside copying what they emit, on {}. At level 1.5 the work is one of \
             patches, at 63 one of vertices and triangles.",
            gpu.name
        ),
        chart: Chart {
            title: "Tessellation: time over level".into(),
            x_label: "level of every edge".into(),
            y_label: "ms a million primitives".into(),
            axes: Axes::Logarithmic,
            curves,
        },
    });
    report.summary = json!({
        "level": USUAL,
        "adapter": gpu.name,
        "stage": summary,
    });
    report
}

fn row(name: &str, method: &str, level: f32, time: f64, measured: &Measured, device: &str) -> Row {
    Row {
        sweep: name.to_owned(),
        method: method.to_owned(),
        parameter: "level".to_owned(),
        parameter_value: f64::from(level),
        quantity: "time of a primitive".to_owned(),
        error: None,
        error_unit: String::new(),
        // ms a million are ns each.
        time_ns: Some(time),
        bytes: Some(measured.bytes.round() as usize),
        vertices: None,
        hash: None,
        device: device.to_owned(),
    }
}

fn measure(
    gpu: &Gpu,
    tessellator: Tessellator,
    drawing: Drawing,
    level: f32,
    options: &Options,
) -> Result<Measured, StageError> {
    let passes = StagePasses::with_drawing(gpu, tessellator, drawing)?;
    let each = tessellator
        .tessellate(&dolomite_tessellation::Levels::uniform(level))
        .primitives
        .len();
    let mesh = mesh(tessellator.domain, options.triangles as usize / each.max(1));
    let mut entity = Instance::IDENTITY;
    entity.params[0][0] = level;
    let most = (mesh.patches() * each) as u32 + 1;
    // Vertices: half of the triangles on a closed surface, all that a lone patch has otherwise.
    let pools = [most + most / each as u32 * 4 + 64, most];
    let entities = [(Arc::new(mesh), entity)];
    let layout = entities[0].0.layout();
    let stage = StageRun::new(gpu, &passes, layout, &entities, pools)?;
    stage.tessellate(1)?;
    let head = stage.head()?;
    let draw = Draw::new(gpu, &passes, &stage)?;
    draw.draw(1)?;
    let (mut times, mut copies, mut draws) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..options.repeats.max(1) {
        times.push(stage.tessellate(TOGETHER)?.as_secs_f64());
        copies.push(stage.copy(&head, TOGETHER)?.as_secs_f64());
        draws.push(draw.draw(TOGETHER)?.as_secs_f64());
    }
    let millions = f64::from(head.primitives) / 1e6;
    let bytes = stage.bytes(&head);
    Ok(Measured {
        primitives: head.primitives,
        stage: median(times).unwrap_or(f64::NAN) * 1e3 / millions,
        copy: median(copies).unwrap_or(f64::NAN) * 1e3 / millions,
        draw: median(draws).unwrap_or(f64::NAN) * 1e3 / millions,
        bytes: bytes as f64 / f64::from(head.primitives),
    })
}

/// About so many patches, one at least, that share their edges: an octahedron, a grid, a bundle.
fn mesh(domain: Domain, patches: usize) -> PatchMesh {
    let side = (patches as f64).sqrt().round().max(1.0) as u32;
    let parts = (patches as f64 / 8.0).sqrt().round().max(1.0) as u32;
    match domain {
        Domain::Triangles if parts <= 64 => return shapes::octahedron(parts),
        _ => {}
    }
    let at = |i: u32, j: u32| [i as f32, j as f32, 0.0, 1.0];
    let quads = (0..side).flat_map(|j| (0..side).map(move |i| (i, j)));
    let (layout, points): (_, Vec<[f32; 4]>) = match domain {
        Domain::Triangles => (
            PatchLayout::TRIANGLE,
            (0..side)
                .flat_map(|j| (0..side.div_ceil(2)).map(move |i| (i, j)))
                .flat_map(|(i, j)| {
                    let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    [a, b, c, a, c, d]
                })
                .collect(),
        ),
        Domain::Quads | Domain::Isolines => (
            if domain == Domain::Quads {
                PatchLayout::QUAD
            } else {
                PatchLayout::lines(4)
            },
            quads
                .flat_map(|(i, j)| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])
                .collect(),
        ),
    };
    PatchMesh::from_patches(layout, &points).expect("whole patches, fewer than a buffer holds")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gpu_small_run_measures_everything() {
        if dolomite_testkit::gpu::for_test().is_none() {
            return;
        }
        let report = run(&Options {
            triangles: 20_000,
            repeats: 1,
            ..Options::default()
        });
        assert_eq!(
            report.rows.len(),
            9 * (LEVELS.len() * 3 + 2),
            "{:?}",
            report.notes
        );
        for (name, found) in report.summary["stage"].as_object().expect("an object") {
            let bytes = found["bytes_per_primitive"].as_f64().expect("a number");
            let reach = if name.starts_with("isolines") {
                30.0
            } else {
                24.0
            };
            assert!(bytes <= reach, "{name}: {bytes}");
            assert!(found["times_copy"].as_f64().expect("a number") > 0.0);
        }
    }
}
