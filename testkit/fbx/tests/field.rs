//! Cases from the field.

use dolomite_fbx_search::field::{CASES, folder};

#[test]
fn every_case_from_the_field_is_right() {
    let Some(folder) = folder() else {
        assert!(
            std::env::var_os("CI").is_none(),
            "no data/field/fbx in the shared data"
        );
        eprintln!("skipped: no data/field/fbx; set DOLOMITE_SHARED");
        return;
    };
    let wrong: Vec<String> = CASES
        .iter()
        .filter_map(|case| {
            Some(format!(
                "\n{}: {}; right: {}",
                case.file,
                case.hold(&folder).err()?,
                case.right
            ))
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.concat());
}
