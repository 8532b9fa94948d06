//! How the layers of a clip are laid over one another.
//!
//! Layers that are not heard are as if they were not there. The clip's first layer gives the value, or where it does not
//! the file's rest; each one above it that moves the same property adds to it (mode 0), replaces it whatever its weight is (mode 1) or mixes with
//! it by its weight (mode 2). Rotations are added and mixed as rotations, or angle by angle; scales are multiplied, with
//! the weight as a power, or added.

use super::Reading;
use super::curve::Line;
use super::transform::{angles, rotation, slerp};
use crate::scene::{Layer, Stack, Target, Vec3};
use glam::DQuat;

/// The layers of a clip that are heard, ready to be asked.
#[derive(Debug)]
pub struct Layers<'a> {
    layers: Vec<Heard<'a>>,
    reading: Reading,
}

#[derive(Debug)]
struct Heard<'a> {
    layer: &'a Layer,
    /// It is the clip's first.
    base: bool,
    weight: Option<Line>,
    tracks: Vec<(Target, [Option<Line>; 3], Vec3)>,
}

impl<'a> Layers<'a> {
    /// Of a clip.
    pub fn of(stack: &'a Stack, reading: Reading) -> Self {
        let heard = stack.heard().into_iter().map(|layer| Heard {
            layer,
            base: std::ptr::eq(layer, &raw const stack.layers[0]),
            weight: layer
                .weight_curve
                .as_ref()
                .map(|curve| Line::of(curve, reading)),
            tracks: layer
                .tracks
                .iter()
                .map(|track| {
                    let line =
                        |curve: &Option<_>| curve.as_ref().map(|curve| Line::of(curve, reading));
                    (
                        track.target,
                        [0, 1, 2].map(|i| line(&track.curves[i])),
                        track.without,
                    )
                })
                .collect(),
        });
        Self {
            layers: heard.collect(),
            reading,
        }
    }

    /// The value of a property that is `rest` where nothing moves it, seconds on the file's clock. `order` is in which
    /// angles turn, for rotations.
    pub fn at(&self, target: Target, rest: Vec3, order: i32, time: f64) -> Vec3 {
        let mut value = rest;
        for heard in &self.layers {
            let Some((_, lines, without)) = heard.tracks.iter().find(|track| track.0 == target)
            else {
                continue;
            };
            let own = [0, 1, 2].map(|i| lines[i].as_ref().map_or(without[i], |line| line.at(time)));
            value = match heard.base {
                true => own,
                false => lay(value, own, heard, self.weight(heard, time), target, order),
            };
        }
        value
    }

    /// 0 to 1.
    fn weight(&self, heard: &Heard, time: f64) -> f64 {
        let weight = heard
            .weight
            .as_ref()
            .map_or(heard.layer.weight, |line| line.at(time))
            / 100.0;
        match weight > self.reading.full {
            true => 1.0,
            false => weight.clamp(0.0, 1.0),
        }
    }
}

fn lay(below: Vec3, own: Vec3, heard: &Heard, weight: f64, target: Target, order: i32) -> Vec3 {
    let layer = heard.layer;
    let adds = layer.blend.unwrap_or(0) == 0;
    if !adds && layer.blend != Some(2) {
        return own;
    }
    match target {
        Target::Rotation(_) if !layer.by_channel => {
            let (a, b) = (rotation(below, order), rotation(own, order));
            let laid = match adds {
                true => a * slerp(DQuat::IDENTITY, b, weight),
                false => slerp(a, b, weight),
            };
            angles(laid, order)
        }
        Target::Scaling(_) if !layer.add_scale => {
            let share = if adds { 1.0 } else { 1.0 - weight };
            [0, 1, 2].map(|i| power(below[i], share) * power(own[i], weight))
        }
        _ => {
            let share = if adds { 1.0 } else { 1.0 - weight };
            [0, 1, 2].map(|i| below[i] * share + own[i] * weight)
        }
    }
}

/// A scale to a power from 0 to 1, on its own side of 0.
fn power(scale: f64, power: f64) -> f64 {
    if power <= 0.0 {
        return 1.0;
    }
    scale.signum() * scale.abs().powf(power)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Curve, Key, Track, Way};

    fn still(values: Vec3, target: Target) -> Track {
        let key = |value: f64| Key {
            time: 0,
            value: value as f32,
            way: Way::Linear,
            weights: None,
            velocity: false,
        };
        Track {
            target,
            curves: values.map(|value| Some(Curve::of(vec![key(value)]))),
            without: [0.0; 3],
        }
    }

    fn over(target: Target, below: Vec3, own: Vec3, change: impl Fn(&mut Layer)) -> Vec3 {
        let mut upper = Layer::plain(vec![still(own, target)]);
        change(&mut upper);
        let stack = Stack {
            name: String::new(),
            start: 0,
            stop: 1,
            layers: vec![Layer::plain(vec![still(below, target)]), upper],
        };
        Layers::of(&stack, Reading::EXACT).at(target, [9.0; 3], 0, 0.0)
    }

    fn near(a: Vec3, b: Vec3) {
        assert!(
            a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9),
            "{a:?} {b:?}"
        );
    }

    #[test]
    fn modes_and_weights() {
        let place = Target::Translation(0);
        let half = |blend| move |layer: &mut Layer| (layer.blend, layer.weight) = (blend, 50.0);
        near(over(place, [1.0; 3], [4.0; 3], half(None)), [3.0; 3]);
        near(over(place, [1.0; 3], [4.0; 3], half(Some(1))), [4.0; 3]);
        near(over(place, [1.0; 3], [4.0; 3], half(Some(2))), [2.5; 3]);
        near(
            over(place, [1.0; 3], [4.0; 3], |layer| layer.mute = true),
            [1.0; 3],
        );
        near(
            over(place, [1.0; 3], [4.0; 3], |layer| layer.solo = true),
            [13.0; 3],
        );
    }

    #[test]
    fn accumulation() {
        let scale = Target::Scaling(0);
        near(
            over(scale, [2.0; 3], [4.0; 3], |layer| layer.weight = 50.0),
            [4.0; 3],
        );
        near(
            over(scale, [2.0; 3], [4.0; 3], |layer| layer.add_scale = true),
            [6.0; 3],
        );
        let turn = Target::Rotation(0);
        // A quarter turn about X carries the layer's own Z to the file's -Y.
        let turned = over(turn, [90.0, 0.0, 0.0], [0.0, 0.0, 30.0], |_| {});
        near(turned, [90.0, -30.0, 0.0]);
        near(
            over(turn, [90.0, 0.0, 0.0], [0.0, 0.0, 30.0], |layer| {
                layer.by_channel = true
            }),
            [90.0, 0.0, 30.0],
        );
    }
}
