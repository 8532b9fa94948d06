//! Boxes that say who comes and goes, however fast.
//!
//! A visitor and a zone move in straight lines within a step, so one seen from the other does too. A line meets a
//! box, which is convex, in one piece, and the ends of that piece are when it enters and leaves (slab method, in
//! f64). Whether somebody is inside is asked of the places at the ends of steps alone, which are the same bits for
//! the step that ends and the one that begins, so that nobody enters or leaves twice.

use crate::action::Output;
use crate::names::Key;
use crate::value::Value;
use crate::values::Logic;
use bevy::ecs::prelude::*;
use bevy::math::{DVec3, Vec3};
use bevy::transform::components::Transform;

/// An upright box around its entity. Outputs: [`Key::ENTERED`] and [`Key::LEFT`] with the visitor; [`ZoneMessage`] says
/// more. A size that is not finite, or below 0 along an axis, holds nobody. Who is where a zone is new or grows has
/// entered, who is where it shrinks or is taken away has left. In a place that is not finite it is where it was.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[require(Logic, Transform)]
pub struct Zone {
    /// Half of its size, metres.
    pub half_size: Vec3,
    /// Where it was a step ago, and its half size; none of one that is new.
    before: Option<(Vec3, Vec3)>,
}

impl Zone {
    /// Of this half size.
    #[must_use]
    pub const fn new(half_size: Vec3) -> Self {
        Self {
            half_size,
            before: None,
        }
    }
}

/// A point that zones see, its entity's place.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[require(Logic, Transform)]
pub struct Visitor {
    /// Where it was a step ago; none of one that is new, which enters where it is.
    before: Option<Vec3>,
}

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ZoneKind {
    /// A visitor came in.
    Enter,
    /// A visitor went out.
    Leave,
}

/// Somebody came or went. Those of a step come in the order of their times, and else of entities.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
pub struct ZoneMessage {
    /// Where.
    pub zone: Entity,
    /// Who.
    pub visitor: Entity,
    /// What.
    pub kind: ZoneKind,
    /// When, as a part of the step.
    pub time: f64,
    /// Where the visitor was then.
    pub place: DVec3,
}

/// When a way from `from` on lies in the box of half size `half` around 0, as parts of it, from 0 to 1; nothing if it
/// never does.
#[must_use]
pub fn inside_times(from: DVec3, way: DVec3, half: DVec3) -> Option<(f64, f64)> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..3 {
        let (from, way, half) = (from[axis], way[axis], half[axis]);
        if way == 0.0 {
            if from.abs() > half || from.is_nan() || half.is_nan() {
                return None;
            }
            continue;
        }
        let (a, b) = ((-half - from) / way, (half - from) / way);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    (enter <= leave).then_some((enter, leave))
}

/// What a visitor did at a zone, from where it was and is, seen from the zone's centre: up to two events with times.
/// `new` is one that was nowhere before.
#[must_use]
pub fn crossing(before: DVec3, now: DVec3, half: DVec3, new: bool) -> [Option<(ZoneKind, f64)>; 2] {
    let holds = |place: DVec3| place.abs().cmple(half).all();
    let (was, is) = (!new && holds(before), holds(now));
    let times = || inside_times(before, now - before, half);
    match (was, is) {
        (false, false) if !new => match times() {
            // Both ends are outside: it passed through, or touched a corner.
            Some((enter, leave)) => [
                Some((ZoneKind::Enter, enter)),
                Some((ZoneKind::Leave, leave)),
            ],
            None => [None, None],
        },
        (false, true) => {
            let time = if new {
                1.0
            } else {
                times().map_or(1.0, |(enter, _)| enter)
            };
            [Some((ZoneKind::Enter, time)), None]
        }
        (true, false) => {
            let time = times().map_or(0.0, |(_, leave)| leave);
            [Some((ZoneKind::Leave, time)), None]
        }
        _ => [None, None],
    }
}

/// Who is where, so that who or what is gone has left.
#[derive(Resource, Debug, Default)]
pub(crate) struct Inside(Vec<(Entity, Entity)>);

/// Whether somebody is in a zone: who is gone has still to leave.
pub(super) fn any_inside(inside: Res<Inside>) -> bool {
    !inside.0.is_empty()
}

/// A zone of this step.
struct Seen {
    low: f64,
    high: f64,
    zone: Entity,
    before: DVec3,
    now: DVec3,
    half: DVec3,
    /// It held others a step ago: the way of a visitor does not say alone who came and went.
    changed: bool,
}

/// The half size of what holds nobody.
const NOBODY: Vec3 = Vec3::NEG_ONE;

pub(super) fn run(
    mut zones: Query<(Entity, &mut Zone, &Transform)>,
    mut visitors: Query<(Entity, &mut Visitor, &Transform)>,
    mut inside: ResMut<Inside>,
    mut messages: MessageWriter<ZoneMessage>,
    mut outputs: MessageWriter<Output>,
) {
    let mut seen = Vec::new();
    for (entity, mut zone, transform) in &mut zones {
        let whole = zone.half_size.is_finite() && zone.half_size.min_element() >= 0.0;
        let half = if whole { zone.half_size } else { NOBODY };
        let known = zone.before;
        let now = match known {
            _ if transform.translation.is_finite() => transform.translation,
            Some((place, _)) => place,
            None => continue,
        };
        let (before, was) = known.unwrap_or((now, NOBODY));
        if known != Some((now, half)) {
            zone.before = Some((now, half));
        }
        if half == NOBODY && was == NOBODY {
            continue;
        }
        let wide = f64::from(half.x.max(was.x));
        seen.push(Seen {
            low: f64::from(before.x.min(now.x)) - wide,
            high: f64::from(before.x.max(now.x)) + wide,
            zone: entity,
            before: before.as_dvec3(),
            now: now.as_dvec3(),
            half: half.as_dvec3(),
            changed: half != was,
        });
    }
    seen.sort_by(|a, b| a.low.total_cmp(&b.low).then(a.zone.cmp(&b.zone)));
    let widest = seen
        .iter()
        .fold(0.0_f64, |w, zone| w.max(zone.high - zone.low));
    let mut found = Vec::new();
    for (entity, mut visitor, transform) in &mut visitors {
        let now = transform.translation;
        if !now.is_finite() {
            continue;
        }
        let new = visitor.before.is_none();
        let before = visitor.before.unwrap_or(now);
        if visitor.before != Some(now) {
            visitor.before = Some(now);
        }
        let (before, now) = (before.as_dvec3(), now.as_dvec3());
        let (low, high) = (before.x.min(now.x), before.x.max(now.x));
        let last = seen.partition_point(|zone| zone.low <= high);
        for zone in seen[..last].iter().rev() {
            if zone.low < low - widest {
                break;
            }
            if zone.high < low {
                continue;
            }
            let (from, to) = (before - zone.before, now - zone.now);
            let events = if zone.changed {
                let was = inside.0.binary_search(&(zone.zone, entity)).is_ok();
                match (was, to.abs().cmple(zone.half).all()) {
                    (false, true) => [Some((ZoneKind::Enter, 1.0)), None],
                    (true, false) => [Some((ZoneKind::Leave, 1.0)), None],
                    _ => [None, None],
                }
            } else {
                crossing(from, to, zone.half, new)
            };
            for (kind, time) in events.into_iter().flatten() {
                found.push(ZoneMessage {
                    zone: zone.zone,
                    visitor: entity,
                    kind,
                    time,
                    place: before.lerp(now, time),
                });
            }
        }
    }
    // Who or what is gone has left.
    inside.0.retain(|&(zone, visitor)| {
        let there = zones.contains(zone) && visitors.contains(visitor);
        if !there {
            found.push(ZoneMessage {
                zone,
                visitor,
                kind: ZoneKind::Leave,
                time: 0.0,
                place: DVec3::ZERO,
            });
        }
        there
    });
    found.sort_by(|a, b| {
        let order = a.time.total_cmp(&b.time);
        order.then((a.zone, a.visitor, a.kind).cmp(&(b.zone, b.visitor, b.kind)))
    });
    for message in &found {
        let pair = (message.zone, message.visitor);
        let name = match (message.kind, inside.0.binary_search(&pair)) {
            (ZoneKind::Enter, Err(at)) => {
                inside.0.insert(at, pair);
                Key::ENTERED
            }
            (ZoneKind::Leave, Ok(at)) => {
                inside.0.remove(at);
                Key::LEFT
            }
            (ZoneKind::Enter, Ok(_)) => Key::ENTERED,
            (ZoneKind::Leave, Err(_)) => Key::LEFT,
        };
        outputs.write(Output {
            source: message.zone,
            name,
            parameter: Value::Entity(message.visitor),
        });
    }
    messages.write_batch(found);
}
