//! Beside `dolomite_collision`: its triggers say who enters, its triangles stop rays, and its movers move after logic.

use crate::action::Output;
use crate::names::Key;
use crate::rays::{Rays, Stop};
use crate::sets::LogicSystems;
use crate::value::Value;
use crate::values::Logic;
use bevy::app::{App, FixedUpdate};
use bevy::ecs::message::Messages;
use bevy::ecs::prelude::*;
use bevy::math::{DVec3, Vec3};
use dolomite_collision::volume::Ray;
use dolomite_collision::{CollisionSystems, TriangleTree, Trigger, TriggerKind, TriggerMessage};
use std::sync::Arc;

/// Triangles that hide and stop shots.
#[derive(Clone, Debug)]
pub struct TriangleRays(pub Arc<TriangleTree>);

impl Rays for TriangleRays {
    fn cast(&self, from: Vec3, to: Vec3) -> Option<Stop> {
        let hit = self
            .0
            .first_hit(&Ray::between(from.as_dvec3(), to.as_dvec3()))?;
        Some(Stop {
            time: hit.time as f32,
            blocker: u64::from(hit.triangle),
        })
    }

    /// The plane of the triangle parts both ends, and three volumes have the same sign (signed volumes of
    /// tetrahedra), in f64. A way through an edge is not known: the tree has to be asked.
    fn still_blocks(&self, blocker: u64, from: Vec3, to: Vec3) -> bool {
        let count = self.0.mesh().triangles().len() as u64;
        if blocker >= count {
            return false;
        }
        let (from, to) = (from.as_dvec3(), to.as_dvec3());
        let corners = self.0.mesh().corners(blocker as u32);
        let [a, b, c] = corners.map(|corner| corner - from);
        let way = to - from;
        let volume = |p: DVec3, q: DVec3| way.dot(p.cross(q));
        let (u, v, w) = (volume(a, b), volume(b, c), volume(c, a));
        let inside = (u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0);
        let normal = (b - a).cross(c - a);
        let (start, end) = (-normal.dot(a), normal.dot(way - a));
        inside && ((start < 0.0 && end > 0.0) || (start > 0.0 && end < 0.0))
    }
}

/// What triggers report becomes outputs of their entities: [`Key::ENTERED`] and [`Key::LEFT`], with the mover.
fn report(mut messages: MessageReader<TriggerMessage>, mut outputs: MessageWriter<Output>) {
    for message in messages.read() {
        let name = match message.kind {
            TriggerKind::Enter => Key::ENTERED,
            TriggerKind::Leave => Key::LEFT,
            TriggerKind::Stay => continue,
        };
        outputs.write(Output {
            source: message.trigger,
            name,
            parameter: Value::Entity(message.mover),
        });
    }
}

/// Whether the app has collision at all: a run condition.
fn has_triggers(messages: Option<Res<Messages<TriggerMessage>>>) -> bool {
    messages.is_some()
}

pub(crate) fn build(app: &mut App) {
    app.configure_sets(
        FixedUpdate,
        (
            LogicSystems::Move.before(CollisionSystems::Gather),
            LogicSystems::Touch.after(CollisionSystems::Trigger),
        ),
    )
    .add_systems(
        FixedUpdate,
        report
            .run_if(
                has_triggers
                    .and_then(any_with_component::<Trigger>)
                    .and_then(any_with_component::<Logic>),
            )
            .in_set(LogicSystems::Touch),
    );
}
