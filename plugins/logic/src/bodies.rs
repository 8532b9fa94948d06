//! Upright capsules of entities: what shots hit and what hides others.

use crate::grid::Grid;
use crate::values::Logic;
use bevy::ecs::prelude::*;
use bevy::math::{DVec2, DVec3, Vec2, Vec3, Vec3Swizzles};
use bevy::transform::components::Transform;

/// An upright capsule around its entity's place, which is its middle. A size that is not above 0 or not finite is hit
/// by nothing.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[require(Logic, Transform)]
pub struct Hitbox {
    /// Metres.
    pub radius: f32,
    /// From bottom to top, metres; at least twice the radius counts.
    pub height: f32,
    before: Option<Vec3>,
}

impl Hitbox {
    /// Of this size.
    #[must_use]
    pub const fn new(radius: f32, height: f32) -> Self {
        Self {
            radius,
            height,
            before: None,
        }
    }
}

impl Default for Hitbox {
    /// A figure of 1.8 m.
    fn default() -> Self {
        Self::new(0.3, 1.8)
    }
}

/// A capsule of this step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Whose.
    pub entity: Entity,
    /// Its middle a step ago.
    pub before: Vec3,
    /// Its middle now.
    pub now: Vec3,
    /// Metres.
    pub radius: f32,
    /// From the middle to the centres of the half spheres, metres.
    pub half: f32,
}

/// All capsules of this step.
#[derive(Resource, Clone, Debug, Default)]
pub struct BodyIndex {
    capsules: Vec<Capsule>,
    places: Vec<Vec2>,
    grid: Grid,
    /// The greatest radius with the longest way of a step: how far from its place one may be met.
    reach: f32,
}

impl BodyIndex {
    /// The capsules.
    #[must_use]
    pub fn capsules(&self) -> &[Capsule] {
        &self.capsules
    }

    /// The capsule that a way from `from` on meets first, and when, as a part of the way. With `moving`, capsules go
    /// from where they were to where they are in the same time; without, they stand where they are.
    #[must_use]
    pub fn cast(
        &self,
        from: DVec3,
        way: DVec3,
        moving: bool,
        skips: impl Fn(&Capsule) -> bool,
    ) -> Option<(f64, &Capsule)> {
        let (a, b) = (from.xz().as_vec2(), (from + way).xz().as_vec2());
        let reach = Vec2::splat(self.reach);
        let mut first: Option<(f64, &Capsule)> = None;
        for number in self.grid.near(a.min(b) - reach, a.max(b) + reach) {
            let capsule = &self.capsules[number as usize];
            if skips(capsule) {
                continue;
            }
            let (middle, motion) = if moving {
                let before = capsule.before.as_dvec3();
                (before, capsule.now.as_dvec3() - before)
            } else {
                (capsule.now.as_dvec3(), DVec3::ZERO)
            };
            let (radius, half) = (f64::from(capsule.radius), f64::from(capsule.half));
            if let Some(time) = meet_capsule(from - middle, way - motion, radius, half) {
                // Of equal times the lower entity counts, wherever it lies in the grid.
                let sooner = first.is_none_or(|(best, other)| {
                    time < best || (time == best && capsule.entity < other.entity)
                });
                if sooner {
                    first = Some((time, capsule));
                }
            }
        }
        first
    }
}

/// When a point from `from` on enters an upright capsule around 0, as a part of its way, 0 to 1; 0 of one that starts
/// in it. The least root of what is met: the cylinder between the half spheres, or one of these.
#[must_use]
pub fn meet_capsule(from: DVec3, way: DVec3, radius: f64, half: f64) -> Option<f64> {
    let axis = from.y.clamp(-half, half);
    if (from - DVec3::Y * axis).length_squared() <= radius * radius {
        return Some(0.0);
    }
    let mut first = f64::INFINITY;
    let (p, d) = (from.xz(), way.xz());
    if let Some(time) = enter_circle(p, d, radius)
        && (from.y + way.y * time).abs() <= half
    {
        first = time;
    }
    for end in [-half, half] {
        if let Some(time) = enter_sphere(from - DVec3::Y * end, way, radius) {
            first = first.min(time);
        }
    }
    (first <= 1.0).then_some(first)
}

/// The smaller root of |p + d t| = r that is not below 0. The discriminant is taken from the distance of the line to
/// the centre, which keeps its digits far away (E. Haines et al., Ray Tracing Gems, 2019, 7).
fn enter_sphere(p: DVec3, d: DVec3, radius: f64) -> Option<f64> {
    let a = d.length_squared();
    let b = -p.dot(d);
    if !(a > 0.0 && b > 0.0) {
        return None;
    }
    let rest = (p + d * (b / a)).length_squared();
    root(
        a,
        b,
        p.length_squared() - radius * radius,
        radius * radius - rest,
    )
}

fn enter_circle(p: DVec2, d: DVec2, radius: f64) -> Option<f64> {
    let a = d.length_squared();
    let b = -p.dot(d);
    if !(a > 0.0 && b > 0.0) {
        return None;
    }
    let rest = (p + d * (b / a)).length_squared();
    root(
        a,
        b,
        p.length_squared() - radius * radius,
        radius * radius - rest,
    )
}

fn root(a: f64, b: f64, c: f64, over: f64) -> Option<f64> {
    if !(over >= 0.0 && c > 0.0) {
        return None;
    }
    Some(c / (b + (a * over).sqrt()))
}

/// Whether the last step had a capsule: those that are gone have still to be forgotten.
pub(crate) fn any_body(index: Res<BodyIndex>) -> bool {
    !index.capsules.is_empty()
}

/// Where capsules were and are.
pub(crate) fn gather(
    mut index: ResMut<BodyIndex>,
    mut bodies: Query<(Entity, &mut Hitbox, &Transform)>,
) {
    let BodyIndex {
        capsules,
        places,
        grid,
        reach,
    } = &mut *index;
    capsules.clear();
    places.clear();
    *reach = 0.0;
    for (entity, mut body, transform) in &mut bodies {
        let now = transform.translation;
        let before = body.before.unwrap_or(now);
        if body.before != Some(now) {
            body.before = Some(now);
        }
        let above = |size: f32| size > 0.0 && size.is_finite();
        let whole = above(body.radius) && above(body.height);
        if !(whole && now.is_finite() && before.is_finite()) {
            continue;
        }
        *reach = reach.max(body.radius + (now - before).xz().length());
        capsules.push(Capsule {
            entity,
            before,
            now,
            radius: body.radius,
            half: (body.height / 2.0 - body.radius).max(0.0),
        });
        places.push(now.xz());
    }
    grid.build(places, 8.0);
}
