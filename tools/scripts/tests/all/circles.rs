//! Circles of `use`: no file of a crate uses one that uses it, be it by way of others.
//!
//! The `use` lines of each crate's `src` are read, and followed through `pub use` to the file that declares the
//! name. Left out is what only tests and documentation use; and what a file uses of the modules below it: a
//! folder's own file puts together what lies in the folder, and that may use what the folder declares. Paths
//! that are written out in the code are not looked at.

use std::collections::{BTreeMap, BTreeSet};

use super::texts::{File, all_texts};

/// Uses without which there is no circle, as the test says them. Every one of them has to be part of a circle:
/// whoever breaks one takes its lines out.
const KNOWN: &[&str] = &[
    "plugins/ground/src/material/layer.rs uses plugins/ground/src/material/bands.rs",
    "plugins/terrain/src/noise/fractal.rs uses plugins/terrain/src/noise/octave.rs",
    "plugins/terrain/src/noise/fractal.rs uses plugins/terrain/src/noise/sum.rs",
    "plugins/fbx/src/check/unpack.rs uses plugins/fbx/src/check/played.rs",
    "plugins/fbx/src/read/names.rs uses plugins/fbx/src/skinning.rs",
    "plugins/fbx/src/read/nodes.rs uses plugins/fbx/src/curves/pose.rs",
    "plugins/fbx/src/write/compress.rs uses plugins/fbx/src/write/buffer.rs",
    "testkit/fbx/src/looks.rs uses testkit/fbx/src/hold.rs",
    "testkit/fbx/src/shrink.rs uses testkit/fbx/src/run.rs",
];

/// What stands before an item that is not looked at.
const LEFT_OUT: [&str; 2] = ["#[cfg(test)]", "#[cfg(doc)]"];

/// More `pub use` than this does no name go through.
const MOST_STEPS: u32 = 16;

/// Names from the crate's root on.
type Module = Vec<String>;

/// A name that a file uses.
struct Use {
    /// Modules within the file that it stands in.
    inside: Module,
    public: bool,
    path: Module,
    /// What it is called here.
    name: String,
}

/// What of a file counts.
#[derive(Default)]
struct Scanned {
    uses: Vec<Use>,
    /// Modules in files of their own that only tests have.
    tests: Vec<Module>,
}

/// What follows `word` at the start of a line or after a `pub` of any kind, and whether there is a `pub`.
fn after<'a>(code: &'a str, word: &str) -> Option<(&'a str, bool)> {
    let (rest, public) = match code.strip_prefix("pub") {
        Some(rest) => match rest.strip_prefix('(') {
            Some(rest) => (rest.split_once(')')?.1, true),
            None => (rest, true),
        },
        None => (code, false),
    };
    let rest = rest.trim_start().strip_prefix(word)?.strip_prefix(' ')?;
    Some((rest, public))
}

/// The paths of a tree, each with the name that it gets here: `a::{b, c as d}` is `a::b` and `a::c`.
fn paths(tree: &str) -> Vec<(Module, String)> {
    let tree = tree.trim();
    if let Some((before, group)) = tree.split_once('{') {
        let group = group.strip_suffix('}').unwrap_or(group);
        let mut depth = 0;
        let parts = group.split(|c: char| {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                _ => (),
            }
            c == ',' && depth == 0
        });
        let parts = parts.map(str::trim).filter(|part| !part.is_empty());
        return parts
            .flat_map(|part| paths(&format!("{before}{part}")))
            .collect();
    }
    let (path, name) = match tree.split_once(" as ") {
        Some((path, name)) => (path, Some(name)),
        None => (tree, None),
    };
    let mut path: Module = path.split("::").map(str::to_owned).collect();
    if path.len() > 1 {
        path.pop_if(|last| last == "self");
    }
    let last = path.last().cloned().unwrap_or_default();
    vec![(path, name.map_or(last, str::to_owned))]
}

/// Reads a file as rustfmt leaves it: a module ends at a bracket that stands as far in as it begins.
fn scan(text: &str) -> Scanned {
    let mut scanned = Scanned::default();
    // Modules within the file, each with the line that ends it.
    let mut inside: Vec<(String, String)> = Vec::new();
    let mut left_out: Option<String> = None;
    // A `use`, which may go over several lines; whether it is `pub`, and whether it counts.
    let mut begun: Option<(String, bool, bool)> = None;
    let mut counts = true;
    for line in text.lines() {
        let code = line.split("//").next().unwrap_or_default().trim();
        if let Some(end) = &left_out {
            if line == end {
                left_out = None;
            }
            continue;
        }
        if let Some((text, ..)) = &mut begun {
            text.push_str(code);
        } else if code.is_empty() {
            continue;
        } else if inside.last().is_some_and(|(_, end)| line == end) {
            inside.pop();
        } else if code.starts_with("#[") {
            counts &= !LEFT_OUT.contains(&code);
        } else {
            let counts = std::mem::replace(&mut counts, true);
            let end = format!("{}}}", &line[..line.len() - line.trim_start().len()]);
            if let Some((text, public)) = after(code, "use") {
                begun = Some((text.to_owned(), public, counts));
            } else if let Some((module, _)) = after(code, "mod") {
                if let Some(module) = module.strip_suffix(" {") {
                    match counts {
                        true => inside.push((module.to_owned(), end)),
                        false => left_out = Some(end),
                    }
                } else if let Some(module) = module.strip_suffix(';').filter(|_| !counts) {
                    scanned.tests.push(within(&inside, module));
                }
            }
        }
        let Some((text, public, counts)) = begun.take_if(|(text, ..)| text.ends_with(';')) else {
            continue;
        };
        for (path, name) in paths(text.trim_end_matches(';')) {
            if counts {
                scanned.uses.push(Use {
                    inside: inside.iter().map(|(name, _)| name.clone()).collect(),
                    public,
                    path,
                    name,
                });
            }
        }
    }
    scanned
}

fn within(inside: &[(String, String)], module: &str) -> Module {
    let names = inside.iter().map(|(name, _)| name.clone());
    names.chain([module.to_owned()]).collect()
}

/// The folder of the crate that a file is of, and its module there. A program beside a library is a crate of its
/// own, which nothing uses.
fn module(path: &str) -> Option<(&str, Module)> {
    let (folder, rest) = match path.rsplit_once("/src/") {
        Some(split) => split,
        None => ("", path.strip_prefix("src/")?),
    };
    let mut module: Module = rest
        .strip_suffix(".rs")?
        .split('/')
        .map(str::to_owned)
        .collect();
    module.pop_if(|last| last == "mod" || last == "lib");
    Some((folder, module))
}

/// The modules of a crate that have files of their own.
type Crate<'a> = BTreeMap<Module, &'a File>;

/// From the root on; `None` for what another crate has.
fn from_root(module: &[String], one: &Use, all: &Crate) -> Option<Module> {
    let mut at = [module, one.inside.as_slice()].concat();
    let mut rest = &one.path[..];
    let (first, others) = rest.split_first()?;
    match first.as_str() {
        "crate" => {
            at.clear();
            rest = others;
        }
        "self" => rest = others,
        "super" => (),
        _ => {
            let below = [module, std::slice::from_ref(first)].concat();
            if !one.inside.is_empty() || !all.contains_key(&below) {
                return None;
            }
        }
    }
    while let Some(("super", others)) = rest.split_first().map(|(a, b)| (a.as_str(), b)) {
        at.pop();
        rest = others;
    }
    at.extend_from_slice(rest);
    Some(at)
}

/// What modules give away by `pub use`: its name there, and what it is.
type Given = BTreeMap<Module, BTreeMap<String, Module>>;

/// The module whose file declares what `path` names.
fn declares(path: &[String], all: &Crate, given: &Given, steps: u32) -> Option<Module> {
    let length = (0..=path.len())
        .rev()
        .find(|length| all.contains_key(&path[..*length]))?;
    let (module, rest) = path.split_at(length);
    let from = rest.first().and_then(|name| given.get(module)?.get(name));
    match from {
        Some(from) if steps > 0 => {
            let path = [from.as_slice(), &rest[1..]].concat();
            declares(&path, all, given, steps - 1)
        }
        _ => Some(module.to_vec()),
    }
}

/// Who uses whom, by paths of files.
type Uses<'a> = BTreeSet<(&'a str, &'a str)>;

fn uses_of_crate<'a>(all: &Crate<'a>) -> Uses<'a> {
    let scanned: Vec<(&Module, Scanned)> = all
        .iter()
        .map(|(module, file)| (module, scan(&file.text)))
        .collect();
    let tests: Vec<Module> = scanned
        .iter()
        .flat_map(|(module, scanned)| {
            let names = scanned.tests.iter();
            names.map(move |name| [module.as_slice(), name.as_slice()].concat())
        })
        .collect();
    let is_test = |module: &[String]| tests.iter().any(|test| module.starts_with(test));
    let mut given = Given::new();
    let mut found: Vec<(&Module, Module)> = Vec::new();
    for (module, scanned) in &scanned {
        for one in scanned.uses.iter().filter(|_| !is_test(module)) {
            let Some(path) = from_root(module, one, all) else {
                continue;
            };
            if one.public && one.inside.is_empty() && one.name != "*" {
                let names = given.entry(module.to_vec()).or_default();
                names.insert(one.name.clone(), path.clone());
            }
            // What lies below and is given away is not used.
            if !(one.public && path.starts_with(module)) {
                found.push((*module, path));
            }
        }
    }
    let mut uses = Uses::new();
    for (from, path) in found {
        let Some(to) = declares(&path, all, &given, MOST_STEPS) else {
            continue;
        };
        if !to.starts_with(from) && !is_test(&to) {
            uses.insert((all[from].path.as_str(), all[&to].path.as_str()));
        }
    }
    uses
}

fn uses(files: &[File]) -> Uses<'_> {
    let mut crates: BTreeMap<&str, Crate> = BTreeMap::new();
    for file in files {
        if let Some((folder, module)) = module(&file.path) {
            crates.entry(folder).or_default().insert(module, file);
        }
    }
    crates.values().flat_map(uses_of_crate).collect()
}

/// Those uses that are part of a circle: who is used leads back to the user.
fn on_circles<'a>(uses: &Uses<'a>) -> Uses<'a> {
    let leads_to = |from: &str, to: &str| {
        let mut seen = BTreeSet::from([from]);
        let mut next = vec![from];
        while let Some(file) = next.pop() {
            if file == to {
                return true;
            }
            let used = uses.range((file, "")..);
            let used = used.take_while(|(user, _)| *user == file);
            next.extend(
                used.map(|(_, used)| *used)
                    .filter(|used| seen.insert(*used)),
            );
        }
        false
    };
    uses.iter()
        .copied()
        .filter(|(user, used)| leads_to(used, user))
        .collect()
}

fn lines(uses: &Uses) -> String {
    let lines: Vec<String> = uses
        .iter()
        .map(|(user, used)| format!("{user} uses {used}"))
        .collect();
    lines.join("\n")
}

#[test]
fn no_file_uses_one_that_uses_it() {
    let files = all_texts();
    let uses = uses(&files);
    assert!(uses.len() > 500, "{} uses: read too little", uses.len());
    let known: Uses = KNOWN
        .iter()
        .map(|line| line.split_once(" uses ").expect("one file uses another"))
        .collect();
    let circles = on_circles(&uses);
    let broken: Uses = known.difference(&circles).copied().collect();
    assert!(
        broken.is_empty(),
        "no part of a circle any more, so no longer to be known:\n{}",
        lines(&broken)
    );
    let rest: Uses = uses.difference(&known).copied().collect();
    let circles = on_circles(&rest);
    assert!(
        circles.is_empty(),
        "uses that make circles:\n{}",
        lines(&circles)
    );
}

#[test]
fn a_circle_is_found_and_what_is_none_is_not() {
    let file = |path: &str, text: &str| File {
        path: path.to_owned(),
        text: text.to_owned(),
    };
    let files = [
        file("x/src/lib.rs", "mod a;\nmod b;\npub use a::A;\n"),
        // By way of what the root and the folder give away, in a group, over several lines.
        file(
            "x/src/a.rs",
            "use crate::{\n    b::{Inner as B, Other},\n};\nuse std::fmt;\npub struct A;\n",
        ),
        file(
            "x/src/b/mod.rs",
            "mod inner;\nmod tests;\npub use inner::{Inner, self};\nuse inner::Inner as I;\npub struct Other;\n",
        ),
        file(
            "x/src/b/inner.rs",
            "use super::Other;\nmod deep {\n    use super::super::super::A;\n}\npub struct Inner;\n",
        ),
        // Tests may use whom they test.
        file(
            "x/src/c.rs",
            "#[cfg(test)]\nmod tests {\n    use crate::d::D;\n}\n#[cfg(test)]\nmod more;\npub struct C;\n",
        ),
        file("x/src/c/more.rs", "use crate::d::D;\nuse super::C;\n"),
        file("x/src/d.rs", "use crate::c::C;\npub struct D;\n"),
        // Another crate has a module of the same name.
        file("y/src/lib.rs", "mod a;\n"),
        file("y/src/a.rs", "use x::A;\n"),
    ];
    let uses = uses(&files);
    let wanted = Uses::from([
        ("x/src/a.rs", "x/src/b/inner.rs"),
        ("x/src/a.rs", "x/src/b/mod.rs"),
        ("x/src/b/inner.rs", "x/src/a.rs"),
        ("x/src/b/inner.rs", "x/src/b/mod.rs"),
        ("x/src/d.rs", "x/src/c.rs"),
    ]);
    assert_eq!(uses, wanted);
    let circle = Uses::from([
        ("x/src/a.rs", "x/src/b/inner.rs"),
        ("x/src/b/inner.rs", "x/src/a.rs"),
    ]);
    assert_eq!(on_circles(&uses), circle);
}
