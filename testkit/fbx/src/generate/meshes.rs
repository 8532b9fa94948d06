//! Random meshes, skins and blend shapes.

use crate::random::{Random, round};
use crate::scene::{Channel, Cluster, Mesh, Scene, Shows, Vec3};

/// Hangs meshes on some nodes.
pub(super) fn add(scene: &mut Scene, size: f64, random: &mut Random) {
    let count = scene.nodes.len();
    if random.chance(0.5) {
        let node = random.below(count);
        scene.nodes[node].shows = Shows::Mesh(scene.meshes.len());
        if random.chance(0.3) {
            let turn = [0, 1, 2].map(|_| round(random.between(-180.0, 180.0), 1));
            let scale = [0, 1, 2].map(|_| round(random.magnitude(0.4, 2.5), 2));
            scene.nodes[node].geometric = Some([random.vector(size / 10.0), turn, scale]);
        }
        let mut mesh = patch(size / 5.0, random);
        mesh.channels = channels(&mesh, size / 10.0, random);
        scene.meshes.push(mesh);
    }
    if count > 1 && random.chance(0.3) {
        skin(scene, size, random);
    }
}

/// A few vertices and faces.
fn patch(size: f64, random: &mut Random) -> Mesh {
    let (across, along) = (2 + random.below(3), 2 + random.below(3));
    let points = (0..across * along).map(|_| random.vector(size)).collect();
    let mut faces = Vec::new();
    for y in 0..along - 1 {
        for x in 0..across - 1 {
            let at = y * across + x;
            let corners = [at, at + 1, at + across + 1, at + across];
            match random.chance(0.5) {
                true => faces.push(corners.to_vec()),
                false => {
                    faces.push(vec![corners[0], corners[1], corners[2]]);
                    faces.push(vec![corners[0], corners[2], corners[3]]);
                }
            }
        }
    }
    Mesh {
        points,
        faces,
        channels: Vec::new(),
        skin: Vec::new(),
        material: None,
    }
}

fn channels(mesh: &Mesh, size: f64, random: &mut Random) -> Vec<Channel> {
    let count = random.pick(&[0, 0, 0, 1, 1, 2]);
    let moved = |random: &mut Random| -> Vec<(usize, Vec3)> {
        let mut out = Vec::new();
        for vertex in 0..mesh.points.len() {
            if random.chance(0.5) {
                out.push((vertex, random.vector(size)));
            }
        }
        if out.is_empty() {
            out.push((0, random.vector(size)));
        }
        out
    };
    let of = |_| {
        let stops: &[f64] = random.pick(&[
            &[100.0] as &[f64],
            &[100.0],
            &[40.0, 100.0],
            &[25.0, 60.0, 100.0],
        ]);
        Channel {
            percent: if random.chance(0.3) {
                round(random.between(0.0, 100.0), 0)
            } else {
                0.0
            },
            shapes: stops.iter().map(|&full| (full, moved(random))).collect(),
        }
    };
    (0..count).map(of).collect()
}

/// A mesh of a node of its own that follows some of the others.
fn skin(scene: &mut Scene, size: f64, random: &mut Random) {
    let number = scene.nodes.len();
    let mut node = crate::scene::Node::plain(&format!("n{number}"), None);
    node.shows = Shows::Mesh(scene.meshes.len());
    if random.chance(0.3) {
        node.translation = random.vector(size / 2.0);
        node.rotation = [0, 1, 2].map(|_| round(random.between(-90.0, 90.0), 1));
    }
    let mut mesh = patch(size / 2.0, random);
    if random.chance(0.3) {
        mesh.channels = channels(&mesh, size / 10.0, random);
    }
    let joints = (1 + random.below(number)).min(6);
    let first = random.below(number - joints + 1);
    mesh.skin = (first..first + joints)
        .map(|node| Cluster {
            node,
            weights: Vec::new(),
        })
        .collect();
    // Now and then more joints than four follow.
    let most = if random.chance(0.15) {
        joints
    } else {
        joints.min(4)
    };
    for vertex in 0..mesh.points.len() {
        let count = 1 + random.below(most);
        let begin = random.below(joints);
        for i in 0..count {
            let weight = round(random.between(0.05, 1.0), 2);
            mesh.skin[(begin + i) % joints]
                .weights
                .push((vertex, weight));
        }
    }
    mesh.skin.retain(|cluster| !cluster.weights.is_empty());
    scene.nodes.push(node);
    scene.meshes.push(mesh);
}
