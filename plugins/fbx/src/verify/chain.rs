//! Majorants of nodes in the world, from those of what places each below its parent.

use crate::clips::{Pose, Shells};
use crate::curves::{Majorant, Rates};
use glam::{DAffine3, DMat3, DVec3};

/// Majorants of a node's origin in the world and of its axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Chain {
    pub(crate) origin: Majorant,
    pub(crate) axes: Majorant,
    /// Its axes keep their lengths.
    pub(super) keeps: bool,
    /// It is as large in all directions, and keeps it.
    even: bool,
}

impl Chain {
    pub(crate) const ROOT: Self = Self {
        origin: Majorant::ZERO,
        axes: Majorant(
            {
                let mut one = Majorant::ZERO.0;
                one[0] = 1.0;
                one
            },
            0.0,
        ),
        keeps: true,
        even: true,
    };

    /// Of a node that stands still.
    pub(crate) fn still(world: &DAffine3) -> Self {
        Self {
            origin: Majorant::ZERO,
            axes: Majorant::still(length(&world.matrix3)),
            keeps: true,
            even: is_even(&world.matrix3),
        }
    }
}

/// Majorants of all nodes that move, parents first, from `rates` below their parents; where they are in the middle of
/// the span is known.
pub(crate) fn down(
    shells: &Shells,
    movers: &[usize],
    moving: &[bool],
    rates: &[Rates],
    (world, pose): (&[DAffine3], &Pose),
    out: &mut [Chain],
) {
    for &node in movers {
        let own = &rates[node];
        let above = match shells.parent(node) {
            None => Chain::ROOT,
            Some(parent) if moving[parent] => out[parent],
            Some(parent) => Chain::still(&world[parent]),
        };
        let keeps = above.even && own.scale.is_still();
        let scale = pose[node].scale.abs();
        let even = scale.max_element() - scale.min_element() <= 1e-9 * scale.max_element();
        out[node] = Chain {
            origin: above.origin.plus(&above.axes.product(&own.translation)),
            axes: above.axes.product(&own.turn).product(&own.scale),
            keeps,
            even: keeps && even,
        };
    }
}

/// The most that a matrix makes of a way of one, or a little more.
pub(crate) fn length(m: &DMat3) -> f64 {
    let columns = [m.x_axis, m.y_axis, m.z_axis];
    match is_even(m) {
        true => m.x_axis.length(),
        false => columns
            .map(DVec3::length_squared)
            .iter()
            .sum::<f64>()
            .sqrt(),
    }
}

/// Its axes are at right angles and of one length.
fn is_even(m: &DMat3) -> bool {
    let one = m.x_axis.length_squared();
    let near = |x: f64| x.abs() <= 1e-9 * one;
    near(m.y_axis.length_squared() - one)
        && near(m.z_axis.length_squared() - one)
        && near(m.x_axis.dot(m.y_axis))
        && near(m.y_axis.dot(m.z_axis))
        && near(m.z_axis.dot(m.x_axis))
}
