//! The permutation preset against the reference surface of the literature's comparisons, where the
//! shared data folder is at hand.

use bevy::math::DVec2;
use dolomite_terrain::{GroundPoint, PermutationNoise};
use std::path::{Path, PathBuf};

/// The shared data: `DOLOMITE_SHARED`, or `shared` beside the repository.
fn shared(file: &str) -> PathBuf {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    std::env::var_os("DOLOMITE_SHARED")
        .map_or_else(beside, PathBuf::from)
        .join(file)
}

#[test]
fn seed_1_is_the_reference_surface() {
    let path = shared("data/classic/heights_1024_f32le.raw");
    let Ok(bytes) = std::fs::read(&path) else {
        assert!(
            std::env::var_os("DOLOMITE_REQUIRE_SHARED").is_none(),
            "{} is missing, though the shared data are there",
            path.display()
        );
        eprintln!(
            "skipped: {} is missing; set DOLOMITE_SHARED",
            path.display()
        );
        return;
    };
    let (reference, rest) = bytes.as_chunks::<4>();
    assert_eq!((reference.len(), rest.len()), (1024 * 1024, 0));
    let classic = PermutationNoise {
        amplitude: 0.9,
        ..PermutationNoise::default()
    }
    .prepare()
    .expect("valid");
    let mut largest = 0.0_f64;
    // Every third sample: 350 000 of them, all rows and columns in turn.
    for at in (0..reference.len()).step_by(3) {
        let xz = DVec2::new((at % 1024) as f64, (at / 1024) as f64) * 1.25;
        let expected = f64::from(f32::from_le_bytes(reference[at]));
        largest = largest.max((classic.sample_f64(xz).height - expected).abs());
        let near = f64::from(classic.sample(GroundPoint::new(xz)).value);
        // The evaluator's own error (1e-5 of 0.9) and the reference's.
        assert!((near - expected).abs() < 1.2e-5, "{xz}: {near} {expected}");
    }
    println!("largest difference {largest:.2e}");
    // The reference is f32 up to 1.1 high and its last rounding 6e-8; the rest is how it was computed.
    assert!(largest < 2e-6, "{largest:e}");
}
