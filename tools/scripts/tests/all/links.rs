//! Links in the documents: each that names a file, or a heading of one, has to find it.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// Folders that hold what others wrote, or what was built.
const SKIPPED: [&str; 4] = [".git", "target", "node_modules", "out"];

/// All `.md` files below `folder`.
fn documents(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("the project's folders can be read") {
        let path = entry.expect("the project's folders can be read").path();
        let name = path
            .file_name()
            .expect("a folder's entry has a name")
            .to_string_lossy()
            .into_owned();
        if path.is_dir() && !SKIPPED.contains(&name.as_str()) {
            documents(&path, found);
        } else if name.ends_with(".md") {
            found.push(path);
        }
    }
}

/// The lines of a document that are not part of a block of code, without what stands between backticks.
fn prose(text: &str) -> Vec<String> {
    let mut code = false;
    let mut lines = Vec::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            code = !code;
        } else if !code {
            lines.push(line.split('`').step_by(2).collect::<Vec<_>>().join("`"));
        }
    }
    lines
}

/// What stands in the round brackets of `[...](...)`.
fn links(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for line in prose(text) {
        let mut rest = line.as_str();
        while let Some((_, after)) = rest.split_once("](") {
            let Some((link, after)) = after.split_once(')') else {
                break;
            };
            found.push(link.trim().to_owned());
            rest = after;
        }
    }
    found
}

/// The anchors that a page of the document has, as the usual viewers make them of its headings.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut code = false;
    let mut found = BTreeSet::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            code = !code;
        } else if !code && line.starts_with('#') {
            let heading = line.trim_start_matches('#').trim().to_lowercase();
            let kept = heading
                .chars()
                .filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c));
            found.insert(kept.collect::<String>().replace(' ', "-"));
        }
    }
    found
}

/// Why a link of the document at `from` finds nothing; `None` where it does, or leads out of the project.
fn broken(from: &Path, text: &str, link: &str) -> Option<String> {
    if link.contains("://") || link.starts_with("mailto:") {
        return None;
    }
    let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
    let target = match file {
        "" => from.to_owned(),
        file => from
            .parent()
            .expect("a document lies in a folder")
            .join(file),
    };
    if !target.exists() {
        return Some(format!("{}: no {link}", from.display()));
    }
    if anchor.is_empty() || target.extension().is_none_or(|kind| kind != "md") {
        return None;
    }
    let there = match file {
        "" => text.to_owned(),
        _ => fs::read_to_string(&target).expect("a document is UTF-8"),
    };
    (!anchors(&there).contains(anchor)).then(|| format!("{}: no heading {link}", from.display()))
}

#[test]
fn every_link_of_the_documents_finds_its_file() {
    let mut files = Vec::new();
    documents(Path::new(ROOT), &mut files);
    let mut count = 0;
    let mut missing = Vec::new();
    for file in &files {
        let text = fs::read_to_string(file).unwrap();
        for link in links(&text) {
            count += 1;
            missing.extend(broken(file, &text, &link));
        }
    }
    assert!(files.len() > 5 && count > 10, "{files:?}: {count} links");
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

#[test]
fn broken_links_are_found() {
    let text =
        "# One, two\n[a](#one-two) [b](#three) `[c](none)`\n```\n[d](none)\n```\n[e](none.md)";
    assert_eq!(links(text), ["#one-two", "#three", "none.md"]);
    let from = Path::new(ROOT).join("README.md");
    let found: Vec<_> = links(text)
        .iter()
        .filter_map(|link| broken(&from, text, link))
        .collect();
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(broken(&from, text, "ARCHITECTURE.md").is_none());
    assert!(broken(&from, text, "ARCHITECTURE.md#no-such-heading").is_some());
    assert!(broken(&from, text, "https://example.org/none").is_none());
}
