//! What few files have: curves that go on beyond their keys, layers of modes without a name, pictures that are turned.

use crate::random::{Random, round};
use crate::scene::{Beyond, Curve, Key, Layer, Scene, Stack, Target, Way};

/// Repetitions of a curve that a clip may hold.
const MOST: i64 = 8;

/// Adds some of it to some scenes.
pub(super) fn add(scene: &mut Scene, random: &mut Random) {
    if random.chance(0.25) {
        scene
            .stacks
            .iter_mut()
            .for_each(|stack| extend(stack, random));
    }
    for stack in &mut scene.stacks {
        for layer in stack.layers.iter_mut().skip(1) {
            if random.chance(0.05) {
                layer.blend = Some(random.pick(&[3, 4, 9, -1]));
            }
        }
    }
    let materials = scene.materials.iter_mut();
    for picture in materials.flat_map(|material| &mut material.pictures) {
        if random.chance(0.3) {
            picture.rotation = match random.chance(0.3) {
                true => random.pick(&[90.0, 180.0, -90.0]),
                false => round(random.between(-180.0, 180.0), 1),
            };
        }
        if random.chance(0.3) {
            picture.translation = [0, 1].map(|_| round(random.between(-2.0, 2.0), 2));
        }
    }
}

fn extend(stack: &mut Stack, random: &mut Random) {
    let clip = [stack.start, stack.stop];
    // Where rotations are mixed as such they are to stay near each other.
    let mixes = |layer: &Layer| !layer.by_channel && layer.blend != Some(1);
    let mixed = stack.layers.iter().skip(1).any(mixes);
    for layer in &mut stack.layers {
        for track in &mut layer.tracks {
            // Scales that pass 0 and what is held between two numbers stay between their keys.
            let far = match track.target {
                Target::Translation(_) => true,
                Target::Rotation(_) => !mixed,
                Target::Scaling(_) | Target::Percent(..) => false,
                _ => continue,
            };
            for curve in track.curves.iter_mut().flatten() {
                if random.chance(0.6) {
                    go_on(curve, clip, far, random);
                }
            }
        }
        if let Some(curve) = layer.weight_curve.as_mut().filter(|_| random.chance(0.3)) {
            go_on(curve, clip, false, random);
        }
    }
}

/// A curve gets a shorter span, so that there is something beyond its keys, and a way to go on there.
fn go_on(curve: &mut Curve, clip: [i64; 2], far: bool, random: &mut Random) {
    let length = clip[1] - clip[0];
    if random.chance(0.7) && curve.keys.len() > 3 {
        // Both ends, of which keys lie on those of the clip.
        curve.keys.pop();
        curve.keys.remove(0);
    }
    let [first, last] = curve.span();
    let repeats = curve.keys.len() > 1 && (last - first) * MOST >= length;
    for beyond in &mut curve.beyond {
        let count = random.pick(&[-1, -1, -1, 0, 1, 2]);
        *beyond = match random.below(5) {
            0 if far => Beyond::Line,
            1 if far && repeats => Beyond::Climbs(count),
            2 if repeats => Beyond::Back(count),
            3 if repeats => Beyond::Again(count),
            _ => Beyond::Stays,
        };
    }
    // Which slope such a curve ends with is not said anywhere: that of its last piece, or that of its last key.
    let cubic = |key: &Key| !matches!(key.way, Way::Constant | Way::ConstantNext | Way::Linear);
    let in_doubt = matches!(&*curve.keys, [.., before, last] if !cubic(before) && cubic(last));
    if in_doubt && curve.beyond[1] == Beyond::Line {
        curve.beyond[1] = Beyond::Stays;
    }
}
