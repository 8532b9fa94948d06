//! A .glb whose views are compressed or whose vertices are quantised, as one of plain numbers.
//!
//! Reads `EXT_meshopt_compression` and `KHR_meshopt_compression`, and turns the integers that
//! `KHR_mesh_quantization` allows for vertices into floats. Files without them are left alone.

use super::played::PlayedError;
use crate::codec::{Filter, Layout, Mode, decode};
use gltf::binary::Glb;
use serde_json::{Value, json};
use std::collections::BTreeMap;

const COMPRESSIONS: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];
const QUANTIZATION: &str = "KHR_mesh_quantization";

/// A .glb of plain numbers.
pub(super) struct Unpacked {
    pub(super) document: gltf::Document,
    pub(super) blob: Vec<u8>,
    /// Bytes of views that were compressed.
    pub(super) coded: BTreeMap<usize, usize>,
}

/// What a .glb holds in plain numbers; `Ok(None)` where nothing has to be done.
///
/// # Errors
/// [`PlayedError`].
pub(super) fn unpack(glb: &[u8]) -> Result<Option<Unpacked>, PlayedError> {
    if !glb.starts_with(b"glTF") {
        return Ok(None);
    }
    let file = Glb::from_slice(glb)?;
    let broken = |_| PlayedError::Missing("sound JSON");
    let mut root: Value = serde_json::from_slice(&file.json).map_err(broken)?;
    let known = |name: &Value| {
        let name = name.as_str().unwrap_or_default();
        COMPRESSIONS.contains(&name) || name == QUANTIZATION
    };
    if !list(&root, "extensionsUsed").iter().any(known) {
        return Ok(None);
    }
    let bin = file.bin.unwrap_or_default();
    let mut out = bin.to_vec();
    let coded = decompress(&mut root, &bin, &mut out)?;
    widen(&mut root, &mut out)?;
    for key in ["extensionsUsed", "extensionsRequired"] {
        let kept: Vec<Value> = list(&root, key)
            .iter()
            .filter(|name| !known(name))
            .cloned()
            .collect();
        if let Some(root) = root.as_object_mut() {
            root.remove(key);
            if !kept.is_empty() {
                root.insert(key.to_owned(), kept.into());
            }
        }
    }
    root["buffers"] = json!([{ "byteLength": out.len() }]);
    let root: gltf::json::Root = serde_json::from_value(root).map_err(broken)?;
    Ok(Some(Unpacked {
        document: gltf::Document::from_json(root)?,
        blob: out,
        coded,
    }))
}

fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().map_or(&[], Vec::as_slice)
}

fn number(value: &Value, key: &str) -> usize {
    value[key].as_u64().unwrap_or(0) as usize
}

/// Puts what compressed views hold behind `out` and lets them point there.
fn decompress(
    root: &mut Value,
    bin: &[u8],
    out: &mut Vec<u8>,
) -> Result<BTreeMap<usize, usize>, PlayedError> {
    let mut sizes = BTreeMap::new();
    let Some(views) = root["bufferViews"].as_array_mut() else {
        return Ok(sizes);
    };
    for (at, view) in views.iter_mut().enumerate() {
        let fault = |what| PlayedError::Compressed { view: at, what };
        let Some(how) = COMPRESSIONS
            .iter()
            .find_map(|name| view["extensions"].get(name))
        else {
            // What lies in another buffer than the first is not in the file.
            if number(view, "buffer") != 0 {
                return Err(fault("bytes outside of the file"));
            }
            continue;
        };
        if number(how, "buffer") != 0 {
            return Err(fault("bytes outside of the file"));
        }
        let begin = number(how, "byteOffset");
        let end = begin.saturating_add(number(how, "byteLength"));
        let coded = bin
            .get(begin..end)
            .ok_or(fault("bytes outside of the file"))?;
        let layout = Layout {
            mode: how["mode"]
                .as_str()
                .and_then(Mode::of)
                .ok_or(fault("no mode that is known"))?,
            filter: match &how["filter"] {
                Value::Null => Filter::None,
                name => name
                    .as_str()
                    .and_then(Filter::of)
                    .ok_or(fault("no filter that is known"))?,
            },
            stride: number(how, "byteStride"),
            count: number(how, "count"),
        };
        let bytes = decode(coded, layout).map_err(fault)?;
        if bytes.len() != number(view, "byteLength") {
            return Err(fault("another length than it says"));
        }
        out.resize(out.len().next_multiple_of(4), 0);
        view["buffer"] = 0.into();
        view["byteOffset"] = out.len().into();
        if let Some(view) = view.as_object_mut() {
            view.remove("extensions");
        }
        out.extend(bytes);
        sizes.insert(at, coded.len());
    }
    Ok(sizes)
}

/// Turns positions, normals, tangents and texture coordinates that are integers into floats.
fn widen(root: &mut Value, out: &mut Vec<u8>) -> Result<(), PlayedError> {
    let mut wanted = std::collections::BTreeSet::new();
    for mesh in list(root, "meshes") {
        for primitive in list(mesh, "primitives") {
            let targets = list(primitive, "targets").iter();
            for attributes in targets.chain([&primitive["attributes"]]) {
                let each = attributes.as_object().into_iter().flatten();
                let wide = each.filter(|(name, _)| {
                    ["POSITION", "NORMAL", "TANGENT"].contains(&name.as_str())
                        || name.starts_with("TEXCOORD")
                });
                wanted.extend(wide.filter_map(|(_, accessor)| accessor.as_u64()));
            }
        }
    }
    for at in wanted {
        let Some(accessor) = root["accessors"].get(at as usize) else {
            continue;
        };
        let component = number(accessor, "componentType");
        if component == 5126 {
            continue;
        }
        let fault = PlayedError::Missing("sound integers of vertices");
        let Some(floats) = floats(root, accessor, component, out) else {
            return Err(fault);
        };
        out.resize(out.len().next_multiple_of(4), 0);
        let width = floats.len() / number(accessor, "count").max(1);
        let bound = |pick: fn(f32, f32) -> f32, start: f32| -> Vec<f32> {
            let one = |i| {
                floats
                    .iter()
                    .skip(i)
                    .step_by(width)
                    .copied()
                    .fold(start, pick)
            };
            (0..width).map(one).collect()
        };
        let (low, high) = (
            bound(f32::min, f32::INFINITY),
            bound(f32::max, f32::NEG_INFINITY),
        );
        let view = json!({ "buffer": 0, "byteOffset": out.len(), "byteLength": floats.len() * 4 });
        out.extend(floats.iter().flat_map(|x| x.to_le_bytes()));
        let made = json!({
            "bufferView": list(root, "bufferViews").len(),
            "componentType": 5126,
            "count": number(accessor, "count"),
            "type": accessor["type"],
            "min": low,
            "max": high,
        });
        if let Some(views) = root["bufferViews"].as_array_mut() {
            views.push(view);
        }
        root["accessors"][at as usize] = made;
    }
    Ok(())
}

fn floats(root: &Value, accessor: &Value, component: usize, out: &[u8]) -> Option<Vec<f32>> {
    let width = match accessor["type"].as_str()? {
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        _ => return None,
    };
    let (size, most) = match component {
        5120 => (1, 127.0),
        5121 => (1, 255.0),
        5122 => (2, 32767.0),
        5123 => (2, 65535.0),
        _ => return None,
    };
    let most = if accessor["normalized"] == true {
        most
    } else {
        1.0
    };
    let view = list(root, "bufferViews").get(number(accessor, "bufferView"))?;
    let begin = number(view, "byteOffset").checked_add(number(accessor, "byteOffset"))?;
    let stride = match number(view, "byteStride") {
        0 => size * width,
        stride => stride,
    };
    let count = number(accessor, "count");
    if count.checked_mul(stride)? > number(view, "byteLength").checked_add(stride)? {
        return None;
    }
    let mut floats = Vec::with_capacity(count * width);
    for element in 0..count {
        for i in 0..width {
            let at = begin.checked_add(element * stride + i * size)?;
            let bytes = out.get(at..at.checked_add(size)?)?;
            let whole = match (component, bytes) {
                (5120, [b]) => f32::from(*b as i8),
                (5121, [b]) => f32::from(*b),
                (5122, [a, b]) => f32::from(i16::from_le_bytes([*a, *b])),
                (_, [a, b]) => f32::from(u16::from_le_bytes([*a, *b])),
                _ => return None,
            };
            floats.push((whole / most).max(if most == 1.0 { f32::MIN } else { -1.0 }));
        }
    }
    Some(floats)
}
