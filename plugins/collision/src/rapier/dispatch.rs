//! Who answers what two shapes are to each other, where one of them is ground.
//!
//! | | the whole ground, `surface.rs` | a tile, `field.rs` |
//! |---|---|---|
//! | contacts | yes | no: they would be there twice |
//! | sensors, casts, rays, points, continuous collision detection | no | yes |
//!
//! Parry's own answers everything else, and everything where this one is not: a tile then has contacts of its own.

use super::contacts::ground_contacts;
use super::field::TileShape;
use super::surface::Surface;
use bevy_rapier3d::parry::math::{Pose, Vector};
use bevy_rapier3d::parry::query::details::{ContactManifoldsWorkspace, NormalConstraints};
use bevy_rapier3d::parry::query::{
    ClosestPoints, Contact, DefaultQueryDispatcher, NonlinearRigidMotion,
    PersistentQueryDispatcher, QueryDispatcher, ShapeCastHit, ShapeCastOptions, Unsupported,
};
use bevy_rapier3d::parry::shape::Shape;
use bevy_rapier3d::rapier::geometry::{ContactData, ContactManifold, ContactManifoldData};

/// Parry's, which knows ground as well.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct GroundDispatcher;

fn is<T: Shape>(one: &dyn Shape, two: &dyn Shape) -> bool {
    one.as_shape::<T>().is_some() || two.as_shape::<T>().is_some()
}

impl QueryDispatcher for GroundDispatcher {
    fn intersection_test(
        &self,
        pos12: &Pose,
        one: &dyn Shape,
        two: &dyn Shape,
    ) -> Result<bool, Unsupported> {
        if is::<Surface>(one, two) {
            return Ok(false);
        }
        DefaultQueryDispatcher.intersection_test(pos12, one, two)
    }

    fn distance(&self, pos12: &Pose, one: &dyn Shape, two: &dyn Shape) -> Result<f32, Unsupported> {
        if is::<Surface>(one, two) {
            return Ok(f32::MAX);
        }
        DefaultQueryDispatcher.distance(pos12, one, two)
    }

    fn contact(
        &self,
        pos12: &Pose,
        one: &dyn Shape,
        two: &dyn Shape,
        prediction: f32,
    ) -> Result<Option<Contact>, Unsupported> {
        if is::<Surface>(one, two) {
            return Ok(None);
        }
        DefaultQueryDispatcher.contact(pos12, one, two, prediction)
    }

    fn closest_points(
        &self,
        pos12: &Pose,
        one: &dyn Shape,
        two: &dyn Shape,
        most: f32,
    ) -> Result<ClosestPoints, Unsupported> {
        if is::<Surface>(one, two) {
            return Ok(ClosestPoints::Disjoint);
        }
        DefaultQueryDispatcher.closest_points(pos12, one, two, most)
    }

    fn cast_shapes(
        &self,
        pos12: &Pose,
        velocity: Vector,
        one: &dyn Shape,
        two: &dyn Shape,
        options: ShapeCastOptions,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        if is::<Surface>(one, two) {
            return Ok(None);
        }
        DefaultQueryDispatcher.cast_shapes(pos12, velocity, one, two, options)
    }

    fn cast_shapes_nonlinear(
        &self,
        motion1: &NonlinearRigidMotion,
        one: &dyn Shape,
        motion2: &NonlinearRigidMotion,
        two: &dyn Shape,
        start: f32,
        end: f32,
        stop_at_penetration: bool,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        if is::<Surface>(one, two) {
            return Ok(None);
        }
        DefaultQueryDispatcher.cast_shapes_nonlinear(
            motion1,
            one,
            motion2,
            two,
            start,
            end,
            stop_at_penetration,
        )
    }
}

impl PersistentQueryDispatcher<ContactManifoldData, ContactData> for GroundDispatcher {
    fn contact_manifolds(
        &self,
        pos12: &Pose,
        one: &dyn Shape,
        two: &dyn Shape,
        prediction: f32,
        manifolds: &mut Vec<ContactManifold>,
        workspace: &mut Option<ContactManifoldsWorkspace>,
    ) -> Result<(), Unsupported> {
        if let Some(ground) = one.as_shape::<Surface>() {
            return ground_contacts(ground, two, pos12, false, prediction, manifolds, workspace);
        }
        if let Some(ground) = two.as_shape::<Surface>() {
            let pos21 = pos12.inverse();
            return ground_contacts(ground, one, &pos21, true, prediction, manifolds, workspace);
        }
        if is::<TileShape>(one, two) {
            manifolds.clear();
            return Ok(());
        }
        DefaultQueryDispatcher.contact_manifolds(pos12, one, two, prediction, manifolds, workspace)
    }

    fn contact_manifold_convex_convex(
        &self,
        pos12: &Pose,
        one: &dyn Shape,
        two: &dyn Shape,
        normals1: Option<&dyn NormalConstraints>,
        normals2: Option<&dyn NormalConstraints>,
        prediction: f32,
        manifold: &mut ContactManifold,
    ) -> Result<(), Unsupported> {
        DefaultQueryDispatcher.contact_manifold_convex_convex(
            pos12, one, two, normals1, normals2, prediction, manifold,
        )
    }
}
