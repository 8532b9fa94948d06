//! Values as they are written, and who makes good what that does.
//!
//! A rotation in 16-bit integers is off by up to 6e-5 radians, which at the end of a long chain may be
//! more than is allowed. So the tree is gone through from its roots to its tips: each joint aims where
//! it belongs in the world and not beside its parent, so that it takes back what those above it were turned
//! too far, and of the integers around that it takes those with which its children, and its own
//! shell, come nearest to where they were.

use super::curve::{Curve, Samples};
use super::state::State;
use crate::model::Property;
use glam::{DAffine3, DQuat, DVec4};

/// Steps of 16-bit integers from 0 to 1.
const STEPS: f64 = 32767.0;

/// How far from unit length a quaternion may be, in steps: players that do not normalise scale what
/// they turn by twice as much.
const LENGTH: f64 = 1.0;

/// Poses while they are rounded: everything for all samples, those of a sample together.
struct Rounding<'s, 'a> {
    state: &'s State<'a>,
    /// The world's rotation of each node before and after, and its place after.
    turned: Vec<DQuat>,
    turned_after: Vec<DQuat>,
    after: Vec<DAffine3>,
}

/// Rounds `curves`, whose poses `state` has.
pub(super) fn round(state: &State, curves: &mut [Curve], samples: Samples) {
    let size = state.nodes().len() * state.count();
    let mut rounding = Rounding {
        state,
        turned: vec![DQuat::IDENTITY; size],
        turned_after: vec![DQuat::IDENTITY; size],
        after: vec![DAffine3::IDENTITY; size],
    };
    let in_order: Vec<usize> = state.in_order().collect();
    for node in in_order {
        rounding.node(node, curves, samples);
    }
}

impl Rounding<'_, '_> {
    fn node(&mut self, node: usize, curves: &mut [Curve], samples: Samples) {
        let state = self.state;
        let (count, width) = (state.count(), state.nodes().len());
        let slot = state.slot(node);
        let above = state.parent_slot(node);
        let children = state.children(node);
        for i in 0..count {
            let own = state.local(node, i).rotation;
            let parent = above.map_or(DQuat::IDENTITY, |above| self.turned[i * width + above]);
            self.turned[i * width + slot] = parent * own;
        }
        let mut turns = None;
        for curve in curves.iter_mut().filter(|curve| curve.target.node == node) {
            if curve.target.property != Property::Rotation {
                curve.write(samples.times);
                continue;
            }
            for key in 0..curve.at.len() {
                let i = curve.at[key];
                let row = i * width;
                // One value for all times cannot make good what changes with them.
                let above = above.filter(|_| curve.at.len() > 1);
                let (is, was) = match above {
                    Some(above) => (self.turned_after[row + above], self.turned[row + above]),
                    None => (DQuat::IDENTITY, DQuat::IDENTITY),
                };
                let aim = (is.conjugate() * was * DQuat::from_vec4(curve.values[key])).normalize();
                let aim = DVec4::from(aim);
                curve.values[key] = match curve.short {
                    true => self.nearest(aim, node, i, &children),
                    false => aim,
                };
            }
            curve.write(samples.times);
            turns = Some(curve.played(samples.times));
        }
        for i in 0..count {
            let row = i * width;
            let mut own = *state.local(node, i);
            if let Some(turns) = &turns {
                own.rotation = DQuat::from_vec4(turns[i]);
            }
            let parent = above.map_or(DQuat::IDENTITY, |above| self.turned_after[row + above]);
            self.turned_after[row + slot] = parent * own.rotation;
            self.after[row + slot] = self.above(node, i) * matrix(&own);
        }
    }

    /// Where the parent of a node is, rounded.
    fn above(&self, node: usize, i: usize) -> DAffine3 {
        match self.state.parent_slot(node) {
            Some(above) => self.after[i * self.state.nodes().len() + above],
            None => self.state.fixed_parent(node),
        }
    }

    /// The integers around `aim` with which what hangs on the node comes nearest to where it was.
    fn nearest(&self, aim: DVec4, node: usize, i: usize, children: &[usize]) -> DVec4 {
        let (above, mut own) = (self.above(node, i), *self.state.local(node, i));
        let wanted = self.state.world(node, i);
        let places: Vec<_> = children
            .iter()
            .map(|&child| {
                let place = self.state.local(child, i).translation;
                (place, wanted.transform_point3(place))
            })
            .collect();
        let low = (aim * STEPS).floor();
        let mut best = (f64::INFINITY, (aim * STEPS).round() / STEPS);
        for corner in 0..16 {
            let up = |bit: u32| f64::from(corner >> bit & 1);
            let value = (low + DVec4::new(up(0), up(1), up(2), up(3))) / STEPS;
            if value.abs().max_element() > 1.0 || (value.length() - 1.0).abs() * STEPS > LENGTH {
                continue;
            }
            own.rotation = DQuat::from_vec4(value).normalize();
            let world = above * matrix(&own);
            let off = |(place, wanted): &(glam::DVec3, glam::DVec3)| {
                world.transform_point3(*place).distance_squared(*wanted)
            };
            let far = places
                .iter()
                .map(off)
                .fold(self.state.apart(node, wanted, &world), f64::max);
            if far < best.0 {
                best = (far, value);
            }
        }
        best.1
    }
}

fn matrix(pose: &crate::model::Trs) -> DAffine3 {
    DAffine3::from_scale_rotation_translation(pose.scale, pose.rotation, pose.translation)
}
