//! The one collider of each ground that bodies are in contact with.
//!
//! It is no entity's: contacts name the ground. Rapier's events panic where a collider is gone that they speak of, so
//! that one whose ground is gone is disabled, and used again for the next.

use super::surface::Surface;
use crate::ground::GroundTiles;
use bevy::ecs::prelude::*;
use bevy::platform::collections::HashMap;
use bevy_rapier3d::parry::shape::SharedShape;
use bevy_rapier3d::prelude::{
    CollisionGroups, DefaultRapierContext, Friction, RapierContextColliders,
    RapierContextSimulation, RapierRigidBodySet, Restitution, SolverGroups,
};
use bevy_rapier3d::rapier::geometry::NarrowPhase;
use bevy_rapier3d::rapier::prelude::{
    Collider, ColliderBuilder, ColliderHandle, ColliderSet, InteractionGroups,
};

/// What is asked of a ground's entity for [`Material`].
pub(super) type Components = (
    Option<&'static Friction>,
    Option<&'static Restitution>,
    Option<&'static CollisionGroups>,
    Option<&'static SolverGroups>,
);

/// What a ground is made of, and which bodies meet it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Material {
    pub friction: Option<Friction>,
    pub restitution: Option<Restitution>,
    pub groups: Option<CollisionGroups>,
    pub solver_groups: Option<SolverGroups>,
}

impl Material {
    /// Of what a query found.
    pub fn of(
        (friction, restitution, groups, solver_groups): (
            Option<&Friction>,
            Option<&Restitution>,
            Option<&CollisionGroups>,
            Option<&SolverGroups>,
        ),
    ) -> Self {
        Self {
            friction: friction.copied(),
            restitution: restitution.copied(),
            groups: groups.copied(),
            solver_groups: solver_groups.copied(),
        }
    }
}

/// One of a ground.
struct Known {
    surface: Surface,
    collider: ColliderHandle,
    material: Material,
}

/// The surfaces of all grounds.
#[derive(Resource, Default)]
pub(super) struct Surfaces {
    of: HashMap<Entity, Known>,
    /// Disabled colliders.
    spare: Vec<ColliderHandle>,
}

impl Surfaces {
    /// That of a ground.
    pub fn get(&self, ground: Entity) -> Option<&Surface> {
        self.of.get(&ground).map(|known| &known.surface)
    }
}

/// Whether there is one.
pub(super) fn any(surfaces: Res<Surfaces>) -> bool {
    !surfaces.of.is_empty()
}

/// Lets a world of Rapier's know what ground is, before anything is in it.
pub(super) fn teach(
    mut worlds: Query<
        (
            &mut RapierContextSimulation,
            &RapierContextColliders,
            &RapierRigidBodySet,
        ),
        Added<RapierContextSimulation>,
    >,
) {
    for (mut world, colliders, set) in &mut worlds {
        if colliders.colliders.is_empty() && set.bodies.is_empty() {
            world.narrow_phase =
                NarrowPhase::with_query_dispatcher(super::dispatch::GroundDispatcher);
        }
    }
}

/// A collider for each ground, and none for those that are gone: bodies on them wake.
pub(super) fn keep(
    mut surfaces: ResMut<Surfaces>,
    grounds: Query<(Entity, &GroundTiles, Components)>,
    mut worlds: Query<
        (
            &mut RapierContextSimulation,
            &mut RapierContextColliders,
            &mut RapierRigidBodySet,
        ),
        With<DefaultRapierContext>,
    >,
) {
    let Ok((mut simulation, mut colliders, mut set)) = worlds.single_mut() else {
        return;
    };
    let colliders = &mut colliders.colliders;
    let Surfaces { of, spare } = &mut *surfaces;
    of.retain(|ground, known| {
        // It is not there where the world was replaced.
        if grounds.contains(*ground) {
            return colliders.contains(known.collider);
        }
        let on_it = simulation
            .narrow_phase
            .contact_pairs_with(known.collider)
            .flat_map(|pair| [pair.collider1, pair.collider2]);
        let bodies: Vec<_> = on_it
            .filter_map(|collider| colliders.get(collider)?.parent())
            .collect();
        for body in bodies {
            simulation.islands.wake_up(&mut set.bodies, body, true);
        }
        if let Some(collider) = colliders.get_mut(known.collider) {
            collider.set_enabled(false);
            spare.push(known.collider);
        }
        false
    });
    // In an order that does not depend on where entities are stored: Rapier's results depend on it.
    let mut all: Vec<_> = grounds.iter().collect();
    all.sort_unstable_by_key(|(entity, ..)| *entity);
    for (entity, ground, components) in all {
        let known = of
            .entry(entity)
            .or_insert_with(|| made(entity, ground, spare, colliders));
        let material = Material::of(components);
        if material != known.material
            && let Some(collider) = colliders.get_mut(known.collider)
        {
            set_material(collider, material);
            known.material = material;
        }
    }
}

/// The surface of a ground, and its collider.
fn made(
    entity: Entity,
    ground: &GroundTiles,
    spare: &mut Vec<ColliderHandle>,
    colliders: &mut ColliderSet,
) -> Known {
    let surface = Surface::new(ground.clone());
    let mut new = ColliderBuilder::new(SharedShape::new(surface.clone())).build();
    new.user_data = u128::from(entity.to_bits());
    let known = |collider| Known {
        surface,
        collider,
        material: Material::default(),
    };
    while let Some(handle) = spare.pop() {
        if let Some(old) = colliders.get_mut(handle) {
            old.set_shape(new.shared_shape().clone());
            old.set_enabled(true);
            old.user_data = new.user_data;
            set_material(old, Material::default());
            return known(handle);
        }
    }
    known(colliders.insert(new))
}

/// Gives a collider what a ground is made of. Without a component it is as Rapier has it by default.
fn set_material(collider: &mut Collider, material: Material) {
    let friction = material.friction.unwrap_or_default();
    collider.set_friction(friction.coefficient);
    collider.set_friction_combine_rule(friction.combine_rule.into());
    let restitution = material.restitution.unwrap_or_default();
    collider.set_restitution(restitution.coefficient);
    collider.set_restitution_combine_rule(restitution.combine_rule.into());
    let all = InteractionGroups::all();
    collider.set_collision_groups(material.groups.map_or(all, Into::into));
    collider.set_solver_groups(material.solver_groups.map_or(all, Into::into));
}
