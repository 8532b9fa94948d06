//! Names that are not UTF-8: files of older programs have them in the code page of the machine that
//! wrote them, and do not say which. The bytes are kept, as `\xHH`, so that names stay apart.

use crate::load::load_names;
use crate::model::Model;
use crate::options::{Budget, Options};
use crate::read::Shapes;
use crate::read::text::escaped;
use crate::read::user::own_properties;
use crate::report::Report;
use crate::skinning::SkinJob;
use std::collections::{BTreeMap, BTreeSet};
use ufbx::{Scene, WarningType};

/// Names of elements that ufbx could not read, by the element's number.
#[derive(Default)]
pub(crate) struct Names {
    known: BTreeMap<u32, String>,
}

impl Names {
    /// Of a scene read from `file`, which is read a second time where there are such names.
    pub(crate) fn of(
        scene: &Scene,
        file: &[u8],
        budget: &Budget,
        options: &Options,
        report: &mut Report,
    ) -> Self {
        let mut names = Self::default();
        if !scene.metadata.has_warning[WarningType::BadUnicode as usize] {
            return names;
        }
        report_properties(scene, report);
        let bad: Vec<u32> = (&scene.elements)
            .into_iter()
            .filter(|element| element.name.contains(char::REPLACEMENT_CHARACTER))
            .map(|element| element.element_id)
            .collect();
        if bad.is_empty() {
            return names;
        }
        if let Ok(raw) = load_names(file, budget, options)
            && raw.elements.len() == scene.elements.len()
        {
            for &number in &bad {
                let element = &raw.elements[number as usize];
                let values = element.dom_node.as_ref().map(|node| &node.values);
                let strings = values.into_iter().flatten().map(|value| &*value.value_blob);
                if let Some(bytes) = strings
                    .map(own_name)
                    .find(|b| std::str::from_utf8(b).is_err())
                {
                    names.known.insert(number, escaped(bytes));
                }
            }
        }
        let example = names.known.values().next();
        let detail = match example {
            Some(example) => format!(
                "names are not UTF-8, and the file does not say what they are; their bytes stand as in {example}"
            ),
            None => "names are not UTF-8; what cannot be read of them is replaced".into(),
        };
        report.lose("name-encoding", &bad.len().to_string(), detail);
        names
    }

    /// The name of an element.
    pub(crate) fn name(&self, element: &ufbx::Element) -> String {
        match self.known.get(&element.element_id) {
            Some(name) => name.clone(),
            None => element.name.to_string(),
        }
    }

    /// As [`Shapes`] names targets.
    fn of_shape(&self, channel: &ufbx::BlendChannel, key: usize) -> String {
        match channel.keyframes.get(key) {
            Some(frame) if channel.keyframes.len() > 1 => self.name(&frame.shape.element),
            _ => self.name(&channel.element),
        }
    }

    /// Puts these names into lines of the report that say what ufbx made of them, where it is clear which
    /// one is meant.
    pub(crate) fn mend(&self, scene: &Scene, report: &mut Report) {
        let mut meant: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        for (&number, name) in &self.known {
            if let Some(element) = scene.elements.get(number as usize) {
                meant.entry(&element.name).or_default().insert(name);
            }
        }
        for lost in &mut report.lost {
            let names = meant.get(lost.name.as_str());
            if let Some(name) = names
                .filter(|all| all.len() == 1)
                .and_then(|all| all.first())
            {
                lost.name = (*name).to_owned();
            }
        }
    }

    /// Gives materials, meshes and their targets, skins, lights and cameras their names; nodes have them.
    pub(crate) fn give(&self, scene: &Scene, model: &mut Model, jobs: &[SkinJob]) {
        if self.known.is_empty() {
            return;
        }
        for (material, source) in model.materials.iter_mut().zip(&scene.materials) {
            material.name = self.name(&source.element);
        }
        for mesh in &mut model.meshes {
            if let Some(source) = scene.meshes.get(mesh.source as usize) {
                mesh.name = self.name(&source.element);
                let keys = Shapes::of(source).keys;
                for (target, key) in mesh.targets.iter_mut().zip(keys) {
                    target.name = self.of_shape(&scene.blend_channels[key.channel], key.key);
                }
            }
        }
        for job in jobs {
            let source = &scene.meshes[job.fbx_mesh];
            if let Some(skin) = (&source.skin_deformers).into_iter().next() {
                model.skins[job.skin].name = self.name(&skin.element);
            }
        }
        let nodes = || model.nodes.iter().zip(&scene.nodes);
        for (node, source) in nodes() {
            if let (Some(number), Some(light)) = (node.light, &source.light) {
                model.lights[number].name = self.name(&light.element);
            }
            if let (Some(number), Some(camera)) = (node.camera, &source.camera) {
                model.cameras[number].name = self.name(&camera.element);
            }
        }
    }
}

/// Properties of users whose names are not UTF-8: what ufbx made of these is all that there is, and of two that
/// look alike then it keeps one.
fn report_properties(scene: &Scene, report: &mut Report) {
    let all = (&scene.elements).into_iter().flat_map(own_properties);
    let count = all
        .filter(|prop| prop.name.contains(char::REPLACEMENT_CHARACTER))
        .count();
    if count > 0 {
        let detail = "names of users' properties are not UTF-8; what cannot be read of them is replaced, and of those of one object that look alike then one is left";
        report.lose("name-encoding", &count.to_string(), detail);
    }
}

/// Without the class that files put before it (`Model::`) or behind (a zero, a one and `Model`).
fn own_name(bytes: &[u8]) -> &[u8] {
    if let Some(end) = bytes.windows(2).position(|two| two == [0, 1]) {
        return &bytes[..end];
    }
    match bytes.windows(2).position(|two| two == b"::") {
        Some(begin) => &bytes[begin + 2..],
        None => bytes,
    }
}

/// Clips are looked up by name: the second `walk` becomes `walk.2`.
pub(crate) fn make_clips_unique(model: &mut Model, report: &mut Report) {
    let mut taken: BTreeSet<String> = model.clips.iter().map(|clip| clip.name.clone()).collect();
    let mut seen = BTreeSet::new();
    for number in 0..model.clips.len() {
        let name = model.clips[number].name.clone();
        if name.is_empty() || seen.insert(name.clone()) {
            continue;
        }
        let mut other = 2;
        let free = loop {
            let free = format!("{name}.{other}");
            if taken.insert(free.clone()) {
                break free;
            }
            other += 1;
        };
        let detail = format!("another clip has this name; this one is called {free}");
        report.lose("clip-name", &name, detail);
        seen.insert(free.clone());
        if let Some(clip) = report.clips.get_mut(number) {
            clip.name.clone_from(&free);
        }
        model.clips[number].name = free;
    }
}

/// Loaders, Bevy's among them, find what a clip moves by the names on the way to it: where it moves one of
/// two `box` below the same node, the second becomes `box.2`.
pub(crate) fn make_paths_unique(model: &mut Model, report: &mut Report) {
    let mut moved = vec![false; model.nodes.len()];
    for channel in model.clips.iter().flat_map(|clip| &clip.channels) {
        let mut at = Some(channel.node);
        while let Some(node) = at.filter(|&node| !moved[node]) {
            moved[node] = true;
            at = model.nodes[node].parent;
        }
    }
    let mut groups: BTreeMap<(Option<usize>, String), Vec<usize>> = BTreeMap::new();
    for (number, node) in model.nodes.iter().enumerate() {
        // A mesh with a skin has its name from a node that may be there too, and nothing moves it.
        if node.skin.is_none() && !node.name.is_empty() {
            let place = (node.parent, node.name.clone());
            groups.entry(place).or_default().push(number);
        }
    }
    let taken: BTreeSet<(Option<usize>, String)> = groups.keys().cloned().collect();
    for ((parent, name), nodes) in groups {
        if nodes.len() < 2 || !nodes.iter().any(|&node| moved[node]) {
            continue;
        }
        let mut free = (2..)
            .map(|i| format!("{name}.{i}"))
            .filter(|free| !taken.contains(&(parent, free.clone())));
        for &node in &nodes[1..] {
            if let Some(free) = free.next() {
                model.nodes[node].name = free;
            }
        }
        let detail = format!(
            "{} nodes of this name hang side by side, and clips find nodes by name; all but the first have a number now",
            nodes.len()
        );
        report.lose("node-name", &name, detail);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_are_no_part_of_names() {
        assert_eq!(own_name(b"Model::\x95\xe0"), b"\x95\xe0");
        assert_eq!(own_name(b"\x95::x\0\x01Model"), b"\x95::x");
    }
}
