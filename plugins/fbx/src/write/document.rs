//! The whole JSON document.

use super::animation::animation;
use super::buffer::{Buffer, Use};
use super::looks::{camera, light, material};
use super::meshes::{mesh, skin};
use super::names::{name, uses};
use crate::model::{Model, Node, Trs};
use gltf_json::extensions::root::{KhrLightsPunctual, Root as RootExtensions};
use gltf_json::extensions::scene::Node as NodeExtensions;
use gltf_json::extensions::scene::khr_lights_punctual::KhrLightsPunctual as NodeLight;
use gltf_json::image::MimeType;
use gltf_json::scene::UnitQuaternion;
use gltf_json::{Asset, Image, Index, Root, Scene};
use serde_json::Map;

/// Where pictures go.
pub(crate) enum Pictures<'a> {
    /// Into the buffer.
    Inside,
    /// Into files of these names.
    Files(&'a [String]),
}

/// The document and its buffer. The entry for the buffer itself is left to the container.
pub(crate) fn document(model: &Model, pictures: Pictures) -> (Root, Vec<u8>) {
    let mut root = Root {
        asset: Asset {
            generator: Some(concat!("dolomite_fbx ", env!("CARGO_PKG_VERSION")).into()),
            version: "2.0".into(),
            ..Asset::default()
        },
        ..Root::default()
    };
    let mut buffer = Buffer::default();
    // Animations first: their bytes lie together.
    for clip in model.clips.iter().filter(|clip| !clip.channels.is_empty()) {
        let clip = animation(&mut root, &mut buffer, clip);
        root.push(clip);
    }
    for source in &model.meshes {
        let made = mesh(&mut root, &mut buffer, source);
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
    for source in &model.materials {
        let made = material(&mut root, source);
        root.push(made);
    }
    for source in &model.cameras {
        root.push(camera(source));
    }
    if !model.lights.is_empty() {
        uses(&mut root, "KHR_lights_punctual");
        root.extensions = Some(RootExtensions {
            khr_lights_punctual: Some(KhrLightsPunctual {
                lights: model.lights.iter().map(light).collect(),
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
    for (node, children) in model.nodes.iter().zip(children) {
        root.push(self::node(node, children));
    }
    let roots = (0..model.nodes.len()).filter(|&node| model.nodes[node].parent.is_none());
    let scene = root.push(Scene {
        extensions: None,
        extras: None,
        name: None,
        nodes: roots.map(|node| Index::new(node as u32)).collect(),
    });
    root.scene = Some(scene);
    (root, buffer.bytes)
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
