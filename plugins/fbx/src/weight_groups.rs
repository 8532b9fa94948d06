//! Vertices whose weights differ from the file's, some beside each other held together.
//!
//! A vertex is off by the sum over its joints of where each would have it times by how much more it follows that joint. These
//! differences sum to nothing (but for rounding), so that the same may be taken from all places: where one of the joints, the
//! group's own, would have it. What is left is small and much the same for vertices beside each other, so that it is worked out for
//! their mean, and what any of them may be beside that is added. Each by itself is only held where that is more than is asked about.

use glam::{DAffine3, DMat3, DVec3};
use std::collections::BTreeMap;

/// Vertices that are held together.
const TOGETHER: usize = 16;

/// A vertex: its place in the mesh, and for each joint how much more it follows it in the file.
pub(crate) struct Held<'a> {
    pub(crate) place: DVec3,
    pub(crate) differences: &'a [(usize, f64)],
}

/// Some of them.
pub(crate) struct Group {
    /// Their numbers.
    pub(crate) members: Vec<usize>,
    /// The joint whose place is taken from all.
    own: usize,
    middle: DVec3,
    /// How far they are from the middle.
    radius: f64,
    /// What the differences of one do not sum to 0 by.
    rest: f64,
    rows: Vec<Row>,
}

/// What one joint does to a group.
struct Row {
    joint: usize,
    /// The mean of differences, and of places from the middle times differences.
    weight: f64,
    place: DVec3,
    /// How far those of a vertex are from these at most.
    weights: f64,
    places: f64,
}

/// Puts vertices that differ at the same joints and lie near each other together.
pub(crate) fn groups(all: &[Held]) -> Vec<Group> {
    let mut alike: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::new();
    for (number, held) in all.iter().enumerate() {
        let mut joints: Vec<usize> = held.differences.iter().map(|d| d.0).collect();
        joints.sort_unstable();
        joints.dedup();
        alike.entry(joints).or_default().push(number);
    }
    let mut out = Vec::new();
    for (joints, mut members) in alike {
        // Along the longest side of their box.
        let places = members.iter().map(|&member| all[member].place);
        let (low, high) = places.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
            (low.min(p), high.max(p))
        });
        let axis = (high - low).max_position();
        members.sort_by(|&a, &b| all[a].place[axis].total_cmp(&all[b].place[axis]));
        for some in members.chunks(TOGETHER) {
            out.extend(Group::of(all, some, &joints));
        }
    }
    out
}

impl Group {
    /// `None` where nothing differs.
    fn of(all: &[Held], members: &[usize], joints: &[usize]) -> Option<Self> {
        let own = *joints.first()?;
        let count = members.len() as f64;
        let middle = members.iter().map(|&m| all[m].place).sum::<DVec3>() / count;
        let difference = |member: usize, joint: usize| -> f64 {
            let its = all[member].differences.iter().filter(|d| d.0 == joint);
            its.map(|d| d.1).sum()
        };
        let row = |&joint: &usize| {
            let each = || {
                members.iter().map(move |&member| {
                    let weight = difference(member, joint);
                    (weight, (all[member].place - middle) * weight)
                })
            };
            let weight = each().map(|one| one.0).sum::<f64>() / count;
            let place = each().map(|one| one.1).sum::<DVec3>() / count;
            Row {
                joint,
                weight,
                place,
                weights: each().map(|one| (one.0 - weight).abs()).fold(0.0, f64::max),
                places: each().map(|one| one.1.distance(place)).fold(0.0, f64::max),
            }
        };
        let sum = |member: usize| joints.iter().map(|&joint| difference(member, joint)).sum();
        Some(Self {
            own,
            middle,
            radius: members
                .iter()
                .map(|&m| all[m].place.distance(middle))
                .fold(0.0, f64::max),
            rest: members
                .iter()
                .map(|&m| f64::abs(sum(m)))
                .fold(0.0, f64::max),
            rows: joints.iter().skip(1).map(row).collect(),
            members: members.to_vec(),
        })
    }

    /// None of them is farther off than this. `matrices` are where joints have the mesh.
    pub(crate) fn bound(&self, matrices: &[DAffine3]) -> f64 {
        let own = &matrices[self.own];
        let at = own.transform_point3(self.middle);
        let (mut mean, mut beside) = (DVec3::ZERO, 0.0);
        for row in &self.rows {
            let its = &matrices[row.joint];
            let shift = its.transform_point3(self.middle) - at;
            let turn = DMat3::from_cols(
                its.matrix3.x_axis - own.matrix3.x_axis,
                its.matrix3.y_axis - own.matrix3.y_axis,
                its.matrix3.z_axis - own.matrix3.z_axis,
            );
            mean += shift * row.weight + turn * row.place;
            beside += shift.length() * row.weights + size(&turn) * row.places;
        }
        let rest = self.rest * (at.length() + size(&own.matrix3) * self.radius);
        // A share for rounding: these are sums of a few products.
        (mean.length() + beside + rest) * (1.0 + 1e-9)
    }
}

/// The most that a matrix makes of a way of one, or a little more.
fn size(m: &DMat3) -> f64 {
    let columns = [m.x_axis, m.y_axis, m.z_axis];
    let squares = columns.map(DVec3::length_squared);
    squares.iter().sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    /// The same numbers in every run, -1 to 1.
    fn noise(seed: usize) -> f64 {
        let x = (seed as f64 * 0.618_033_988_749_895 + 0.1).fract();
        (x * 7919.0).fract() * 2.0 - 1.0
    }

    #[test]
    fn no_vertex_is_farther_off_than_its_group() {
        let differences: Vec<Vec<(usize, f64)>> = (0..400)
            .map(|vertex| {
                let (a, b) = (noise(vertex) * 0.1, noise(vertex + 7000) * 0.1);
                // A vertex may follow a joint twice, and sums are only nearly 0.
                match vertex % 3 {
                    0 => vec![(0, a), (1, b), (2, -a - b + 1e-7)],
                    1 => vec![(3, a), (1, -a)],
                    _ => vec![(2, a), (2, b), (4, -a), (0, -b)],
                }
            })
            .collect();
        let held: Vec<Held> = differences
            .iter()
            .enumerate()
            .map(|(vertex, differences)| Held {
                place: DVec3::new(noise(vertex + 1), noise(vertex + 2) * 3.0, 5.0),
                differences,
            })
            .collect();
        let groups = groups(&held);
        let mut seen: Vec<usize> = groups.iter().flat_map(|g| g.members.clone()).collect();
        seen.sort_unstable();
        assert!(seen == (0..400).collect::<Vec<_>>());
        let mut near = f64::INFINITY;
        let mut last: Option<Vec<DAffine3>> = None;
        for pose in 0..40 {
            let matrix = |joint: usize| {
                let seed = pose * 100 + joint * 10;
                let axis = DVec3::new(noise(seed), noise(seed + 1), 1.5).normalize();
                DAffine3::from_scale_rotation_translation(
                    DVec3::splat(1.0 + 0.2 * noise(seed + 3)),
                    DQuat::from_axis_angle(axis, noise(seed + 2)),
                    DVec3::new(noise(seed + 4), 0.0, noise(seed + 5)) * 0.3,
                )
            };
            let matrices: Vec<DAffine3> = (0..5).map(matrix).collect();
            let mixed = |before: &Vec<DAffine3>| -> Vec<DAffine3> {
                let mix = |(a, b): (&DAffine3, &DAffine3)| DAffine3 {
                    matrix3: a.matrix3 * 1.7 - b.matrix3 * 0.7,
                    translation: a.translation * 1.7 - b.translation * 0.7,
                };
                matrices.iter().zip(before).map(mix).collect()
            };
            for group in &groups {
                let bound = group.bound(&matrices);
                if let Some(before) = &last {
                    // Bounds of mixtures are no larger than those of what is mixed, all added.
                    let all = 1.7 * bound + 0.7 * group.bound(before);
                    assert!(group.bound(&mixed(before)) <= all * (1.0 + 1e-12));
                }
                for &member in &group.members {
                    let parts = held[member].differences.iter();
                    let off: DVec3 = parts
                        .map(|&(j, w)| matrices[j].transform_point3(held[member].place) * w)
                        .sum();
                    assert!(off.length() <= bound, "{} of {bound}", off.length());
                    near = near.min(bound / off.length());
                }
            }
            last = Some(matrices);
        }
        // It is a bound of something, not of anything.
        assert!(near < 1.5, "{near}");
    }
}
