//! FBX as text.

use super::{Record, Value};
use std::fmt::Write;

/// Writes records as text.
pub fn write(records: &[Record], version: u32) -> Vec<u8> {
    let (major, minor) = (version / 1000, version / 100 % 10);
    let mut out = format!("; FBX {major}.{minor}.0 project file\n");
    for record in records {
        one(record, 0, &mut out);
    }
    out.into_bytes()
}

fn one(record: &Record, depth: usize, out: &mut String) {
    let tabs = "\t".repeat(depth);
    let _ = write!(out, "{tabs}{}: ", record.name);
    // A lone array has a block of its own, with its length before it.
    if let [array] = &record.values[..]
        && let Some((length, numbers)) = array_text(array)
    {
        let _ = writeln!(out, "*{length} {{\n{tabs}\ta: {numbers}\n{tabs}}}");
        return;
    }
    // Properties of 7.x have no space before their numbers; readers take both.
    let values: Vec<String> = record.values.iter().map(plain).collect();
    out.push_str(&values.join(", "));
    if record.below.is_empty()
        && !record.values.is_empty()
        && record.name != "Properties70"
        && !opens(&record.name)
    {
        out.push('\n');
        return;
    }
    out.push_str(" {\n");
    for below in &record.below {
        one(below, depth + 1, out);
    }
    let _ = writeln!(out, "{tabs}}}");
}

/// Objects have a block even where it is empty.
fn opens(name: &str) -> bool {
    matches!(
        name,
        "Model"
            | "Geometry"
            | "Material"
            | "Texture"
            | "Deformer"
            | "NodeAttribute"
            | "AnimationStack"
            | "AnimationLayer"
            | "AnimationCurveNode"
            | "AnimationCurve"
    )
}

fn plain(value: &Value) -> String {
    match value {
        Value::Int(x) => x.to_string(),
        Value::Long(x) => x.to_string(),
        Value::Double(x) => number(*x),
        Value::Letter(x) => char::from(*x).to_string(),
        // Binary files have name and kind the other way round.
        Value::Text(text) => match text.split_once("\0\u{1}") {
            Some((name, kind)) => format!("\"{kind}::{name}\""),
            None => format!("\"{text}\""),
        },
        array => array_text(array).map_or_else(String::new, |(_, numbers)| numbers),
    }
}

fn array_text(value: &Value) -> Option<(usize, String)> {
    fn list<T>(of: &[T], one: impl Fn(&T) -> String) -> Option<(usize, String)> {
        Some((of.len(), of.iter().map(one).collect::<Vec<_>>().join(",")))
    }
    match value {
        Value::Ints(all) => list(all, i32::to_string),
        Value::Longs(all) => list(all, i64::to_string),
        Value::Floats(all) => list(all, |x| number(f64::from(*x))),
        Value::Bits(all) => list(all, |x| x.cast_signed().to_string()),
        Value::Doubles(all) => list(all, |x| number(*x)),
        _ => None,
    }
}

/// With all digits, so that it is read again as it was.
fn number(x: f64) -> String {
    format!("{x}")
}
