//! Movers push bodies, and bodies do not pass through movers.

use crate::plugin::{CharacterBody, MoveState};
use bevy::ecs::prelude::*;
use bevy::math::Vec3;
use bevy::reflect::prelude::*;
use bevy::time::Time;
use bevy::transform::components::Transform;
use bevy_rapier3d::prelude::{
    Collider, DefaultRapierContext, RapierContextSimulation, RapierRigidBodyHandle,
    RapierRigidBodySet, RigidBody,
};

/// On a mover: it pushes bodies of Rapier's that it walks into (those that have
/// [`MeetsMovers`](super::MeetsMovers)), and an upright capsule as wide and as high as the mover stands in its place
/// for Rapier.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct Pusher {
    /// How hard it pushes at most, newtons. What is not above 0 pushes nothing.
    pub force: f32,
}

impl Default for Pusher {
    /// As hard as a grown person leans: some 400 N.
    fn default() -> Self {
        Self { force: 400.0 }
    }
}

/// The body that stands in a mover's place.
#[derive(Component, Clone, Copy, Debug)]
pub(super) struct StandIn(Entity);

/// A capsule of these radii along the axes: its caps are as wide as the mover, or as high.
fn capsule(radii: Vec3) -> Option<Collider> {
    let radius = radii.x.min(radii.z);
    let whole = radii.is_finite() && radii.min_element() > 0.0;
    whole.then(|| match radii.y - radius {
        above if above > 0.0 => Collider::capsule_y(above, radius),
        _ => Collider::cylinder(radii.y, radius),
    })
}

/// Stand-ins of movers that are new, where movers are, and none of movers that are gone.
pub(super) fn stand_in(
    movers: Query<(Entity, Ref<CharacterBody>, &Transform), With<Pusher>>,
    mut stand_ins: Query<(Entity, &StandIn, &mut Transform), Without<CharacterBody>>,
    mut commands: Commands,
) {
    let mut known = Vec::new();
    for (entity, stand_in, mut place) in &mut stand_ins {
        let Ok((mover, body, at)) = movers.get(stand_in.0) else {
            commands.entity(entity).despawn();
            continue;
        };
        known.push(mover);
        if place.translation != at.translation && at.translation.is_finite() {
            place.translation = at.translation;
        }
        if body.is_changed()
            && let Some(shape) = capsule(body.radii)
        {
            commands.entity(entity).insert(shape);
        }
    }
    known.sort_unstable();
    for (mover, body, at) in &movers {
        if known.binary_search(&mover).is_err()
            && at.translation.is_finite()
            && let Some(shape) = capsule(body.radii)
        {
            commands.spawn((
                StandIn(mover),
                RigidBody::KinematicPositionBased,
                shape,
                Transform::from_translation(at.translation),
            ));
        }
    }
}

/// An impulse for each contact of a mover with a body, towards the speed at which the mover wished to go there.
pub(super) fn push(
    movers: Query<(&Pusher, &MoveState), With<CharacterBody>>,
    handles: Query<&RapierRigidBodyHandle>,
    mut worlds: Query<
        (&mut RapierContextSimulation, &mut RapierRigidBodySet),
        With<DefaultRapierContext>,
    >,
    time: Res<Time>,
) {
    let Ok((mut simulation, mut set)) = worlds.single_mut() else {
        return;
    };
    let step = time.delta_secs();
    if step <= 0.0 {
        return;
    }
    for (pusher, state) in &movers {
        // The smaller of no number and of an impulse would be the impulse.
        if pusher.force.is_nan() || pusher.force <= 0.0 {
            continue;
        }
        for (entity, contact) in state.contacts() {
            let Ok(handle) = handles.get(entity) else {
                continue;
            };
            // Level: a mover that stands on a body does not kick it down.
            let normal = contact.normal.as_vec3();
            let Some(along) = (-normal).with_y(0.0).try_normalize() else {
                continue;
            };
            let wished = state.wished.dot(along) / step;
            let Some(body) = set.bodies.get(handle.0).filter(|body| body.is_dynamic()) else {
                continue;
            };
            let point = contact.point.as_vec3();
            let lacking = wished - body.velocity_at_point(point).dot(along);
            let most = pusher.force * step;
            let impulse = (lacking * body.mass()).min(most);
            if !(impulse > 0.0 && impulse.is_finite()) {
                continue;
            }
            simulation.islands.wake_up(&mut set.bodies, handle.0, true);
            if let Some(body) = set.bodies.get_mut(handle.0) {
                body.apply_impulse_at_point(along * impulse, point, true);
            }
        }
    }
}
