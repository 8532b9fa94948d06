//! What the city promises, counted and printed as JSON; `CITY_SAMPLES` says over how many samples of the error.

use crate::promised::{Effort, numbers};

#[test]
fn what_is_promised_is_kept() {
    let samples = std::env::var("CITY_SAMPLES")
        .ok()
        .and_then(|text| text.parse().ok());
    let effort = Effort {
        sides: 1_000_000,
        samples: samples.unwrap_or(100_000),
        repeats: 9,
    };
    let found = numbers(1, effort);
    println!("{found:#}");
    for (at, most) in [
        ("/seams/differing_bits", 0.0),
        ("/borders/displaced", 0.0),
        ("/borders/sloped", 0.0),
        ("/error_above_tolerance", 0.0),
        ("/boxes/outside", 0.0),
        ("/tubes/twist_deg", 0.1),
        ("/tubes/not_finite", 0.0),
        ("/bytes/block_record", 64.0),
    ] {
        let number = found.pointer(at).and_then(serde_json::Value::as_f64);
        assert!(number.is_some_and(|n| n <= most), "{at}: {number:?}");
    }
    assert_eq!(found["same_bits"], true);
    assert!(found["seams"]["points"].as_u64() >= Some(1_000_000));
}
