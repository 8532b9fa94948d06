//! Background pixels: a camera inside of a closed surface sees none, whatever the levels.

use super::functions::ROCKY;
use super::pairs::{TESSELLATORS, layout, tessellator};
use super::report::{Section, figure, row};
use super::tally::tessellator_name;
use crate::study::Options;
use dolomite_tessellation::shape::Shape;
use dolomite_tessellation::tables::Instance;
use dolomite_tessellation::{Domain, Drawing, Levels, PatchLayout, PatchMesh, Tessellator, shapes};
use dolomite_testkit::gpu::Gpu;
use dolomite_testkit::random::Random;
use dolomite_testkit::raster::{Raster, SIDE};
use dolomite_testkit::stage::{StageError, StagePasses, StageRun};
use serde_json::json;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Frames of whole surfaces for one of each surface that is open on purpose.
const CONTROLS: usize = 10;

/// Time between two lines of progress.
const PROGRESS: Duration = Duration::from_secs(3);

/// What surrounds the camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Surface {
    /// Closed: every edge is shared.
    Closed,
    /// One patch is taken out.
    PatchLess,
    /// All patches are there, but each has its own control points: none shares an edge.
    Apart,
}

impl Surface {
    const ALL: [Self; 3] = [Self::Closed, Self::PatchLess, Self::Apart];

    const fn name(self) -> &'static str {
        match self {
            Self::Closed => "closed surface",
            Self::PatchLess => "one patch taken out",
            Self::Apart => "edges not shared",
        }
    }
}

/// A frame.
#[derive(Debug, Clone, Copy)]
struct Frame {
    surface: Surface,
    /// Place of its tessellator.
    place: usize,
    background: usize,
    triangles: u32,
}

/// Counts the frames of the run.
pub fn run(options: &Options, gpu: Option<&Gpu>) -> Section {
    let mut section = Section::open(
        "background",
        "0 background pixels over a sentinel colour in 1000 frames",
    );
    let Some(gpu) = gpu else {
        section
            .notes
            .push("Nothing was drawn: there is no adapter.".into());
        return section;
    };
    let frames = match draw(options, gpu) {
        Ok(frames) => frames,
        Err(reason) => {
            section.notes.push(format!("Nothing was counted: {reason}"));
            return section;
        }
    };
    let of = |surface: Surface| frames.iter().filter(move |frame| frame.surface == surface);
    let sum = |surface| of(surface).map(|frame| frame.background).sum::<usize>();
    let mut curves = Vec::new();
    let mut details = json!({ "pixels_of_a_frame": SIDE * SIDE });
    for surface in Surface::ALL {
        let (mut points, mut so_far) = (Vec::new(), 0.0);
        for (number, frame) in (1_u32..).zip(of(surface)) {
            let method = format!(
                "{}, {}",
                surface.name(),
                tessellator_name(tessellator(frame.place))
            );
            let number = f64::from(number);
            let background = frame.background as f64;
            let counted = ("background", background, "pixels");
            section.rows.push(row(
                "background",
                &method,
                ("frame", number),
                counted,
                &gpu.name,
            ));
            so_far += background;
            points.push((number, so_far));
        }
        details[surface.name().replace(' ', "_")] = json!({
            "frames": of(surface).count(),
            "frames_with_background": of(surface).filter(|frame| frame.background > 0).count(),
            "background_pixels": sum(surface),
            "most_in_a_frame": of(surface).map(|frame| frame.background).max(),
            "triangles": of(surface).map(|frame| u64::from(frame.triangles)).sum::<u64>(),
        });
        curves.push((surface.name().to_owned(), points));
    }
    let open = sum(Surface::Closed);
    section.reached = json!(open);
    section.holds = Some(open == 0);
    section.details = details;
    section.figures.push(figure(
        "tessellation_background",
        format!(
            "Pixels that show the sentinel colour, in all frames so far, of {SIDE} x {SIDE} each. Closed \
             surfaces have none in any frame, hence no line. Without a patch, or with edges that are \
             not shared, the sentinel shows: the count can fail."
        ),
        ["Background pixels behind a surface around the camera", "frame", "pixels"],
        curves,
    ));
    section.notes.push(
        "Spheres displaced by noise (the relief of assets/shaders/rock.wgsl), of 128 triangle patches \
         or 96 quads, anew for every frame: each patch asks for random levels up to 40 of its own; the \
         camera stands near the middle, 90 degrees wide, turned at random. Triangles are drawn from \
         both sides without depth over a sentinel colour. Every spacing and both modes in turn."
            .into(),
    );
    section
}

fn draw(options: &Options, gpu: &Gpu) -> Result<Vec<Frame>, StageError> {
    let raster = Raster::new(gpu);
    let mut random = Random::new(options.seed);
    let mut frames = Vec::new();
    let (start, mut told) = (Instant::now(), Instant::now());
    let each = options.frames.div_ceil(TESSELLATORS);
    for place in 0..TESSELLATORS {
        let tessellator = tessellator(place);
        let passes = StagePasses::with_functions(gpu, tessellator, Drawing::Stored, ROCKY)?;
        for surface in Surface::ALL {
            let count = if surface == Surface::Closed {
                each
            } else {
                each.div_ceil(CONTROLS)
            };
            for _ in 0..count {
                let (mesh, pools) = mesh(tessellator, surface, &mut random);
                let layout = mesh.layout();
                let mut entity = Instance::IDENTITY;
                // A seventh of the radius, 1.4 waves: as examples/sphere.rs has it.
                entity.params[0] = [0.0, 0.14, 1.4, 0.0];
                let entities = [(Arc::new(mesh), entity)];
                let run = StageRun::new(gpu, &passes, layout, &entities, pools)?;
                run.tessellate(1)?;
                let background = raster.uncovered(gpu, &run, &view(&mut random))?;
                frames.push(Frame {
                    surface,
                    place,
                    background,
                    triangles: run.head()?.primitives,
                });
                if told.elapsed() > PROGRESS {
                    told = Instant::now();
                    eprintln!(
                        "tessellation-stage: background, {} frames, {:.0} s",
                        frames.len(),
                        start.elapsed().as_secs_f64()
                    );
                }
            }
        }
    }
    Ok(frames)
}

/// A closed surface of patches around the origin, each with random levels of its own in two control
/// points behind those that span it; with pools that hold it.
fn mesh(tessellator: Tessellator, surface: Surface, random: &mut Random) -> (PatchMesh, [u32; 2]) {
    let whole = match tessellator.domain {
        Domain::Triangles => shapes::octahedron(4),
        _ => cube(4),
    };
    let mut layout = layout(tessellator.domain);
    let spanning = layout.points as usize;
    layout.points += 2;
    let mut points = whole.points().to_vec();
    let (mut indices, mut sizes) = (Vec::new(), [0; 2]);
    let missing =
        (surface == Surface::PatchLess).then(|| (random.unit() * whole.patches() as f64) as usize);
    let mut level = || {
        let [a, b] = [random.unit(), random.unit()];
        (0.5 + 39.5 * a * b * b) as f32
    };
    for (number, patch) in whole.indices().chunks_exact(spanning).enumerate() {
        if missing == Some(number) {
            continue;
        }
        let levels = Levels {
            outer: std::array::from_fn(|_| level()),
            inner: std::array::from_fn(|_| level()),
        };
        if surface == Surface::Apart {
            let first = points.len() as u32;
            points.extend(patch.iter().map(|k| whole.points()[*k as usize]));
            indices.extend(first..first + spanning as u32);
        } else {
            indices.extend_from_slice(patch);
        }
        indices.extend([points.len() as u32, points.len() as u32 + 1]);
        let [u, v] = levels.inner;
        points.extend([levels.outer, [u, v, 0.0, 0.0]]);
        let Tessellator {
            domain,
            spacing,
            mode,
            ..
        } = tessellator;
        if let Some(shape) = Shape::new(&levels, domain, spacing, mode) {
            sizes[0] += shape.vertices();
            sizes[1] += shape.primitives();
        }
    }
    // Edges rise to the levels of their neighbours.
    let pools = sizes.map(|size| 3 * size + 1024);
    let mesh = PatchMesh::new(layout, points, indices).expect("whole patches of points that exist");
    (mesh, pools)
}

/// The six faces of a cube around the origin, `parts`² quads each.
#[must_use]
pub fn cube(parts: u32) -> PatchMesh {
    // The axis that a face looks along, and the two of its sides, right-handed.
    let faces: [[[f32; 3]; 3]; 6] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
        [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
        [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
    ];
    let mut points: Vec<[f32; 4]> = Vec::new();
    for [out, right, up] in faces {
        // Steps of whole numbers: faces have the bits of their common points in common.
        let at = |i: u32, j: u32| {
            let place = |k: u32| (2 * k) as f32 / parts as f32 - 1.0;
            let p: [f32; 3] =
                std::array::from_fn(|k| out[k] + place(i) * right[k] + place(j) * up[k]);
            [p[0], p[1], p[2], 0.0]
        };
        for j in 0..parts {
            for i in 0..parts {
                points.extend([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    PatchMesh::from_patches(PatchLayout::QUAD, &points).expect("whole quads")
}

/// A camera near the origin that looks somewhere, 90 degrees wide; column by column.
fn view(random: &mut Random) -> [f32; 16] {
    let mut next = || random.signed_unit() as f32;
    // A unit quaternion (x, y, z, w) from four numbers is a rotation.
    let [x, y, z, w] = loop {
        let q = [next(), next(), next(), next()];
        let length = q.iter().map(|x| x * x).sum::<f32>().sqrt();
        // Within the unit ball no direction is preferred; near its middle there is none.
        if (0.1..1.0).contains(&length) {
            break q.map(|x| x / length);
        }
    };
    let rows = [
        [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - z * w),
            2.0 * (x * z + y * w),
        ],
        [
            2.0 * (x * y + z * w),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - x * w),
        ],
        [
            2.0 * (x * z - y * w),
            2.0 * (y * z + x * w),
            1.0 - 2.0 * (x * x + y * y),
        ],
    ];
    let eye = [0.2 * next(), 0.2 * next(), 0.2 * next()];
    let moved = rows.map(|row| -(row[0] * eye[0] + row[1] * eye[1] + row[2] * eye[2]));
    // Clip space: x, y as they are, z = w - near (all of it in front), w = -z of the view.
    let near = 0.01;
    let mut clip = [0.0; 16];
    for k in 0..3 {
        clip[4 * k..4 * k + 4].copy_from_slice(&[rows[0][k], rows[1][k], -rows[2][k], -rows[2][k]]);
    }
    clip[12..].copy_from_slice(&[moved[0], moved[1], -moved[2] - near, -moved[2]]);
    clip
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_is_closed() {
        let mesh = cube(3);
        let topology = mesh.topology();
        let found = (topology.corners.len(), topology.edges.len(), mesh.patches());
        assert_eq!(found, (56, 108, 54));
    }

    #[test]
    fn gpu_closed_surfaces_show_nothing_and_open_ones_do() {
        let Some(gpu) = dolomite_testkit::gpu::for_test() else {
            return;
        };
        let options = Options {
            frames: 4 * TESSELLATORS,
            ..Options::default()
        };
        let section = run(&options, Some(&gpu));
        assert_eq!(section.reached, 0, "{:?}", section.notes);
        let background = |surface: &str| section.details[surface]["background_pixels"].as_u64();
        assert_eq!(section.details["closed_surface"]["frames"], 48);
        assert!(background("one_patch_taken_out") > Some(u64::from(SIDE)));
        assert!(
            background("edges_not_shared") > Some(u64::from(SIDE)),
            "{}",
            section.details
        );
        assert_eq!(section.rows.len(), 48 + 2 * TESSELLATORS);
    }
}
