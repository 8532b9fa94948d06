//! Contacts of bodies with the whole ground.
//!
//! As parry's with a height field, with three differences: contacts are worked out in the frame of the cell, whatever
//! holds its samples; contacts come in the order of cells in the world, so that they are solved in one order everywhere;
//! and what is known from the step before is found by the cell, so that samples may come and go under a body.

use super::cells::Lattice;
use super::surface::Surface;
use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use bevy_rapier3d::parry::math::Pose;
use bevy_rapier3d::parry::query::details::{
    ContactManifoldsWorkspace, NormalConstraints, TypedWorkspaceData, WorkspaceData,
};
use bevy_rapier3d::parry::query::{DefaultQueryDispatcher, PersistentQueryDispatcher, Unsupported};
use bevy_rapier3d::parry::shape::Shape;
use bevy_rapier3d::rapier::geometry::{ContactData, ContactManifold, ContactManifoldData};

/// A triangle of the ground and a part of a body: contacts between them are one manifold. In the order in which they
/// are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    cell: [i32; 2],
    right: bool,
    part: u32,
}

impl Key {
    /// A number of the triangle, for those who ask Rapier which it was: the same again 32 768 cells east and 65 536
    /// cells south.
    const fn id(self) -> u32 {
        let [x, z] = self.cell;
        ((x as u32 & 0x7fff) << 17) | ((z as u32 & 0xffff) << 1) | self.right as u32
    }
}

/// Which manifolds a pair has.
#[derive(Clone, Default)]
struct Known {
    lattice: Option<Lattice>,
    /// One of each manifold, in order.
    keys: Vec<Key>,
}

impl WorkspaceData for Known {
    fn as_typed_workspace_data(&self) -> TypedWorkspaceData<'_> {
        TypedWorkspaceData::Custom
    }

    fn clone_dyn(&self) -> Box<dyn WorkspaceData> {
        Box::new(self.clone())
    }
}

/// A part of a body: its number, where it lies on the body, its shape, and between which directions its normals lie.
type OnPart<'a> = dyn FnMut(u32, Option<&Pose>, &dyn Shape, Option<&dyn NormalConstraints>) + 'a;

/// Contacts of a body at `pos` in the frame of the ground. `flipped`: the body is the first of the pair.
///
/// # Errors
/// [`Unsupported`] where parry knows no contacts of such a body with triangles.
pub(super) fn ground_contacts(
    ground: &Surface,
    body: &dyn Shape,
    pos: &Pose,
    flipped: bool,
    prediction: f32,
    manifolds: &mut Vec<ContactManifold>,
    workspace: &mut Option<ContactManifoldsWorkspace>,
) -> Result<(), Unsupported> {
    let known = workspace
        .as_mut()
        .and_then(|data| data.0.downcast_mut::<Known>());
    let Known { lattice, keys } = known.map(std::mem::take).unwrap_or_default();
    let mut old = std::mem::take(manifolds);
    let bounds = body.compute_aabb(pos).loosened(prediction);
    let Some(patch) = ground.patch(&bounds) else {
        *workspace = Some(Known::default().into());
        return Ok(());
    };
    // Cells of another lattice are other triangles, though they have the same numbers.
    let old_keys = if lattice == Some(patch.lattice) {
        keys
    } else {
        Vec::new()
    };
    let mut new = Known {
        lattice: Some(patch.lattice),
        keys: Vec::with_capacity(old_keys.len()),
    };
    let mut result = Ok(());
    for cell in patch.between(bounds.mins.y, bounds.maxs.y) {
        for right in [false, true] {
            let (part, origin) = patch.part(cell, right);
            let origin = Pose::from_translation(origin);
            // Exact: both are numbers of f32, and the frame is nearer to the body than the origin is.
            let in_cell = origin.inv_mul(pos);
            let around = || part.triangle.aabb(&in_cell.inverse()).loosened(prediction);
            let mut meet =
                |id: u32,
                 at: Option<&Pose>,
                 shape: &dyn Shape,
                 constraints: Option<&dyn NormalConstraints>| {
                    let key = Key {
                        cell: cell.to_array(),
                        right,
                        part: id,
                    };
                    let mut manifold = old_keys.binary_search(&key).map_or_else(
                        |_| {
                            let (one, two) = if flipped {
                                (id, key.id())
                            } else {
                                (key.id(), id)
                            };
                            ContactManifold::with_data(one, two, ContactManifoldData::default())
                        },
                        |at| old[at].take(),
                    );
                    let place = at.map_or(in_cell, |at| in_cell * *at);
                    let normals: Option<&dyn NormalConstraints> = Some(&part.normals);
                    let done = if flipped {
                        manifold.set_subshape_pos1(at.copied());
                        manifold.set_subshape_pos2(Some(origin));
                        contact(
                            &place.inverse(),
                            (shape, constraints),
                            (&part.triangle, normals),
                            prediction,
                            &mut manifold,
                        )
                    } else {
                        manifold.set_subshape_pos1(Some(origin));
                        manifold.set_subshape_pos2(at.copied());
                        contact(
                            &place,
                            (&part.triangle, normals),
                            (shape, constraints),
                            prediction,
                            &mut manifold,
                        )
                    };
                    result = result.and(done);
                    new.keys.push(key);
                    manifolds.push(manifold);
                };
            each_part(body, around, &mut meet);
        }
    }
    *workspace = Some(new.into());
    result
}

/// Parts of a body that meet a box in its frame, in the order of their numbers.
fn each_part(body: &dyn Shape, around: impl Fn() -> Aabb, meet: &mut OnPart<'_>) {
    let Some(parts) = body.as_composite_shape() else {
        meet(0, None, body, None);
        return;
    };
    let mut ids: Vec<u32> = parts.bvh().intersect_aabb(&around()).collect();
    ids.sort_unstable();
    for id in ids {
        parts.map_part_at(id, &mut |at, shape, constraints| {
            meet(id, at, shape, constraints)
        });
    }
}

/// A shape, and between which directions its normals lie.
type Side<'a> = (&'a dyn Shape, Option<&'a dyn NormalConstraints>);

/// Contacts of two convex shapes, by parry.
fn contact(
    pos12: &Pose,
    one: Side<'_>,
    two: Side<'_>,
    prediction: f32,
    manifold: &mut ContactManifold,
) -> Result<(), Unsupported> {
    PersistentQueryDispatcher::<ContactManifoldData, ContactData>::contact_manifold_convex_convex(
        &DefaultQueryDispatcher,
        pos12,
        one.0,
        two.0,
        one.1,
        two.1,
        prediction,
        manifold,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rapier::{Diagonals, GroundTiles};
    use bevy::math::{DVec2, IVec2, Quat, Vec3};
    use bevy_rapier3d::parry::shape::{Ball, Compound, Cuboid, SharedShape};
    use dolomite_terrain::{Ground, GroundSample};
    use std::sync::Arc;

    /// Heights without any order.
    struct Rough;

    impl Ground for Rough {
        fn sample(&self, xz: DVec2) -> GroundSample {
            let at = (xz * 4.0).as_ivec2();
            let mixed = at.x.wrapping_mul(7919) ^ at.y.wrapping_mul(104_729);
            GroundSample {
                height: f64::from(mixed.rem_euclid(1000)) * 1e-3 + 30.0,
                gradient: DVec2::ZERO,
            }
        }
    }

    fn tiles(cells: u32) -> GroundTiles {
        GroundTiles::new(Arc::new(Rough), 0.5, cells).expect("the samples are usable")
    }

    type Found = (Vec<ContactManifold>, Option<ContactManifoldsWorkspace>);

    fn contacts(surface: &Surface, body: &dyn Shape, at: &Pose, flipped: bool, found: &mut Found) {
        ground_contacts(surface, body, at, flipped, 0.02, &mut found.0, &mut found.1)
            .expect("parry knows these shapes");
    }

    /// All that there is of contacts, in order, to the bit.
    fn bits(manifolds: &[ContactManifold]) -> Vec<[u32; 12]> {
        let of = |manifold: &ContactManifold| {
            let place = |pose: Option<&Pose>| pose.map_or(Vec3::ZERO, |pose| pose.translation);
            let (one, two) = (manifold.subshape_pos1(), manifold.subshape_pos2());
            let (from, n1) = (place(one) + place(two), manifold.local_n1);
            let points = manifold.points.iter().map(move |point| {
                let (p1, p2) = (point.local_p1, point.local_p2);
                let numbers = [p1.x, p1.y, p1.z, p2.x, p2.y, p2.z, n1.x, n1.z];
                let more = [point.dist, from.x, from.y, from.z];
                let mut bits = [0; 12];
                for (bits, number) in bits.iter_mut().zip(numbers.into_iter().chain(more)) {
                    *bits = number.to_bits();
                }
                bits
            });
            points.collect::<Vec<_>>()
        };
        manifolds.iter().flat_map(of).collect()
    }

    fn bodies() -> Vec<(SharedShape, Pose)> {
        let turned = Quat::from_rotation_z(0.3) * Quat::from_rotation_y(0.7);
        let part = SharedShape::new(Cuboid::new(Vec3::new(0.6, 0.2, 0.4)));
        let parts = [-0.7_f32, 0.7].map(|x| (Pose::from_translation(Vec3::X * x), part.clone()));
        let compound = SharedShape::new(Compound::new(parts.to_vec()));
        let at = |x: f32, y: f32, z: f32| Pose::from_parts(Vec3::new(x, y, z), turned);
        vec![
            (SharedShape::new(Ball::new(0.8)), at(3.9, 31.2, -8.1)),
            (SharedShape::new(Ball::new(0.8)), at(0.1, 31.2, -0.1)),
            (part, at(7.9, 30.7, 8.1)),
            (compound, at(-16.2, 30.6, 4.1)),
        ]
    }

    /// Tiles of any size, there or not: the contacts are the same, to the bit and in order.
    #[test]
    fn tiles_are_no_matter_to_contacts() {
        for (body, at) in bodies() {
            for flipped in [false, true] {
                let mut expected = Found::default();
                let unsampled = Surface::new(tiles(64));
                contacts(&unsampled, &*body, &at, flipped, &mut expected);
                let expected = bits(&expected.0);
                assert!(expected.len() > 1, "{at:?}: there is something to compare");
                for cells in [1, 2, 8, 256] {
                    let ground = tiles(cells);
                    let surface = Surface::new(ground.clone());
                    let mut found = Found::default();
                    for x in -2..2 {
                        for z in -2..2 {
                            // Half of them: the others are asked of the ground.
                            let tile = IVec2::new(x, z);
                            if (x + z) % 2 == 0 {
                                surface.insert(tile, ground.samples(tile));
                            }
                        }
                    }
                    contacts(&surface, &*body, &at, flipped, &mut found);
                    assert_eq!(bits(&found.0), expected, "{cells}");
                }
                // The counterpart: cells cut another way have other contacts.
                let alike = tiles(8).with_diagonals(Diagonals::Alike);
                let mut other = Found::default();
                contacts(&Surface::new(alike), &*body, &at, flipped, &mut other);
                assert_ne!(bits(&other.0), expected);
            }
        }
    }

    /// What the solver left with a contact is there in the next step, though tiles went, and is not where the cells are
    /// others.
    #[test]
    fn contacts_keep_what_the_solver_left() {
        for (body, at) in bodies() {
            let ground = tiles(8);
            let surface = Surface::new(ground.clone());
            surface.insert(IVec2::ZERO, ground.samples(IVec2::ZERO));
            let mut found = Found::default();
            contacts(&surface, &*body, &at, false, &mut found);
            let impulses = |found: &Found| -> Vec<f32> {
                let points = found.0.iter().flat_map(|manifold| &manifold.points);
                points.map(|point| point.data.impulse).collect()
            };
            let points = found.0.iter_mut().flat_map(|manifold| &mut manifold.points);
            for (number, point) in points.enumerate() {
                point.data.impulse = 1.0 + number as f32;
            }
            let left = impulses(&found);
            surface.remove(IVec2::ZERO);
            contacts(&surface, &*body, &at, false, &mut found);
            assert_eq!(impulses(&found), left);
            let alike = ground.with_diagonals(Diagonals::Alike);
            surface.set(alike, bevy::platform::collections::HashMap::default());
            contacts(&surface, &*body, &at, false, &mut found);
            assert!(impulses(&found).iter().all(|&impulse| impulse == 0.0));
        }
    }

    #[test]
    fn what_is_nowhere_has_no_contacts() {
        let surface = Surface::new(tiles(8));
        for x in [f32::NAN, f32::INFINITY, 1e30] {
            let mut found = Found::default();
            let at = Pose::from_translation(Vec3::new(x, 30.0, 0.0));
            contacts(&surface, &Ball::new(1.0), &at, false, &mut found);
            assert!(found.0.is_empty());
        }
    }
}
