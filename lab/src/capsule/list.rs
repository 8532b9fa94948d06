//! What capsules there are.

use std::path::Path;

use dolomite_ground::detail::Metric;
use dolomite_tessellation::{Domain, Drawing, Mode, Spacing, Tessellator, Winding};

use super::format::Capsule;
use super::meshes::{globe_case, hostile_mesh, mesh_of, split_mesh};
use super::stage::{StageCase, record};
use super::{CapsuleError, blocks, functions, heights, patches, plants, skinning, tiles};
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

    /// Whether CI plays it.
    #[must_use]
    pub fn is_short(&self) -> bool {
        SHORT.contains(&self.name.as_str())
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
    entries.extend(others());
    entries
}

/// What CI plays: every domain, spacing and mode, and every kind of check; the rest differs by definitions alone.
const SHORT: &[&str] = &[
    "stage-triangles-odd-exact",
    "stage-quads-even-d3d",
    "stage-isolines-equal-exact",
    "stage-view",
    "captures",
    "heights",
    "ground-culled",
    "plants",
    "light-tiles",
    "crowd",
];

/// The parts that draw beside the stage.
fn others() -> Vec<Entry> {
    let ground = |name: &str, about: &str, metric: Metric, culled: bool| {
        Entry::new(name, about, move |name, about, settings| {
            blocks::capsule(name, about, (metric, culled, settings.seed))
        })
    };
    vec![
        ground(
            "ground-error",
            "The ground's choice in blocks by error in pixels, made from nothing on, and its answers to height queries",
            Metric::ErrorBound { pixels: 6.0 },
            false,
        ),
        ground(
            "ground-length",
            "The ground's choice in blocks by length of edges, made from nothing on, and its answers to height queries",
            Metric::EdgeLength { pixels: 60.0 },
            false,
        ),
        ground(
            "ground-culled",
            "The same by error in pixels, with the triangles left out that the picture does not show",
            Metric::ErrorBound { pixels: 6.0 },
            true,
        ),
        Entry::new(
            "plants",
            "Roots of a lattice on triangles: each in one of them, thinned by distance",
            |name, about, settings| plants::capsule(name, about, settings.seed),
        ),
        Entry::new(
            "light-tiles",
            "Which lights reach which tile of a picture",
            |name, about, settings| tiles::capsule(name, about, settings.seed),
        ),
        Entry::new(
            "crowd",
            "Vertices of a crowd's figures, skinned from its palette",
            |name, about, settings| skinning::capsule(name, about, settings.seed),
        ),
    ]
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
            move |name, about, _| record(name, about, &globe_case(2, [1 << 13, 1 << 14], 24.0)),
        ),
        Entry::new(
            "stage-large",
            "The same with a hundred thousand triangles: what browsers are timed with",
            move |name, about, _| record(name, about, &globe_case(4, [1 << 17, 1 << 18], 5.4)),
        ),
    ]
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
        assert!(entries.len() >= 35, "{}", entries.len());
        let short = entries.iter().filter(|entry| entry.is_short()).count();
        assert_eq!(short, SHORT.len(), "each of them is there");
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
