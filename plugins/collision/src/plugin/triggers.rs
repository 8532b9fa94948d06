//! Boxes that report who comes, stays and goes.

use super::movers::{CharacterBody, MoveState};
use crate::mesh::TriangleMesh;
use crate::sweep::UnitSpace;
use crate::tree::{TreeKind, TreeSettings, TriangleTree};
use crate::volume::{Aabb, Ellipsoid, Volume};
use bevy::ecs::prelude::*;
use bevy::math::{DVec3, Vec3};
use bevy::platform::collections::HashSet;
use bevy::reflect::prelude::*;
use bevy::transform::components::Transform;

/// An upright box around an entity. A half size above 10¹² m, not finite, or 0 or less along an axis, reports nothing.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq)]
#[require(Transform)]
pub struct Trigger {
    /// Half of its size, metres.
    pub half_size: Vec3,
}

impl Default for Trigger {
    /// A cube of 1 m.
    fn default() -> Self {
        Self {
            half_size: Vec3::splat(0.5),
        }
    }
}

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TriggerKind {
    /// A mover touched it first.
    Enter,
    /// A mover was in it all of the step.
    Stay,
    /// A mover left it.
    Leave,
}

/// Something happened at a trigger. Messages of a step come in the order of their times, and else of entities. A mover
/// that passes through within one step enters and leaves.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
pub struct TriggerMessage {
    /// At which trigger.
    pub trigger: Entity,
    /// Who.
    pub mover: Entity,
    /// What.
    pub kind: TriggerKind,
    /// When, as a part of the step.
    pub time: f64,
    /// Where the mover's centre was.
    pub place: DVec3,
}

/// Who is in what.
#[derive(Resource, Default)]
pub(super) struct Inside(HashSet<(Entity, Entity)>);

/// Whether somebody is in a trigger, who leaves it with the last of them.
pub(super) fn occupied(inside: Res<Inside>) -> bool {
    !inside.0.is_empty()
}

/// The straight way of a mover's step against each trigger where it is now.
pub(super) fn report(
    triggers: Query<(Entity, &Trigger, &Transform)>,
    movers: Query<(Entity, &CharacterBody, &MoveState)>,
    mut inside: ResMut<Inside>,
    mut messages: MessageWriter<TriggerMessage>,
) {
    let mut found = Vec::new();
    let mut now = HashSet::default();
    for (trigger, size, transform) in &triggers {
        let half = size.half_size;
        if !half.is_finite() || half.min_element() <= 0.0 {
            continue;
        }
        let center = transform.translation.as_dvec3();
        let bounds = Aabb::around(center, half.as_dvec3());
        // Made for the first mover that comes near.
        let mut tree = None;
        for (mover, body, state) in &movers {
            let radii = body.radii.as_dvec3();
            let at = |place| Ellipsoid::upright(place, radii);
            let was = inside.0.contains(&(trigger, mover));
            let is = Volume::Ellipsoid(at(state.center)).overlaps(&Volume::Aabb(bounds));
            let mut add = |kind, time: f64| {
                found.push(TriggerMessage {
                    trigger,
                    mover,
                    kind,
                    time,
                    place: state.before.lerp(state.center, time),
                });
            };
            if was && is {
                add(TriggerKind::Stay, 0.0);
            } else if was || is || near(&bounds, state, radii) {
                let Some(tree) = tree.get_or_insert_with(|| around(center, half)) else {
                    continue;
                };
                let way = state.center - state.before;
                let touch = |from: DVec3, way: DVec3| {
                    let space = UnitSpace::new(&at(from)).ok()?;
                    tree.sweep_space(&space, way).map(|(touch, _)| touch.time)
                };
                // Who begins within enters at once, and not where its way touches a wall from inside.
                let began = Volume::Ellipsoid(at(state.before)).overlaps(&Volume::Aabb(bounds));
                let enter = if began {
                    Some(0.0)
                } else {
                    touch(state.before, way)
                };
                if !was && (is || enter.is_some()) {
                    add(TriggerKind::Enter, enter.unwrap_or(0.0));
                }
                if !is && (was || enter.is_some()) {
                    let leave = touch(state.center, -way).map_or(1.0, |time| 1.0 - time);
                    add(TriggerKind::Leave, leave.max(enter.unwrap_or(0.0)));
                }
            }
            if is {
                now.insert((trigger, mover));
            }
        }
    }
    // Who or what is gone has left.
    for &(trigger, mover) in &inside.0 {
        if !triggers.contains(trigger) || !movers.contains(mover) {
            found.push(TriggerMessage {
                trigger,
                mover,
                kind: TriggerKind::Leave,
                time: 0.0,
                place: movers
                    .get(mover)
                    .map_or(DVec3::ZERO, |mover| mover.2.before),
            });
        }
    }
    inside.0 = now;
    found.sort_by(|a, b| {
        let order = a.time.total_cmp(&b.time);
        order.then((a.trigger, a.mover).cmp(&(b.trigger, b.mover)))
    });
    messages.write_batch(found);
}

fn near(bounds: &Aabb, state: &MoveState, radii: DVec3) -> bool {
    let way = Aabb::around(state.before, radii).union(&Aabb::around(state.center, radii));
    Volume::Aabb(way).overlaps(&Volume::Aabb(*bounds))
}

fn around(center: DVec3, half: Vec3) -> Option<TriangleTree> {
    let settings = TreeSettings {
        kind: TreeKind::List,
        ..TreeSettings::default()
    };
    TriangleMesh::cuboid(center, half)
        .ok()
        .map(|mesh| TriangleTree::new(mesh, settings))
}
