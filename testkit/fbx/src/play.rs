//! A .glb read by the crate `gltf` and played in f64 as glTF's specification says.

use glam::{DMat4, DQuat, DVec3, Mat4};
use gltf::animation::Interpolation;
use gltf::animation::util::ReadOutputs;

/// A .glb in memory.
pub struct Glb {
    /// The crate's view of it, for what does not move.
    pub document: gltf::Document,
    /// Its text as it stands in the file, for what the crate does not know.
    pub json: serde_json::Value,
    /// Its nodes, by number.
    pub nodes: Vec<Joint>,
    order: Vec<usize>,
    meshes: Vec<Mesh>,
    skins: Vec<Vec<(usize, DMat4)>>,
    clips: Vec<Clip>,
}

/// A node.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// What it hangs on.
    pub parent: Option<usize>,
    /// Number of the mesh that it shows.
    pub mesh: Option<usize>,
    skin: Option<usize>,
    rest: (DVec3, DQuat, DVec3),
}

struct Mesh {
    weights: Vec<f64>,
    parts: Vec<Part>,
}

struct Part {
    positions: Vec<DVec3>,
    targets: Vec<Vec<DVec3>>,
    follows: Vec<Vec<(usize, f64)>>,
}

struct Clip {
    name: String,
    channels: Vec<Channel>,
}

#[derive(PartialEq, Clone, Copy)]
enum Moves {
    Place,
    Turn,
    Size,
    Weights,
}

struct Channel {
    node: usize,
    moves: Moves,
    interpolation: Interpolation,
    times: Vec<f64>,
    values: Vec<f64>,
    width: usize,
}

/// Where every node is and how much of every morph target there is.
pub struct Posed {
    /// From each node to the world.
    pub worlds: Vec<DMat4>,
    weights: Vec<Option<Vec<f64>>>,
}

impl Glb {
    /// Reads a .glb.
    ///
    /// # Errors
    /// One sentence on what is wrong with it.
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        let gltf::Gltf { document, blob } =
            gltf::Gltf::from_slice(bytes).map_err(|error| error.to_string())?;
        let blob = blob.unwrap_or_default();
        let text = gltf::Glb::from_slice(bytes)
            .map_err(|error| error.to_string())?
            .json;
        let json = serde_json::from_slice(&text).map_err(|error| error.to_string())?;
        let mut nodes: Vec<Joint> = document
            .nodes()
            .map(|node| {
                let (translation, rotation, scale) = node.transform().decomposed();
                Joint {
                    name: node.name().unwrap_or_default().to_owned(),
                    parent: None,
                    mesh: node.mesh().map(|mesh| mesh.index()),
                    skin: node.skin().map(|skin| skin.index()),
                    rest: (
                        glam::Vec3::from(translation).as_dvec3(),
                        DQuat::from_array(rotation.map(f64::from)).normalize(),
                        glam::Vec3::from(scale).as_dvec3(),
                    ),
                }
            })
            .collect();
        for node in document.nodes() {
            for child in node.children() {
                nodes[child.index()].parent = Some(node.index());
            }
        }
        let mut order = Vec::with_capacity(nodes.len());
        let mut next: Vec<usize> = (0..nodes.len())
            .filter(|&node| nodes[node].parent.is_none())
            .collect();
        while let Some(node) = next.pop() {
            order.push(node);
            next.extend((0..nodes.len()).filter(|&child| nodes[child].parent == Some(node)));
        }
        Ok(Self {
            order,
            meshes: document
                .meshes()
                .map(|mesh| read_mesh(&mesh, &blob))
                .collect::<Result<_, _>>()?,
            skins: document
                .skins()
                .map(|skin| read_skin(&skin, &blob))
                .collect::<Result<_, _>>()?,
            clips: document
                .animations()
                .map(|clip| read_clip(&clip, &blob))
                .collect::<Result<_, _>>()?,
            nodes,
            json,
            document,
        })
    }

    /// Names of the clips, and the seconds of their last keys.
    pub fn clips(&self) -> Vec<(String, f64)> {
        let last = |clip: &Clip| {
            clip.channels
                .iter()
                .filter_map(|c| c.times.last().copied())
                .fold(0.0, f64::max)
        };
        self.clips
            .iter()
            .map(|clip| (clip.name.clone(), last(clip)))
            .collect()
    }

    /// Times of all keys of a clip, growing.
    pub fn key_times(&self, clip: usize) -> Vec<f64> {
        let mut times: Vec<f64> = self.clips[clip]
            .channels
            .iter()
            .flat_map(|c| c.times.iter().copied())
            .collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// Everything at `time` seconds of a clip; `None` is at rest.
    pub fn at(&self, clip: Option<usize>, time: f64) -> Posed {
        let mut own: Vec<(DVec3, DQuat, DVec3)> = self.nodes.iter().map(|node| node.rest).collect();
        let mut weights = vec![None; self.nodes.len()];
        for channel in clip.iter().flat_map(|&clip| &self.clips[clip].channels) {
            let value = channel.at(time);
            let node = &mut own[channel.node];
            match channel.moves {
                Moves::Place => node.0 = DVec3::from_slice(&value),
                Moves::Turn => node.1 = DQuat::from_slice(&value).normalize(),
                Moves::Size => node.2 = DVec3::from_slice(&value),
                Moves::Weights => weights[channel.node] = Some(value),
            }
        }
        let mut worlds = vec![DMat4::IDENTITY; self.nodes.len()];
        for &node in &self.order {
            let (translation, rotation, scale) = own[node];
            let own = DMat4::from_scale_rotation_translation(scale, rotation, translation);
            worlds[node] = self.nodes[node]
                .parent
                .map_or(own, |parent| worlds[parent] * own);
        }
        Posed { worlds, weights }
    }

    /// Vertices in the world that a node shows, over all primitives.
    pub fn points(&self, node: usize, posed: &Posed) -> Vec<DVec3> {
        let Some(number) = self.nodes[node].mesh else {
            return Vec::new();
        };
        let mesh = &self.meshes[number];
        let weights = posed.weights[node].as_ref().unwrap_or(&mesh.weights);
        let joints: Option<Vec<DMat4>> = self.nodes[node].skin.map(|skin| {
            let joints = self.skins[skin].iter();
            joints
                .map(|(joint, bind)| posed.worlds[*joint] * *bind)
                .collect()
        });
        let mut out = Vec::new();
        for part in &mesh.parts {
            for (vertex, position) in part.positions.iter().enumerate() {
                let mut p = *position;
                for (target, weight) in part.targets.iter().zip(weights) {
                    p += target[vertex] * *weight;
                }
                out.push(match &joints {
                    None => posed.worlds[node].transform_point3(p),
                    Some(joints) => part.follows[vertex]
                        .iter()
                        .map(|&(joint, weight)| joints[joint].transform_point3(p) * weight)
                        .sum(),
                });
            }
        }
        out
    }
}

impl Channel {
    fn at(&self, time: f64) -> Vec<f64> {
        let cubic = self.interpolation == Interpolation::CubicSpline;
        let key = |i: usize, part: usize| {
            let number = if cubic { i * 3 + part } else { i };
            &self.values[number * self.width..(number + 1) * self.width]
        };
        let next = self.times.partition_point(|&t| t <= time);
        let at = next.saturating_sub(1);
        if next == 0 || next == self.times.len() || self.interpolation == Interpolation::Step {
            return key(at, 1).to_vec();
        }
        let length = self.times[next] - self.times[at];
        let s = (time - self.times[at]) / length;
        let (from, to) = (key(at, 1), key(next, 1));
        if cubic {
            let (s2, s3) = (s * s, s * s * s);
            let by = [
                2.0 * s3 - 3.0 * s2 + 1.0,
                (s3 - 2.0 * s2 + s) * length,
                3.0 * s2 - 2.0 * s3,
                (s3 - s2) * length,
            ];
            let (out, into) = (key(at, 2), key(next, 0));
            return (0..self.width)
                .map(|i| by[0] * from[i] + by[1] * out[i] + by[2] * to[i] + by[3] * into[i])
                .collect();
        }
        if self.moves == Moves::Turn {
            let quat = |v: &[f64]| DQuat::from_slice(v).normalize();
            return crate::truth::slerp(quat(from), quat(to), s)
                .to_array()
                .to_vec();
        }
        from.iter().zip(to).map(|(a, b)| a + (b - a) * s).collect()
    }
}

fn read_mesh(mesh: &gltf::Mesh, blob: &[u8]) -> Result<Mesh, String> {
    let mut parts = Vec::new();
    for primitive in mesh.primitives() {
        let reader = primitive.reader(|_| Some(blob));
        let vector = |v: [f32; 3]| glam::Vec3::from(v).as_dvec3();
        let positions: Vec<DVec3> = reader
            .read_positions()
            .ok_or("no positions")?
            .map(vector)
            .collect();
        let mut follows = vec![Vec::new(); positions.len()];
        for set in 0..2 {
            if let (Some(joints), Some(weights)) =
                (reader.read_joints(set), reader.read_weights(set))
            {
                for (list, (joints, weights)) in follows
                    .iter_mut()
                    .zip(joints.into_u16().zip(weights.into_f32()))
                {
                    let pairs = joints.into_iter().zip(weights);
                    list.extend(
                        pairs.map(|(joint, weight)| (usize::from(joint), f64::from(weight))),
                    );
                }
            }
        }
        let mut targets = Vec::new();
        for (moved, _, _) in reader.read_morph_targets() {
            targets.push(
                moved
                    .ok_or("a target without positions")?
                    .map(vector)
                    .collect(),
            );
        }
        parts.push(Part {
            positions,
            targets,
            follows,
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

fn read_skin(skin: &gltf::Skin, blob: &[u8]) -> Result<Vec<(usize, DMat4)>, String> {
    let reader = skin.reader(|_| Some(blob));
    let binds = reader
        .read_inverse_bind_matrices()
        .ok_or("no bind matrices")?;
    let binds = binds.map(|m| Mat4::from_cols_array_2d(&m).as_dmat4());
    Ok(skin
        .joints()
        .map(|joint| joint.index())
        .zip(binds)
        .collect())
}

fn read_clip(clip: &gltf::Animation, blob: &[u8]) -> Result<Clip, String> {
    let mut channels = Vec::new();
    for channel in clip.channels() {
        let reader = channel.reader(|_| Some(blob));
        let times: Vec<f64> = reader
            .read_inputs()
            .ok_or("no times")?
            .map(f64::from)
            .collect();
        if times.is_empty() || times.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err("times of keys that do not grow".into());
        }
        let (moves, values): (_, Vec<f32>) = match reader.read_outputs().ok_or("no values")? {
            ReadOutputs::Translations(values) => (Moves::Place, values.flatten().collect()),
            ReadOutputs::Rotations(values) => (Moves::Turn, values.into_f32().flatten().collect()),
            ReadOutputs::Scales(values) => (Moves::Size, values.flatten().collect()),
            ReadOutputs::MorphTargetWeights(values) => {
                (Moves::Weights, values.into_f32().collect())
            }
        };
        if values.iter().any(|x| !x.is_finite()) {
            return Err("a key that is no number".into());
        }
        let interpolation = channel.sampler().interpolation();
        let each = if interpolation == Interpolation::CubicSpline {
            3
        } else {
            1
        };
        if values.is_empty() || values.len() % (times.len() * each) != 0 {
            return Err(format!(
                "{} values and {} times that do not fit ({} each)",
                values.len(),
                times.len(),
                each
            ));
        }
        channels.push(Channel {
            node: channel.target().node().index(),
            moves,
            interpolation,
            width: values.len() / (times.len() * each),
            values: values.into_iter().map(f64::from).collect(),
            times,
        });
    }
    Ok(Clip {
        name: clip.name().unwrap_or_default().to_owned(),
        channels,
    })
}
