//! What bodies cover.

use bevy::ecs::prelude::*;
use bevy::ecs::system::SystemParam;
use bevy::math::{DVec2, Vec3};
use bevy::time::Time;
use bevy::transform::components::Transform;
use bevy_rapier3d::prelude::{
    Collider, RapierContextColliders, RapierRigidBodyHandle, RapierRigidBodySet, RigidBody,
    RigidBodyDisabled, Velocity,
};
use bevy_rapier3d::rapier::prelude::{Aabb, Pose, RigidBodyHandle};

/// Bodies that fall: dynamic ones.
#[derive(SystemParam)]
pub(super) struct Bodies<'w, 's> {
    bodies: Query<
        'w,
        's,
        (
            Entity,
            &'static RigidBody,
            Option<&'static RapierRigidBodyHandle>,
            Option<&'static Collider>,
            Option<&'static Velocity>,
            &'static Transform,
        ),
        Without<RigidBodyDisabled>,
    >,
    time: Res<'w, Time>,
}

/// What a body covers, seen from above.
pub(super) struct BodyBox {
    pub entity: Entity,
    pub handle: Option<RigidBodyHandle>,
    pub awake: bool,
    /// Where it is.
    pub at_min: DVec2,
    pub at_max: DVec2,
    /// Where it is and where it may be at the end of this step and of the next.
    pub min: DVec2,
    pub max: DVec2,
    /// The lowest of it, metres.
    pub bottom: f32,
}

impl Bodies<'_, '_> {
    /// All dynamic bodies whose places are finite, in the order of entities.
    pub fn boxes(
        &self,
        set: &RapierRigidBodySet,
        colliders: &RapierContextColliders,
    ) -> Vec<BodyBox> {
        let ahead = 2.0 * self.time.delta_secs_f64();
        let mut boxes: Vec<BodyBox> = self
            .bodies
            .iter()
            .filter(|(_, kind, ..)| **kind == RigidBody::Dynamic)
            .filter_map(|(entity, _, handle, collider, velocity, place)| {
                // Where the app has put it counts, not where Rapier had it.
                let pose = Pose::from_parts(place.translation, place.rotation);
                let known = handle.and_then(|handle| set.bodies.get(handle.0));
                let mut around = collider.map(|collider| collider.raw.compute_aabb(&pose));
                let mut velocity = velocity.map_or(Vec3::ZERO, |velocity| velocity.linear);
                if let Some(body) = known {
                    velocity = body.linvel();
                    let parts = body.colliders().iter();
                    for part in parts.filter_map(|part| colliders.colliders.get(*part)) {
                        around = Some(merged(around, part.compute_aabb()));
                    }
                }
                let around =
                    around.unwrap_or_else(|| Aabb::new(place.translation, place.translation));
                let whole =
                    around.mins.is_finite() && around.maxs.is_finite() && velocity.is_finite();
                let flat = |v: Vec3| DVec2::new(f64::from(v.x), f64::from(v.z));
                let (at_min, at_max) = (flat(around.mins), flat(around.maxs));
                let way = flat(velocity) * ahead;
                whole.then(|| BodyBox {
                    entity,
                    handle: handle.map(|handle| handle.0),
                    awake: known.is_none_or(|body| !body.is_sleeping()),
                    at_min,
                    at_max,
                    min: at_min + way.min(DVec2::ZERO),
                    max: at_max + way.max(DVec2::ZERO),
                    bottom: around.mins.y,
                })
            })
            .collect();
        boxes.sort_unstable_by_key(|body| body.entity);
        boxes
    }
}

fn merged(known: Option<Aabb>, other: Aabb) -> Aabb {
    known.map_or(other, |known| {
        Aabb::new(known.mins.min(other.mins), known.maxs.max(other.maxs))
    })
}
