//! The whole way from bytes of FBX to a [`Model`].

use crate::clips::{Reduced, Samples, Shells, Source, leverage, reduce, refine, sample};
use crate::error::FbxError;
use crate::load::load;
use crate::model::{Channel, Interpolation, Mesh, Model, Node, Property, Trs};
use crate::options::{Budget, Options, Origin};
use crate::read::devices::{read_camera, read_light};
use crate::read::textures::Textures;
use crate::read::{Meshes, ShapeKey, Shapes, read_materials, read_nodes, read_skin, report_lost};
use crate::report::Report;
use crate::skinning::{SkinJob, write_weights};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};
use ufbx::SceneRoot;

/// A converted file: what becomes glTF, and what to say of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Conversion {
    /// Nodes, meshes, clips.
    pub model: Model,
    /// What was made, how exact it is and what is lost.
    pub report: Report,
}

impl Conversion {
    /// For each mesh, which FBX mesh and which of its vertices each vertex came from, over all parts;
    /// for [`check::vertex_error`](crate::check::vertex_error).
    pub fn sources(&self) -> BTreeMap<usize, (u32, Vec<u32>)> {
        let of = |mesh: &Mesh| {
            let sources = mesh
                .parts
                .iter()
                .flat_map(|part| part.sources.iter().copied());
            (mesh.source, sources.collect())
        };
        self.model.meshes.iter().map(of).enumerate().collect()
    }
}

/// Converts the bytes of an FBX file.
///
/// # Errors
/// [`FbxError`]: no FBX file, a broken one, one beyond the limits, or an option out of range.
pub fn convert(bytes: &[u8], origin: &Origin, options: &Options) -> Result<Conversion, FbxError> {
    options.check()?;
    let budget = Budget::of(&origin.name, bytes.len(), options);
    let limits = budget.limits;
    let scene = load(bytes, &budget, options)?;
    let mut report = Report {
        version: scene.metadata.version,
        creator: scene.metadata.creator.to_string(),
        unit: scene.settings.original_unit_meters,
        ..Report::default()
    };
    let mut textures = Textures::new(origin, limits.memory);
    let mut model = Model {
        nodes: read_nodes(&scene),
        materials: read_materials(&scene, &mut textures, &mut report),
        ..Model::default()
    };
    model.images = textures.images;
    options.report("meshes", 0.0);
    let jobs = hang_in(&scene, &mut model, &budget, &mut report)?;
    let shapes = shapes_of(&scene, &model);
    report_lost(&scene, &mut report);
    let mut clips: Vec<Samples> = (0..scene.anim_stacks.len())
        .map(|stack| {
            options.report("clips", stack as f64 / scene.anim_stacks.len() as f64);
            sample(&scene, stack, &model, &shapes, options, &budget)
        })
        .collect::<Result<_, _>>()?;
    write_weights(
        &scene,
        &mut model,
        &jobs,
        &clips,
        options,
        &budget,
        &mut report,
    )?;
    let shells = Shells::of(&model);
    report.size = size(&model, &shells);
    report.bound = options
        .max_error
        .min(options.max_relative_error * report.size);
    let mut reduced = Vec::with_capacity(clips.len());
    let count = clips.len();
    for (stack, clip) in clips.iter_mut().enumerate() {
        options.report("keys", stack as f64 / count as f64);
        let source = Source {
            scene: &scene,
            stack,
            model: &model,
            shapes: &shapes,
            options,
            budget: &budget,
        };
        let leverage = leverage(clip, &model, &shells);
        refine(clip, &source, &leverage, report.bound)?;
        reduced.push(reduce(
            clip,
            &model,
            &shells,
            leverage,
            report.bound,
            options,
            &budget,
        )?);
    }
    take_clips(&mut model, &mut report, reduced);
    finish(&mut model);
    tally(&model, &mut report);
    options.report("done", 1.0);
    Ok(Conversion { model, report })
}

/// Hangs meshes, lights and cameras into the tree. A skinned mesh gets a node of its own beside the
/// tree, since glTF has it there: its joints alone say where it is.
fn hang_in(
    scene: &SceneRoot,
    model: &mut Model,
    budget: &Budget,
    report: &mut Report,
) -> Result<Vec<SkinJob>, FbxError> {
    let mut meshes = Meshes::default();
    let mut jobs = Vec::new();
    for (number, node) in scene.nodes.iter().enumerate() {
        if let Some(light) = node
            .light
            .as_ref()
            .and_then(|light| read_light(light, report))
        {
            model.lights.push(light);
            model.nodes[number].light = Some(model.lights.len() - 1);
        }
        if let Some(camera) = &node.camera {
            model
                .cameras
                .push(read_camera(camera, scene.metadata.geometry_scale));
            model.nodes[number].camera = Some(model.cameras.len() - 1);
        }
        let Some(mesh) = &node.mesh else { continue };
        let skin = (&mesh.skin_deformers)
            .into_iter()
            .next()
            .filter(|skin| (&skin.clusters).into_iter().any(|c| c.bone_node.is_some()));
        let made = meshes.number(
            node,
            mesh,
            skin.is_some(),
            &model.materials,
            &mut model.meshes,
            budget,
        )?;
        let Some(made) = made else { continue };
        let Some(skin) = skin else {
            model.nodes[number].mesh = Some(made);
            continue;
        };
        let source = read_skin(mesh, skin, node, &mut model.nodes);
        model.skins.push(source.skin.clone());
        model.nodes.push(Node {
            name: node.element.name.to_string(),
            parent: None,
            rest: Trs::IDENTITY,
            mesh: Some(made),
            skin: Some(model.skins.len() - 1),
            light: None,
            camera: None,
        });
        jobs.push(SkinJob {
            mesh: made,
            skin: model.skins.len() - 1,
            source,
            fbx_mesh: mesh.element.typed_id as usize,
        });
    }
    Ok(jobs)
}

/// For each mesh of the model, what its targets are in the scene.
fn shapes_of(scene: &SceneRoot, model: &Model) -> Vec<Vec<ShapeKey>> {
    let of = |mesh: &Mesh| Shapes::of(&scene.meshes[mesh.source as usize]).keys;
    model.meshes.iter().map(of).collect()
}

/// Diagonal of the box around all vertices and nodes at rest, metres.
fn size(model: &Model, shells: &Shells) -> f64 {
    let rest: Vec<Trs> = model.nodes.iter().map(|node| node.rest).collect();
    let mut world = Vec::new();
    shells.world(&rest, &mut world);
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let mut take = |p: DVec3| {
        if p.is_finite() {
            (low, high) = (low.min(p), high.max(p));
        }
    };
    let has_meshes = !model.meshes.is_empty();
    for (number, node) in model.nodes.iter().enumerate() {
        let Some(mesh) = node.mesh.map(|mesh| &model.meshes[mesh]) else {
            if !has_meshes {
                take(world[number].translation);
            }
            continue;
        };
        for part in &mesh.parts {
            for (vertex, position) in part.positions.iter().enumerate() {
                let position = glam::Vec3::from(*position).as_dvec3();
                take(match node.skin.map(|skin| &model.skins[skin]) {
                    None => world[number].transform_point3(position),
                    // The joint that it follows most is near enough for a size.
                    Some(skin) => {
                        let joint = usize::from(part.joints[0][vertex][0]);
                        let bound = skin.inverse_bind[joint].transform_point3(position);
                        world[skin.joints[joint]].transform_point3(bound)
                    }
                });
            }
        }
    }
    let size = (high - low).length();
    if size.is_finite() && size > 1e-9 {
        size
    } else {
        1.0
    }
}

/// Channels that no clip moves away from rest are left out of all. Where one clip does, the others
/// keep a key: a player that changes clips would else leave the node where the last one had it.
fn take_clips(model: &mut Model, report: &mut Report, reduced: Vec<Reduced>) {
    let mut moves: BTreeSet<(usize, Property)> = BTreeSet::new();
    for one in &reduced {
        for (channel, &at_rest) in one.clip.channels.iter().zip(&one.at_rest) {
            if !at_rest {
                moves.insert((channel.node, channel.property));
            }
        }
    }
    // A stack that moves nothing is a clip all the same.
    if moves.is_empty() && model.nodes.len() > 1 {
        moves.insert((1, Property::Translation));
    }
    for mut one in reduced {
        one.clip
            .channels
            .retain(|c| moves.contains(&(c.node, c.property)));
        for &(node, property) in &moves {
            let there = |c: &Channel| (c.node, c.property) == (node, property);
            if !one.clip.channels.iter().any(there) {
                one.clip.channels.push(still(model, node, property));
            }
        }
        one.clip.channels.sort_by_key(|c| (c.node, c.property));
        one.report.keys = one.clip.channels.iter().map(|c| c.times.len()).sum();
        report.clips.push(one.report);
        model.clips.push(one.clip);
    }
}

/// A channel of one key that keeps a node at rest.
fn still(model: &Model, node: usize, property: Property) -> Channel {
    let rest = model.nodes[node].rest;
    let targets = model.nodes[node]
        .mesh
        .map(|mesh| &model.meshes[mesh].targets);
    let values: Vec<f64> = match property {
        Property::Translation => rest.translation.to_array().to_vec(),
        Property::Rotation => rest.rotation.to_array().to_vec(),
        Property::Scale => rest.scale.to_array().to_vec(),
        Property::Weights => targets
            .into_iter()
            .flatten()
            .map(|target| target.rest)
            .collect(),
    };
    Channel {
        node,
        property,
        interpolation: Interpolation::Linear,
        times: vec![0.0],
        values: values.into_iter().map(|x| x as f32).collect(),
        short: false,
    }
}

/// Takes out nodes that say nothing: the root that no file shows, unless joints need it in common,
/// and the emptied nodes of skinned meshes.
fn finish(model: &mut Model) {
    let count = model.nodes.len();
    let mut kept = vec![false; count];
    let animated = model
        .clips
        .iter()
        .flat_map(|clip| &clip.channels)
        .map(|c| c.node);
    for node in animated.chain(
        model
            .skins
            .iter()
            .flat_map(|skin| skin.joints.iter().copied()),
    ) {
        kept[node] = true;
    }
    let skinned: Vec<String> = model
        .nodes
        .iter()
        .filter(|node| node.skin.is_some())
        .map(|node| node.name.clone())
        .collect();
    let mut children = vec![0; count];
    for node in &model.nodes {
        if let Some(parent) = node.parent {
            children[parent] += 1;
        }
    }
    for (number, node) in model.nodes.iter().enumerate() {
        let shows = node.mesh.is_some() || node.light.is_some() || node.camera.is_some();
        let emptied = !shows && children[number] == 0 && skinned.contains(&node.name);
        kept[number] |= !emptied;
    }
    let tops = model
        .nodes
        .iter()
        .filter(|node| node.parent == Some(0))
        .count();
    kept[0] = tops > 1 && !model.skins.is_empty() || model.nodes.len() == 1;
    renumber(model, &kept);
}

fn renumber(model: &mut Model, kept: &[bool]) {
    let mut next = 0;
    let numbers: Vec<Option<usize>> = kept
        .iter()
        .map(|&kept| {
            next += usize::from(kept);
            kept.then(|| next - 1)
        })
        .collect();
    let of = |old: usize| numbers[old].expect("what is referred to is kept");
    let mut keep = kept.iter();
    model
        .nodes
        .retain(|_| *keep.next().expect("one flag for each node"));
    for node in &mut model.nodes {
        node.parent = node.parent.and_then(|parent| numbers[parent]);
    }
    for skin in &mut model.skins {
        skin.joints.iter_mut().for_each(|joint| *joint = of(*joint));
    }
    for clip in &mut model.clips {
        clip.channels
            .iter_mut()
            .for_each(|channel| channel.node = of(channel.node));
    }
}

fn tally(model: &Model, report: &mut Report) {
    report.nodes = model.nodes.len();
    let joints: BTreeSet<usize> = model
        .skins
        .iter()
        .flat_map(|skin| skin.joints.iter().copied())
        .collect();
    report.joints = joints.len();
    let parts = || model.meshes.iter().flat_map(|mesh| &mesh.parts);
    report.vertices = parts().map(|part| part.positions.len()).sum();
    let mut animation = BTreeSet::new();
    report.animation_bytes = model
        .clips
        .iter()
        .flat_map(|clip| &clip.channels)
        .map(|c| c.bytes(&mut animation))
        .sum();
    report.triangles = parts().map(|part| part.indices.len() / 3).sum();
}
