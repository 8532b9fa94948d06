//! The whole way from bytes of FBX to a [`Model`].

use crate::clips::{Reduced, Samples, Shells, Source, Take, clip};
use crate::conversion::Conversion;
use crate::curves::Reading;
use crate::error::FbxError;
use crate::load::load;
use crate::model::{Channel, Clip, Interpolation, Mesh, Model, Node, Property, Trs};
use crate::options::{Budget, Compression, Options, Origin};
use crate::position_error::report_position_error;
use crate::read::devices::{read_camera, read_light};
use crate::read::keyed::report_keyed;
use crate::read::names::{Names, make_clips_unique, make_paths_unique};
use crate::read::place::{is_alone, show_at};
use crate::read::textures::Textures;
use crate::read::user::read_extras;
use crate::read::visibility::Hidden;
use crate::read::{
    Meshes, ShapeKey, Shapes, UvOrder, read_materials, read_nodes, read_skin, report_lost,
};
use crate::report::{Lost, Report};
use crate::skinning::{SkinJob, write_weights};
use crate::smaller::{Rounded, smaller};
use crate::verify::{Bodies, doubts};
use glam::{DMat4, DVec3};
use std::collections::BTreeSet;
use ufbx::SceneRoot;

/// Converts the bytes of an FBX file.
///
/// # Errors
/// [`FbxError`]: no FBX file, a broken one, one beyond the limits, or an option out of range.
pub fn convert(bytes: &[u8], origin: &Origin, options: &Options) -> Result<Conversion, FbxError> {
    options.check()?;
    let budget = Budget::of(&origin.name, bytes, options);
    let scene = load(bytes, &budget, options)?;
    let mut report = Report {
        version: scene.metadata.version,
        creator: scene.metadata.creator.to_string(),
        unit: scene.settings.original_unit_meters,
        compression: options.compress,
        ..Report::default()
    };
    let names = Names::of(&scene, bytes, &budget, options, &mut report);
    let mut textures = Textures::new(origin, &budget, options.limits.is_none());
    let (mut materials, uv_orders) = read_materials(&scene, &mut textures, &mut report);
    let images = textures.used(&mut materials);
    let mut model = Model {
        nodes: read_nodes(&scene, &names),
        materials,
        images,
        ..Model::default()
    };
    options.report("meshes", 0.0);
    let jobs = hang_in(
        &scene,
        bytes,
        &mut model,
        &uv_orders,
        options.max_error,
        &budget,
        &mut report,
    )?;
    names.give(&scene, &mut model, &jobs);
    let hidden = Hidden::of(&scene);
    hidden.mark(&scene, &mut model, &mut report);
    model.extras = read_extras(&scene, &model, &mut report);
    let shapes = shapes_of(&scene, &model);
    report_lost(&scene, &mut report);
    report_keyed(&scene, &names, &hidden, &mut report);
    let count = scene.anim_stacks.len();
    let mut takes = Vec::with_capacity(count);
    let mut clips: Vec<Samples> = Vec::with_capacity(count);
    for number in 0..count {
        options.report("clips", number as f64 / count as f64);
        let take = Take::of(&scene, number, &shapes, options, &budget)?;
        clips.push(match take.is_whole() {
            true => take.sample(&take.plan, 0..take.plan.len(), &model, options, &budget)?,
            false => take.overview(&model, options, &budget)?,
        });
        takes.push(take);
    }
    write_weights(
        &scene,
        &mut model,
        &jobs,
        (&takes, &clips),
        options,
        &budget,
        &mut report,
    )?;
    let shells = Shells::of(&model);
    report.size = size(&model, &shells);
    report.bound = options
        .max_error
        .min(options.max_relative_error * report.size);
    let mut rounded = match options.compress {
        Compression::None => Rounded::default(),
        Compression::Meshopt => Rounded::of(&mut model, &shells, &clips, report.bound, &budget),
    };
    let before = report.clone();
    report.rounding_error = rounded.error;
    let motion = Motion {
        scene: &scene,
        names: &names,
        takes: &takes,
        shells: &shells,
    };
    let reduced = motion.reduce(&model, clips, options, &budget, &mut report)?;
    // What cannot be made a second time stands as it is.
    let again = match options.compress == Compression::Meshopt && rounded.is_in_doubt(&reduced) {
        true => rounded
            .plain(&mut model)
            .and_then(|model| motion.again(model, before, options, &budget)),
        false => None,
    };
    drop(takes);
    let made = completed(&scene, &names, model, report, reduced);
    let again =
        again.map(|(model, report, reduced)| completed(&scene, &names, model, report, reduced));
    let mut made = match options.compress {
        Compression::None => made,
        Compression::Meshopt => smaller(made, again),
    };
    tally(&made.model, &mut made.report, options.compress);
    options.report("done", 1.0);
    Ok(made)
}

/// What clips are made of.
struct Motion<'a> {
    scene: &'a SceneRoot,
    names: &'a Names,
    takes: &'a [Take<'a>],
    shells: &'a Shells,
}

impl Motion<'_> {
    /// Keys of all clips; `samples` are those of them that are known already.
    fn reduce(
        &self,
        model: &Model,
        samples: Vec<Samples>,
        options: &Options,
        budget: &Budget,
        report: &mut Report,
    ) -> Result<Vec<Reduced>, FbxError> {
        // What rounded vertices are off by comes on top of what keys are.
        let bound = report.bound - report.rounding_error;
        let takes = self.takes.iter();
        let moved: BTreeSet<usize> = takes.flat_map(|take| &take.moving).copied().collect();
        let moved = self.shells.moved_by(moved.into_iter());
        let takes = self.takes.iter();
        let morphed: BTreeSet<usize> = takes.flat_map(|take| &take.meshes).copied().collect();
        let bodies = Bodies::of(model, &moved, &morphed);
        let mut samples = samples.into_iter();
        let mut reduced = Vec::with_capacity(self.takes.len());
        for (number, take) in self.takes.iter().enumerate() {
            options.report("keys", number as f64 / self.takes.len() as f64);
            let source = Source {
                take,
                model,
                options,
                budget,
                bodies: &bodies,
            };
            let samples = samples.next().filter(|_| take.is_whole());
            let mut made = clip(&source, samples, self.shells, bound)?;
            made.clip.name = self.names.name(&self.scene.anim_stacks[number].element);
            made.report.name.clone_from(&made.clip.name);
            report_doubts(&source, self.shells, &made, report);
            reduced.push(made);
        }
        Ok(reduced)
    }

    /// The same as a plain conversion has them; `None` where the limits do not allow it.
    fn again(
        &self,
        model: Model,
        mut report: Report,
        options: &Options,
        budget: &Budget,
    ) -> Option<(Model, Report, Vec<Reduced>)> {
        let plain = Options {
            compress: Compression::None,
            ..*options
        };
        let reduced = self.reduce(&model, Vec::new(), &plain, &budget.again(), &mut report);
        Some((model, report, reduced.ok()?))
    }
}

/// Takes clips into a model, and says what is only known then.
fn completed(
    scene: &SceneRoot,
    names: &Names,
    mut model: Model,
    mut report: Report,
    reduced: Vec<Reduced>,
) -> Conversion {
    take_clips(&mut model, &mut report, reduced);
    make_clips_unique(&mut model, &mut report);
    report_position_error(scene, &model, &mut report);
    finish(&mut model);
    make_paths_unique(&mut model, &mut report);
    names.mend(scene, &mut report);
    Conversion { model, report }
}

/// Hangs meshes, lights and cameras into the tree. A skinned mesh gets a node of its own beside the
/// tree, since glTF has it there: its joints alone say where it is.
fn hang_in(
    scene: &SceneRoot,
    file: &[u8],
    model: &mut Model,
    uv_orders: &[UvOrder],
    max_error: f64,
    budget: &Budget,
    report: &mut Report,
) -> Result<Vec<SkinJob>, FbxError> {
    let mut meshes = Meshes::new(scene, file, report);
    let hidden = Hidden::of(scene);
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
            let unit = scene.metadata.geometry_scale;
            model.cameras.push(read_camera(camera, unit, report));
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
            (&model.materials, uv_orders),
            &mut model.meshes,
            max_error,
            budget,
        )?;
        let Some(made) = made else { continue };
        let offset = model.meshes[made].offset;
        let Some(skin) = skin else {
            let alone = offset != DVec3::ZERO && is_alone(scene, node);
            show_at(&mut model.nodes, number, alone, made, offset);
            continue;
        };
        let mut source = read_skin(mesh, skin, node, &mut model.nodes);
        for bind in &mut source.skin.inverse_bind {
            *bind *= DMat4::from_translation(offset);
        }
        model.skins.push(source.skin.clone());
        if hidden.node(number) {
            model.hidden.insert(model.nodes.len());
        }
        model.nodes.push(Node {
            name: model.nodes[number].name.clone(),
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

/// One line for each layer whose meaning the file leaves open, where that comes to more than the bound.
fn report_doubts(source: &Source, shells: &Shells, made: &Reduced, report: &mut Report) {
    for (name, reading, metres) in doubts(source, shells, &made.clip) {
        if metres <= report.bound {
            continue;
        }
        let detail = match reading {
            Reading::OverrideFades => {
                "overrides with a weight of less than 100 %: taken whole, as the format says; programs that lessen it show something else"
            }
            _ => "has a blend mode without a name: taken to override",
        };
        report.lost.push(Lost {
            what: "layer",
            name: format!("{}: {name}", made.clip.name),
            metres: Some(metres),
            detail: detail.to_owned(),
        });
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
        keep_length(&mut one.clip);
        one.report.keys = one.clip.channels.iter().map(|c| c.times.len()).sum();
        report.clips.push(one.report);
        model.clips.push(one.clip);
    }
}

/// Players take a clip to be as long as its last key says: where all stand still before the end, one channel
/// gets a second key there.
fn keep_length(clip: &mut Clip) {
    let last = |channel: &Channel| channel.times.last().copied().unwrap_or(0.0);
    let end = clip.duration as f32;
    if clip.channels.iter().map(last).fold(0.0, f32::max) >= end {
        return;
    }
    let is_plain = |channel: &&mut Channel| channel.interpolation != Interpolation::Cubic;
    let shortest = clip.channels.iter_mut().filter(is_plain);
    if let Some(channel) = shortest.min_by_key(|channel| channel.values.len()) {
        let width = channel.values.len() / channel.times.len().max(1);
        let value = channel.values[channel.values.len() - width..].to_vec();
        channel.times.push(end);
        channel.values.extend(value);
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
/// and the emptied nodes of skinned meshes that nothing else tells the place of.
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
        let emptied = !shows
            && children[number] == 0
            && skinned.contains(&node.name)
            && !model.extras.nodes.contains_key(&number)
            && is_at_the_origin(&model.nodes, number);
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

/// Whether a node is where a node without parent and place is: that one can stand for it.
fn is_at_the_origin(nodes: &[Node], number: usize) -> bool {
    let mut world = DMat4::IDENTITY;
    let mut above = Some(number);
    while let Some(at) = above {
        world = nodes[at].rest.matrix() * world;
        above = nodes[at].parent;
    }
    world.abs_diff_eq(DMat4::IDENTITY, 1e-9)
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
    model.hidden = model.hidden.iter().filter_map(|&n| numbers[n]).collect();
    let extras = std::mem::take(&mut model.extras.nodes);
    let extras = extras
        .into_iter()
        .filter_map(|(n, own)| Some((numbers[n]?, own)));
    model.extras.nodes = extras.collect();
    for skin in &mut model.skins {
        skin.joints.iter_mut().for_each(|joint| *joint = of(*joint));
    }
    for clip in &mut model.clips {
        clip.channels
            .iter_mut()
            .for_each(|channel| channel.node = of(channel.node));
    }
}

/// Counts what there is; what was written under `compression` is counted already.
fn tally(model: &Model, report: &mut Report, compression: Compression) {
    report.nodes = model.nodes.len();
    let joints: BTreeSet<usize> = model
        .skins
        .iter()
        .flat_map(|skin| skin.joints.iter().copied())
        .collect();
    report.joints = joints.len();
    let parts = || model.meshes.iter().flat_map(|mesh| &mesh.parts);
    report.vertices = parts().map(|part| part.positions.len()).sum();
    if compression == Compression::None {
        let mut known = BTreeSet::new();
        let channels = model.clips.iter().flat_map(|clip| &clip.channels);
        report.animation_bytes = channels.map(|channel| channel.bytes(&mut known)).sum();
    }
    report.triangles = parts().map(|part| part.indices.len() / 3).sum();
}
