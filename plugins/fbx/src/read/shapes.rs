//! Blend shapes as morph targets.
//!
//! An FBX channel has a weight and shapes at given weights (in-betweens): between two of them the
//! mesh is their mixture, beyond the last it goes on straight. Each shape becomes a morph target of
//! its own, and the channel's weight becomes one piecewise linear weight for each of them, so that
//! in-betweens are exact.

use super::convert::vec3;
use crate::curves::{Majorant, Number};
use crate::model::Target;
use glam::DVec3;
use ufbx::{BlendChannel, BlendShape, Mesh};

/// A shape of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ShapeKey {
    /// Number of the channel in the scene.
    pub(crate) channel: usize,
    /// Which of the channel's shapes.
    pub(crate) key: usize,
}

/// What each morph target of a mesh is.
#[derive(Default)]
pub(crate) struct Shapes<'a> {
    pub(crate) keys: Vec<ShapeKey>,
    pub(crate) targets: Vec<Target>,
    sources: Vec<&'a BlendShape>,
}

/// Weights of a channel's shapes when the channel's own is `weight`; `targets` are the weights that
/// the shapes stand at, growing. The mesh itself stands at 0.
pub(crate) fn shape_weights(targets: &[f64], weight: f64) -> Vec<f64> {
    let mut out = vec![0.0; targets.len()];
    // Neighbours on the side of 0 that the weight is on, from 0 outwards.
    let side: Vec<usize> = match weight > 0.0 {
        true => (0..targets.len()).filter(|&i| targets[i] > 0.0).collect(),
        false => (0..targets.len())
            .rev()
            .filter(|&i| targets[i] < 0.0)
            .collect(),
    };
    let Some(last) = side.len().checked_sub(1) else {
        // Nothing on this side: straight on from the nearest shape of the other.
        let nearest =
            (0..targets.len()).min_by(|&a, &b| targets[a].abs().total_cmp(&targets[b].abs()));
        if let Some(i) = nearest.filter(|&i| targets[i] != 0.0) {
            out[i] = weight / targets[i];
        }
        return out;
    };
    let beyond = side.iter().position(|&i| targets[i].abs() > weight.abs());
    let next = beyond.unwrap_or(last);
    let (below, from) = match next.checked_sub(1) {
        Some(i) => (Some(side[i]), targets[side[i]]),
        None => (None, 0.0),
    };
    let to = targets[side[next]];
    if to == from {
        return out;
    }
    let t = (weight - from) / (to - from);
    if let Some(i) = below {
        out[i] = 1.0 - t;
    }
    out[side[next]] = t;
    out
}

/// Adds the majorants of [`shape_weights`] over a span to `out`: these bend where the channel's own weight passes a shape
/// or 0.
pub(crate) fn shape_rates(targets: &[f64], weight: &Number, out: &mut Vec<Majorant>) {
    let (low, high) = (weight.low(), weight.high());
    if weight.is_still() || !low.is_finite() || !high.is_finite() {
        let known = weight.is_still();
        out.extend(
            shape_weights(targets, weight.middle)
                .into_iter()
                .map(|value| match known {
                    true => Majorant::still(value),
                    false => Majorant::UNKNOWN,
                }),
        );
        return;
    }
    let mut stops = vec![low, high];
    let passed = targets.iter().copied().chain([0.0]);
    stops.extend(passed.filter(|&stop| stop > low && stop < high));
    stops.sort_by(f64::total_cmp);
    let values: Vec<Vec<f64>> = stops.iter().map(|&w| shape_weights(targets, w)).collect();
    out.extend((0..targets.len()).map(|target| {
        let (mut slope, mut most) = (0.0_f64, values[0][target].abs());
        for (pair, stops) in values.windows(2).zip(stops.windows(2)) {
            most = most.max(pair[1][target].abs());
            if stops[1] > stops[0] {
                let rise = pair[1][target] - pair[0][target];
                slope = slope.max((rise / (stops[1] - stops[0])).abs());
            }
        }
        let mut moves = weight.moves.scaled(slope);
        if stops.len() > 2 {
            moves = moves.bent();
        }
        moves.0[0] = most;
        moves
    }));
}

/// The weights that a channel's shapes stand at.
pub(crate) fn stops(channel: &BlendChannel) -> Vec<f64> {
    channel
        .keyframes
        .iter()
        .map(|key| key.target_weight)
        .collect()
}

impl<'a> Shapes<'a> {
    pub(crate) fn of(mesh: &'a Mesh) -> Self {
        let mut shapes = Self::default();
        for deformer in &mesh.blend_deformers {
            for channel in &deformer.channels {
                let rest = shape_weights(&stops(channel), channel.weight);
                for (key, frame) in channel.keyframes.iter().enumerate() {
                    let shape: &BlendShape = &frame.shape;
                    let name = match channel.keyframes.len() {
                        1 => &channel.element.name,
                        _ => &shape.element.name,
                    };
                    shapes.keys.push(ShapeKey {
                        channel: channel.element.typed_id as usize,
                        key,
                    });
                    shapes.targets.push(Target {
                        name: name.to_string(),
                        rest: if rest[key].is_finite() {
                            rest[key]
                        } else {
                            0.0
                        },
                        reach: reach(shape),
                    });
                    // The scene outlives its parts, which it owns.
                    shapes.sources.push(frame.shape.as_ref());
                }
            }
        }
        shapes
    }

    /// What target `index` adds to each vertex of the FBX mesh, and to its normal where it says so.
    pub(crate) fn offsets(
        &self,
        index: usize,
        vertices: usize,
    ) -> (Vec<DVec3>, Option<Vec<DVec3>>) {
        let shape = self.sources[index];
        let weight = |i: usize| shape.offset_weights.get(i).copied().unwrap_or(1.0);
        let spread = |values: &[ufbx::Vec3]| {
            let mut out = vec![DVec3::ZERO; vertices];
            for (i, (&vertex, &value)) in shape.offset_vertices.iter().zip(values).enumerate() {
                if let Some(slot) = out.get_mut(vertex as usize) {
                    *slot += vec3(value) * weight(i);
                }
            }
            out
        };
        let has_normals = shape.normal_offsets.iter().any(|n| vec3(*n) != DVec3::ZERO);
        (
            spread(&shape.position_offsets),
            has_normals.then(|| spread(&shape.normal_offsets)),
        )
    }
}

fn reach(shape: &BlendShape) -> f64 {
    let far = |(i, offset): (usize, &ufbx::Vec3)| {
        vec3(*offset).length() * shape.offset_weights.get(i).copied().unwrap_or(1.0).abs()
    };
    let reach = shape.position_offsets.iter().enumerate().map(far);
    reach.filter(|r| r.is_finite()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::shape_weights;

    #[test]
    fn between_shapes_the_mesh_is_their_mixture() {
        let stops = [0.25, 0.5, 1.0];
        assert_eq!(shape_weights(&stops, 0.0), [0.0, 0.0, 0.0]);
        assert_eq!(shape_weights(&stops, 0.125), [0.5, 0.0, 0.0]);
        assert_eq!(shape_weights(&stops, 0.25), [1.0, 0.0, 0.0]);
        assert_eq!(shape_weights(&stops, 0.75), [0.0, 0.5, 0.5]);
        assert_eq!(shape_weights(&stops, 1.0), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn beyond_the_last_shape_it_goes_on_straight() {
        assert_eq!(shape_weights(&[0.5, 1.0], 1.5), [-1.0, 2.0]);
        assert_eq!(shape_weights(&[1.0], 2.0), [2.0]);
    }

    #[test]
    fn shapes_below_zero_have_their_own_side() {
        let stops = [-1.0, 1.0];
        assert_eq!(shape_weights(&stops, -0.5), [0.5, 0.0]);
        assert_eq!(shape_weights(&stops, 0.5), [0.0, 0.5]);
        assert_eq!(shape_weights(&[0.5, 1.0], -0.5), [-1.0, 0.0]);
        assert_eq!(shape_weights(&[], 0.5), [0.0; 0]);
    }
}
