//! Cases from the field, each against what is right for it.

use dolomite_fbx_search::field::{CASES, folder};
use serde_json::json;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What came of a case.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Held {
    /// Name of its file without the ending.
    pub(super) file: &'static str,
    /// What is not right.
    pub(super) wrong: Option<String>,
}

/// Holds all cases and prints a line for each; none where the shared data lacks them, which is noted.
pub(super) fn held(notes: &mut Vec<String>) -> Vec<Held> {
    let Some(folder) = folder() else {
        notes
            .push("cases from the field are left out: no data/field/fbx in the shared data".into());
        return Vec::new();
    };
    let hold = |case: &dolomite_fbx_search::field::Case| {
        let held = catch_unwind(AssertUnwindSafe(|| case.hold(&folder)));
        let wrong = held.unwrap_or_else(|_| Err("a panic".into())).err();
        println!(
            "{}",
            json!({ "case": case.file, "ok": wrong.is_none(), "right": case.right, "wrong": wrong })
        );
        Held {
            file: case.file,
            wrong,
        }
    };
    CASES.iter().map(hold).collect()
}
