//! The tessellation stage against captures of a real tessellator.

use dolomite_lab::studies::tessellation::captures::compare;
use dolomite_lab::studies::tessellation::cases::read;
use dolomite_lab::studies::tessellation::check::{Faults, against_capture};
use dolomite_tessellation::{Mode, Primitives, Tessellator};
use std::path::Path;

fn captures() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/gl45.jsonl")
}

fn faults(mode: Mode) -> Faults {
    let mut all = Faults::default();
    for case in read(&captures()).expect("captures") {
        let tessellator = Tessellator {
            mode,
            ..case.tessellator
        };
        let patch = tessellator.tessellate_fixed(&case.levels);
        let found = against_capture(&case, mode, &patch);
        if !found.none() {
            eprintln!("{tessellator:?} {:?}: {found:?}", case.levels);
        }
        all.add(&found);
    }
    all
}

#[test]
fn the_cpu_reference_agrees_with_captures() {
    for mode in [Mode::Exact, Mode::D3d] {
        let found = faults(mode);
        assert!(found.none(), "{mode:?}: {found:?}");
    }
}

#[test]
fn d3d_mode_has_the_printed_digits() {
    // Seven digits after the point, and 2^-16 steps lie 1.5e-5 apart: half of the last digit.
    assert!(faults(Mode::D3d).max_coordinate_error <= 5.01e-8);
}

#[test]
fn gpu_agrees_with_captures() {
    if dolomite_testkit::gpu::for_test().is_none() {
        return;
    }
    let report = compare(&captures()).expect("an adapter");
    assert_eq!(report["cases"], 300);
    assert_eq!(report["cases_with_other_bits_on_the_gpu"], 0);
    for target in ["cpu", "gpu"] {
        for key in [
            "count_mismatches",
            "coordinate_mismatches",
            "cover_failures",
            "winding_failures",
        ] {
            assert_eq!(report[target][key], 0, "{target} {key}");
        }
    }
}

/// The comparison sees what is wrong: a missing triangle, a moved vertex, a turned triangle.
#[test]
fn wrong_answers_are_seen() {
    let case = read(&captures())
        .expect("captures")
        .into_iter()
        .find(|case| {
            !case.primitives.is_empty()
                && case.primitives[0].len() == 3
                && case.primitives.len() > 8
        });
    let case = case.expect("a case with triangles");
    let mode = Mode::D3d;
    let tessellator = Tessellator {
        mode,
        ..case.tessellator
    };
    let good = tessellator.tessellate_fixed(&case.levels);
    assert!(against_capture(&case, mode, &good).none());
    let triangles = good.1.triangles().to_vec();

    let fewer = Primitives::Triangles(triangles[1..].to_vec());
    let found = against_capture(&case, mode, &(good.0.clone(), fewer));
    assert_eq!((found.count_mismatches, found.cover_failures), (1, 1));

    let mut moved = good.clone();
    moved.0[0][0] ^= 1 << 20;
    let found = against_capture(&case, mode, &moved);
    assert!(found.coordinate_mismatches >= 1 && found.cover_failures == 1);

    let mut turned = triangles;
    turned[0].swap(1, 2);
    let found = against_capture(&case, mode, &(good.0, Primitives::Triangles(turned)));
    assert_eq!((found.winding_failures, found.cover_failures), (1, 1));
}
