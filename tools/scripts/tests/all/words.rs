//! What is written: no private terms, and no names of files that are gone.

use std::fs;

use super::texts::{File, all_paths, all_texts, ending, root};

/// Where the words are listed, and so the one file that may hold them.
const GLOSSARY: &str = "docs/glossary.md";

/// Files that a user makes, or that a program writes: named in comments, not in the repository.
const NOT_OURS: [&str; 6] = [
    "settings.ron",
    "my.ron",
    "waving.wgsl",
    "broken.wgsl",
    "TOPIC.md",
    "rustup.rs",
];

/// What stands between backticks in the left column of the first table.
fn private_terms(glossary: &str) -> Vec<String> {
    let table = glossary
        .lines()
        .skip_while(|line| !line.starts_with("|---"));
    let rows = table.skip(1).take_while(|line| line.starts_with('|'));
    rows.flat_map(|row| {
        let left = row.split('|').nth(1).unwrap_or_default();
        let terms = left.split('`').skip(1).step_by(2);
        terms.map(str::to_lowercase).collect::<Vec<_>>()
    })
    .collect()
}

/// Lines that hold one of `terms`, in either case and as part of a word too: what `git grep -i` finds.
fn found<'a>(files: &'a [File], terms: &'a [String]) -> Vec<String> {
    let mut lines = Vec::new();
    for file in files.iter().filter(|file| file.path != GLOSSARY) {
        for (number, line) in (1..).zip(file.text.lines()) {
            let line = line.to_lowercase();
            let term = terms.iter().find(|term| line.contains(&***term));
            lines.extend(term.map(|term| format!("{}:{number}: {term}", file.path)));
        }
    }
    lines
}

/// Names of files in `text`: words of letters, digits, `_`, `-`, `.` and `/` with an ending of ours.
fn file_names(text: &str) -> impl Iterator<Item = &str> {
    let part = |c: char| c.is_ascii_alphanumeric() || "_-./".contains(c);
    text.split(move |c| !part(c))
        .map(|word| word.trim_end_matches('.'))
        // From the root of a machine or from a folder of its user: not in the repository.
        .filter(|word| !word.starts_with('/'))
        .filter(|word| {
            let stem = word.rsplit('/').next().unwrap_or_default();
            ["rs", "wgsl", "md", "ron"].iter().any(|ending| {
                stem.strip_suffix(ending)
                    .is_some_and(|stem| stem.len() > 1 && stem.ends_with('.'))
            })
        })
}

/// The comments of a line of code; the whole line of other texts.
fn comment<'a>(path: &str, line: &'a str) -> &'a str {
    match ending(path) {
        Some("rs" | "wgsl" | "c") => line.split_once("//").map_or("", |(_, comment)| comment),
        Some("md") => line,
        Some("toml" | "py") => line.split_once('#').map_or("", |(_, comment)| comment),
        _ => "",
    }
}

/// Names of files in comments that no file of the repository has.
fn names_of_nothing(files: &[File], paths: &[String]) -> Vec<String> {
    let known = |name: &str| {
        let name = name.trim_start_matches("./").trim_start_matches("../");
        // A path from the root, or its end: `render/mod.rs`, `mod.rs`.
        paths
            .iter()
            .any(|path| path == name || path.strip_suffix(name).is_some_and(|p| p.ends_with('/')))
            || NOT_OURS.iter().any(|other| name.ends_with(other))
    };
    let mut lines = Vec::new();
    for file in files
        .iter()
        .filter(|file| file.path != "tools/scripts/tests/all/words.rs")
    {
        for (number, line) in (1..).zip(file.text.lines()) {
            let names = file_names(comment(&file.path, line)).filter(|name| !known(name));
            lines.extend(names.map(|name| format!("{}:{number}: {name}", file.path)));
        }
    }
    lines
}

#[test]
fn no_private_term_stands_outside_of_the_glossary() {
    let glossary = fs::read_to_string(root().join(GLOSSARY)).expect("the glossary");
    let terms = private_terms(&glossary);
    assert!(terms.len() >= 10, "the glossary lists {}", terms.len());
    let lines = found(&all_texts(), &terms);
    assert!(
        lines.is_empty(),
        "say it in the field's terms:\n{}",
        lines.join("\n")
    );
}

#[test]
fn files_that_comments_name_are_there() {
    let lines = names_of_nothing(&all_texts(), &all_paths());
    assert!(lines.is_empty(), "no such file:\n{}", lines.join("\n"));
}

#[test]
fn a_word_and_a_name_that_are_wrong_are_found() {
    let terms =
        private_terms("# G\n\n| a | b |\n|---|---|\n| `Quux`, `two words` | x `y` |\n\n| `z` |\n");
    assert_eq!(terms, ["quux", "two words"]);
    let file = |path: &str, text: &str| File {
        path: path.to_owned(),
        text: text.to_owned(),
    };
    let files = [
        file(GLOSSARY, "quux"),
        file("a.rs", "fn f() {}\nlet aQuuxB = 1;"),
        file("b.md", "Two Words"),
    ];
    assert_eq!(found(&files, &terms), ["a.rs:2: quux", "b.md:1: two words"]);

    let files = [file(
        "src/a.rs",
        "let x = \"gone.rs\"; // see b/c.wgsl, gone.rs, ./a.rs.",
    )];
    let paths = ["src/a.rs".to_owned(), "shaders/b/c.wgsl".to_owned()];
    assert_eq!(names_of_nothing(&files, &paths), ["src/a.rs:1: gone.rs"]);
}
