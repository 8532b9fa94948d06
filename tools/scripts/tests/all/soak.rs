//! `scripts/soak`, with a cargo that builds a laboratory of three lines.

use crate::support::{Said, System};

const SOAK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scripts/soak");

/// A laboratory that prints `report`, and tests that end with `code`.
fn soak(arguments: &str, report: &str, code: u8) -> (System, Said) {
    let system = System::new();
    for tool in ["date", "mkdir", "mv", "tail", "tee", "basename", "chmod"] {
        system.tool(tool);
    }
    // Who has the files alone, without a repository, may have no git either.
    system.command("git", "exit 1");
    system.command(
        "cargo",
        &format!(
            "case $1 in\n\
             --version) echo cargo 1.95.0 ;;\n\
             build) [[ $* != *lab/avian/* || {code} == 0 ]] || exit {code}\n\
               mkdir -p \"$SYSTEM/target/release\"\n\
               printf '%s\\n' '#!/usr/bin/env bash' \"cat \\\"$SYSTEM/report\\\"\" >\"$SYSTEM/target/release/dolomite_lab\"\n\
               printf '%s' '{report}' >\"$SYSTEM/report\"\n\
               printf '%s\\n' '#!/usr/bin/env bash' 'printf \"{{\\n  \\\"arguments\\\": \\\"%s\\\"\\n}}\\n\" \"$*\"' >\"$SYSTEM/target/release/dolomite_fbx_search\"\n\
               chmod +x \"$SYSTEM\"/target/release/* ;;\n\
             nextest) printf 'one \"quoted\"\\tline\\n'; exit {code} ;;\n\
             esac"
        ),
    );
    let said = system.run(&format!(
        "export DOLOMITE_NO_SYSTEM_CHECK=1 CARGO_TARGET_DIR=$SYSTEM/target SOAK_OUT=$SYSTEM/out; \
         bash {SOAK} {arguments}"
    ));
    (system, said)
}

#[test]
fn a_study_s_summary_is_kept_without_its_rows() {
    let report = "{\n  \"notes\": [],\n  \"rows\": [\n    {\n      \"x\": 1\n    }\n  ],\n  \"study\": \"noise\"\n}";
    let (system, said) = soak("noise", report, 0);
    assert_eq!(said.code, 0, "{said:#?}");
    let kept = system.file("out/noise.json");
    assert!(kept.contains("\"passed\": true"), "{kept}");
    assert!(
        kept.ends_with("\"report\": {\n  \"notes\": [],\n  \"study\": \"noise\"\n}}\n"),
        "{kept}"
    );
    let table = system.file("out/README.md");
    assert!(table.contains("| [noise](noise.json) | true | "), "{table}");
    assert!(
        table.contains("`dolomite_lab noise --samples 1048576`"),
        "{table}"
    );
}

#[test]
fn tests_that_fail_are_a_failure_and_their_words_are_kept() {
    let (system, said) = soak("ignored", "", 100);
    assert_eq!(said.code, 1, "{said:#?}");
    said.line("error: failed: ignored");
    let kept = system.file("out/ignored.json");
    assert!(kept.contains("\"passed\": false"), "{kept}");
    assert!(kept.contains("\"one \\\"quoted\\\" line\""), "{kept}");
}

/// Avian is a package of its own, whose crates a machine may not have.
#[test]
fn bodies_are_measured_beside_avian_where_it_can_be_built() {
    let report = "{\n  \"study\": \"bodies\"\n}";
    for code in [0, 1] {
        let (system, said) = soak("bodies", report, code);
        assert_eq!(said.code, 0, "{said:#?}");
        let kept = system.file("out/bodies.json");
        assert!(kept.contains("\"passed\": true"), "{kept}");
        assert_eq!(
            kept.contains("/target/avian/release/dolomite_avian"),
            code == 0,
            "{kept}"
        );
    }
}

/// Many hours' work goes on where it was.
#[test]
fn a_search_keeps_what_it_has_found_between_its_pieces() {
    let (system, said) = soak("fbx", "", 0);
    assert_eq!(said.code, 0, "{said:#?}");
    let kept = system.file("out/fbx.json");
    let asked = "--files 1000000 --out ";
    assert!(kept.contains(asked), "{kept}");
    assert!(kept.contains("/target/soak_fbx.json\"\n}\n}\n"), "{kept}");
}

#[test]
fn a_soak_that_is_not_there_is_refused_before_anything_is_built() {
    let (_, said) = soak("ignored nothing", "", 0);
    assert_eq!(said.code, 1, "{said:#?}");
    said.line("there is no soak nothing");
    assert!(!said.text.contains("building"), "{said:#?}");
}

#[test]
fn each_soak_is_listed_with_its_minutes() {
    let (_, said) = soak("--list", "", 0);
    assert_eq!(said.code, 0, "{said:#?}");
    for line in said.text.lines() {
        let words: Vec<_> = line.split_whitespace().collect();
        let minutes: u32 = words[1].parse().unwrap();
        assert!(
            minutes > 0 && words[2] == "min" && words.len() > 6,
            "{line}"
        );
    }
    assert!(said.text.lines().count() >= 7, "{said:#?}");
}
