//! How far the clips of two .glb files are apart, node by node, for files of which one was made of the other.

use super::played::Played;
use glam::{DMat4, DVec3};
use std::collections::{BTreeMap, BTreeSet};

/// The shell around a node, metres.
const SHELL: f64 = 0.03;

impl Played {
    /// The largest distance of points around nodes of this file from where `other` has them, metres, at all times
    /// at which a clip of this file has a key: six points around each node of a name that both have once, 3 cm
    /// from it or as far out as the farthest vertex that follows it. Clips are the same where their names are.
    /// `None` where a clip or a node of this file that moves is not there.
    pub fn farthest_from(&self, other: &Self) -> Option<f64> {
        let (own, others) = (self.numbers(), other.numbers());
        let reach = self.reach();
        let mut farthest = 0.0_f64;
        for (clip, source) in self.clips.iter().enumerate() {
            let times: BTreeSet<u32> = source
                .channels
                .iter()
                .flat_map(|channel| &channel.times)
                .map(|time| time.to_bits())
                .collect();
            let same = other.clips.iter().position(|clip| clip.name == source.name);
            if same.is_none() && !source.channels.is_empty() {
                // A clip that moves nothing may be left out.
                let still = source
                    .channels
                    .iter()
                    .all(|channel| channel.times.len() == 1);
                if !still {
                    return None;
                }
            }
            for time in times {
                let time = f64::from(f32::from_bits(time));
                let (world, _) = self.world(Some(clip), time);
                let (apart, _) = other.world(same, time);
                for (name, &node) in &own {
                    let Some(&there) = others.get(name) else {
                        continue;
                    };
                    let shell = reach[node].max(SHELL / largest(&world[node]).max(1e-9));
                    farthest = farthest.max(off(&world[node], &apart[there], shell));
                }
            }
        }
        let moved = self.clips.iter().flat_map(|clip| &clip.channels);
        for channel in moved.filter(|channel| channel.times.len() > 1) {
            let name = &self.nodes[channel.node].name;
            if own.contains_key(name.as_str()) && !others.contains_key(name.as_str()) {
                return None;
            }
        }
        Some(farthest)
    }

    /// The largest distance of nodes of the same name at rest, metres.
    pub fn rest_from(&self, other: &Self) -> f64 {
        let (world, _) = self.world(None, 0.0);
        let (apart, _) = other.world(None, 0.0);
        let others = other.numbers();
        let own = self.numbers();
        let pairs = own
            .iter()
            .filter_map(|(name, &node)| Some((node, *others.get(name)?)));
        let off = |(node, there): (usize, usize)| {
            let (a, b) = (world[node].w_axis, apart[there].w_axis);
            a.truncate().distance(b.truncate())
        };
        pairs.map(off).fold(0.0, f64::max)
    }

    /// Nodes by names that only one of them has; those that carry a skinned mesh stand nowhere.
    fn numbers(&self) -> BTreeMap<&str, usize> {
        let mut out = BTreeMap::new();
        let mut twice = BTreeSet::new();
        for (number, node) in self.nodes.iter().enumerate() {
            if node.skin.is_none() && out.insert(node.name.as_str(), number).is_some() {
                twice.insert(node.name.as_str());
            }
        }
        out.retain(|name, _| !name.is_empty() && !twice.contains(name));
        out
    }

    /// For each node the distance of the farthest vertex that follows it, as much as it does, in the node's own unit.
    fn reach(&self) -> Vec<f64> {
        let mut out = vec![0.0_f64; self.nodes.len()];
        for (number, node) in self.nodes.iter().enumerate() {
            let Some(mesh) = node.mesh else { continue };
            for part in &self.meshes[mesh].parts {
                for (vertex, position) in part.positions.iter().enumerate() {
                    let Some(skin) = node.skin else {
                        out[number] = out[number].max(position.length());
                        continue;
                    };
                    let skin = &self.skins[skin];
                    for &(joint, weight) in &part.joints[vertex] {
                        let far = skin.inverse_bind[joint]
                            .transform_point3(*position)
                            .length();
                        let slot = &mut out[skin.joints[joint]];
                        *slot = slot.max(far * weight);
                    }
                }
            }
        }
        out
    }
}

fn largest(m: &DMat4) -> f64 {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    axes.map(|axis| m.transform_vector3(axis).length())
        .into_iter()
        .fold(0.0, f64::max)
}

fn off(a: &DMat4, b: &DMat4, shell: f64) -> f64 {
    let points = [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        -DVec3::X,
        -DVec3::Y,
        -DVec3::Z,
    ];
    points
        .map(|p| {
            a.transform_point3(p * shell)
                .distance(b.transform_point3(p * shell))
        })
        .into_iter()
        .fold(0.0, f64::max)
}
