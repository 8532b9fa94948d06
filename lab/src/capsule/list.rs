//! What capsules there are.

use std::path::Path;

use dolomite_tessellation::layout::StageView;
use dolomite_tessellation::patches::WHOLE;
use dolomite_tessellation::tables::Instance;
use dolomite_tessellation::{
    Domain, Drawing, Mode, PatchLayout, PatchMesh, Spacing, Tessellator, Winding, shapes,
};
use dolomite_testkit::random::Random;

use super::format::Capsule;
use super::stage::{StageCase, Tolerance, open_view, record};
use super::{CapsuleError, functions, globe, heights, patches};
use crate::studies::tessellation::cases::read;
use crate::studies::tessellation::random::Tuples;

/// What capsules may be told.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Seed of all that is random.
    pub seed: u32,
    /// Tuples of `tuples`.
    pub count: usize,
}

/// A capsule, by name.
pub struct Entry {
    /// As it is asked for.
    pub name: String,
    /// One sentence on what is run.
    pub about: String,
    make: Make,
}

type Make = Box<dyn Fn(&str, &str, Settings) -> Result<Capsule, CapsuleError>>;

impl Entry {
    fn new(
        name: impl Into<String>,
        about: impl Into<String>,
        make: impl Fn(&str, &str, Settings) -> Result<Capsule, CapsuleError> + 'static,
    ) -> Self {
        Self {
            name: name.into(),
            about: about.into(),
            make: Box::new(make),
        }
    }

    /// Makes it.
    ///
    /// # Errors
    /// [`CapsuleError`].
    pub fn make(&self, settings: Settings) -> Result<Capsule, CapsuleError> {
        (self.make)(&self.name, &self.about, settings)
    }
}

const DOMAINS: [(Domain, &str); 3] = [
    (Domain::Triangles, "triangles"),
    (Domain::Quads, "quads"),
    (Domain::Isolines, "isolines"),
];
const SPACINGS: [(Spacing, &str); 3] = [
    (Spacing::Equal, "equal"),
    (Spacing::FractionalEven, "even"),
    (Spacing::FractionalOdd, "odd"),
];
const MODES: [(Mode, &str); 2] = [(Mode::Exact, "exact"), (Mode::D3d, "d3d")];

/// Pools in which all that is small fits.
const POOLS: [u32; 2] = [1 << 11, 1 << 12];

/// All of them.
#[must_use]
pub fn all() -> Vec<Entry> {
    let mut entries = Vec::new();
    for (domain, domain_name) in DOMAINS {
        for (spacing, spacing_name) in SPACINGS {
            for (mode, mode_name) in MODES {
                let tessellator = Tessellator {
                    domain,
                    spacing,
                    mode,
                    winding: Winding::Ccw,
                };
                entries.push(Entry::new(
                    format!("stage-{domain_name}-{spacing_name}-{mode_name}"),
                    format!(
                        "All passes of the stage: {domain_name}, {spacing_name} spacing, mode {mode_name}, random levels"
                    ),
                    move |name, about, settings| {
                        let mesh = mesh_of(domain, settings.seed, 7.0);
                        record(name, about, &StageCase::flat(tessellator, mesh, POOLS))
                    },
                ));
            }
        }
    }
    entries.extend(variations());
    entries.push(Entry::new(
        "captures",
        "The 300 patches that were captured from an OpenGL 4.5 tessellator, in both modes",
        |name, about, _| {
            let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/gl45.jsonl");
            let cases = read(&file)?;
            let both = MODES.iter().flat_map(|(mode, _)| {
                let set = |t| Tessellator { mode: *mode, ..t };
                cases
                    .iter()
                    .map(move |case| (set(case.tessellator), case.levels))
            });
            patches::capsule(name, about, &both.collect::<Vec<_>>())
        },
    ));
    entries.push(Entry::new(
        "tuples",
        "Random patches of every domain, spacing, winding and mode, with levels where a tessellator may go wrong",
        |name, about, settings| {
            let tuples = Tuples::new(settings.seed).take(settings.count);
            let patches: Vec<_> = tuples.map(|t| (t.tessellator, t.levels)).collect();
            patches::capsule(name, about, &patches)
        },
    ));
    entries.push(Entry::new(
        "functions",
        "WGSL's own functions of random numbers, against their definitions in f64",
        |name, about, _| functions::capsule(name, about),
    ));
    entries.push(Entry::new(
        "heights",
        "Height and slope of a terrain with every kind of source, against the f32 CPU reference",
        |name, about, settings| heights::capsule(name, about, settings.seed),
    ));
    entries
}

/// What else the stage can do.
fn variations() -> Vec<Entry> {
    let of = |domain| Tessellator {
        domain,
        spacing: Spacing::FractionalOdd,
        ..Default::default()
    };
    vec![
        Entry::new(
            "stage-clockwise",
            "Triangles turned round",
            move |name, about, settings| {
                let tessellator = Tessellator {
                    winding: Winding::Cw,
                    ..of(Domain::Triangles)
                };
                let mesh = mesh_of(Domain::Triangles, settings.seed, 7.0);
                record(name, about, &StageCase::flat(tessellator, mesh, POOLS))
            },
        ),
        Entry::new(
            "stage-lowered",
            "Pools that hold a third: all levels are lowered until they fit",
            move |name, about, settings| {
                let mesh = mesh_of(Domain::Triangles, settings.seed, 24.0);
                let case = StageCase::flat(of(Domain::Triangles), mesh, [700, 1400]);
                record(name, about, &case)
            },
        ),
        Entry::new(
            "stage-split-sides",
            "Quads of two sizes beside each other: a side along two edges",
            move |name, about, _| {
                let case = StageCase::flat(of(Domain::Quads), split_mesh(), POOLS);
                record(name, about, &case)
            },
        ),
        Entry::new(
            "stage-amplified",
            "Isolines whose segments a draw turns into 24 triangles each: the arguments of that draw",
            move |name, about, settings| {
                let mesh = mesh_of(Domain::Isolines, settings.seed, 7.0);
                let mut case = StageCase::flat(of(Domain::Isolines), mesh, POOLS);
                case.amplified = 72;
                record(name, about, &case)
            },
        ),
        Entry::new(
            "stage-evaluated",
            "Vertices that the draws evaluate: patch and place of each",
            move |name, about, settings| {
                let mesh = mesh_of(Domain::Quads, settings.seed, 7.0);
                let mut case = StageCase::flat(of(Domain::Quads), mesh, POOLS);
                case.drawing = Drawing::Evaluated;
                record(name, about, &case)
            },
        ),
        Entry::new(
            "stage-discarded",
            "NaN, negative and infinite levels: patches that are taken away, and the greatest level",
            move |name, about, _| {
                let case = StageCase::flat(of(Domain::Triangles), hostile_mesh(), POOLS);
                record(name, about, &case)
            },
        ),
        Entry::new(
            "stage-view",
            "A sphere whose levels follow its size in pixels: lengths, quotients and roots decide",
            move |name, about, _| record(name, about, &globe_case()),
        ),
    ]
}

/// Patches whose sums of products are exact: unit cells, and an octahedron cut in halves.
fn mesh_of(domain: Domain, seed: u32, most: f32) -> PatchMesh {
    let mut random = Random::new(seed);
    let mut level = || random.range(0.3, most);
    if domain == Domain::Triangles {
        let mesh = shapes::octahedron(2);
        let points = mesh
            .points()
            .iter()
            .map(|[x, y, z, _]| [*x, *y, *z, level()]);
        let points = points.collect();
        return PatchMesh::new(PatchLayout::TRIANGLE, points, mesh.indices().to_vec())
            .expect("whole triangles");
    }
    let layout = match domain {
        Domain::Isolines => PatchLayout::lines(4),
        _ => PatchLayout::QUAD,
    };
    let side = 4_u32;
    let points = (0..=side)
        .flat_map(|y| (0..=side).map(move |x| [x as f32, y as f32]))
        .map(|[x, y]| [x, y, 0.0, level()])
        .collect();
    let corner = |x: u32, y: u32| y * (side + 1) + x;
    let indices = (0..side)
        .flat_map(|y| (0..side).map(move |x| (x, y)))
        .flat_map(|(x, y)| {
            [
                corner(x, y),
                corner(x + 1, y),
                corner(x + 1, y + 1),
                corner(x, y + 1),
            ]
        })
        .collect();
    PatchMesh::new(layout, points, indices).expect("whole quads")
}

/// A quad above two of half its size.
fn split_mesh() -> PatchMesh {
    let places: [[f32; 3]; 8] = [
        [0.0, 0.0, 9.4],
        [1.0, 0.0, 3.1],
        [2.0, 0.0, 8.2],
        [0.0, 2.0, 5.3],
        [2.0, 2.0, 6.6],
        [0.0, -1.0, 1.2],
        [1.0, -1.0, 2.7],
        [2.0, -1.0, 0.9],
    ];
    let points = places.map(|[x, y, w]| [x, y, 0.0, w]).to_vec();
    let indices = vec![0, 2, 4, 3, 5, 6, 1, 0, 6, 7, 2, 1];
    let middles = [[WHOLE, 1, WHOLE, WHOLE], [WHOLE; 4], [WHOLE; 4]];
    let layout = PatchLayout::QUAD.with_split_sides();
    PatchMesh::with_middles(layout, points, indices, &middles).expect("halves lie along the side")
}

/// Corners whose levels discard, and one that is beyond all bounds.
fn hostile_mesh() -> PatchMesh {
    let mesh = shapes::octahedron(2);
    let mut points: Vec<_> = mesh
        .points()
        .iter()
        .map(|[x, y, z, _]| [*x, *y, *z, 2.5])
        .collect();
    for (k, level) in [(0, f32::NAN), (4, f32::NEG_INFINITY), (9, 31.0), (14, -1e9)] {
        points[k][3] = level;
    }
    PatchMesh::new(PatchLayout::TRIANGLE, points, mesh.indices().to_vec()).expect("whole triangles")
}

/// A sphere in front of a camera, whose levels are no whole numbers.
fn globe_case() -> StageCase<'static> {
    let tessellator = Tessellator {
        spacing: Spacing::Equal,
        ..Default::default()
    };
    let mut instance = Instance::IDENTITY;
    instance.rows = [
        [1.5, 0.0, 0.0, 100.25],
        [0.0, 1.5, 0.0, 2.0],
        [0.0, 0.0, 1.5, -7.5],
    ];
    instance.params[0][0] = 3.0;
    let view = StageView {
        eye: [0.5, 0.75, 5.0],
        anchor: [100.0, 2.0, -8.0],
        pixels_per_radian: 800.0,
        pixels_per_edge: 24.0,
        camera: 1.0,
        ..open_view()
    };
    StageCase {
        tessellator,
        mesh: shapes::octahedron(2),
        instance,
        pools: [1 << 13, 1 << 14],
        view,
        drawing: Drawing::Stored,
        amplified: 0,
        functions: Some(globe::FUNCTIONS),
        reference: &globe::Globe,
        // `normalize` is 1 / inverseSqrt of a sum of three squares: 2 for the root, 1.5 for the squares'
        // halved relative error, 1 for the product; then 1.5 times that and a sum of two terms.
        tolerance: Tolerance {
            ulp: 8.0,
            scale: 1.5,
            steps: 1,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::super::format::{Command, Header};
    use super::*;

    const SETTINGS: Settings = Settings { seed: 1, count: 50 };

    fn checks(header: &Header) -> usize {
        let check = |c: &&Command| matches!(c, Command::Check { .. } | Command::Digest { .. });
        header.commands.iter().filter(check).count()
    }

    #[test]
    fn every_capsule_is_made_and_read_back_as_it_was() {
        let entries = all();
        let mut names: Vec<_> = entries.iter().map(|entry| &entry.name).collect();
        names.dedup();
        assert_eq!(names.len(), entries.len());
        assert!(entries.len() >= 28, "{}", entries.len());
        for entry in &entries {
            let capsule = entry
                .make(SETTINGS)
                .unwrap_or_else(|error| panic!("{error}"));
            assert!(capsule.header.features.is_empty());
            assert!(checks(&capsule.header) >= 1, "{}", entry.name);
            let bytes = capsule.to_bytes();
            assert_eq!(
                Capsule::from_bytes(&bytes).unwrap(),
                capsule,
                "{}",
                entry.name
            );
            assert!(Capsule::from_bytes(&bytes[1..]).is_err());
            assert!(Capsule::from_bytes(&bytes[..40]).is_err());
        }
    }
}
