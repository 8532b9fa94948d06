//! Movers of entities.

use super::bodies::Bodies;
use crate::motion::{
    Body, MoveContact, MoveError, MoveOutcome, MoveSettings, Mover, World, advance_all,
};
use bevy::ecs::prelude::*;
use bevy::math::{DVec3, Vec3};
use bevy::reflect::prelude::*;
use bevy::transform::components::Transform;

/// An upright ellipsoid that moves by its [`MoveWish`]. Its entity's translation is its centre.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq)]
#[require(Transform, MoveWish, MoveState)]
pub struct CharacterBody {
    /// Along the coordinate axes, metres, above 0.
    pub radii: Vec3,
    /// See [`MoveSettings`].
    #[reflect(ignore)]
    pub settings: MoveSettings,
}

impl Default for CharacterBody {
    /// A figure of 1.8 m.
    fn default() -> Self {
        Self {
            radii: Vec3::new(0.3, 0.9, 0.3),
            settings: MoveSettings::default(),
        }
    }
}

/// Where a mover wants to go in the next step, metres; 0 after it. Falling is part of it.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, PartialEq)]
pub struct MoveWish(pub Vec3);

/// What became of a mover.
#[derive(Component, Clone, Debug, Default)]
pub struct MoveState {
    /// Its centre: the transform is this, rounded. A transform that somebody else moved counts instead.
    pub center: DVec3,
    /// Where it was before the last step.
    pub before: DVec3,
    /// The wish of the last step.
    pub wished: Vec3,
    /// The entity that it stands on.
    pub stands_on: Option<Entity>,
    /// Whether it stands, what it touched, and what it cost. Numbers of bodies are those of `bodies`.
    pub outcome: MoveOutcome,
    /// The entities of the contacts, in the same order.
    pub touched: Vec<Entity>,
    /// What was written into the transform.
    written: Option<Vec3>,
}

impl MoveState {
    /// Whether it stands.
    #[must_use]
    pub const fn grounded(&self) -> bool {
        self.outcome.grounded
    }

    /// What it touched, each with the entity.
    pub fn contacts(&self) -> impl Iterator<Item = (Entity, &MoveContact)> {
        self.touched.iter().copied().zip(&self.outcome.contacts)
    }

    /// Where its centre is, of an entity whose transform is this.
    pub(crate) fn place(&self, transform: &Transform) -> DVec3 {
        if self.is_placed(transform) {
            self.center
        } else {
            transform.translation.as_dvec3()
        }
    }

    /// Whether the transform is what was written last.
    pub(crate) fn is_placed(&self, transform: &Transform) -> bool {
        self.written == Some(transform.translation)
    }

    /// It is here from now on, and drawn there.
    pub(crate) const fn put(&mut self, center: DVec3, drawn: Vec3) {
        self.center = center;
        self.written = Some(drawn);
    }

    /// Why it did not move.
    #[must_use]
    pub const fn error(&self) -> Option<MoveError> {
        self.outcome.error
    }
}

/// Lists that steps use again.
#[derive(Default)]
pub(crate) struct Lists {
    entities: Vec<(Entity, MoveSettings)>,
    movers: Vec<Mover>,
    wishes: Vec<DVec3>,
    outcomes: Vec<MoveOutcome>,
}

/// One step of all movers.
pub(crate) fn go(
    bodies: Res<Bodies>,
    mut query: Query<(
        Entity,
        &CharacterBody,
        &mut MoveWish,
        &mut MoveState,
        &mut Transform,
    )>,
    mut lists: Local<Lists>,
) {
    let lists = &mut *lists;
    lists.entities.clear();
    lists.movers.clear();
    lists.wishes.clear();
    lists.outcomes.clear();
    for (entity, body, wish, mut state, transform) in &mut query {
        state.center = state.place(&transform);
        state.before = state.center;
        state.wished = wish.0;
        lists.entities.push((entity, body.settings));
        lists.movers.push(Mover {
            center: state.center,
            radii: body.radii.as_dvec3(),
            stands_on: state.stands_on.and_then(|entity| bodies.find(entity)),
        });
        lists.wishes.push(wish.0.as_dvec3());
        lists.outcomes.push(std::mem::take(&mut state.outcome));
    }
    let placed: Vec<Body> = bodies
        .placed
        .iter()
        .map(|body| Body {
            tree: &body.tree,
            before: body.before,
            after: body.after,
        })
        .collect();
    let world = World::new(&placed);
    // Runs of the same settings go together: mostly there is one.
    let mut start = 0;
    while start < lists.entities.len() {
        let settings = lists.entities[start].1;
        let same = lists.entities[start..]
            .iter()
            .take_while(|(_, other)| *other == settings);
        let end = start + same.count().max(1);
        advance_all(
            &world,
            &mut lists.movers[start..end],
            &lists.wishes[start..end],
            &settings,
            &mut lists.outcomes[start..end],
        );
        start = end;
    }
    for (index, (entity, _)) in lists.entities.iter().enumerate() {
        let Ok((_, _, mut wish, mut state, mut transform)) = query.get_mut(*entity) else {
            continue;
        };
        let mover = lists.movers[index];
        state.outcome = std::mem::take(&mut lists.outcomes[index]);
        let of = |body: u32| bodies.placed[body as usize].entity;
        let MoveState {
            touched, outcome, ..
        } = &mut *state;
        touched.clear();
        touched.extend(outcome.contacts.iter().map(|contact| of(contact.body)));
        state.stands_on = mover.stands_on.map(of);
        if state.outcome.error.is_none() {
            let rounded = mover.center.as_vec3();
            if transform.translation != rounded {
                transform.translation = rounded;
            }
            state.put(mover.center, rounded);
        }
        if wish.0 != Vec3::ZERO {
            wish.0 = Vec3::ZERO;
        }
    }
}
