//! The study: random patches against what the specification asks, and coordinates against rational
//! numbers.

use super::check::{Patch, covers, is_wound};
use super::expected::expected;
use super::random::{Tuple, Tuples};
use super::rational;
use super::report::{Found, Sweep, Tallies};
use super::rules::{Verdicts, verdicts};
use super::wgsl::Adapter;
use crate::study::{Asked, Options, Report, Study};
use crate::tessellators::{DOMAINS, MODES, SPACINGS};
use dolomite_tessellation::place::UNIT;
use dolomite_tessellation::{Domain, Levels, Mode, Tessellator};
use dolomite_testkit::cores::on_all_cores;
use dolomite_testkit::metrics::ErrorStats;
use dolomite_testkit::random::Random;
use std::time::{Duration, Instant};

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "tessellation",
    about: "the tessellation stage: counts, cover, invariance rules, WGSL bits, coordinates",
    run,
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 6] = [
    Asked {
        what: "Random patches",
        asked: "",
        at: "/tuples",
        unit: "patches",
    },
    Asked {
        what: "Patches with another count of vertices or primitives than the specification",
        asked: "0",
        at: "/count_mismatches",
        unit: "patches",
    },
    Asked {
        what: "Patches that do not cover their domain once",
        asked: "0",
        at: "/cover_failures",
        unit: "patches",
    },
    Asked {
        what: "Patches wound otherwise",
        asked: "0",
        at: "/winding_failures",
        unit: "patches",
    },
    Asked {
        what: "Patches that the adapter gives other bits for",
        asked: "0",
        at: "/gpu_bit_mismatches",
        unit: "patches",
    },
    Asked {
        what: "Error of a coordinate, mode `exact`",
        asked: "≤ 2⁻²⁴",
        at: "/exact_error_max",
        unit: "of the side",
    },
];

/// Patches that are held at once.
const BATCH: usize = 1024;

/// Time between two lines of progress.
const PROGRESS: Duration = Duration::from_secs(3);

/// Most segments.
const MOST: u32 = 64;

/// What was found about a patch, and the patch.
struct Examined {
    patch: Patch,
    found: Found,
}

fn run(options: &Options) -> Report {
    let mut notes = Vec::new();
    let mut adapter = match Adapter::open() {
        Ok(adapter) => Some(adapter),
        Err(reason) => {
            notes.push(format!("The WGSL is left out: {reason}"));
            None
        }
    };
    let mut tallies = Tallies::new(adapter.as_ref().map(|a| a.name().to_owned()));
    let mut source = Tuples::new(options.seed);
    let (start, mut told) = (Instant::now(), Instant::now());
    let mut done = 0;
    while done < options.samples {
        let count = BATCH.min(options.samples - done);
        let batch: Vec<Tuple> = source.by_ref().take(count).collect();
        let mut examined = on_all_cores(&batch, examine);
        if let Some(opened) = &adapter
            && let Err(reason) = compare(opened, &batch, &mut examined)
        {
            notes.push(format!(
                "The WGSL is left out from patch {done} on: {reason}"
            ));
            adapter = None;
        }
        for (tuple, examined) in batch.iter().zip(&examined) {
            tallies.add(tuple, &examined.found);
        }
        done += count;
        if told.elapsed() > PROGRESS || done == options.samples {
            told = Instant::now();
            eprintln!(
                "tessellation: {done} of {} patches, {} faults, {:.0} s",
                options.samples,
                tallies.total().faults(),
                start.elapsed().as_secs_f64()
            );
        }
    }
    let sweep = sweep(options);
    super::report::report(tallies, &sweep, notes)
}

/// Everything that the CPU is asked about one patch.
fn examine(tuple: &Tuple) -> Examined {
    let stage = |tessellator: &Tessellator, levels: &Levels| tessellator.tessellate_fixed(levels);
    let patch = stage(&tuple.tessellator, &tuple.levels);
    let mut found = faults(tuple, &patch, verdicts(tuple, &patch, stage));
    // The same patch in floating point is the same output.
    let floating = tuple.tessellator.tessellate(&tuple.levels);
    let same = floating.primitives == patch.1
        && floating.coordinates.len() == patch.0.len()
        && floating
            .coordinates
            .iter()
            .zip(&patch.0)
            .all(|(one, other)| {
                (0..3).all(|k| f64::from(one[k]) * f64::from(UNIT) == f64::from(other[k]))
            });
    found.rules[0] = found.rules[0].map(|holds| holds && same);
    Examined { patch, found }
}

/// What is wrong with a patch; the adapter has not been asked yet.
pub(super) fn faults(tuple: &Tuple, patch: &Patch, rules: Verdicts) -> Found {
    let Tuple {
        tessellator,
        levels,
        ..
    } = tuple;
    let expected = expected(tessellator, levels);
    let counts = expected.map_or([0, 0], |expected| expected.counts());
    let right_counts = [patch.0.len(), patch.1.len()] == counts.map(|count| count as usize);
    // Indices are read before anything else is asked of them.
    let joined = patch.1.triangles().as_flattened();
    let usable = joined
        .iter()
        .all(|vertex| (*vertex as usize) < patch.0.len());
    let errors = rational::errors(tuple, &patch.0);
    let cover = !usable || !covers(tessellator, levels, patch);
    let winding = !usable || !is_wound(tessellator, patch);
    let folds = usable && expected.is_some_and(|expected| expected.folds(tessellator));
    Found {
        count: !right_counts,
        cover: cover && !folds,
        winding: winding && !folds,
        fold: folds && (cover || winding),
        rules,
        coordinate_error: errors.map(|errors| errors.into_iter().fold(0.0, f64::max)),
        bits: None,
    }
}

/// Tessellates the batch on the adapter and marks the patches that come out otherwise.
fn compare(
    adapter: &Adapter,
    batch: &[Tuple],
    examined: &mut [Examined],
) -> Result<(), dolomite_testkit::gpu::GpuError> {
    let patches: Vec<(Tessellator, Levels)> =
        batch.iter().map(|t| (t.tessellator, t.levels)).collect();
    adapter.tessellate(&patches, |k, ours| {
        examined[k].found.bits = Some(ours != examined[k].patch);
    })
}

/// Levels 1 to 64 in steps of 1/7, and random ones between.
fn sweep_levels(options: &Options) -> Vec<f32> {
    let mut random = Random::new(options.seed);
    let count = (options.samples / 64).clamp(64, 1024);
    let sevenths = (7..=7 * MOST).map(|k| k as f32 / 7.0);
    let between = (0..count).map(|_| (1.0 + 63.0 * random.unit()) as f32);
    sevenths.chain(between).collect()
}

/// Errors of all vertices of patches with one level everywhere, by mode and number of segments.
fn sweep(options: &Options) -> Vec<Sweep> {
    let levels = sweep_levels(options);
    let items: Vec<(Mode, bool, u32)> = MODES
        .into_iter()
        .flat_map(|mode| [(mode, true), (mode, false)])
        .flat_map(|(mode, triangles)| (1..=MOST).map(move |n| (mode, triangles, n)))
        .collect();
    eprintln!("tessellation: coordinates of {} levels", levels.len());
    let of_segments = |&(mode, triangles, segments): &(Mode, bool, u32)| {
        let mut errors = Vec::new();
        let domains = DOMAINS
            .into_iter()
            .filter(|domain| (*domain == Domain::Triangles) == triangles);
        let kinds: Vec<_> = domains.flat_map(|d| SPACINGS.map(|s| (d, s))).collect();
        for level in &levels {
            for &(domain, spacing) in &kinds {
                let tessellator = Tessellator {
                    domain,
                    spacing,
                    mode,
                    ..Default::default()
                };
                let mut tuple = uniform(tessellator, *level);
                if domain == Domain::Isolines {
                    // The number of lines has a spacing of its own.
                    tuple.levels.outer[0] = segments as f32;
                }
                let counted = expected(&tuple.tessellator, &tuple.levels);
                // Side 1 follows the spacing in every domain.
                if counted.is_some_and(|e| e.outer[1].segments == segments) {
                    let patch = tuple.tessellator.tessellate_fixed(&tuple.levels);
                    let found = rational::errors(&tuple, &patch.0);
                    errors.extend(found.unwrap_or_else(|| vec![f64::INFINITY]));
                }
            }
        }
        ErrorStats::of(errors)
    };
    items
        .iter()
        .zip(on_all_cores(&items, of_segments))
        .filter_map(|(&(mode, triangles, segments), errors)| {
            Some(Sweep {
                mode,
                triangles,
                segments,
                errors: errors?,
            })
        })
        .collect()
}

fn uniform(tessellator: Tessellator, level: f32) -> Tuple {
    let levels = Levels::uniform(level);
    Tuple {
        tessellator,
        levels,
        others: levels,
        side: 0,
        other_side: 1,
    }
}

/// How often each rule is broken by patches that `stage` made in place of the real one.
#[cfg(test)]
pub(super) fn violations_of(
    count: usize,
    stage: impl Fn(&Tessellator, &Levels) -> Patch,
) -> [usize; super::rules::RULES] {
    let mut tallies = Tallies::new(None);
    for tuple in Tuples::new(1).take(count) {
        let patch = stage(&tuple.tessellator, &tuple.levels);
        let rules = verdicts(&tuple, &patch, &stage);
        tallies.add(&tuple, &faults(&tuple, &patch, rules));
    }
    tallies.total().rules
}

#[cfg(test)]
mod tests {
    use super::super::rules::RULES;
    use super::*;
    use dolomite_tessellation::Primitives;
    use serde_json::Value;

    /// A small run of the whole study finds nothing wrong.
    #[test]
    fn gpu_small_run_finds_no_fault() {
        let report = run(&Options {
            samples: 1500,
            ..Options::default()
        });
        let summary = &report.summary;
        if summary["adapter"] == Value::Null {
            let reasons = report.notes.join("; ");
            assert!(
                std::env::var_os("CI").is_none(),
                "CI must not skip the WGSL: {reasons}"
            );
            eprintln!("skipped: the WGSL ({reasons})");
        } else {
            assert_eq!(summary["gpu_bit_mismatches"], 0);
            assert_eq!(summary["gpu_cases"], 1500);
        }
        assert_eq!(summary["tuples"], 1500);
        for key in [
            "count_mismatches",
            "cover_failures",
            "winding_failures",
            "coordinate_failures",
        ] {
            assert_eq!(summary[key], 0, "{key}: {:?}", report.notes);
        }
        for rule in 1..=RULES {
            let rule = rule.to_string();
            assert_eq!(
                summary["rule_violations"][&rule], 0,
                "rule {rule}: {:?}",
                report.notes
            );
            assert!(
                summary["rule_cases"][&rule].as_u64() > Some(300),
                "rule {rule}"
            );
        }
        let error = |key: &str| summary[key].as_f64().unwrap();
        assert!(
            error("exact_error_max") > 0.0 && error("exact_error_max") <= 1.0 / f64::from(UNIT)
        );
        // The study has to show that it sees the fixed point.
        assert!(error("d3d_edge_error_max") > 1.8e-4);
        assert!(error("d3d_edge_error_max") <= rational::D3D_REACH);
        assert!(error("d3d_error_max") > error("d3d_edge_error_max"));
        assert!(error("d3d_error_max") <= rational::D3D_RING_REACH);
        let folder =
            std::env::temp_dir().join(format!("dolomite_lab_tessellation_{}", std::process::id()));
        assert_eq!(report.write(&folder).unwrap().len(), 2);
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn gpu_other_bits_are_seen() {
        if dolomite_testkit::gpu::for_test().is_none() {
            return;
        }
        let batch: Vec<Tuple> = Tuples::new(3).take(40).collect();
        let mut examined: Vec<Examined> = batch.iter().map(examine).collect();
        let moved = examined.iter_mut().rfind(|e| !e.patch.0.is_empty());
        moved.expect("some are not discarded").patch.0[0][0] ^= 1;
        compare(&Adapter::open().unwrap(), &batch, &mut examined).unwrap();
        let other = examined.iter().filter(|e| e.found.bits == Some(true));
        assert_eq!(other.count(), 1);
    }

    fn triangles(patch: &mut Patch) -> &mut Vec<[u32; 3]> {
        match &mut patch.1 {
            Primitives::Triangles(triangles) => triangles,
            Primitives::Segments(_) => panic!("triangles are asked for"),
        }
    }

    #[test]
    fn wrong_patches_are_seen() {
        let tuple = uniform(Tessellator::default(), 5.3);
        let good = tuple.tessellator.tessellate_fixed(&tuple.levels);
        let seen = |change: &dyn Fn(&mut Patch)| {
            let mut patch = good.clone();
            change(&mut patch);
            let found = faults(&tuple, &patch, [None; RULES]);
            (found.count, found.cover, found.winding)
        };
        assert_eq!(seen(&|_| ()), (false, false, false));
        assert_eq!(
            seen(&|patch| triangles(patch).truncate(3)),
            (true, true, false)
        );
        assert_eq!(
            seen(&|patch| triangles(patch)[3].swap(0, 1)),
            (false, true, true)
        );
        assert_eq!(
            seen(&|patch| triangles(patch)[3][0] = 1 << 20),
            (false, true, true)
        );
        assert_eq!(
            seen(&|patch| patch.0.push([0, 0, UNIT])),
            (true, false, false)
        );
        // A discarded patch must have nothing.
        let discarded = Tuple {
            levels: Levels::uniform(-1.0),
            ..tuple
        };
        let found = faults(&discarded, &good, [None; RULES]);
        assert!(found.count && found.cover);
    }
}
