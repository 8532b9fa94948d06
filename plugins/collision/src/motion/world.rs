//! What movers meet: bodies, each a tree of triangles that stands, moves or turns.

use crate::geometry::{nearest_on_triangle, unit_normal};
use crate::sweep::{UnitSpace, UnitTouch};
use crate::tree::TriangleTree;
use crate::volume::{Aabb, Ray};
use bevy::math::{DAffine3, DMat3, DQuat, DVec3};

/// Where a body is, without scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Where its own origin lies.
    pub translation: DVec3,
    /// How it is turned; of length 1.
    pub rotation: DQuat,
}

impl Default for Pose {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Pose {
    /// As the mesh is given.
    pub const IDENTITY: Self = Self {
        translation: DVec3::ZERO,
        rotation: DQuat::IDENTITY,
    };

    /// Not turned.
    #[must_use]
    pub const fn at(translation: DVec3) -> Self {
        Self {
            translation,
            rotation: DQuat::IDENTITY,
        }
    }

    /// A place of the body, in the world.
    #[inline]
    #[must_use]
    pub fn outward(&self, place: DVec3) -> DVec3 {
        self.translation + self.rotation * place
    }

    /// A place of the world, in the body.
    #[inline]
    #[must_use]
    pub fn inward(&self, place: DVec3) -> DVec3 {
        self.rotation.inverse() * (place - self.translation)
    }

    fn is_valid(&self) -> bool {
        self.translation.is_finite() && self.rotation.is_finite()
    }
}

/// A body over one step.
#[derive(Clone, Copy, Debug)]
pub struct Body<'a> {
    /// Its triangles.
    pub tree: &'a TriangleTree,
    /// Where it was at the start of the step.
    pub before: Pose,
    /// Where it is at the end.
    pub after: Pose,
}

impl<'a> Body<'a> {
    /// One that stands where its mesh is.
    #[must_use]
    pub const fn fixed(tree: &'a TriangleTree) -> Self {
        Self::standing(tree, Pose::IDENTITY)
    }

    /// One that stands.
    #[must_use]
    pub const fn standing(tree: &'a TriangleTree, pose: Pose) -> Self {
        Self {
            tree,
            before: pose,
            after: pose,
        }
    }

    /// Whether it moved in this step.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.before != self.after
    }

    /// Where a place that stays on it gets to in this step.
    #[must_use]
    pub fn carry(&self, place: DVec3) -> DVec3 {
        self.after.outward(self.before.inward(place))
    }

    /// The box around it at a pose.
    fn bounds(&self, pose: &Pose) -> Option<Aabb> {
        let bounds = self.tree.bounds()?;
        let map = DAffine3::from_rotation_translation(pose.rotation, pose.translation);
        Some(bounds.transformed(&map))
    }
}

/// All bodies that a mover may meet. A body whose pose is not finite is passed over.
#[derive(Clone, Copy, Debug, Default)]
pub struct World<'a> {
    /// In the order of their numbers.
    pub bodies: &'a [Body<'a>],
    /// One that is not met for now: that which carries or pushes the mover.
    pub(super) without: Option<u32>,
}

/// A touch, and whose.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    /// Which body.
    pub body: u32,
    /// Which triangle of it.
    pub triangle: u32,
    /// In unit space of the mover, turned as the world is.
    pub unit: UnitTouch,
    /// Away from the surface, in the world.
    pub normal: DVec3,
    /// The normal of the triangle itself on the same side, zero of one without area.
    pub face: DVec3,
}

/// Nearer in time, and else first by number.
fn before(touch: &UnitTouch, known: Option<&Touch>) -> bool {
    known.is_none_or(|known| touch.time < known.unit.time)
}

impl<'a> World<'a> {
    /// Of these bodies.
    #[must_use]
    pub const fn new(bodies: &'a [Body<'a>]) -> Self {
        Self {
            bodies,
            without: None,
        }
    }

    /// The same but for one.
    pub(super) const fn without(&self, body: u32) -> Self {
        Self {
            bodies: self.bodies,
            without: Some(body),
        }
    }

    /// The first that an ellipsoid touches on its way, of bodies where they are at the end of the step.
    #[must_use]
    pub fn sweep(&self, space: &UnitSpace, way: DVec3) -> Option<Touch> {
        let half = space.half_size();
        let mut best: Option<Touch> = None;
        let swept = Aabb::around(space.center, half).union(&Aabb::around(space.center + way, half));
        for (index, body) in (0..).zip(self.bodies) {
            if self.without == Some(index) || !meets(body, &body.after, &swept) {
                continue;
            }
            let (local, local_way) = inside(space, &body.after, way);
            if let Some((unit, triangle)) = body.tree.sweep_space(&local, local_way)
                && before(&unit, best.as_ref())
            {
                best = Some(touch(index, body, &body.after, triangle, unit, space));
            }
        }
        best
    }

    /// The normal of the first triangle that a ray hits, on the ray's side, of bodies at the end of the step; and the
    /// body.
    #[must_use]
    pub fn normal_along(&self, ray: &Ray) -> Option<(u32, DVec3)> {
        let mut best: Option<(f64, u32, DVec3)> = None;
        for (index, body) in (0..).zip(self.bodies) {
            if self.without == Some(index) || !body.after.is_valid() {
                continue;
            }
            let turn = body.after.rotation;
            let local = Ray {
                origin: body.after.inward(ray.origin),
                direction: turn.inverse() * ray.direction,
                end: ray.end,
            };
            if let Some(hit) = body.tree.first_hit(&local)
                && best.is_none_or(|(time, ..)| hit.time < time)
            {
                let normal = turn * unit_normal(body.tree.mesh().corners(hit.triangle));
                let side = if normal.dot(ray.direction) > 0.0 {
                    -normal
                } else {
                    normal
                };
                best = Some((hit.time, index, side));
            }
        }
        best.map(|(_, index, normal)| (index, normal))
    }

    /// The first moment at which a moving body runs into an ellipsoid that stands, by number of the body: the way
    /// that its triangles come, seen from the body at its start, is swept back. A turn is taken as the way of the
    /// ellipsoid's centre.
    #[must_use]
    pub fn run_into(&self, index: usize, space: &UnitSpace) -> Option<Touch> {
        let body = &self.bodies[index];
        if !body.before.is_valid() || !body.after.is_valid() {
            return None;
        }
        let start = body.before.inward(space.center);
        let end = body.after.inward(space.center);
        // In the frame of the body at its start; the ellipsoid's own turn is neglected.
        let (local, _) = inside(space, &body.before, DVec3::ZERO);
        let local = UnitSpace {
            center: start,
            ..local
        };
        let (unit, triangle) = body.tree.sweep_space(&local, end - start)?;
        Some(touch(
            index as u32,
            body,
            &body.before,
            triangle,
            unit,
            space,
        ))
    }

    /// The triangle that reaches deepest over an ellipsoid by more than `least` radii, at the end of the step.
    #[must_use]
    pub fn deepest(&self, space: &UnitSpace, least: f64) -> Option<Touch> {
        let around = Aabb::around(space.center, space.half_size());
        let mut best: Option<Touch> = None;
        for (index, body) in (0..).zip(self.bodies) {
            if !meets(body, &body.after, &around) {
                continue;
            }
            let (local, _) = inside(space, &body.after, DVec3::ZERO);
            let near = Aabb::around(local.center, local.half_size());
            body.tree.for_each_near(&near, |triangle| {
                let triangle_there = local.triangle(body.tree.mesh().corners(triangle));
                let (point, feature) = nearest_on_triangle(DVec3::ZERO, triangle_there.corners);
                let depth = 1.0 - point.length();
                let deeper = match &best {
                    None => depth > least,
                    Some(known) => {
                        depth > known.unit.depth
                            || (depth == known.unit.depth
                                && (index, triangle) < (known.body, known.triangle))
                    }
                };
                if deeper {
                    let unit = UnitTouch {
                        time: 0.0,
                        normal: (-point).try_normalize().unwrap_or(DVec3::ZERO),
                        point,
                        feature,
                        depth,
                    };
                    best = Some(touch(index, body, &body.after, triangle, unit, space));
                }
            });
        }
        best
    }
}

fn meets(body: &Body, pose: &Pose, swept: &Aabb) -> bool {
    pose.is_valid()
        && body.bounds(pose).is_some_and(|bounds| {
            bounds.min.cmple(swept.max).all() && swept.min.cmple(bounds.max).all()
        })
}

/// Unit space as a body at a pose sees it: its own axes are turned, unit space is not.
fn inside(space: &UnitSpace, pose: &Pose, way: DVec3) -> (UnitSpace, DVec3) {
    if pose.rotation == DQuat::IDENTITY {
        let center = space.center - pose.translation;
        return (UnitSpace { center, ..*space }, way);
    }
    let turn = DMat3::from_quat(pose.rotation);
    let back = turn.transpose();
    let local = UnitSpace {
        center: back * (space.center - pose.translation),
        to_unit: space.to_unit * turn,
        axes: back * space.axes,
    };
    (local, back * way)
}

fn touch(
    index: u32,
    body: &Body,
    pose: &Pose,
    triangle: u32,
    mut unit: UnitTouch,
    space: &UnitSpace,
) -> Touch {
    let face = pose.rotation * unit_normal(body.tree.mesh().corners(triangle));
    if unit.normal == DVec3::ZERO {
        // The centre is on the triangle: out of its front.
        unit.normal = (space.axes.transpose() * face).normalize_or(DVec3::Y);
    }
    let normal = space.normal(unit.normal);
    let face = if face.dot(normal) < 0.0 { -face } else { face };
    Touch {
        body: index,
        triangle,
        unit,
        normal,
        face,
    }
}
