//! The whole JSON document.

use super::animation::animation;
use super::buffer::{Buffer, Use};
use super::compress::{self, named};
use super::looks::{camera, light, material};
use super::meshes::{mesh, skin};
use super::names::{extras, name, uses};
use crate::model::{Model, Node, Trs};
use crate::options::Compression;
use gltf_json::accessor::GenericComponentType;
use gltf_json::extensions::root::{KhrLightsPunctual, Root as RootExtensions};
use gltf_json::extensions::scene::Node as NodeExtensions;
use gltf_json::extensions::scene::khr_lights_punctual::KhrLightsPunctual as NodeLight;
use gltf_json::image::MimeType;
use gltf_json::scene::UnitQuaternion;
use gltf_json::validation::{Checked, USize64};
use gltf_json::{Accessor, Asset, Image, Index, Root, Scene, extensions};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Hides nodes and all below them.
const VISIBILITY: &str = "KHR_node_visibility";

/// Where pictures go.
pub(crate) enum Pictures<'a> {
    /// Into the buffer.
    Inside,
    /// Into files of these names; the buffer has a file of its own.
    Files {
        names: &'a [String],
        buffer: &'a str,
    },
}

/// A whole document, and the buffer that it refers to.
pub(crate) struct Document {
    pub(crate) root: Root,
    pub(crate) bytes: Vec<u8>,
}

impl Document {
    /// The JSON text.
    pub(crate) fn text(&self) -> Vec<u8> {
        let text = self.root.to_vec();
        text.expect("numbers and strings are JSON")
    }

    /// Bytes of text and buffer, each to a multiple of four, as a .glb has them.
    pub(crate) fn size(&self) -> usize {
        self.text().len().next_multiple_of(4) + self.bytes.len().next_multiple_of(4)
    }

    /// Whether anything of it is compressed.
    pub(crate) fn is_compressed(&self) -> bool {
        let mut required = self.root.extensions_required.iter();
        required.any(|name| name == compress::NAME)
    }

    /// Bytes of keys and their times; accessors and compressed views that several channels share count once.
    pub(crate) fn animation_bytes(&self) -> usize {
        let root = &self.root;
        let samplers = root.animations.iter().flat_map(|clip| &clip.samplers);
        let accessors = samplers.flat_map(|sampler| [sampler.input, sampler.output]);
        let sizes: BTreeMap<(bool, usize), usize> = accessors
            .map(|number| {
                let accessor = &root.accessors[number.value()];
                let coded = accessor.buffer_view.and_then(|view| {
                    let extensions = root.buffer_views[view.value()].extensions.as_ref()?;
                    let how = extensions.others.get(compress::NAME)?;
                    Some((view.value(), how.get("byteLength")?.as_u64()? as usize))
                });
                match coded {
                    Some((view, bytes)) => ((true, view), bytes),
                    None => ((false, number.value()), bytes_of(accessor)),
                }
            })
            .collect();
        sizes.values().sum()
    }
}

/// Bytes of the numbers of an accessor.
fn bytes_of(accessor: &Accessor) -> usize {
    let (Checked::Valid(GenericComponentType(component)), Checked::Valid(shape)) =
        (&accessor.component_type, &accessor.type_)
    else {
        return 0;
    };
    accessor.count.0 as usize * component.size() * shape.multiplicity()
}

/// The document of a model. Under compression it is the smallest of three: plain, views of clips by their kinds, and
/// with those merged that can be.
pub(crate) fn document(model: &Model, pictures: &Pictures, compression: Compression) -> Document {
    let mut best = written(model, pictures, Buffer::default());
    if compression == Compression::None {
        return best;
    }
    let mut size = best.size();
    let ways: &[bool] = match model.clips.iter().any(|clip| !clip.channels.is_empty()) {
        true => &[false, true],
        false => &[false],
    };
    for &merged in ways {
        let next = written(model, pictures, Buffer::compressed(merged));
        let next_size = next.size();
        if next_size < size {
            (best, size) = (next, next_size);
        }
    }
    best
}

fn written(model: &Model, pictures: &Pictures, mut buffer: Buffer) -> Document {
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
            Pictures::Files { names, .. } => (None, Some(names[number].clone())),
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
    let uri = match pictures {
        Pictures::Inside => None,
        Pictures::Files { buffer, .. } => Some(*buffer),
    };
    give_buffers(&mut root, &bytes, uri, fallback);
    Document { root, bytes }
}

/// The entry of the buffer, and of the one that has no bytes where something is compressed.
fn give_buffers(root: &mut Root, bytes: &[u8], uri: Option<&str>, fallback: usize) {
    let mut give = |length: usize, uri: Option<&str>, others: Map<String, Value>| {
        root.push(gltf_json::Buffer {
            byte_length: USize64::from(length),
            name: None,
            uri: uri.map(str::to_owned),
            extensions: (!others.is_empty()).then_some(extensions::buffer::Buffer { others }),
            extras: None,
        });
    };
    if !bytes.is_empty() {
        give(bytes.len(), uri, Map::new());
    }
    if fallback > 0 {
        give(fallback, None, named(json!({ "fallback": true })));
    }
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
