//! Majorants of nodes in the world, from those of what places each below its parent.

use crate::clips::{Pose, Shells};
use crate::curves::{Majorant, Rates, Turning};
use glam::{DAffine3, DMat3, DVec3};

/// Majorants of a node's origin in the world and of its axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Chain {
    pub(crate) origin: Majorant,
    pub(crate) axes: Majorant,
    /// Axes are the exponential of this sum of angles, times all else: sums down a chain are less work than products.
    turned: Majorant,
    others: Majorant,
    /// Its axes keep their lengths.
    pub(super) keeps: bool,
    /// It is as large in all directions, and keeps it.
    even: bool,
    /// By how large a share squares of its axes' lengths may change, and by how large a one its axes are uneven: where scales above
    /// stand still and what turns are known angles, else infinite.
    pub(super) changes: f64,
    uneven: f64,
}

/// See [`Chain::hardly_changes`].
pub(super) const HARDLY: f64 = 1e-3;

const ONE: Majorant = Majorant([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0);

impl Chain {
    pub(crate) const ROOT: Self = Self {
        origin: Majorant::ZERO,
        axes: ONE,
        turned: Majorant::ZERO,
        others: ONE,
        keeps: true,
        even: true,
        changes: 0.0,
        uneven: 0.0,
    };

    /// Of a node that stands still.
    pub(crate) fn still(world: &DAffine3) -> Self {
        Self {
            origin: Majorant::ZERO,
            axes: Majorant::still(length(&world.matrix3)),
            turned: Majorant::ZERO,
            others: Majorant::still(length(&world.matrix3)),
            keeps: true,
            even: is_even(&world.matrix3),
            changes: 0.0,
            uneven: uneven(&world.matrix3),
        }
    }

    /// Of how far out what is `far` away at most by axes whose lengths hardly change is, in the node's own unit: as much more as
    /// these are short. `None` where they change by more than a share of [`HARDLY`].
    ///
    /// Squares of lengths are `g (1 + f)`, where `f` is turned from both sides, so that its coefficients are below those of
    /// `c E^2`, with `c` as [`Chain::changes`] and `E` the exponential of all angles. Those of `(1 + f)^(-1/2)` are below
    /// those of the sum of `c^j E^(2 j) / 2`, where those of `E^(2 j)` are no more than `j^k` times those of `E^2` in order `k`: to the
    /// sixth, all after the first are less than a tenth of it.
    pub(super) fn hardly_changes(&self, far: f64) -> Option<Majorant> {
        if self.changes.is_nan() || self.changes > HARDLY {
            return None;
        }
        let mut out = self
            .turned
            .scaled(2.0)
            .exponential()
            .scaled(self.changes * far);
        out.0[0] = far * (1.0 + 2.0 * self.changes);
        Some(out.near(2.0 * self.changes * far))
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
        let still;
        let above = match shells.parent(node) {
            None => &Chain::ROOT,
            Some(parent) if moving[parent] => &out[parent],
            Some(parent) => {
                still = Chain::still(&world[parent]);
                &still
            }
        };
        let is_scaled = !own.scale.is_still();
        let keeps = above.even && !is_scaled;
        let scale = pose[node].scale.abs();
        let (least, most) = (scale.min_element(), scale.max_element());
        let even = most - least <= 1e-9 * most;
        // Of scales s the squares are uneven by no more than this.
        let own_uneven = (most * most - least * least) / (least * least);
        let changes = above.uneven * (1.0 + own_uneven);
        let mut turned = above.turned;
        let mut others = above.others;
        let mut is_known = !is_scaled;
        match &own.turn {
            Turning::By(angle) => turned = turned.plus(angle),
            Turning::Whole(turn) => {
                others = others.product(turn);
                is_known = false;
            }
        }
        if is_scaled || own.scale.0[0] != 1.0 {
            others = others.product(&own.scale);
        }
        let axes = match &own.turn {
            // Mostly no node's own.
            Turning::By(angle) if angle.is_still() => above.axes.product(&own.scale),
            _ if others.is_still() => turned.rotation().scaled(others.0[0]),
            _ => turned.rotation().product(&others),
        };
        out[node] = Chain {
            origin: above.origin.plus_product(&above.axes, &own.translation),
            axes,
            turned,
            others,
            keeps,
            even: keeps && even,
            changes: if is_known { changes } else { f64::INFINITY },
            uneven: if is_known {
                own_uneven + changes
            } else {
                f64::INFINITY
            },
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

/// By how large a share of their mean the squares of its axes' lengths, and what they have in common, are uneven.
fn uneven(m: &DMat3) -> f64 {
    let mut product = m.transpose() * *m;
    let mean = product.diagonal().element_sum() / 3.0;
    product -= DMat3::from_diagonal(DVec3::splat(mean));
    let columns = [product.x_axis, product.y_axis, product.z_axis];
    columns
        .map(DVec3::length_squared)
        .iter()
        .sum::<f64>()
        .sqrt()
        / mean
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clips::SHELL;
    use crate::curves::{Over, holds};
    use crate::model::{Model, Node, Trs};
    use glam::{DQuat, DVec3};

    fn node(parent: Option<usize>, scale: DVec3) -> Node {
        Node {
            name: String::new(),
            parent,
            rest: Trs {
                scale,
                translation: DVec3::X,
                ..Trs::IDENTITY
            },
            mesh: None,
            skin: None,
            light: None,
            camera: None,
        }
    }

    /// Two nodes that turn, below one that does not, all of them scaled a little unevenly.
    #[test]
    fn shells_of_axes_that_hardly_change_hold() {
        for uneven in [0.0, 1e-7, 1e-4, 1e-2] {
            let scale = DVec3::new(2.0 + uneven, 2.0, 2.0 - uneven);
            let nodes = [None, Some(0), Some(1)].map(|parent| node(parent, scale));
            let model = Model {
                nodes: nodes.to_vec(),
                ..Model::default()
            };
            let shells = Shells::of(&model);
            let (speeds, axis) = ([1.3, -0.9], DVec3::new(1.0, 2.0, -1.0).normalize());
            let pose = |t: f64| -> Pose {
                let mut pose: Pose = model.nodes.iter().map(|node| node.rest).collect();
                pose[1].rotation = DQuat::from_axis_angle(axis, speeds[0] * t);
                pose[2].rotation = DQuat::from_rotation_y(0.4 + speeds[1] * t);
                pose
            };
            let world = |t: f64| {
                let mut world = Vec::new();
                shells.world(&pose(t), &mut world);
                world
            };
            let mut rates: Vec<Rates> = pose(0.0).iter().map(Rates::still).collect();
            rates[1].turn = Turning::By(Majorant::moving(0.0, speeds[0]));
            rates[2].turn = Turning::By(Majorant::moving(0.0, speeds[1]));
            let mut chains = vec![Chain::ROOT; 3];
            // Where nodes are at any time will do.
            let now = (&world(0.2)[..], &pose(0.2));
            let moving = [false, true, true];
            down(&shells, &[1, 2], &moving, &rates, now, &mut chains);
            let way = |t: f64| [world(t)[2].translation - world(0.5)[2].translation];
            let origin = chains[2].origin;
            holds(&Majorant(origin.0, origin.1), Over::WHOLE, |t| {
                (way(t)[0] + DVec3::ZERO).to_array()
            });
            let axes = |t: f64| world(t)[2].matrix3;
            let least = |t: f64| {
                let m = axes(t);
                let columns = [m.x_axis, m.y_axis, m.z_axis].map(DVec3::length);
                columns.into_iter().fold(f64::INFINITY, f64::min)
            };
            let Some(shell) = chains[2].hardly_changes(SHELL / least(0.2)) else {
                assert_eq!(uneven, 1e-2);
                continue;
            };
            assert!(uneven < 1e-2);
            for axis in 0..3 {
                holds(
                    &shell,
                    Over::WHOLE,
                    |t| [SHELL / axes(t).col(axis).length()],
                );
                holds(&chains[2].axes, Over::WHOLE, |t| {
                    axes(t).col(axis).to_array()
                });
            }
            // As little as the axes are uneven.
            assert!(shell.0[1] <= 20.0 * uneven * SHELL, "{uneven}: {shell:?}");
        }
    }
}
