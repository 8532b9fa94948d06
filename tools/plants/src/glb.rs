//! Binary glTF 2.0: each level is a mesh; the scene shows the finest.

use serde_json::{Value, json};

use crate::model::Model;

const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;

/// The bytes of a file. Models have at most 65 536 vertices.
#[must_use]
pub fn glb(name: &str, levels: &[Model], roughness: f32) -> Vec<u8> {
    let mut data = Vec::new();
    let mut views = Vec::new();
    let mut accessors = Vec::new();
    let mut meshes = Vec::new();
    let mut view = |bytes: &[u8], target: u32, data: &mut Vec<u8>| {
        views.push(json!({"buffer": 0, "byteOffset": data.len(), "byteLength": bytes.len(), "target": target}));
        data.extend_from_slice(bytes);
        data.resize(data.len().next_multiple_of(4), 0);
        views.len() - 1
    };
    for (number, model) in levels.iter().enumerate() {
        let places: Vec<[f32; 3]> = model.vertices.iter().map(|v| v.place).collect();
        let normals: Vec<[f32; 3]> = model.vertices.iter().map(|v| v.normal).collect();
        let colours: Vec<[u16; 4]> = model
            .vertices
            .iter()
            .map(|v| {
                let [r, g, b] = v
                    .colour
                    .map(|c| (c.clamp(0.0, 1.0) * 65_535.0).round() as u16);
                [r, g, b, u16::MAX]
            })
            .collect();
        let indices: Vec<u16> = model.indices.iter().map(|k| *k as u16).collect();
        let bounds = |pick: fn(f32, f32) -> f32, from: f32| {
            places.iter().fold([from; 3], |all, place| {
                [0, 1, 2].map(|k| pick(all[k], place[k]))
            })
        };
        let (min, max) = (bounds(f32::min, f32::MAX), bounds(f32::max, f32::MIN));
        let count = places.len();
        let parts = [
            (
                bytemuck::cast_slice(&places),
                34962,
                json!({"componentType": FLOAT, "count": count, "type": "VEC3", "min": min, "max": max}),
            ),
            (
                bytemuck::cast_slice(&normals),
                34962,
                json!({"componentType": FLOAT, "count": count, "type": "VEC3"}),
            ),
            (
                bytemuck::cast_slice(&colours),
                34962,
                json!({"componentType": UNSIGNED_SHORT, "normalized": true, "count": count, "type": "VEC4"}),
            ),
            (
                bytemuck::cast_slice(&indices),
                34963,
                json!({"componentType": UNSIGNED_SHORT, "count": indices.len(), "type": "SCALAR"}),
            ),
        ];
        let [place, normal, colour, index] =
            parts.map(|(bytes, target, mut accessor): (&[u8], u32, Value)| {
                accessor["bufferView"] = view(bytes, target, &mut data).into();
                accessors.push(accessor);
                accessors.len() - 1
            });
        meshes.push(json!({
            "name": format!("{name}_level_{number}"),
            "primitives": [{
                "attributes": {"POSITION": place, "NORMAL": normal, "COLOR_0": colour},
                "indices": index,
                "material": 0,
            }],
        }));
    }
    let text = json!({
        "asset": {"version": "2.0", "generator": "dolomite_plants"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": name, "mesh": 0}],
        "meshes": meshes,
        "materials": [{"name": name, "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": roughness}}],
        "buffers": [{"byteLength": data.len()}],
        "bufferViews": views,
        "accessors": accessors,
    });
    let mut text = text.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = Vec::new();
    let word = |k: usize, file: &mut Vec<u8>| file.extend_from_slice(&(k as u32).to_le_bytes());
    file.extend_from_slice(b"glTF");
    word(2, &mut file);
    word(12 + 8 + text.len() + 8 + data.len(), &mut file);
    word(text.len(), &mut file);
    file.extend_from_slice(b"JSON");
    file.extend_from_slice(&text);
    word(data.len(), &mut file);
    file.extend_from_slice(b"BIN\0");
    file.extend_from_slice(&data);
    file
}
