//! Who walks through grass presses it aside, and it springs back.
//!
//! Nothing is stored for a blade. A list of at most [`MOST_PRESSES`] upright capsules says who stands where, and where
//! somebody stood: a capsule that goes on leaves presses behind, whose strength falls like the way of a critically
//! damped spring, (1 + ωt)·e^(−ωt). A blade's lean is a function of that list.

use bevy::math::{DVec3, Vec2, Vec3, ops};
use bevy::prelude::*;
use bytemuck::{Pod, Zeroable};
use dolomite_terrain::GroundPoint;

/// Most capsules and traces that shaders read.
pub const MOST_PRESSES: usize = 64;

/// ω of the spring, radians a second: within 2.4 s a tip of half a metre is back to a millimetre.
const SPRING: f32 = 4.0;

/// A trace whose strength has fallen below this is dropped.
const GONE: f32 = 1e-3;

/// How far above its foot a capsule presses: of what is higher the stems are below.
const OVER: f32 = 1.0;

/// On a character or anything else that presses grass aside, with its foot at the entity's place.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Transform)]
pub struct PressesGrass {
    /// Radius of its capsule, metres.
    pub radius: f32,
}

impl Default for PressesGrass {
    /// A person.
    fn default() -> Self {
        Self { radius: 0.35 }
    }
}

/// One capsule or trace, relative to an anchor: 32 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Press {
    /// Its foot relative to the anchor (x, z), and its height in the world (y), metres.
    pub foot: [f32; 3],
    /// Radius, metres.
    pub radius: f32,
    /// 1: somebody stands there; falls to 0.
    pub strength: f32,
    /// To fill 16 bytes.
    pub rest: [f32; 3],
}

/// Where somebody stood.
#[derive(Clone, Copy, Debug)]
struct Trace {
    foot: DVec3,
    radius: f32,
    left: f64,
}

/// Who stands where, and who stood: kept by the plugin.
#[derive(Resource, Debug, Default)]
pub struct Presses {
    standing: Vec<(Entity, DVec3, f32)>,
    dropped: Vec<(Entity, DVec3)>,
    traces: Vec<Trace>,
    now: f64,
}

/// The strength of a trace that was left so many seconds ago.
#[inline]
#[must_use]
pub fn strength(age: f32) -> f32 {
    let turn = SPRING * age.max(0.0);
    (1.0 + turn) * ops::exp(-turn)
}

impl Presses {
    /// Takes over who stands where at a time, seconds.
    pub fn update(&mut self, now: f64, standing: impl Iterator<Item = (Entity, DVec3, f32)>) {
        self.now = now;
        self.standing.clear();
        self.standing
            .extend(standing.filter(|(_, foot, radius)| foot.is_finite() && *radius > 0.0));
        for (entity, foot, radius) in &self.standing {
            match self.dropped.iter_mut().find(|(known, _)| known == entity) {
                Some((_, last)) => {
                    // Traces overlap by half, so that a path has no gaps.
                    if last.distance(*foot) > f64::from(*radius) {
                        self.traces.push(Trace {
                            foot: *last,
                            radius: *radius,
                            left: now,
                        });
                        *last = *foot;
                    }
                }
                None => self.dropped.push((*entity, *foot)),
            }
        }
        let standing = &self.standing;
        let traces = &mut self.traces;
        self.dropped.retain(|(entity, foot)| {
            let there = standing.iter().any(|(known, ..)| known == entity);
            if !there {
                traces.push(Trace {
                    foot: *foot,
                    radius: PressesGrass::default().radius,
                    left: now,
                });
            }
            there
        });
        traces.retain(|trace| strength((now - trace.left) as f32) > GONE);
    }

    /// Whether anything is pressed: where this is false and was so before, nothing has to be drawn anew.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.standing.is_empty() && self.traces.is_empty()
    }

    /// What shaders read, relative to an anchor: those who stand first, then the youngest traces.
    #[must_use]
    pub fn list(&self, anchor: GroundPoint) -> Vec<Press> {
        let press = |foot: DVec3, radius: f32, strength: f32| {
            let flat = GroundPoint::new(foot.xz()).relative_to(anchor);
            Press {
                foot: [flat.x, foot.y as f32, flat.y],
                radius,
                strength,
                rest: [0.0; 3],
            }
        };
        let standing = self
            .standing
            .iter()
            .map(|(_, foot, radius)| press(*foot, *radius, 1.0));
        let traces = self.traces.iter().rev().map(|trace| {
            press(
                trace.foot,
                trace.radius,
                strength((self.now - trace.left) as f32),
            )
        });
        standing.chain(traces).take(MOST_PRESSES).collect()
    }
}

/// The lean of a blade of some length at a root, after all presses. Where a capsule stands on the root the blade lies
/// flat and away from it; at a distance within its length it leans away so far that it does not reach in.
#[must_use]
pub fn pressed(lean: Vec2, root: Vec3, length: f32, presses: &[Press]) -> Vec2 {
    let mut lean = lean;
    for press in presses {
        let away = Vec2::new(root.x - press.foot[0], root.z - press.foot[2]);
        let above = root.y - press.foot[1];
        if above.abs() > OVER {
            continue;
        }
        let distance = away.length();
        // Straight onto a blade's root: it lies along its own lean.
        let out = if distance > 1e-4 {
            away / distance
        } else {
            lean.normalize_or(Vec2::X)
        };
        let near = 1.0 - (distance - press.radius) / length.max(1e-3);
        let near = press.strength * near.clamp(0.0, 1.0);
        if near > 0.0 {
            // At the border of the capsule flat, smoothly less away from it.
            let wanted = near * (2.0 - near) * crate::blade::MOST_LEAN;
            let along = lean.dot(out);
            if along < wanted {
                // What leans towards it is turned away; what leans aside stays so, as far as there is room.
                let aside = (lean - out * along) * (1.0 - near);
                let along = along + (wanted - along) * near.sqrt();
                lean = out * along + aside;
            }
        }
    }
    lean.clamp_length_max(crate::blade::MOST_LEAN)
}

/// Takes over who stands where.
pub(crate) fn gather(
    time: Res<Time>,
    mut presses: ResMut<Presses>,
    who: Query<(Entity, &PressesGrass, &GlobalTransform)>,
) {
    if who.is_empty() && presses.is_empty() {
        return;
    }
    let standing = who
        .iter()
        .map(|(entity, presses, place)| (entity, place.translation().as_dvec3(), presses.radius));
    presses.update(time.elapsed_secs_f64(), standing);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blade::BladeShape;

    const PERSON: Press = Press {
        foot: [0.0; 3],
        radius: 0.35,
        strength: 1.0,
        rest: [0.0; 3],
    };

    /// How deep the curve of a blade is inside a capsule that stands on the ground, at most.
    fn depth(shape: &BladeShape, root: Vec3, lean: Vec2) -> f32 {
        let curve = shape.curve(lean);
        (0..=64)
            .map(|k| {
                let place = root + curve.at(k as f32 / 64.0).0;
                let on_axis =
                    Vec3::new(0.0, place.y.clamp(PERSON.radius, 1.8 - PERSON.radius), 0.0);
                PERSON.radius - place.distance(on_axis)
            })
            .fold(f32::MIN, f32::max)
    }

    /// Blades around a person, of any lean and length: outside of the capsule's radius none reaches in by more than a
    /// centimetre, and those below lie flat.
    #[test]
    fn no_blade_goes_through_a_person() {
        let (mut worst, mut before) = (f32::MIN, f32::MIN);
        for k in 0..4000_u32 {
            let random = |salt| crate::place::unit(crate::place::salted(k, salt));
            let turn = |r: f32| Vec2::new(ops::cos(r), ops::sin(r));
            let flat = turn(std::f32::consts::TAU * random(1)) * (PERSON.radius + random(2));
            let root = Vec3::new(flat.x, 0.0, flat.y);
            let shape = BladeShape {
                length: 0.2 + 0.5 * random(3),
                width: 0.01,
                lean: turn(std::f32::consts::TAU * random(4)) * (0.7 * random(5)),
                droop: 0.5 * random(6),
                across: Vec2::X,
                give: 0.0,
            };
            let lean = pressed(shape.lean, root, shape.length, &[PERSON]);
            before = before.max(depth(&shape, root, shape.lean));
            worst = worst.max(depth(&shape, root, lean));
        }
        assert!(before > 0.1, "some lean in before: {before}");
        assert!(worst < 0.01, "{worst}");
        let below = pressed(
            Vec2::new(0.1, 0.0),
            Vec3::new(0.1, 0.0, 0.1),
            0.5,
            &[PERSON],
        );
        assert!(below.length() > 0.98, "{below}");
    }

    /// A step has no jump: leans change smoothly with the distance of a person.
    #[test]
    fn presses_are_smooth() {
        let lean = Vec2::new(-0.3, 0.2);
        let mut last = pressed(lean, Vec3::new(2.0, 0.0, 0.0), 0.5, &[PERSON]);
        assert_eq!(last, lean, "far away nothing is pressed");
        for k in 1..1900 {
            let root = Vec3::new(2.0 - 0.001 * k as f32, 0.0, 0.0);
            let next = pressed(lean, root, 0.5, &[PERSON]);
            assert!(next.distance(last) < 0.05, "{k}: {last} {next}");
            last = next;
        }
    }

    /// Grass is back to a millimetre after three seconds, without a jump; traces end.
    #[test]
    fn grass_springs_back() {
        let entity = Entity::PLACEHOLDER;
        let mut presses = Presses::default();
        for k in 0..60 {
            let foot = DVec3::new(0.05 * f64::from(k), 0.0, 0.0);
            presses.update(f64::from(k) / 60.0, std::iter::once((entity, foot, 0.35)));
        }
        let anchor = GroundPoint::default();
        let list = presses.list(anchor);
        assert!((5..MOST_PRESSES).contains(&list.len()), "{}", list.len());
        assert_eq!(list[0].strength, 1.0);
        let lean = Vec2::new(0.1, 0.0);
        let root = Vec3::new(2.7, 0.0, 0.1);
        let mut last = pressed(lean, root, 0.5, &list);
        assert!(last.distance(lean) > 0.3, "pressed");
        for k in 0..300 {
            presses.update(1.0 + f64::from(k) / 60.0, std::iter::empty());
            let next = pressed(lean, root, 0.5, &presses.list(anchor));
            assert!(next.distance(last) < 0.3, "{k}: {last} {next}");
            last = next;
        }
        assert!(0.5 * last.distance(lean) < 0.001 && presses.is_empty());
    }

    #[test]
    fn many_are_cut_to_the_limit() {
        let mut presses = Presses::default();
        let crowd = (0..200).map(|k| {
            (
                Entity::from_raw_u32(k).expect("an index"),
                DVec3::splat(f64::from(k)),
                0.3,
            )
        });
        presses.update(0.0, crowd);
        assert_eq!(presses.list(GroundPoint::default()).len(), MOST_PRESSES);
        presses.update(0.0, std::iter::once((Entity::PLACEHOLDER, DVec3::NAN, 0.3)));
        assert!(presses.standing.is_empty());
    }
}
