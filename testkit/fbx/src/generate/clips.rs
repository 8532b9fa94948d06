//! Random clips: which layers they have, and what these move.

use super::curves::{Range, curve};
use crate::random::{Random, round};
use crate::scene::{Curve, Key, Layer, Scene, Shows, Stack, TICKS, Target, Track, Way};

/// A clip of what a scene holds. `steady` keeps scales still.
pub(super) fn clip(
    number: usize,
    scene: &Scene,
    size: f64,
    steady: bool,
    random: &mut Random,
) -> Stack {
    let seconds = match random.below(10) {
        0 => random.magnitude(0.002, 0.1),
        // Hours are as rare as they cost time.
        1 => {
            let most = match random.below(200) {
                0 => 20_000.0,
                1..6 => 1500.0,
                _ => 200.0,
            };
            random.magnitude(60.0, most)
        }
        _ => random.magnitude(0.2, 20.0),
    };
    let start = match random.below(4) {
        0 => round(random.between(-5.0, 100.0), 3),
        _ => 0.0,
    };
    let start = (start * TICKS as f64) as i64;
    let stop = start + (seconds * TICKS as f64) as i64;
    let mut stack = Stack {
        name: format!("s{number}"),
        start,
        stop,
        layers: Vec::new(),
    };
    let count = random.pick(&[1, 1, 1, 2, 2, 3]);
    // A clip that nothing moves in.
    if random.chance(0.03) {
        stack.layers.push(Layer::plain(Vec::new()));
        return stack;
    }
    let upper: Vec<Layer> = (1..count).map(|_| upper([start, stop], random)).collect();
    // Where rotations are mixed as such, they stay near each other: halfway to the other side of the circle there are two
    // ways, and which one is taken nobody means.
    let near = upper
        .iter()
        .any(|layer| !layer.by_channel && layer.blend != Some(1));
    let moves = Moves {
        scene,
        clip: [start, stop],
        size,
        steady,
        near,
        sparse: random.chance(0.5),
    };
    stack.layers.push(Layer::plain(moves.tracks(random)));
    for mut layer in upper {
        layer.tracks = moves.tracks(random);
        stack.layers.push(layer);
    }
    if count > 1 {
        if random.chance(0.2) {
            let one = random.below(count);
            stack.layers[one].mute = true;
        } else if random.chance(0.15) {
            let one = random.below(count);
            stack.layers[one].solo = true;
        }
    }
    stack
}

fn upper(clip: [i64; 2], random: &mut Random) -> Layer {
    let weight = match random.chance(0.5) {
        true => 100.0,
        false => round(random.between(0.0, 100.0), 0),
    };
    let keyed = random.chance(0.25);
    let range = Range {
        values: [0.0, 100.0],
        held: true,
    };
    Layer {
        blend: random.pick(&[None, Some(0), Some(1), Some(2)]),
        weight,
        weight_curve: keyed.then(|| curve(clip, range, random)),
        by_channel: random.chance(0.4),
        add_scale: random.chance(0.3),
        ..Layer::plain(Vec::new())
    }
}

struct Moves<'a> {
    scene: &'a Scene,
    clip: [i64; 2],
    size: f64,
    steady: bool,
    near: bool,
    sparse: bool,
}

impl Moves<'_> {
    fn tracks(&self, random: &mut Random) -> Vec<Track> {
        let chance = if self.sparse { 0.3 } else { 0.8 };
        let mut tracks = Vec::new();
        for (number, node) in self.scene.nodes.iter().enumerate() {
            if random.chance(chance * 0.6) {
                let range = |random: &mut Random| around(0.0, self.size / 2.0 * random.unit());
                tracks.push(self.track(
                    Target::Translation(number),
                    node.translation,
                    range,
                    false,
                    random,
                ));
            }
            if random.chance(chance) {
                tracks.push(self.turns(number, node.rotation, random));
            }
            if !self.steady && random.chance(chance * 0.3) {
                let range = |random: &mut Random| [0.4, random.between(0.5, 2.5)];
                let rest = node.scaling.map(f64::abs);
                tracks.push(self.track(Target::Scaling(number), rest, range, true, random));
            }
            if random.chance(0.01) {
                tracks.push(self.track(
                    Target::Visibility(number),
                    [1.0; 3],
                    |_| [0.0, 1.0],
                    true,
                    random,
                ));
            }
            match node.shows {
                Shows::Light(_) if random.chance(0.3) => {
                    tracks.push(self.track(
                        Target::Intensity(number),
                        [100.0; 3],
                        |_| [0.0, 200.0],
                        true,
                        random,
                    ));
                }
                Shows::Camera(_) if random.chance(0.3) => {
                    tracks.push(self.track(
                        Target::FieldOfView(number),
                        [40.0; 3],
                        |_| [20.0, 70.0],
                        true,
                        random,
                    ));
                }
                _ => {}
            }
        }
        for (number, mesh) in self.scene.meshes.iter().enumerate() {
            for (index, channel) in mesh.channels.iter().enumerate() {
                if random.chance(chance) {
                    let target = Target::Percent(number, index);
                    tracks.push(self.track(
                        target,
                        [channel.percent; 3],
                        |_| [0.0, 100.0],
                        true,
                        random,
                    ));
                }
            }
        }
        for number in 0..self.scene.materials.len() {
            if random.chance(0.1) {
                tracks.push(self.track(
                    Target::Diffuse(number),
                    [0.8; 3],
                    |_| [0.0, 1.0],
                    true,
                    random,
                ));
            }
        }
        tracks
    }

    fn track(
        &self,
        target: Target,
        without: [f64; 3],
        range: impl Fn(&mut Random) -> [f64; 2],
        held: bool,
        random: &mut Random,
    ) -> Track {
        let mut one = |index: usize| {
            let keyed = index < target.width() && (target.width() == 1 || random.chance(0.7));
            keyed.then(|| {
                let values = range(random);
                curve(self.clip, Range { values, held }, random)
            })
        };
        Track {
            curves: [0, 1, 2].map(&mut one),
            target,
            without,
        }
    }

    /// A rotation: as a figure turns, right around, or spinning.
    fn turns(&self, node: usize, rest: [f64; 3], random: &mut Random) -> Track {
        let target = Target::Rotation(node);
        if self.near {
            return self.track(
                target,
                rest,
                |random| around(0.0, random.between(2.0, 25.0)),
                false,
                random,
            );
        }
        let seconds = (self.clip[1] - self.clip[0]) as f64 / TICKS as f64;
        match random.below(10) {
            0..6 => self.track(
                target,
                rest,
                |random| around(0.0, random.between(2.0, 60.0)),
                false,
                random,
            ),
            6 | 7 => self.track(target, rest, |_| around(0.0, 180.0), false, random),
            _ => {
                let most = if random.chance(0.02) { 200.0 } else { 40.0 };
                let turns =
                    (random.magnitude(0.1, 60.0) * seconds).min(random.magnitude(0.5, most));
                let axis = random.below(3);
                let mut track = Track {
                    target,
                    curves: [None, None, None],
                    without: rest,
                };
                track.curves[axis] = Some(match random.chance(0.6) {
                    true => spin(self.clip, turns * 360.0, random),
                    false => {
                        let range = Range {
                            values: around(0.0, turns.min(30.0) * 180.0),
                            held: false,
                        };
                        curve(self.clip, range, random)
                    }
                });
                track
            }
        }
    }
}

fn around(middle: f64, by: f64) -> [f64; 2] {
    [middle - by, middle + by]
}

/// Two keys and a straight line: the least that a wheel has.
fn spin(clip: [i64; 2], degrees: f64, random: &mut Random) -> Curve {
    let key = |time: i64, value: f64| Key {
        time,
        value: value as f32,
        way: Way::Linear,
        weights: None,
        velocity: false,
    };
    let whole = match random.chance(0.5) {
        // Whole turns: every keyframe of some rate may see the same place.
        true => (degrees / 360.0).round() * 360.0,
        false => degrees,
    };
    Curve::of(vec![key(clip[0], 0.0), key(clip[1], whole)])
}
