//! Making a file that does not hold as small as it gets while it does not hold in the same way.

use crate::hold::Failure;
use crate::random::round;
use crate::run::Property;
use crate::scene::{Asked, Beyond, Container, Scene, Shows, Target, Vec3, Way};

/// Simplifies a scene, one step after another, as long as it fails in the same way; at most `tries` conversions.
pub fn shrink(
    scene: &Scene,
    seed: u64,
    failure: &Failure,
    property: Property,
    tries: usize,
) -> (Scene, Failure) {
    let mut best = (scene.clone(), failure.clone());
    let mut left = tries;
    loop {
        let mut better = false;
        let mut at = 0;
        // Steps are numbered; after one that helped the same number means the next step.
        while left > 0 {
            let Some(smaller) = step(&best.0, at) else {
                break;
            };
            if smaller == best.0 {
                at += 1;
                continue;
            }
            left -= 1;
            match property(&smaller, seed) {
                Err(other) if other.kind == failure.kind => {
                    best = (smaller, other);
                    better = true;
                }
                _ => at += 1,
            }
        }
        if !better || left == 0 {
            return best;
        }
    }
}

/// Step number `at` of those that a scene has; `None` after the last.
fn step(scene: &Scene, at: usize) -> Option<Scene> {
    let mut count = 0;
    let mut out = None;
    let mut offer = |change: &dyn Fn(&mut Scene)| {
        if count == at {
            let mut smaller = scene.clone();
            change(&mut smaller);
            out = Some(smaller);
        }
        count += 1;
    };
    offer(&|s| s.container = Container::Ascii);
    for number in (0..scene.stacks.len()).rev() {
        offer(&|s| {
            s.stacks.remove(number);
        });
    }
    for number in (0..scene.nodes.len()).rev() {
        offer(&|s| drop_node(s, number));
    }
    for (stack, clip) in scene.stacks.iter().enumerate() {
        for layer in (0..clip.layers.len()).rev() {
            offer(&|s| {
                s.stacks[stack].layers.remove(layer);
            });
        }
        for (layer, of) in clip.layers.iter().enumerate() {
            for track in (0..of.tracks.len()).rev() {
                offer(&|s| {
                    s.stacks[stack].layers[layer].tracks.remove(track);
                });
            }
        }
    }
    for number in (0..scene.nodes.len()).rev() {
        offer(&|s| s.nodes[number].shows = Shows::Nothing);
    }
    let plain: [fn(&mut Scene); 5] = [
        |s| s.version = 7400,
        |s| s.time_mode = 6,
        |s| s.unit = 100.0,
        |s| (0..3).for_each(|i| s.axes[i] = crate::scene::Axis { axis: i, sign: 1 }),
        |s| {
            s.asked = Asked {
                max_error: 1e-4,
                within_frames: false,
                eight: false,
                thorough: false,
            }
        },
    ];
    plain.iter().for_each(|change| offer(change));
    for (number, mesh) in scene.meshes.iter().enumerate() {
        offer(&|s| s.meshes[number].material = None);
        for channel in (0..mesh.channels.len()).rev() {
            offer(&|s| drop_channel(s, number, channel));
        }
        for cluster in (0..mesh.skin.len()).rev() {
            offer(&|s| {
                s.meshes[number].skin.remove(cluster);
            });
        }
        for face in (1..mesh.faces.len()).rev() {
            offer(&|s| {
                s.meshes[number].faces.remove(face);
            });
        }
    }
    for (number, material) in scene.materials.iter().enumerate() {
        for picture in (0..material.pictures.len()).rev() {
            offer(&|s| {
                s.materials[number].pictures.remove(picture);
            });
            offer(&|s| s.materials[number].pictures[picture].rotation = 0.0);
            offer(&|s| s.materials[number].pictures[picture].translation = [0.0; 2]);
        }
        offer(&|s| s.materials[number].transparent = None);
        offer(&|s| s.materials[number].transparency = None);
        offer(&|s| s.materials[number].emissive = [0.0; 3]);
        offer(&|s| s.materials[number].emissive_factor = 1.0);
        offer(&|s| s.materials[number].diffuse = [0.5; 3]);
    }
    of_nodes(scene, &mut offer);
    of_curves(scene, &mut offer);
    out
}

fn of_nodes(scene: &Scene, offer: &mut impl FnMut(&dyn Fn(&mut Scene))) {
    for number in 0..scene.nodes.len() {
        offer(&|s| s.nodes[number].geometric = None);
        offer(&|s| s.nodes[number].hidden = false);
        offer(&|s| s.nodes[number].user = None);
        offer(&|s| s.nodes[number].inherit = 1);
        offer(&|s| s.nodes[number].order = 0);
        offer(&|s| s.nodes[number].active = true);
        offer(&|s| s.nodes[number].parent = None);
        offer(&|s| s.nodes[number].scaling = [1.0; 3]);
        let vectors: [fn(&mut crate::scene::Node) -> &mut Vec3; 8] = [
            |n| &mut n.pre,
            |n| &mut n.post,
            |n| &mut n.rotation_offset,
            |n| &mut n.rotation_pivot,
            |n| &mut n.scaling_offset,
            |n| &mut n.scaling_pivot,
            |n| &mut n.translation,
            |n| &mut n.rotation,
        ];
        for vector in vectors {
            offer(&|s| *vector(&mut s.nodes[number]) = [0.0; 3]);
            offer(&|s| {
                vector(&mut s.nodes[number])
                    .iter_mut()
                    .for_each(|x| *x = round(*x, 0))
            });
        }
    }
}

fn of_curves(scene: &Scene, offer: &mut impl FnMut(&dyn Fn(&mut Scene))) {
    for (stack, clip) in scene.stacks.iter().enumerate() {
        for (number, layer) in clip.layers.iter().enumerate() {
            let of = |s: &mut Scene, change: &dyn Fn(&mut crate::scene::Layer)| {
                change(&mut s.stacks[stack].layers[number])
            };
            offer(&|s| of(s, &|l| l.weight_curve = None));
            offer(&|s| of(s, &|l| l.weight = 100.0));
            offer(&|s| of(s, &|l| l.mute = false));
            offer(&|s| of(s, &|l| l.solo = false));
            offer(&|s| of(s, &|l| l.by_channel = false));
            offer(&|s| of(s, &|l| l.add_scale = false));
            if !matches!(layer.blend, None | Some(0..=2)) {
                offer(&|s| of(s, &|l| l.blend = Some(1)));
            }
            for (index, track) in layer.tracks.iter().enumerate() {
                for axis in 0..3 {
                    let Some(curve) = &track.curves[axis] else {
                        continue;
                    };
                    let of = |s: &mut Scene, change: &dyn Fn(&mut Option<crate::scene::Curve>)| {
                        change(&mut s.stacks[stack].layers[number].tracks[index].curves[axis]);
                    };
                    offer(&|s| of(s, &|curve| *curve = None));
                    for side in 0..2 {
                        let stays = |c: &mut crate::scene::Curve| c.beyond[side] = Beyond::Stays;
                        offer(&|s| of(s, &|c| c.iter_mut().for_each(stays)));
                    }
                    if curve.keys.len() > 1 {
                        for key in (0..curve.keys.len()).rev() {
                            offer(&|s| {
                                of(s, &|c| {
                                    c.iter_mut().for_each(|c| {
                                        c.keys.remove(key);
                                    })
                                })
                            });
                        }
                    }
                    for key in 0..curve.keys.len() {
                        let of = |s: &mut Scene, change: &dyn Fn(&mut crate::scene::Key)| {
                            of(s, &|c| c.iter_mut().for_each(|c| change(&mut c.keys[key])));
                        };
                        offer(&|s| of(s, &|key| key.velocity = false));
                        offer(&|s| of(s, &|key| key.weights = None));
                        offer(&|s| of(s, &|key| key.way = Way::Linear));
                        offer(&|s| of(s, &|key| key.value = key.value.round()));
                    }
                }
                offer(&|s| {
                    s.stacks[stack].layers[number].tracks[index].without = match track.target {
                        Target::Scaling(_) => [1.0; 3],
                        _ => [0.0; 3],
                    }
                });
            }
        }
    }
}

fn drop_channel(scene: &mut Scene, mesh: usize, channel: usize) {
    scene.meshes[mesh].channels.remove(channel);
    retarget(scene, |target| match target {
        Target::Percent(of, at) if of == mesh && at >= channel => {
            (at > channel).then(|| Target::Percent(of, at - 1))
        }
        other => Some(other),
    });
}

/// Takes a node out; what hangs on it hangs on its parent.
fn drop_node(scene: &mut Scene, number: usize) {
    if scene.nodes.len() == 1 || number >= scene.nodes.len() {
        return;
    }
    let above = scene.nodes.remove(number).parent;
    let moved = |node: usize| if node > number { node - 1 } else { node };
    for node in &mut scene.nodes {
        if node.parent == Some(number) {
            node.parent = above;
        }
        node.parent = node.parent.map(moved);
    }
    for mesh in &mut scene.meshes {
        mesh.skin.retain(|cluster| cluster.node != number);
        mesh.skin
            .iter_mut()
            .for_each(|cluster| cluster.node = moved(cluster.node));
    }
    retarget(scene, |target| {
        let node = |node: usize| (node != number).then(|| moved(node));
        Some(match target {
            Target::Translation(at) => Target::Translation(node(at)?),
            Target::Rotation(at) => Target::Rotation(node(at)?),
            Target::Scaling(at) => Target::Scaling(node(at)?),
            Target::Visibility(at) => Target::Visibility(node(at)?),
            Target::Intensity(at) => Target::Intensity(node(at)?),
            Target::FieldOfView(at) => Target::FieldOfView(node(at)?),
            Target::Percent(..) | Target::Diffuse(_) => target,
        })
    });
}

fn retarget(scene: &mut Scene, of: impl Fn(Target) -> Option<Target>) {
    for layer in scene.stacks.iter_mut().flat_map(|stack| &mut stack.layers) {
        layer.tracks.retain(|track| of(track.target).is_some());
        for track in &mut layer.tracks {
            if let Some(target) = of(track.target) {
                track.target = target;
            }
        }
    }
}
