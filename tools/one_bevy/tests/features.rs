//! One Bevy for all: whatever is built or tested here asks for the same features of the same crates, so that
//! cargo compiles each of them once.
//!
//! Cargo is asked what it would build (`cargo tree`, nothing is compiled). The features of a crate for the
//! machine that compiles (build scripts, procedural macros) may differ from those for the program, so a crate
//! may have two sets of features, but these two have to be the same in every selection.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// A crate with its version, and the sets of features that it is compiled with.
type Units = BTreeMap<String, BTreeSet<String>>;

/// What people and CI build: a name, the packages, and whether tests and examples are among it. The tests of each
/// plugin come to these.
const SELECTIONS: [(&str, &[&str], bool); 6] = [
    ("Bevy alone", &["-p", "dolomite_one_bevy"], false),
    ("./scripts/play", &["-p", "dolomite_game"], false),
    ("the lab", &["-p", "dolomite_lab"], false),
    ("the workspace", &["--workspace"], false),
    (
        "the game's tests and examples",
        &["-p", "dolomite_game"],
        true,
    ),
    ("the lab's tests", &["-p", "dolomite_lab"], true),
];

/// What tests and studies share is taken in parts, so that the tests of one plugin do not compile the others;
/// it stands below tests and the lab alone.
const IN_PARTS: &str = "dolomite_testkit ";

/// What a plugin may name of Bevy stands in these two: they are a plugin's own where it is compiled by itself.
const BEVY_ITSELF: [&str; 2] = ["bevy ", "bevy_internal "];

/// Sound on the system's device: its crates are compiled for it alone, and none of them stands below Bevy.
const DEVICE: &str = "device";

/// The names of the packages below `plugins/`, each with the names of its features.
fn plugins() -> Vec<(String, Vec<String>)> {
    let folders = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../../plugins"))
        .expect("plugins/ is a folder");
    let mut names: Vec<_> = folders
        .map(|folder| {
            folder
                .expect("plugins/ can be read")
                .path()
                .join("Cargo.toml")
        })
        .filter(|manifest| manifest.exists())
        .map(|manifest| {
            let text = std::fs::read_to_string(&manifest).expect("a manifest is UTF-8");
            let name = text
                .lines()
                .find_map(|line| line.strip_prefix("name = \"")?.strip_suffix('"'));
            let name = name.unwrap_or_else(|| panic!("{} has no name", manifest.display()));
            let features = text
                .lines()
                .skip_while(|line| *line != "[features]")
                .skip(1)
                .take_while(|line| !line.starts_with('['))
                .filter_map(|line| Some(line.split_once(" = ")?.0.to_owned()))
                .filter(|feature| feature != "default" && feature != DEVICE);
            (name.to_owned(), features.collect())
        })
        .collect();
    names.sort();
    assert!(names.len() >= 6, "{names:?}");
    names
}

/// The lines of `cargo tree -f '{p} {f}' --prefix none`: name, version, perhaps a path in brackets or a star
/// for what was printed before, and the features.
fn units(tree: &str) -> Units {
    let mut units = Units::new();
    for line in tree.lines().filter(|line| !line.is_empty()) {
        let mut words = line.splitn(3, ' ');
        let name = format!(
            "{} {}",
            words.next().expect("splitting gives one part at least"),
            words.next().unwrap_or("")
        );
        let mut features = words.next().unwrap_or("").trim_end_matches("(*)").trim();
        while let Some((_, rest)) = features
            .starts_with('(')
            .then(|| features.split_once(')'))
            .flatten()
        {
            features = rest.trim();
        }
        units.entry(name).or_default().insert(features.to_owned());
    }
    units
}

/// A line for each crate that `some` compiles with features which `all` does not compile it with.
fn differences(all: &Units, some: &Units) -> Vec<String> {
    let none = BTreeSet::new();
    let mut lines = Vec::new();
    for (name, sets) in some {
        let known = all.get(name).unwrap_or(&none);
        for set in sets.difference(known) {
            lines.push(format!("{name}: [{set}], elsewhere {known:?}"));
        }
    }
    lines
}

fn cargo_tree(packages: &[&str], tests: bool) -> Units {
    let edges = if tests {
        "normal,build,dev"
    } else {
        "normal,build"
    };
    let output = Command::new(env!("CARGO"))
        .args(["tree", "--locked", "--offline", "--prefix", "none"])
        .args(["-f", "{p} {f}", "-e", edges])
        .args(packages)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
        .output()
        .expect("cargo can be started");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    let units = units(std::str::from_utf8(&output.stdout).expect("cargo prints UTF-8"));
    assert!(
        units.keys().any(|name| name.starts_with("bevy_ecs ")),
        "no Bevy: {units:?}"
    );
    units
}

#[test]
fn every_selection_builds_the_same_crates() {
    let all = cargo_tree(&["--workspace"], true);
    println!("the workspace with its tests: {} crates", all.len());
    let mut lines = Vec::new();
    let mut compare = |name: &str, some: &Units| {
        println!("{name}: {} crates", some.len());
        for line in differences(&all, some) {
            if !line.starts_with(IN_PARTS) {
                lines.push(format!("{name}: {line}"));
            }
        }
    };
    for (name, packages, tests) in SELECTIONS {
        compare(name, &cargo_tree(packages, tests));
    }
    for (plugin, _) in plugins() {
        compare(
            &format!("tests of {plugin}"),
            &cargo_tree(&["-p", &plugin], true),
        );
    }
    assert!(
        lines.is_empty(),
        "these are compiled once more; tools/one_bevy/Cargo.toml has to ask for their features:\n{}",
        lines.join("\n")
    );
}

/// A plugin by itself, with none and with all of its features, beside the parts of Bevy (`tools/bevy_parts`): only what it may
/// name of Bevy is its own, so that `.ci/run` compiles Bevy's own crates once for all plugins. It has no features of tests.
#[test]
fn a_plugin_alone_compiles_nothing_of_bevy_but_its_names() {
    let all = cargo_tree(&["--workspace"], true);
    let mut lines = Vec::new();
    let mut with_features = 0;
    let mut others = 0;
    for (plugin, features) in plugins() {
        let features = features.join(",");
        with_features += usize::from(!features.is_empty());
        let both = ["-p", &plugin, "-p", "dolomite_bevy_parts"];
        let none = both.into_iter().chain(["--no-default-features"]);
        let with = none.clone().chain(["--features", &features]);
        for packages in [none.collect::<Vec<_>>(), with.collect()] {
            for line in differences(&all, &cargo_tree(&packages, false)) {
                if BEVY_ITSELF.iter().any(|own| line.starts_with(own)) {
                    others += 1;
                } else if !line.starts_with("dolomite") {
                    lines.push(format!("{}: {line}", packages.join(" ")));
                }
            }
        }
    }
    lines.sort();
    lines.dedup();
    assert!(
        lines.is_empty(),
        "these are compiled once more; tools/bevy_parts/Cargo.toml has to ask for their features:\n{}",
        lines.join("\n")
    );
    // Plugins ask for less than everything, and have features: else nothing was compared.
    assert!(
        others > 10 && with_features > 5,
        "{others}, {with_features}"
    );
}

/// Bevy itself has one set of features, for no build script or macro uses it.
#[test]
fn bevy_has_one_set_of_features() {
    let all = cargo_tree(&["--workspace"], true);
    for (name, sets) in &all {
        // What macros are made of is compiled for the machine that compiles.
        let macros = ["bevy_macro_utils ", "bevy_platform "];
        if name.starts_with("bevy") && !macros.iter().any(|these| name.starts_with(these)) {
            assert_eq!(sets.len(), 1, "{name}: {sets:?}");
        }
    }
}

#[test]
fn another_set_of_features_is_a_difference() {
    let all = units("bevy_ecs v0.19.1 std,trace\nrand v0.10.0 std\nrand v0.10.0 alloc\n");
    let same = units("bevy_ecs v0.19.1 std,trace (*)\nrand v0.10.0 alloc\n");
    assert_eq!(differences(&all, &same), Vec::<String>::new());
    let fewer = units("bevy_ecs v0.19.1 std\n");
    assert_eq!(differences(&all, &fewer).len(), 1);
    let bare = units("bevy_ecs v0.19.1 \n");
    assert_eq!(differences(&all, &bare).len(), 1);
    let version = units("bevy_ecs v0.19.2 std,trace\n");
    assert_eq!(differences(&all, &version).len(), 1);
    let local = units("own v0.1.0 (/somewhere/own) default,render\nown v0.1.0 (proc-macro) \n");
    let sets = &local["own v0.1.0"];
    assert!(
        sets.contains("default,render") && sets.contains(""),
        "{sets:?}"
    );
}
