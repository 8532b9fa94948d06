//! Every kind of patches of an example is among those whose shaders Tint compiles (`tests/all/tint/examples.rs`).

use crate::texts::{all_texts, ending};

/// Names of the types that a text implements `PatchKind` for.
fn kinds(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .filter_map(|line| line.strip_prefix("impl PatchKind for "))
        .map(|rest| rest.trim_end_matches([' ', '{']))
}

/// Those of `examples` (path and text) that `list` does not compile.
fn missing<'a>(examples: impl Iterator<Item = (&'a str, &'a str)>, list: &str) -> Vec<String> {
    examples
        .flat_map(|(path, text)| {
            let module = path.rsplit('/').next().unwrap_or_default();
            let module = module.trim_end_matches(".rs").to_owned();
            kinds(text).map(move |kind| format!("{module}::{kind}"))
        })
        .filter(|kind| !list.contains(&format!("stage_variants::<{kind}>()")))
        .collect()
}

#[test]
fn tint_compiles_the_functions_of_every_example() {
    let texts = all_texts();
    let list = texts
        .iter()
        .find(|file| file.path == "tests/all/tint/examples.rs");
    let list = &list.expect("the list of examples").text;
    let examples: Vec<_> = texts
        .iter()
        .filter(|file| file.path.contains("examples/") && ending(&file.path) == Some("rs"))
        .map(|file| (file.path.as_str(), file.text.as_str()))
        .collect();
    let all: usize = examples.iter().map(|(_, text)| kinds(text).count()).sum();
    assert!(all >= 7, "only {all} kinds were found");
    let missing = missing(examples.into_iter(), list);
    assert!(missing.is_empty(), "Tint does not compile {missing:?}");
}

#[test]
fn a_kind_that_is_not_listed_is_found() {
    let example = ("examples/new.rs", "impl PatchKind for New {\n}\n");
    let found = missing([example].into_iter(), "stage_variants::<old::Old>()");
    assert_eq!(found, ["new::New"]);
}
