//! Runs that go on where they were ended.

use dolomite_fbx_search::run::Property;
use dolomite_fbx_search::total::{ResumeError, run_in_pieces};
use dolomite_fbx_search::{Failure, Seen, Total, run_by};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Every 400th file fails, and every 300th is refused.
const PROPERTY: Property = |_, seed| {
    if seed % 400 == 399 {
        let detail = format!("of {seed}");
        return Err(Failure {
            kind: "test",
            detail,
        });
    }
    Ok(Seen {
        poses: 2,
        refused: (seed % 300 == 299).then(|| "too much".to_owned()),
        worst: 1.0 / (1.0 + (seed % 10) as f64),
    })
};

fn without_times(mut total: Total) -> Total {
    total.slowest.clear();
    total
}

#[test]
fn a_run_that_was_ended_goes_on_and_comes_to_the_same() {
    let folder = std::env::temp_dir().join(format!("dolomite_fbx_total_{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for temporary files");
    let state = folder.join("state.json");
    let go = |build: &str, ends: bool| {
        run_in_pieces(PROPERTY, (0, 1200, 0), &folder, &state, build, |total| {
            assert!(!ends || total.files < 1000, "ended here");
        })
    };
    let ended = catch_unwind(AssertUnwindSafe(|| go("one", true)));
    assert!(ended.is_err() && state.exists());
    assert!(matches!(go("another", false), Err(ResumeError::Other)));
    let on = go("one", false).expect("it goes on");
    assert!(!state.exists());

    let mut whole = Total::default();
    whole.add(&run_by(PROPERTY, 0, 1200, 0, &folder));
    assert_eq!(on.files, 1200);
    assert_eq!(on.refused.len(), 3);
    assert_eq!(on.kinds["test"], 3);
    assert_eq!(on.failed[&799], "seed 799: test: of 799");
    assert_eq!(without_times(on.clone()), without_times(whole));
    let median = on.stated_over_true(0.5);
    assert!((median - 5.0).abs() <= 0.05, "{median}");

    std::fs::write(&state, "{").expect("a file in it");
    assert!(matches!(go("one", false), Err(ResumeError::Broken)));
    std::fs::remove_dir_all(&folder).expect("it is ours");
}
