//! Captures of a tessellator: one JSON object a line, a patch each.

use dolomite_tessellation::{Domain, Levels, Mode, Spacing, Tessellator, Winding};
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// One captured patch.
#[derive(Debug, Clone)]
pub struct Case {
    /// What the tessellator was set to; the mode is not part of a capture.
    pub tessellator: Tessellator,
    /// As the control shader wrote them.
    pub levels: Levels,
    /// Distinct coordinates (u, v, w).
    pub vertices: Vec<[f64; 3]>,
    /// Triangles, or segments, of indices into them.
    pub primitives: Vec<Vec<u32>>,
}

/// Why a file of cases cannot be used.
#[derive(Debug, Error)]
pub enum CaseError {
    /// It cannot be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A line is not what it should be.
    #[error("{}, line {line}: {reason}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// Which line, from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// It has no case.
    #[error("{} holds no case; one JSON object a line is expected", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
}

/// Reads a file of cases. Empty lines are passed over.
///
/// # Errors
/// [`CaseError`], with file and line.
pub fn read(path: &Path) -> Result<Vec<Case>, CaseError> {
    let text = std::fs::read_to_string(path).map_err(|source| CaseError::Read {
        path: path.to_owned(),
        source,
    })?;
    let mut cases = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        if line.trim().is_empty() {
            continue;
        }
        cases.push(parse(line).map_err(|reason| CaseError::Line {
            path: path.to_owned(),
            line: number,
            reason,
        })?);
    }
    if cases.is_empty() {
        return Err(CaseError::Empty {
            path: path.to_owned(),
        });
    }
    Ok(cases)
}

/// One line. `NaN` and `Infinity`, which JSON does not have but some writers put there, are read.
fn parse(line: &str) -> Result<Case, String> {
    let value: Value = serde_json::from_str(line)
        .or_else(|_| {
            let quoted = line
                .replace("-Infinity", "\"-inf\"")
                .replace("Infinity", "\"inf\"")
                .replace("NaN", "\"nan\"");
            serde_json::from_str(&quoted)
        })
        .map_err(|error| error.to_string())?;
    let object = value.as_object().ok_or("a JSON object is expected")?;
    let domain = choice(
        object,
        "domain",
        &[
            ("triangles", Domain::Triangles),
            ("quads", Domain::Quads),
            ("isolines", Domain::Isolines),
        ],
    )?;
    let spacing = choice(
        object,
        "spacing",
        &[
            ("equal_spacing", Spacing::Equal),
            ("fractional_even_spacing", Spacing::FractionalEven),
            ("fractional_odd_spacing", Spacing::FractionalOdd),
        ],
    )?;
    let winding = choice(
        object,
        "winding",
        &[("ccw", Winding::Ccw), ("cw", Winding::Cw)],
    )?;
    let levels = Levels {
        outer: levels(object, "outer", domain.outer_levels())?,
        inner: levels(object, "inner", domain.inner_levels())?,
    };
    let vertices = array(object, "vertices")?
        .iter()
        .map(|vertex| {
            let numbers: Option<Vec<f64>> = vertex.as_array()?.iter().map(Value::as_f64).collect();
            let [u, v, w] = numbers?.try_into().ok()?;
            Some([u, v, w])
        })
        .collect::<Option<Vec<_>>>()
        .ok_or("`vertices` has to hold triples of numbers")?;
    let size = if domain == Domain::Isolines { 2 } else { 3 };
    let primitives = array(object, "primitives")?
        .iter()
        .map(|primitive| {
            let indices: Option<Vec<u32>> = primitive
                .as_array()?
                .iter()
                .map(|index| {
                    let index = index.as_u64()?;
                    (index < vertices.len() as u64).then_some(index as u32)
                })
                .collect();
            indices.filter(|indices| indices.len() == size)
        })
        .collect::<Option<Vec<_>>>()
        .ok_or_else(|| format!("`primitives` has to hold {size} indices of `vertices` each"))?;
    Ok(Case {
        tessellator: Tessellator {
            domain,
            spacing,
            winding,
            mode: Mode::default(),
        },
        levels,
        vertices,
        primitives,
    })
}

fn array<'a>(object: &'a Map<String, Value>, key: &str) -> Result<&'a Vec<Value>, String> {
    object
        .get(key)
        .and_then(Value::as_array)
        .ok_or_else(|| format!("`{key}` has to be a list"))
}

fn choice<T: Copy>(
    object: &Map<String, Value>,
    key: &str,
    known: &[(&str, T)],
) -> Result<T, String> {
    let given = object.get(key).and_then(Value::as_str);
    known
        .iter()
        .find(|(name, _)| Some(*name) == given)
        .map(|(_, value)| *value)
        .ok_or_else(|| {
            let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
            format!("`{key}` has to be one of: {}", names.join(", "))
        })
}

/// Levels; those that the domain does not use may be missing.
fn levels<const N: usize>(
    object: &Map<String, Value>,
    key: &str,
    needed: usize,
) -> Result<[f32; N], String> {
    let mut levels = [1.0; N];
    let given = array(object, key)?;
    if given.len() < needed {
        return Err(format!("`{key}` has to hold {needed} levels at least"));
    }
    for (level, value) in levels.iter_mut().zip(given) {
        *level = match value {
            // JSON's writers that have no NaN write null.
            Value::Null => f32::NAN,
            Value::String(text) => text
                .parse()
                .map_err(|_| format!("`{key}` holds \"{text}\", which is no number"))?,
            _ => value
                .as_f64()
                .ok_or_else(|| format!("`{key}` has to hold numbers"))? as f32,
        };
    }
    Ok(levels)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = r#"{"domain":"isolines","spacing":"equal_spacing","winding":"cw","outer":[1,NaN,-Infinity],"inner":[],"vertices":[[0,0,0],[1,0,0]],"primitives":[[0,1]]}"#;

    #[test]
    fn levels_that_json_does_not_have_are_read() {
        let case = parse(GOOD).expect("a case");
        assert!(case.levels.outer[1].is_nan());
        assert_eq!(case.levels.outer[2], f32::NEG_INFINITY);
        assert_eq!(case.primitives, [[0, 1]]);
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (from, to, expected) in [
            ("isolines", "hexagons", "triangles, quads, isolines"),
            ("[0,1]]", "[0,2]]", "2 indices of `vertices`"),
            ("[1,0,0]", "[1,0]", "triples"),
            ("[1,NaN,-Infinity]", "[1]", "2 levels at least"),
            ("}", "", "EOF"),
        ] {
            let fault = parse(&GOOD.replace(from, to)).expect_err(to);
            assert!(fault.contains(expected), "{fault}");
        }
    }
}
