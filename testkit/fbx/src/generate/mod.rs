//! Random files. Each seed is a file of some topic (clips of plain curves, layers, spins, skins, looks, ...), small enough
//! to be read by eye once it is shrunk.

mod beyond;
mod clips;
mod curves;
mod looks;
mod meshes;

use crate::random::{Random, round};
use crate::scene::{Asked, Axis, Container, Node, Scene, Shows};

/// Units that programs write, centimetres.
const UNITS: [f64; 6] = [1.0, 100.0, 2.54, 0.1, 30.48, 1000.0];

/// How nodes inherit scale, which says where scales may be.
#[derive(Clone, Copy, PartialEq)]
enum Inherit {
    /// As matrices do, with any scale.
    Together,
    /// Rotations and scales apart, with any scale.
    Apart,
    /// Every node in its own way: scales are the same along all axes and stand still, for what a shear becomes when it is
    /// inherited apart nobody has written down.
    Mixed,
}

/// The file of a seed.
pub fn generate(seed: u64) -> Scene {
    let mut random = Random::new(seed);
    let random = &mut random;
    let unit = random.pick(&UNITS);
    let mut scene = Scene {
        asked: Asked {
            max_error: random.pick(&[1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-3, 1e-3, 1e-3, 1e-5]),
            within_frames: random.chance(0.2),
            eight: random.chance(0.2),
            thorough: random.chance(0.002),
        },
        container: random.pick(&[Container::Ascii, Container::Binary, Container::Deflated]),
        version: random.pick(&[7400, 7500]),
        unit,
        axes: axes(random),
        time_mode: random.pick(&[6, 3, 11, 10, 14]),
        nodes: Vec::new(),
        meshes: Vec::new(),
        materials: Vec::new(),
        stacks: Vec::new(),
    };
    let inherit = random.pick(&[
        Inherit::Together,
        Inherit::Together,
        Inherit::Together,
        Inherit::Together,
        Inherit::Apart,
        Inherit::Mixed,
    ]);
    // Metres of the whole, in the file's unit.
    let size = match random.chance(0.1) {
        true => random.magnitude(0.01, 1000.0),
        false => random.magnitude(0.3, 5.0),
    } * 100.0
        / unit;
    let count = 1 + random.below(6);
    for number in 0..count {
        let made = node(number, size / count as f64, inherit, random);
        scene.nodes.push(made);
    }
    meshes::add(&mut scene, size, random);
    if random.chance(0.25) {
        looks::add(&mut scene, random);
    }
    let stacks = random.pick(&[0, 1, 1, 1, 1, 1, 1, 2, 3]);
    for number in 0..stacks {
        let clip = clips::clip(number, &scene, size, inherit == Inherit::Mixed, random);
        scene.stacks.push(clip);
    }
    // By numbers of its own: what stands above is the same for the same seed as ever.
    beyond::add(&mut scene, &mut Random::new(seed ^ 0x6265_796f_6e64));
    scene
}

fn axes(random: &mut Random) -> [Axis; 3] {
    let usual = [[0, 1, 2], [0, 2, 1]];
    let order = match random.chance(0.6) {
        true => random.pick(&usual),
        false => random.pick(&[
            [0, 1, 2],
            [0, 2, 1],
            [1, 0, 2],
            [1, 2, 0],
            [2, 0, 1],
            [2, 1, 0],
        ]),
    };
    let mut axes = order.map(|axis| Axis { axis, sign: 1 });
    if order == [0, 2, 1] {
        // Z up, as Blender and 3ds Max have it.
        axes[2].sign = -1;
    }
    if random.chance(0.3) {
        axes.iter_mut()
            .for_each(|axis| axis.sign = random.pick(&[1, -1]));
    }
    axes
}

fn node(number: usize, size: f64, inherit: Inherit, random: &mut Random) -> Node {
    let parent = match number {
        0 => None,
        _ if random.chance(0.15) => None,
        _ => Some(random.below(number)),
    };
    let mut node = Node::plain(&format!("n{number}"), parent);
    let whole = |size: f64, random: &mut Random| random.vector(size);
    let turn = |random: &mut Random| [0, 1, 2].map(|_| round(random.between(-180.0, 180.0), 1));
    let place = |chance: f64, size: f64, random: &mut Random| match random.chance(chance) {
        true => whole(size, random),
        false => [0.0; 3],
    };
    node.translation = place(0.9, size, random);
    node.rotation_offset = place(0.15, size / 2.0, random);
    node.rotation_pivot = place(0.25, size / 2.0, random);
    node.scaling_offset = place(0.15, size / 2.0, random);
    node.scaling_pivot = place(0.25, size / 2.0, random);
    if random.chance(0.5) {
        node.rotation = [0, 1, 2].map(|_| round(random.between(-30.0, 30.0), 1));
    }
    if random.chance(0.3) {
        node.order = random.below(6) as i32;
    }
    if random.chance(0.3) {
        node.pre = turn(random);
    }
    if random.chance(0.2) {
        node.post = turn(random);
    }
    node.active = node.order != 0 || random.chance(0.9);
    if random.chance(0.4) {
        let one = round(random.magnitude(0.3, 3.0), 2);
        node.scaling = match inherit == Inherit::Mixed || random.chance(0.3) {
            true => [one; 3],
            false => [0, 1, 2].map(|_| round(random.magnitude(0.3, 3.0), 2)),
        };
        if inherit != Inherit::Mixed && random.chance(0.15) {
            node.scaling[random.below(3)] *= -1.0;
        }
    }
    node.inherit = match inherit {
        Inherit::Together => 1,
        Inherit::Apart => random.pick(&[0, 2]),
        Inherit::Mixed => random.pick(&[0, 1, 2]),
    };
    node.shows = match random.chance(0.5) {
        true => Shows::Bone,
        false => Shows::Nothing,
    };
    node
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Target, Way};

    #[test]
    fn every_kind_comes_up() {
        let scenes: Vec<Scene> = (0..1000).map(generate).collect();
        let some = |what: &str, has: &dyn Fn(&Scene) -> bool| {
            assert!(scenes.iter().any(has), "no file of 1000 has {what}");
        };
        let layers = |scene: &Scene, has: &dyn Fn(&crate::scene::Layer) -> bool| {
            scene.stacks.iter().flat_map(|stack| &stack.layers).any(has)
        };
        some("a mute layer", &|s| layers(s, &|l| l.mute));
        some("a solo layer", &|s| layers(s, &|l| l.solo));
        some("a keyed weight", &|s| {
            layers(s, &|l| l.weight_curve.is_some())
        });
        for blend in [None, Some(0), Some(1), Some(2)] {
            some("a blend mode", &|s| {
                s.stacks
                    .iter()
                    .any(|t| t.layers.iter().skip(1).any(|l| l.blend == blend))
            });
        }
        some("a skin", &|s| s.meshes.iter().any(|m| !m.skin.is_empty()));
        some("a blend shape that moves", &|s| {
            layers(s, &|l| {
                l.tracks
                    .iter()
                    .any(|t| matches!(t.target, Target::Percent(..)))
            })
        });
        some("a long clip", &|s| {
            s.stacks
                .iter()
                .any(|t| t.stop - t.start > 600 * crate::scene::TICKS)
        });
        some("a short clip", &|s| {
            s.stacks
                .iter()
                .any(|t| t.stop - t.start < crate::scene::TICKS / 50)
        });
        for way in 0..6 {
            let is = |key: &Way| match key {
                Way::Constant => 0,
                Way::ConstantNext => 1,
                Way::Linear => 2,
                Way::User { .. } => 3,
                Way::Auto { .. } => 4,
                Way::Tcb(_) => 5,
            };
            some("a kind of key", &|s| {
                layers(s, &|l| {
                    l.curves().any(|c| c.keys.iter().any(|k| is(&k.way) == way))
                })
            });
        }
        some("weighted tangents", &|s| {
            layers(s, &|l| {
                l.curves()
                    .any(|c| c.keys.iter().any(|k| k.weights.is_some()))
            })
        });
        some("a left hand's axes", &|s| {
            crate::truth::Space::of(s).mirrored()
        });
        some("a camera", &|s| {
            s.nodes.iter().any(|n| matches!(n.shows, Shows::Camera(_)))
        });
        some("a light", &|s| {
            s.nodes.iter().any(|n| matches!(n.shows, Shows::Light(_)))
        });
        some("a material", &|s| !s.materials.is_empty());
    }
}
