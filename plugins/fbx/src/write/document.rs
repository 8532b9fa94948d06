//! The whole JSON document.

use super::animation::animation;
use super::buffer::{Buffer, Use};
use super::compress;
use super::looks::{camera, light, material};
use super::meshes::{mesh, skin};
use super::names::{extras, name, uses};
use crate::model::{Model, Node, Trs};
use crate::options::Compression;
use gltf_json::extensions::root::{KhrLightsPunctual, Root as RootExtensions};
use gltf_json::extensions::scene::Node as NodeExtensions;
use gltf_json::extensions::scene::khr_lights_punctual::KhrLightsPunctual as NodeLight;
use gltf_json::image::MimeType;
use gltf_json::scene::UnitQuaternion;
use gltf_json::{Asset, Image, Index, Root, Scene};
use serde_json::Map;

/// Hides nodes and all below them.
const VISIBILITY: &str = "KHR_node_visibility";

/// Where pictures go.
pub(crate) enum Pictures<'a> {
    /// Into the buffer.
    Inside,
    /// Into files of these names.
    Files(&'a [String]),
}

/// The document, its buffer, and how many bytes a buffer would have that stands in for what is compressed. The
/// entries for the buffers themselves are left to the container.
pub(crate) fn document(
    model: &Model,
    pictures: &Pictures,
    compression: Compression,
) -> (Root, Vec<u8>, usize) {
    match compression {
        Compression::None => written(model, pictures, Buffer::default()),
        Compression::Meshopt => {
            let [apart, merged] =
                [false, true].map(|merged| written(model, pictures, Buffer::compressed(merged)));
            match merged.1.len() < apart.1.len() {
                true => merged,
                false => apart,
            }
        }
    }
}

fn written(model: &Model, pictures: &Pictures, mut buffer: Buffer) -> (Root, Vec<u8>, usize) {
    let mut root = Root {
        asset: Asset {
            generator: Some(concat!("dolomite_fbx ", env!("CARGO_PKG_VERSION")).into()),
            version: "2.0".into(),
            ..Asset::default()
        },
        ..Root::default()
    };
    // Animations first: their bytes lie together.
    for clip in model.clips.iter().filter(|clip| !clip.channels.is_empty()) {
        let clip = animation(&mut root, &mut buffer, clip);
        root.push(clip);
    }
    for (number, source) in model.meshes.iter().enumerate() {
        let own = model.extras.meshes.get(&number);
        let made = mesh(&mut root, &mut buffer, source, own);
        root.push(made);
    }
    for source in &model.skins {
        let made = skin(&mut root, &mut buffer, source);
        root.push(made);
    }
    for (number, image) in model.images.iter().enumerate() {
        let (view, uri) = match pictures {
            Pictures::Inside => (Some(buffer.view(&mut root, &image.bytes, Use::Other)), None),
            Pictures::Files(names) => (None, Some(names[number].clone())),
        };
        root.push(Image {
            buffer_view: view,
            mime_type: view.map(|_| MimeType(image.mime.into())),
            name: name(&image.name),
            uri,
            extensions: None,
            extras: None,
        });
    }
    for (number, source) in model.materials.iter().enumerate() {
        let mut made = material(&mut root, source);
        made.extras = extras(model.extras.materials.get(&number));
        root.push(made);
    }
    for (number, source) in model.cameras.iter().enumerate() {
        let mut made = camera(source);
        made.extras = extras(model.extras.cameras.get(&number));
        root.push(made);
    }
    let lights = model.lights.iter().enumerate().map(|(number, source)| {
        let mut made = light(source);
        made.extras = extras(model.extras.lights.get(&number));
        made
    });
    if !model.lights.is_empty() {
        uses(&mut root, "KHR_lights_punctual");
        root.extensions = Some(RootExtensions {
            khr_lights_punctual: Some(KhrLightsPunctual {
                lights: lights.collect(),
            }),
            others: Map::new(),
        });
    }
    let mut children = vec![Vec::new(); model.nodes.len()];
    for (number, node) in model.nodes.iter().enumerate() {
        if let Some(parent) = node.parent {
            children[parent].push(Index::new(number as u32));
        }
    }
    if !model.hidden.is_empty() {
        uses(&mut root, VISIBILITY);
    }
    for (number, (node, children)) in model.nodes.iter().zip(children).enumerate() {
        let mut made = self::node(node, children);
        made.extras = extras(model.extras.nodes.get(&number));
        if model.hidden.contains(&number) {
            let hidden = serde_json::json!({ "visible": false });
            let extensions = made.extensions.get_or_insert_default();
            extensions.others.insert(VISIBILITY.into(), hidden);
        }
        root.push(made);
    }
    let roots = (0..model.nodes.len()).filter(|&node| model.nodes[node].parent.is_none());
    let scene = root.push(Scene {
        extensions: None,
        extras: None,
        name: None,
        nodes: roots.map(|node| Index::new(node as u32)).collect(),
    });
    root.scene = Some(scene);
    let (bytes, fallback) = buffer.finish(&mut root);
    if fallback > 0 {
        uses(&mut root, compress::NAME);
        root.extensions_required.push(compress::NAME.to_owned());
    }
    (root, bytes, fallback)
}

/// Bytes of keys and their times as they are written; what several channels share counts once.
pub(crate) fn animation_bytes(model: &Model, compression: Compression) -> usize {
    let clips = Model {
        clips: model.clips.clone(),
        ..Model::default()
    };
    let (root, ..) = document(&clips, &Pictures::Inside, compression);
    let coded = |view: &gltf_json::buffer::View| {
        let how = view.extensions.as_ref()?.others.get(compress::NAME)?;
        how.get("byteLength")?.as_u64()
    };
    let bytes = |view| coded(view).unwrap_or(view.byte_length.0) as usize;
    root.buffer_views.iter().map(bytes).sum()
}

fn node(node: &Node, children: Vec<Index<gltf_json::Node>>) -> gltf_json::Node {
    let Trs {
        translation,
        rotation,
        scale,
    } = node.rest;
    let index = |number: Option<usize>| number.map(|n| n as u32);
    gltf_json::Node {
        camera: index(node.camera).map(Index::new),
        children: (!children.is_empty()).then_some(children),
        extensions: node.light.map(|light| NodeExtensions {
            khr_lights_punctual: Some(NodeLight {
                light: Index::new(light as u32),
            }),
            others: Map::new(),
        }),
        extras: None,
        matrix: None,
        mesh: index(node.mesh).map(Index::new),
        name: name(&node.name),
        rotation: (node.rest.rotation != Trs::IDENTITY.rotation)
            .then(|| UnitQuaternion(rotation.normalize().as_quat().to_array())),
        scale: (scale != Trs::IDENTITY.scale).then(|| scale.as_vec3().to_array()),
        translation: (translation != Trs::IDENTITY.translation)
            .then(|| translation.as_vec3().to_array()),
        skin: index(node.skin).map(Index::new),
        weights: None,
    }
}
