//! What the patches come to: tallies, rows, figure, summary.

use super::random::Tuple;
use super::rational::{D3D_REACH, D3D_RING_REACH, EXACT_REACH};
use super::rules::{ASKED, RULES, Verdicts};
use crate::csv::{ErrorNumbers, Row};
use crate::plot::{Axes, Chart, Curve};
use crate::study::{Figure, Report};
use crate::tessellators::{DOMAINS, MODES, SPACINGS};
use dolomite_tessellation::{Domain, Mode, Spacing};
use dolomite_testkit::metrics::ErrorStats;
use serde_json::{Map, Value, json};

/// Errors of the coordinates of all patches with some number of segments.
pub struct Sweep {
    /// How coordinates were placed.
    pub mode: Mode,
    /// Of triangles, which have rings; else of quads and isolines, whose vertices lie as on edges.
    pub triangles: bool,
    /// Number of segments.
    pub segments: u32,
    /// Over the vertices of all spacings.
    pub errors: ErrorStats,
}

/// What was found about one patch.
#[derive(Debug, Clone)]
pub struct Found {
    /// It has other numbers of vertices or primitives.
    pub count: bool,
    /// It does not cover its domain once.
    pub cover: bool,
    /// A primitive has the wrong orientation.
    pub winding: bool,
    /// Either of these, where the fixed point of mode `D3d` is known to fold an edge: no fault.
    pub fold: bool,
    /// Which invariance rules hold.
    pub rules: Verdicts,
    /// Its largest error against rational numbers; `None` of another number of vertices.
    pub coordinate_error: Option<f64>,
    /// The adapter gives other bits; `None` if it was not asked.
    pub bits: Option<bool>,
}

/// Faults, summed over patches.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tally {
    /// Patches.
    pub cases: usize,
    /// Patches with other numbers of vertices or primitives.
    pub counts: usize,
    /// Patches that do not cover their domain once.
    pub covers: usize,
    /// Patches with a primitive of the wrong orientation.
    pub windings: usize,
    /// Patches that the fixed point of mode `D3d` folds.
    pub folds: usize,
    /// Patches that break each rule.
    pub rules: [usize; RULES],
    /// Patches that each rule says something about.
    pub rule_cases: [usize; RULES],
    /// Patches with a coordinate farther from its place than its mode may be.
    pub coordinates: usize,
    /// Largest error of a coordinate.
    pub coordinate_error: f64,
    /// Patches of which the adapter gave other bits.
    pub bits: usize,
    /// Patches that the adapter was asked for.
    pub bit_cases: usize,
}

impl Tally {
    /// All faults together.
    pub fn faults(&self) -> usize {
        self.counts
            + self.covers
            + self.windings
            + self.coordinates
            + self.bits
            + self.rules.iter().sum::<usize>()
    }

    fn add(&mut self, other: &Self) {
        self.cases += other.cases;
        self.counts += other.counts;
        self.covers += other.covers;
        self.windings += other.windings;
        self.folds += other.folds;
        for k in 0..RULES {
            self.rules[k] += other.rules[k];
            self.rule_cases[k] += other.rule_cases[k];
        }
        self.coordinates += other.coordinates;
        self.coordinate_error = self.coordinate_error.max(other.coordinate_error);
        self.bits += other.bits;
        self.bit_cases += other.bit_cases;
    }
}

/// Largest error that a coordinate may have.
fn reach(mode: Mode, domain: Domain) -> f64 {
    match (mode, domain) {
        (Mode::Exact, _) => EXACT_REACH,
        (Mode::D3d, Domain::Triangles) => D3D_RING_REACH,
        (Mode::D3d, _) => D3D_REACH,
    }
}

/// Faulty patches that are written down.
const WRITTEN: usize = 12;

/// A tally for every mode, domain and spacing.
pub struct Tallies {
    tallies: Vec<(Mode, Domain, Spacing, Tally)>,
    /// Name of the adapter that gives the bits.
    adapter: Option<String>,
    /// The first faulty patches, in words.
    faulty: Vec<String>,
}

impl Tallies {
    /// Nothing yet.
    pub fn new(adapter: Option<String>) -> Self {
        let mut tallies = Vec::new();
        for mode in MODES {
            for domain in DOMAINS {
                tallies.extend(SPACINGS.map(|spacing| (mode, domain, spacing, Tally::default())));
            }
        }
        Self {
            tallies,
            adapter,
            faulty: Vec::new(),
        }
    }

    /// Adds a patch.
    pub fn add(&mut self, tuple: &Tuple, found: &Found) {
        let set = tuple.tessellator;
        let error = found.coordinate_error.unwrap_or(f64::INFINITY);
        let one = Tally {
            cases: 1,
            counts: found.count.into(),
            covers: found.cover.into(),
            windings: found.winding.into(),
            folds: found.fold.into(),
            rules: found.rules.map(|rule| (rule == Some(false)).into()),
            rule_cases: found.rules.map(|rule| rule.is_some().into()),
            coordinates: (error > reach(set.mode, set.domain)).into(),
            coordinate_error: error,
            bits: (found.bits == Some(true)).into(),
            bit_cases: found.bits.is_some().into(),
        };
        if one.faults() > 0 && self.faulty.len() < WRITTEN {
            self.faulty.push(format!("Faulty: {tuple:?}: {found:?}"));
            eprintln!("tessellation: {tuple:?}: {found:?}");
        }
        let tally = self.tallies.iter_mut().find(|(mode, domain, spacing, _)| {
            (*mode, *domain, *spacing) == (set.mode, set.domain, set.spacing)
        });
        if let Some((.., tally)) = tally {
            tally.add(&one);
        }
    }

    /// All of them together.
    pub fn total(&self) -> Tally {
        self.sum(|_, _| true)
    }

    fn sum(&self, of: impl Fn(Mode, Domain) -> bool) -> Tally {
        let mut sum = Tally::default();
        for (mode, domain, _, tally) in &self.tallies {
            if of(*mode, *domain) {
                sum.add(tally);
            }
        }
        sum
    }
}

fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Exact => "exact",
        Mode::D3d => "d3d",
    }
}

fn vertices_name(triangles: bool) -> &'static str {
    if triangles {
        "triangles"
    } else {
        "quads and isolines"
    }
}

fn kind_name(domain: Domain, spacing: Spacing) -> String {
    let domain = match domain {
        Domain::Triangles => "triangles",
        Domain::Quads => "quads",
        Domain::Isolines => "isolines",
    };
    let spacing = match spacing {
        Spacing::Equal => "equal_spacing",
        Spacing::FractionalEven => "fractional_even_spacing",
        Spacing::FractionalOdd => "fractional_odd_spacing",
    };
    format!("{domain} {spacing}")
}

fn standing_notes() -> Vec<String> {
    [
        "Patches: levels drawn around integers, uniformly in [0.5, 66], as random bits of an f32, \
         zero, huge and denormal; every domain, spacing, winding and mode in turn. Every rule is tried \
         on every patch that it says something about; errors are numbers of patches.",
        "Counts are compared with sums over rings, levels with f64, both written from the \
         specification. cover_failures: the border is the outline, its vertices in order, and the \
         areas sum to the domain's to the bit. winding_failures: a triangle turned over by more than \
         the rounding of its coordinates.",
        "d3d_folds: no fault of the stage's but of the fixed point that mode d3d repeats bit for bit. At \
         even levels hardly above 6 (to 6.0001) and 30 (to 30.0064) the vertex that leaves the middle \
         of an edge starts out up to 7 / 65536 on the other side of it.",
        "In mode d3d a coordinate's true place is that of the level as its 16.16 fixed point reads it.",
        "coordinate_error: largest distance of a coordinate from its place in rational numbers, as a \
         part of the domain's side; rms and p99, by segments, are over vertices.",
    ]
    .map(str::to_owned)
    .to_vec()
}

fn rows(tallies: &Tallies, sweep: &[Sweep]) -> Vec<Row> {
    let mut rows = Vec::new();
    for (place, (mode, domain, spacing, tally)) in tallies.tallies.iter().enumerate() {
        let row = |quantity: String, number: f64, unit: &str, device: &str| Row {
            sweep: "patches".into(),
            method: mode_name(*mode).into(),
            parameter: kind_name(*domain, *spacing),
            parameter_value: (place % 9) as f64,
            quantity,
            error: Some(ErrorNumbers {
                max: number,
                rms: number,
                p99: number,
            }),
            error_unit: unit.into(),
            time_ns: None,
            bytes: None,
            vertices: None,
            hash: None,
            device: device.into(),
        };
        let mut add = |quantity: &str, number: usize, device: &str| {
            rows.push(row(quantity.into(), number as f64, "cases", device));
        };
        add("tuples", tally.cases, "CPU");
        add("count_mismatches", tally.counts, "CPU");
        add("cover_failures", tally.covers, "CPU");
        add("winding_failures", tally.windings, "CPU");
        add("d3d_folds", tally.folds, "CPU");
        add("coordinate_failures", tally.coordinates, "CPU");
        for k in 0..RULES {
            let quantity = format!("rule_{}_violations", k + 1);
            add(&quantity, tally.rules[k], "CPU");
        }
        if let Some(adapter) = &tallies.adapter {
            add("gpu_bit_mismatches", tally.bits, adapter);
        }
        rows.push(Row {
            error: Some(ErrorNumbers {
                max: tally.coordinate_error,
                rms: tally.coordinate_error,
                p99: tally.coordinate_error,
            }),
            ..row(
                "coordinate_error".into(),
                tally.coordinate_error,
                "domain sides",
                "CPU",
            )
        });
    }
    rows.extend(sweep.iter().map(|point| Row {
        sweep: format!("segments, {}", vertices_name(point.triangles)),
        method: mode_name(point.mode).into(),
        parameter: format!("segments={}", point.segments),
        parameter_value: f64::from(point.segments),
        quantity: "coordinate_error".into(),
        error: Some(point.errors.into()),
        error_unit: "domain sides".into(),
        time_ns: None,
        bytes: None,
        vertices: None,
        hash: None,
        device: "CPU".into(),
    }));
    rows
}

fn figure(sweep: &[Sweep]) -> Figure {
    let mut curves = Vec::new();
    for mode in MODES {
        for triangles in [true, false] {
            let mine = |point: &&Sweep| (point.mode, point.triangles) == (mode, triangles);
            curves.push(Curve {
                name: format!("{}, {}", mode_name(mode), vertices_name(triangles)),
                colour: curves.len(),
                points: sweep
                    .iter()
                    .filter(mine)
                    .map(|point| (f64::from(point.segments), point.errors.max))
                    .collect(),
            });
        }
    }
    curves.push(Curve {
        name: "2^-24".into(),
        colour: 8,
        points: vec![(1.0, EXACT_REACH), (64.0, EXACT_REACH)],
    });
    Figure {
        name: "tessellation_coordinate_error".into(),
        caption:
            "Largest error of a coordinate against rational numbers by number of segments, over \
                  all spacings; one level everywhere. Errors of 0 have no place on the \
                  axis: coordinates of 1, 2, 4, ... segments of equal length are exact."
                .into(),
        chart: Chart {
            title: "Error of coordinates against number of segments".into(),
            x_label: "segments of an edge".into(),
            y_label: "largest error (of the domain's side)".into(),
            axes: Axes::Logarithmic,
            curves,
        },
    }
}

fn summary(tallies: &Tallies, sweep: &[Sweep]) -> Value {
    let total = tallies.total();
    let by_rule = |numbers: [usize; RULES]| {
        let numbered = (1..).zip(numbers);
        let object: Map<String, Value> =
            numbered.map(|(k, n)| (format!("{k}"), json!(n))).collect();
        object
    };
    let worst = |mode: Mode, with_triangles: bool| {
        let counts = |triangles: bool| with_triangles || !triangles;
        let of_patches = tallies
            .sum(|of, domain| of == mode && counts(domain == Domain::Triangles))
            .coordinate_error;
        let points = sweep
            .iter()
            .filter(|point| point.mode == mode && counts(point.triangles));
        let worst = points.map(|p| p.errors.max).fold(of_patches, f64::max);
        // Infinity, which JSON does not have, stands for vertices without a place.
        if worst.is_finite() {
            json!(worst)
        } else {
            json!("inf")
        }
    };
    let asked: Map<String, Value> = (1..)
        .zip(ASKED)
        .map(|(k, rule)| (format!("{k}"), json!(rule)))
        .collect();
    json!({
        "tuples": total.cases,
        "count_mismatches": total.counts,
        "cover_failures": total.covers,
        "winding_failures": total.windings,
        "d3d_folds": total.folds,
        "coordinate_failures": total.coordinates,
        "rule_violations": by_rule(total.rules),
        "rule_cases": by_rule(total.rule_cases),
        "rules": asked,
        "gpu_bit_mismatches": tallies.adapter.as_ref().map(|_| total.bits),
        "gpu_cases": total.bit_cases,
        "exact_error_max": worst(Mode::Exact, true),
        "exact_error_reach": EXACT_REACH,
        "d3d_error_max": worst(Mode::D3d, true),
        "d3d_error_reach": D3D_RING_REACH,
        "d3d_edge_error_max": worst(Mode::D3d, false),
        "d3d_edge_error_reach": D3D_REACH,
        "adapter": tallies.adapter,
    })
}

/// Puts everything together.
pub fn report(tallies: Tallies, sweep: &[Sweep], notes: Vec<String>) -> Report {
    let mut all = standing_notes();
    all.extend(notes);
    all.extend(tallies.faulty.iter().cloned());
    Report {
        study: "tessellation",
        rows: rows(&tallies, sweep),
        figures: vec![figure(sweep)],
        notes: all,
        summary: summary(&tallies, sweep),
    }
}
