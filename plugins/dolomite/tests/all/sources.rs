//! Settings as they stand in the plugins' sources, so that nobody has to list them.
//!
//! A setting is a component or a resource whose fields are all public and are plain data: numbers, switches, texts,
//! vectors, entities, lists, optional values and types of ours that are made of those; data that several share (`Arc`) may
//! stand beside them. What has a private field, an error, a texture or a buffer is a plugin's own state.

use std::collections::BTreeMap;
use std::fs::{read_dir, read_to_string};
use std::path::Path;

/// Types of others that reflection reads and writes.
const PLAIN: [&str; 32] = [
    "f32",
    "f64",
    "u8",
    "u16",
    "u32",
    "u64",
    "usize",
    "i8",
    "i16",
    "i32",
    "i64",
    "isize",
    "bool",
    "String",
    "Vec",
    "Option",
    "Vec2",
    "Vec3",
    "Vec4",
    "DVec2",
    "DVec3",
    "Quat",
    "UVec2",
    "UVec3",
    "IVec2",
    "IVec3",
    "Color",
    "LinearRgba",
    "Entity",
    "Range",
    "RangeInclusive",
    "Name",
];

/// A public type of a plugin.
#[derive(Clone, Debug, Default)]
struct Type {
    file: String,
    attributes: String,
    /// It is not of one type, but of a family.
    family: bool,
    /// All fields are public.
    open: bool,
    /// What its fields are.
    fields: Vec<String>,
}

/// Types by crate and name.
type Types = BTreeMap<(String, String), Type>;

/// A setting.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// The crate's name, with `_`.
    pub of_crate: String,
    /// The type's name.
    pub name: String,
    /// Whether it derives `Reflect`.
    pub reflects: bool,
}

/// All settings of all plugins, by crate and name.
pub fn settings() -> Vec<Setting> {
    let plugins = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut types = Types::new();
    let mut outside = BTreeMap::new();
    for plugin in read_dir(plugins).expect("the plugins' folder").flatten() {
        let folder = plugin.path().join("src");
        let name = plugin.file_name().to_string_lossy().into_owned();
        // The inspector does not inspect itself.
        if !folder.is_dir() || name == "inspector" {
            continue;
        }
        let lib = read_to_string(folder.join("lib.rs")).expect("a library");
        outside.insert(name.clone(), lib);
        read_folder(&folder, &name, &mut types);
    }
    of(&types, |plugin, name| {
        let lib = outside.get(plugin).map_or("", String::as_str);
        let exports = lib.split(';').filter(|item| item.contains("pub use "));
        exports
            .into_iter()
            .any(|item| words(item).any(|word| word == name))
    })
}

/// The settings among types. What is of the render world counts where its library exports it by name.
fn of(types: &Types, exported: impl Fn(&str, &str) -> bool) -> Vec<Setting> {
    let found = types.iter().filter(|((plugin, name), found)| {
        let is = |word| derives(&found.attributes, word);
        (is("Component") || is("Resource"))
            && (!found.file.contains("/render/") || exported(plugin, name))
            && !found.family
            && found.open
            && found.fields.iter().all(|field| {
                field.starts_with("Arc<") || is_plain(types, plugin, field, &mut Vec::new())
            })
            && (found.fields.is_empty()
                || found.fields.iter().any(|field| !field.starts_with("Arc<")))
    });
    found
        .map(|((plugin, name), found)| Setting {
            of_crate: format!("dolomite_{plugin}"),
            name: name.clone(),
            reflects: derives(&found.attributes, "Reflect"),
        })
        .collect()
}

fn derives(attributes: &str, name: &str) -> bool {
    let lists = attributes.split("derive(").skip(1);
    let mut lists = lists.filter_map(|rest| rest.split(')').next());
    lists.any(|list| list.split(',').any(|one| one.trim() == name))
}

fn read_folder(folder: &Path, plugin: &str, types: &mut Types) {
    for entry in read_dir(folder).expect("a folder of sources").flatten() {
        let path = entry.path();
        if path.is_dir() {
            read_folder(&path, plugin, types);
        } else if path.extension().is_some_and(|end| end == "rs") {
            let text = read_to_string(&path).expect("a source");
            read_file(&text, &path.display().to_string(), plugin, types);
        }
    }
}

/// Adds the public types of a file, which is formatted by rustfmt.
fn read_file(text: &str, file: &str, plugin: &str, types: &mut Types) {
    let lines: Vec<_> = text.lines().collect();
    for (at, line) in lines.iter().enumerate() {
        let (rest, is_struct) = match (
            line.strip_prefix("pub struct "),
            line.strip_prefix("pub enum "),
        ) {
            (Some(rest), _) => (rest, true),
            (_, Some(rest)) => (rest, false),
            _ => continue,
        };
        let name = words(rest).next().unwrap_or_default().to_owned();
        let before = lines[..at].iter().rev();
        let before = before.take_while(|line| !line.trim().is_empty() && **line != "}");
        let attributes: Vec<_> = before.filter(|line| !is_comment(line)).copied().collect();
        let ends = line.ends_with(';') || line.ends_with('}');
        let body: Vec<_> = if ends {
            Vec::new()
        } else {
            let body = lines[at + 1..].iter().take_while(|line| **line != "}");
            let body = body.filter(|line| !is_comment(line) && !line.trim().starts_with('#'));
            body.map(|line| line.split(" //").next().unwrap_or(line))
                .collect()
        };
        let mut found = Type {
            file: file.to_owned(),
            attributes: attributes.into_iter().rev().collect::<Vec<_>>().join("\n"),
            family: rest
                .trim_start_matches(char::is_alphanumeric)
                .starts_with('<'),
            open: true,
            fields: Vec::new(),
        };
        if !is_struct {
            for line in &body {
                let inner = match (line.split_once('('), line.split_once(": ")) {
                    (Some((_, inner)), _) => inner.trim_end_matches([',', ')']),
                    (_, Some((_, kind))) => kind.trim_end_matches(','),
                    _ => continue,
                };
                found.fields.push(inner.to_owned());
            }
        } else if ends {
            let inner = rest
                .split_once('(')
                .and_then(|(_, rest)| rest.rsplit_once(')'));
            for field in inner.into_iter().flat_map(|(inner, _)| inner.split(", ")) {
                found.open &= field.starts_with("pub ");
                found
                    .fields
                    .push(field.trim_start_matches("pub ").to_owned());
            }
        } else {
            // Deeper lines are the rest of a field that does not fit a line.
            for line in body.iter().filter(|line| !line.starts_with("     ")) {
                let (head, kind) = line.split_once(": ").unwrap_or((line, ""));
                found.open &= head.trim().starts_with("pub ");
                found.fields.push(kind.trim_end_matches(',').to_owned());
            }
        }
        types.insert((plugin.to_owned(), name), found);
    }
}

fn is_comment(line: &str) -> bool {
    line.trim().starts_with("//")
}

/// Words of a type, without the modules before its name.
fn words(kind: &str) -> impl Iterator<Item = &str> {
    let is_end = |c: char| !(c.is_alphanumeric() || c == '_' || c == ':');
    let names = kind
        .split(is_end)
        .filter_map(|path| path.rsplit("::").next());
    names
        .map(|name| name.trim_end_matches(':'))
        .filter(|name| name.starts_with(|c: char| c.is_alphabetic()))
}

fn is_plain(types: &Types, plugin: &str, kind: &str, above: &mut Vec<String>) -> bool {
    if kind.is_empty() || kind.contains("dyn ") || kind.contains("fn(") || kind.contains('&') {
        return false;
    }
    let mut all = words(kind);
    all.all(|word| {
        if PLAIN.contains(&word) {
            return true;
        }
        let own = types.get_key_value(&(plugin.to_owned(), word.to_owned()));
        let known = own.or_else(|| types.iter().find(|((_, name), _)| name == word));
        let Some(((plugin, _), known)) = known else {
            return false;
        };
        if above.iter().any(|name| name == word) || known.family || !known.open {
            return false;
        }
        above.push(word.to_owned());
        let plain = known
            .fields
            .iter()
            .all(|field| is_plain(types, plugin, field, above));
        above.pop();
        plain
    })
}

#[test]
fn what_a_setting_is() {
    let text = "
/// Plain.
#[derive(Component, Reflect, Clone)]
pub struct Fog {
    /// Dust; (not all of it
    pub dust: Option<f32>,
    #[reflect(ignore)]
    pub map: Arc<Map>,
    pub kind: crate::fog::Kind,
}

pub enum Kind {
    Thin,
    Banks(Vec<u32>, [f32; 3]),
    Thick { share: f32 },
}

#[derive(Resource)]
pub struct Clock(pub u64);

#[derive(Component)]
pub struct Hidden {
    pub dust: f32,
    known: bool,
}

#[derive(Component)]
pub struct Shared(pub Arc<Map>);

#[derive(Component)]
pub struct Made {
    pub picture: Handle<Image>,
}

#[derive(Clone)]
pub struct Neither {
    pub dust: f32,
}

#[derive(Component)]
pub struct Marker;

#[derive(Component)]
pub struct Family<K> {
    pub dust: f32,
}
";
    let mut types = Types::new();
    read_file(text, "fog/src/lib.rs", "fog", &mut types);
    let names = |types: &Types, exported: bool| -> Vec<(String, bool)> {
        let found = of(types, |_, _| exported);
        found
            .into_iter()
            .map(|one| (one.name, one.reflects))
            .collect()
    };
    let expected = [("Clock", false), ("Fog", true), ("Marker", false)];
    let expected = expected.map(|(name, reflects)| (name.to_owned(), reflects));
    assert_eq!(names(&types, false), expected);
    // Of the render world only what is exported.
    let mut types = Types::new();
    read_file(text, "fog/src/render/mod.rs", "fog", &mut types);
    assert_eq!(names(&types, false), []);
    assert_eq!(names(&types, true), expected);
}
