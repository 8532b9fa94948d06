//! Meshes and skins.

use super::buffer::{Buffer, Numbers, Use};
use crate::model::{Mesh, Part, Properties, Skin};
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::mesh::{Mode, MorphTarget, Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index, Root};
use std::collections::BTreeMap;

/// A mesh with all its parts; `joints` is the greatest number of joints of any skin.
pub(crate) fn mesh(
    root: &mut Root,
    buffer: &mut Buffer,
    mesh: &Mesh,
    own: Option<&Properties>,
) -> gltf_json::Mesh {
    let primitives = mesh
        .parts
        .iter()
        .map(|part| primitive(root, buffer, part))
        .collect();
    let names: Vec<&str> = mesh.targets.iter().map(|target| &*target.name).collect();
    let mut extras = own.cloned().unwrap_or_default();
    if !names.is_empty() {
        extras.insert("targetNames".into(), names.into());
    }
    gltf_json::Mesh {
        extensions: None,
        extras: super::names::extras(Some(&extras).filter(|extras| !extras.is_empty())),
        name: super::names::name(&mesh.name),
        primitives,
        weights: match mesh.targets.is_empty() {
            true => None,
            false => Some(
                mesh.targets
                    .iter()
                    .map(|target| target.rest as f32)
                    .collect(),
            ),
        },
    }
}

fn primitive(root: &mut Root, buffer: &mut Buffer, part: &Part) -> Primitive {
    let mut attributes: BTreeMap<Checked<Semantic>, Index<Accessor>> = BTreeMap::new();
    let mut put = |root: &mut Root, semantic, numbers: &Numbers| {
        let accessor = buffer.accessor(root, numbers, Use::Vertices);
        attributes.insert(Checked::Valid(semantic), accessor);
    };
    put(
        root,
        Semantic::Positions,
        &Numbers::bounded(&part.positions),
    );
    put(root, Semantic::Normals, &Numbers::floats(&part.normals));
    if !part.tangents.is_empty() {
        put(root, Semantic::Tangents, &Numbers::floats(&part.tangents));
    }
    for (set, uvs) in part.uvs.iter().enumerate() {
        put(root, Semantic::TexCoords(set as u32), &Numbers::floats(uvs));
    }
    for (set, colours) in part.colours.iter().enumerate() {
        put(
            root,
            Semantic::Colors(set as u32),
            &Numbers::floats(colours),
        );
    }
    for (set, joints) in part.joints.iter().enumerate() {
        put(root, Semantic::Joints(set as u32), &joint_numbers(joints));
    }
    for (set, weights) in part.weights.iter().enumerate() {
        put(
            root,
            Semantic::Weights(set as u32),
            &Numbers::floats(weights),
        );
    }
    let mut target = |(positions, normals): &(Vec<[f32; 3]>, Vec<[f32; 3]>)| MorphTarget {
        positions: Some(buffer.accessor(root, &Numbers::bounded(positions), Use::Vertices)),
        normals: (!normals.is_empty())
            .then(|| buffer.accessor(root, &Numbers::floats(normals), Use::Vertices)),
        tangents: None,
    };
    let targets: Vec<MorphTarget> = part.offsets.iter().map(&mut target).collect();
    Primitive {
        attributes,
        extensions: None,
        extras: None,
        indices: Some(buffer.accessor(root, &index_numbers(part), Use::Indices)),
        material: part.material.map(|material| Index::new(material as u32)),
        mode: Checked::Valid(Mode::Triangles),
        targets: (!targets.is_empty()).then_some(targets),
    }
}

/// Indices in 16 bits where they fit; the greatest 16-bit number would restart a strip.
fn index_numbers(part: &Part) -> Numbers {
    let small = part.positions.len() < usize::from(u16::MAX);
    let indices = part.indices.iter();
    Numbers {
        bytes: match small {
            true => indices.flat_map(|&i| (i as u16).to_le_bytes()).collect(),
            false => indices.flat_map(|i| i.to_le_bytes()).collect(),
        },
        component: if small {
            ComponentType::U16
        } else {
            ComponentType::U32
        },
        shape: Type::Scalar,
        count: part.indices.len(),
        normalised: false,
        period: 1,
        bounds: None,
    }
}

fn joint_numbers(joints: &[[u16; 4]]) -> Numbers {
    let small = joints.iter().flatten().all(|&joint| joint < 256);
    let all = joints.iter().flatten();
    Numbers {
        bytes: match small {
            true => all.map(|&joint| joint as u8).collect(),
            false => all.flat_map(|joint| joint.to_le_bytes()).collect(),
        },
        component: if small {
            ComponentType::U8
        } else {
            ComponentType::U16
        },
        shape: Type::Vec4,
        count: joints.len(),
        normalised: false,
        period: 4,
        bounds: None,
    }
}

/// A skin.
pub(crate) fn skin(root: &mut Root, buffer: &mut Buffer, skin: &Skin) -> gltf_json::Skin {
    let matrices: Vec<[f32; 16]> = skin
        .inverse_bind
        .iter()
        .map(|m| {
            let mut m = m.as_mat4().to_cols_array();
            // The specification wants the last row exact, and it is.
            (m[3], m[7], m[11], m[15]) = (0.0, 0.0, 0.0, 1.0);
            m
        })
        .collect();
    gltf_json::Skin {
        extensions: None,
        extras: None,
        inverse_bind_matrices: Some(buffer.accessor(root, &Numbers::floats(&matrices), Use::Other)),
        joints: skin
            .joints
            .iter()
            .map(|&joint| Index::new(joint as u32))
            .collect(),
        name: super::names::name(&skin.name),
        skeleton: None,
    }
}
