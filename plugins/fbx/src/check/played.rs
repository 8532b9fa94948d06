//! A .glb, read by the crate `gltf` and played on the CPU.

use super::unpack::{Unpacked, unpack};
use crate::clips::{Player, order, play};
use crate::model::{Channel, Clip, Interpolation, Node, Property, Skin, Trs};
use glam::{DMat4, DVec3, Mat4, Quat, Vec3};
use gltf::animation::Interpolation as GltfInterpolation;
use gltf::animation::util::ReadOutputs;
use std::collections::BTreeMap;

/// Why a .glb cannot be played.
#[derive(Debug, thiserror::Error)]
pub enum PlayedError {
    /// The crate `gltf` refuses it.
    #[error("no sound .glb: {0}")]
    Refused(#[from] gltf::Error),
    /// A compressed view cannot be decoded.
    #[error("buffer view {view} of the .glb has {what}")]
    Compressed {
        /// Its number.
        view: usize,
        /// What is wrong with it.
        what: &'static str,
    },
    /// Something that was to be there is not.
    #[error("the .glb has no {0}")]
    Missing(&'static str),
}

/// A .glb in memory.
pub struct Played {
    pub(super) nodes: Vec<Node>,
    pub(super) order: Vec<usize>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) skins: Vec<Skin>,
    pub(super) clips: Vec<Clip>,
    animation_bytes: usize,
}

pub(super) struct Mesh {
    weights: Vec<f64>,
    pub(super) parts: Vec<Part>,
}

pub(super) struct Part {
    pub(super) positions: Vec<DVec3>,
    offsets: Vec<Vec<DVec3>>,
    /// Joints and weights of each vertex, those above 0.
    pub(super) joints: Vec<Vec<(usize, f64)>>,
}

/// A mesh where a node shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Number of the mesh.
    pub mesh: usize,
    /// Vertices of all its primitives in the world, metres.
    pub points: Vec<DVec3>,
}

impl Played {
    /// Reads a .glb.
    ///
    /// # Errors
    /// [`PlayedError`].
    pub fn read(glb: &[u8]) -> Result<Self, PlayedError> {
        let Unpacked {
            document,
            blob,
            coded,
        } = match unpack(glb)? {
            Some(unpacked) => unpacked,
            None => {
                let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(glb)?;
                Unpacked {
                    document,
                    blob: blob.unwrap_or_default(),
                    coded: BTreeMap::new(),
                }
            }
        };
        let mut parents = vec![None; document.nodes().len()];
        for node in document.nodes() {
            for child in node.children() {
                parents[child.index()] = Some(node.index());
            }
        }
        let nodes: Vec<Node> = document
            .nodes()
            .map(|node| read_node(&node, &parents))
            .collect();
        let meshes = document
            .meshes()
            .map(|mesh| read_mesh(&mesh, &blob))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            animation_bytes: animation_bytes(&document, &coded),
            order: order(&parents),
            nodes,
            meshes,
            skins: document
                .skins()
                .map(|skin| read_skin(&skin, &blob))
                .collect::<Result<_, _>>()?,
            clips: document
                .animations()
                .map(|clip| read_clip(&clip, &blob))
                .collect::<Result<_, _>>()?,
        })
    }

    /// Names and seconds of the clips.
    pub fn clips(&self) -> Vec<(String, f64)> {
        self.clips
            .iter()
            .map(|clip| (clip.name.clone(), clip.duration))
            .collect()
    }

    /// Bytes of all keys and times as they lie in the file; accessors and compressed views that several
    /// channels share count once.
    pub fn animation_bytes(&self) -> usize {
        self.animation_bytes
    }

    /// Every mesh where a node shows it, and where every node is, at `time` seconds of a clip; `None`
    /// is the pose at rest.
    pub fn at(&self, clip: Option<usize>, time: f64) -> (Vec<Shape>, Vec<(String, DVec3)>) {
        let (world, weights) = self.world(clip, time);
        let shapes = (0..self.nodes.len())
            .filter_map(|node| self.shape(node, weights[node].as_deref(), &world))
            .collect();
        let places = self.nodes.iter().zip(&world);
        let places = places.map(|(node, world)| (node.name.clone(), world.w_axis.truncate()));
        (shapes, places.collect())
    }

    /// Matrices of all nodes at `time` seconds of a clip, and weights that it gives to meshes.
    pub(super) fn world(
        &self,
        clip: Option<usize>,
        time: f64,
    ) -> (Vec<DMat4>, Vec<Option<Vec<f64>>>) {
        let mut pose: Vec<Trs> = self.nodes.iter().map(|node| node.rest).collect();
        let mut weights: Vec<Option<Vec<f64>>> = vec![None; self.nodes.len()];
        if let Some(clip) = clip.and_then(|clip| self.clips.get(clip)) {
            let mut players: Vec<Player> = clip.channels.iter().map(Player::new).collect();
            play(&mut players, time, &mut pose, |node, w| {
                weights[node] = Some(w.to_vec())
            });
        }
        let mut world = vec![DMat4::IDENTITY; self.nodes.len()];
        for &node in &self.order {
            let own = pose[node].matrix();
            world[node] = match self.nodes[node].parent {
                Some(parent) => world[parent] * own,
                None => own,
            };
        }
        (world, weights)
    }

    fn shape(&self, node: usize, weights: Option<&[f64]>, world: &[DMat4]) -> Option<Shape> {
        let number = self.nodes[node].mesh?;
        let mesh = &self.meshes[number];
        let weights = weights.unwrap_or(&mesh.weights);
        let matrices: Option<Vec<DMat4>> = self.nodes[node].skin.map(|skin| {
            let skin = &self.skins[skin];
            let joints = skin.joints.iter().zip(&skin.inverse_bind);
            joints.map(|(&joint, bind)| world[joint] * *bind).collect()
        });
        let mut points = Vec::new();
        for part in &mesh.parts {
            for vertex in 0..part.positions.len() {
                let mut point = part.positions[vertex];
                for (offsets, weight) in part.offsets.iter().zip(weights) {
                    point += offsets[vertex] * *weight;
                }
                points.push(match &matrices {
                    None => world[node].transform_point3(point),
                    Some(matrices) => part.joints[vertex]
                        .iter()
                        .map(|&(joint, weight)| matrices[joint].transform_point3(point) * weight)
                        .sum(),
                });
            }
        }
        Some(Shape {
            mesh: number,
            points,
        })
    }
}

/// `coded` says how many bytes compressed views have; each counts once.
fn animation_bytes(document: &gltf::Document, coded: &BTreeMap<usize, usize>) -> usize {
    let samplers = document.animations().flat_map(|clip| {
        let samplers: Vec<_> = clip.samplers().collect();
        samplers
            .into_iter()
            .flat_map(|sampler| [sampler.input(), sampler.output()])
    });
    let sizes: BTreeMap<(bool, usize), usize> = samplers
        .map(|accessor| {
            let view = accessor.view().map(|view| view.index());
            match view.and_then(|view| Some((view, *coded.get(&view)?))) {
                Some((view, bytes)) => ((true, view), bytes),
                None => (
                    (false, accessor.index()),
                    accessor.count() * accessor.size(),
                ),
            }
        })
        .collect();
    sizes.values().sum()
}

fn vec3(v: [f32; 3]) -> DVec3 {
    Vec3::from(v).as_dvec3()
}

fn read_node(node: &gltf::Node, parents: &[Option<usize>]) -> Node {
    let (translation, rotation, scale) = node.transform().decomposed();
    Node {
        name: node.name().unwrap_or_default().to_owned(),
        parent: parents[node.index()],
        rest: Trs {
            translation: vec3(translation),
            rotation: Quat::from_array(rotation).as_dquat().normalize(),
            scale: vec3(scale),
        },
        mesh: node.mesh().map(|mesh| mesh.index()),
        skin: node.skin().map(|skin| skin.index()),
        light: None,
        camera: node.camera().map(|camera| camera.index()),
    }
}

fn read_mesh(mesh: &gltf::Mesh, blob: &[u8]) -> Result<Mesh, PlayedError> {
    let mut parts = Vec::new();
    for primitive in mesh.primitives() {
        let reader = primitive.reader(|_| Some(blob));
        let positions = reader
            .read_positions()
            .ok_or(PlayedError::Missing("positions"))?;
        let positions: Vec<DVec3> = positions.map(vec3).collect();
        let mut joints = vec![Vec::new(); positions.len()];
        for set in 0..2 {
            let (Some(numbers), Some(weights)) =
                (reader.read_joints(set), reader.read_weights(set))
            else {
                continue;
            };
            let pairs = numbers.into_u16().zip(weights.into_f32());
            for (list, (numbers, weights)) in joints.iter_mut().zip(pairs) {
                let pairs = numbers
                    .into_iter()
                    .zip(weights)
                    .filter(|(_, weight)| *weight > 0.0);
                list.extend(pairs.map(|(joint, weight)| (usize::from(joint), f64::from(weight))));
            }
        }
        let mut offsets = Vec::new();
        for (moved, _, _) in reader.read_morph_targets() {
            let moved = moved.ok_or(PlayedError::Missing("positions of a target"))?;
            offsets.push(moved.map(vec3).collect());
        }
        parts.push(Part {
            positions,
            offsets,
            joints,
        });
    }
    let weights = mesh
        .weights()
        .unwrap_or(&[])
        .iter()
        .map(|&w| f64::from(w))
        .collect();
    Ok(Mesh { weights, parts })
}

fn read_skin(skin: &gltf::Skin, blob: &[u8]) -> Result<Skin, PlayedError> {
    let reader = skin.reader(|_| Some(blob));
    let matrices = reader
        .read_inverse_bind_matrices()
        .ok_or(PlayedError::Missing("bind matrices"))?;
    Ok(Skin {
        name: skin.name().unwrap_or_default().to_owned(),
        joints: skin.joints().map(|joint| joint.index()).collect(),
        inverse_bind: matrices
            .map(|m| Mat4::from_cols_array_2d(&m).as_dmat4())
            .collect(),
    })
}

fn read_clip(clip: &gltf::Animation, blob: &[u8]) -> Result<Clip, PlayedError> {
    let mut channels = Vec::new();
    for channel in clip.channels() {
        let reader = channel.reader(|_| Some(blob));
        let times: Vec<f32> = reader
            .read_inputs()
            .ok_or(PlayedError::Missing("times"))?
            .collect();
        let outputs = reader.read_outputs().ok_or(PlayedError::Missing("keys"))?;
        let (property, values): (_, Vec<f32>) = match outputs {
            ReadOutputs::Translations(values) => {
                (Property::Translation, values.flatten().collect())
            }
            ReadOutputs::Rotations(values) => {
                (Property::Rotation, values.into_f32().flatten().collect())
            }
            ReadOutputs::Scales(values) => (Property::Scale, values.flatten().collect()),
            ReadOutputs::MorphTargetWeights(values) => {
                (Property::Weights, values.into_f32().collect())
            }
        };
        channels.push(Channel {
            node: channel.target().node().index(),
            property,
            interpolation: match channel.sampler().interpolation() {
                GltfInterpolation::Step => Interpolation::Step,
                GltfInterpolation::Linear => Interpolation::Linear,
                GltfInterpolation::CubicSpline => Interpolation::Cubic,
            },
            times,
            values,
            short: false,
        });
    }
    let last = channels
        .iter()
        .filter_map(|channel| channel.times.last().copied());
    Ok(Clip {
        name: clip.name().unwrap_or_default().to_owned(),
        begin: 0.0,
        duration: f64::from(last.fold(0.0, f32::max)),
        channels,
    })
}
