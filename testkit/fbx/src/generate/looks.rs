//! Random materials, cameras and lights.

use crate::random::{Random, round};
use crate::scene::{Camera, Light, Material, Node, Picture, Scene, Shows};

/// Gives meshes materials, and hangs up cameras and lights.
pub(super) fn add(scene: &mut Scene, random: &mut Random) {
    for number in 0..scene.meshes.len() {
        scene.meshes[number].material = Some(scene.materials.len());
        scene.materials.push(material(random));
    }
    for _ in 0..random.below(3) {
        let number = scene.nodes.len();
        let parent = random.chance(0.5).then(|| random.below(number));
        let mut node = Node::plain(&format!("n{number}"), parent);
        node.translation = random.vector(100.0 / scene.unit);
        node.shows = match random.chance(0.5) {
            true => Shows::Camera(camera(scene.unit, random)),
            false => Shows::Light(Light {
                kind: random.pick(&[0, 1, 2]),
                colour: [0, 1, 2].map(|_| round(random.unit(), 2)),
                intensity: round(random.between(10.0, 500.0), 0),
            }),
        };
        scene.nodes.push(node);
    }
    if random.chance(0.15) {
        let node = random.below(scene.nodes.len());
        scene.nodes[node].hidden = true;
    }
    if random.chance(0.15) {
        let node = random.below(scene.nodes.len());
        scene.nodes[node].user = Some(round(random.between(0.0, 100.0), 1));
    }
}

fn camera(unit: f64, random: &mut Random) -> Camera {
    let near = random.magnitude(0.01, 1.0) * 100.0 / unit;
    Camera {
        perspective: random.chance(0.7),
        angle: round(random.between(10.0, 100.0), 1),
        aspect: random.pick(&[[640.0, 480.0], [16.0, 9.0], [1.0, 1.0]]),
        near: round(near, 5),
        far: round(near * random.magnitude(10.0, 10_000.0), 5),
    }
}

fn material(random: &mut Random) -> Material {
    let colour = |random: &mut Random| [0, 1, 2].map(|_| round(random.unit(), 2));
    let transparency = random.chance(0.5).then(|| round(random.unit(), 2));
    let mut pictures = Vec::new();
    for slot in ["DiffuseColor", "NormalMap", "EmissiveColor"] {
        if random.chance(0.3) {
            let scaling = match random.chance(0.7) {
                true => [0, 1].map(|_| round(random.magnitude(0.2, 8.0), 2)),
                false => [1.0; 2],
            };
            pictures.push(Picture {
                slot,
                scaling,
                rotation: 0.0,
                translation: [0.0; 2],
            });
        }
    }
    Material {
        diffuse: colour(random),
        transparent: match transparency {
            Some(_) if random.chance(0.7) => {
                Some(random.pick(&[[1.0; 3], [0.0; 3], [1.0, 0.5, 0.0]]))
            }
            _ => None,
        },
        transparency,
        emissive: if random.chance(0.5) {
            colour(random)
        } else {
            [0.0; 3]
        },
        emissive_factor: random.pick(&[0.0, 0.5, 1.0, 1.0, 5.0]),
        pictures,
    }
}
