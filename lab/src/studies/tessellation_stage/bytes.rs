//! Bytes: what a triangle costs with its share of vertices, over the level.

use super::frames::cube;
use super::report::{Section, domain_name, figure, row, spacing_name};
use crate::tessellators::{DOMAINS, SPACINGS};
use dolomite_tessellation::shape::Shape;
use dolomite_tessellation::tables::Instance;
use dolomite_tessellation::{
    Domain, Drawing, Levels, Mode, PatchLayout, PatchMesh, Spacing, Tessellator, shapes,
};
use dolomite_testkit::gpu::Gpu;
use dolomite_testkit::stage::{StageError, StagePasses, StageRun};
use serde_json::{Map, Value, json};
use std::sync::Arc;

/// What a triangle may cost, bytes.
pub const ASKED: f64 = 24.0;

/// Levels: 1 to 64, and some between where the curve bends.
fn levels() -> Vec<f32> {
    let whole = (1..=64_u16).map(f32::from);
    let mut levels: Vec<f32> = whole.chain([1.5, 2.5, 3.5, 11.5]).collect();
    levels.sort_by(f32::total_cmp);
    levels
}

const DRAWINGS: [(Drawing, &str); 2] = [
    (Drawing::Stored, "stored"),
    (Drawing::Evaluated, "evaluated"),
];

/// Patches that share all their edges, or one alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Patches {
    Closed,
    Alone,
}

/// Emits every domain and spacing at every level and counts.
pub fn run(gpu: Option<&Gpu>) -> Section {
    let mut section = Section::open(
        "bytes",
        "24 bytes a triangle with its share of vertices, at most",
    );
    let Some(gpu) = gpu else {
        section
            .notes
            .push("Nothing was emitted: there is no adapter.".into());
        return section;
    };
    let mut curves = Vec::new();
    let mut details = Map::new();
    let mut most = 0.0_f64;
    for domain in DOMAINS {
        for spacing in SPACINGS {
            eprintln!(
                "tessellation-stage: bytes, {}, {}",
                domain_name(domain),
                spacing_name(spacing)
            );
            for (drawing, drawing_name) in DRAWINGS {
                let name = format!("{}, {}", domain_name(domain), spacing_name(spacing));
                for patches in [Patches::Closed, Patches::Alone] {
                    // Lines share nothing.
                    if domain == Domain::Isolines && patches == Patches::Closed {
                        continue;
                    }
                    let found = match sweep(gpu, (domain, spacing), drawing, patches) {
                        Ok(found) => found,
                        Err(reason) => {
                            section.notes.push(format!("{name} is left out: {reason}"));
                            continue;
                        }
                    };
                    let which = match patches {
                        Patches::Alone => "one patch alone",
                        Patches::Closed => "closed surface",
                    };
                    let method = format!("{name}, {drawing_name}, {which}");
                    for (level, bytes) in &found {
                        let quantity = ("bytes of a primitive", *bytes, "bytes");
                        let level = ("level", *level);
                        section
                            .rows
                            .push(row("bytes", &method, level, quantity, &gpu.name));
                    }
                    let worst = found.iter().map(|(_, bytes)| *bytes).fold(0.0, f64::max);
                    let last = found.last().map(|(_, bytes)| *bytes);
                    let usual = found.iter().find(|(level, _)| *level == 11.5);
                    details.insert(
                        method.clone(),
                        json!({
                            "most": worst,
                            "at_level_11.5": usual.map(|(_, bytes)| *bytes),
                            "at_level_64": last,
                            "levels_above_24": found.iter().filter(|(_, b)| *b > ASKED).count(),
                        }),
                    );
                    if domain != Domain::Isolines
                        && patches == Patches::Closed
                        && drawing == Drawing::Stored
                    {
                        most = most.max(worst);
                    }
                    // Closed surfaces differ by the second digit behind the point: one spacing
                    // stands for all of them there, the table has the others.
                    if drawn(domain, spacing, patches, drawing) {
                        let name = domain_name(domain);
                        curves.push((format!("{name}, {drawing_name}, {which}"), found));
                    }
                }
            }
        }
    }
    curves.push(("24 bytes".into(), vec![(1.0, ASKED), (64.0, ASKED)]));
    section.reached = json!(most);
    section.holds = Some(most > 0.0 && most <= ASKED);
    section.details = Value::Object(details);
    section.figures.push(figure(
        "tessellation_bytes",
        "Bytes of vertices and indices that the stage emits for a triangle (isolines: a segment) over \
         the level of every edge. Closed surface: 128 triangle patches or 96 quads that share their \
         edges and corners; one patch alone shares nothing, so that few triangles carry all of its \
         outline. Fractional odd spacing, isolines equal; all spacings are in the table."
            .into(),
        ["Bytes a triangle over the level", "level of every edge", "bytes a triangle"],
        curves,
    ));
    section.notes.push(
        "reached: the most over all levels of closed surfaces, triangles and quads, every spacing, \
         vertices stored (20 bytes each, 4 an index). What is left above 22 is 40 over the number of \
         triangles, so a closed surface of fewer than 20 triangles needs more than 24; so do patches \
         that share no edge at low levels (details). Isolines are segments, not triangles: 8 bytes of \
         indices and a vertex each, 28, and one vertex more a line."
            .into(),
    );
    section
}

fn drawn(domain: Domain, spacing: Spacing, patches: Patches, drawing: Drawing) -> bool {
    match (domain, patches) {
        (Domain::Isolines, _) => spacing == Spacing::Equal && drawing == Drawing::Stored,
        (_, Patches::Closed) => spacing == Spacing::FractionalOdd,
        (_, Patches::Alone) => spacing == Spacing::FractionalOdd && drawing == Drawing::Stored,
    }
}

fn sweep(
    gpu: &Gpu,
    (domain, spacing): (Domain, Spacing),
    drawing: Drawing,
    patches: Patches,
) -> Result<Vec<(f64, f64)>, StageError> {
    let tessellator = Tessellator {
        domain,
        spacing,
        ..Default::default()
    };
    let passes = StagePasses::with_drawing(gpu, tessellator, drawing)?;
    let mesh = Arc::new(mesh(domain, patches));
    levels()
        .into_iter()
        .map(|level| {
            let mut entity = Instance::IDENTITY;
            entity.params[0][0] = level;
            let shape = Shape::new(&Levels::uniform(level), domain, spacing, Mode::Exact);
            let size = shape.map_or([0; 2], |shape| [shape.vertices(), shape.primitives()]);
            let pools = size.map(|size| size * mesh.patches() as u32);
            let entities = [(mesh.clone(), entity)];
            let run = StageRun::new(gpu, &passes, mesh.layout(), &entities, pools)?;
            run.tessellate(1)?;
            let head = run.head()?;
            let bytes = run.bytes(&head) as f64 / f64::from(head.primitives.max(1));
            Ok((f64::from(level), bytes))
        })
        .collect()
}

fn mesh(domain: Domain, patches: Patches) -> PatchMesh {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let points: Vec<[f32; 4]> = corners.iter().map(|[x, y]| [*x, *y, 0.0, 0.0]).collect();
    let one = match domain {
        Domain::Triangles if patches == Patches::Closed => return shapes::octahedron(4),
        Domain::Quads if patches == Patches::Closed => return cube(4),
        Domain::Triangles => PatchMesh::from_patches(PatchLayout::TRIANGLE, &points[..3]),
        Domain::Quads => PatchMesh::from_patches(PatchLayout::QUAD, &points),
        Domain::Isolines => PatchMesh::from_patches(PatchLayout::lines(4), &points),
    };
    one.expect("one whole patch")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gpu_closed_surfaces_keep_to_it_and_lone_patches_do_not() {
        let Some(gpu) = dolomite_testkit::gpu::for_test() else {
            return;
        };
        let of = (Domain::Triangles, Spacing::Equal);
        let closed = sweep(&gpu, of, Drawing::Stored, Patches::Closed).expect("a sweep");
        assert_eq!(closed.len(), levels().len());
        assert!(
            closed
                .iter()
                .all(|(_, bytes)| *bytes > 22.0 && *bytes <= ASKED)
        );
        // 128 triangles, 66 vertices.
        assert_eq!(closed[0], (1.0, 12.0 + 20.0 * 66.0 / 128.0));
        let alone = sweep(&gpu, of, Drawing::Stored, Patches::Alone).expect("a sweep");
        assert_eq!(alone[0], (1.0, 72.0));
        let evaluated = sweep(&gpu, of, Drawing::Evaluated, Patches::Closed).expect("a sweep");
        assert!(
            evaluated
                .iter()
                .zip(&closed)
                .all(|(one, other)| one.1 < other.1)
        );
    }
}
