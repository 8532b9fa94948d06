//! Planting: from a pose on a flat floor to one on the ground.
//!
//! A clip knows a floor, y = 0 of the model. Each foot is carried over to the ground beneath it: up by the
//! ground's height there, tilted with the slope about the point below the ankle. What touched the floor
//! touches the ground's tangent plane.
//!
//! While a foot stands, the lower one of heel and ball does not move: whatever the clip's speed and the
//! figure's differ by, and whatever the tilt adds, the foot is moved back by. In the air it returns to
//! where its clip has it. So a foot may roll from heel to ball, and slides neither way. Who stands still
//! with a foot too far off takes a step on the spot.
//!
//! Then the pelvis comes down until both legs reach, and the legs are bent. A foot that a leg cannot keep
//! where it stands, behind a long stride uphill, is lifted before its time: better than dragged.

use super::foot::{Foot, Held, Sole};
use super::two_bone::{EXACT_REACH, Limb, bend};
use crate::blend::smooth;
use crate::gait::{LegJoints, Spring, Step, rotation_of, turned, wrapped, yaw_of};
use crate::pose::Pose;
use crate::skeleton::Skeleton;
use bevy::math::{Affine3A, DVec2, DVec3, Quat, Vec3};

/// The ground at a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footing {
    /// Metres.
    pub height: f64,
    /// Rise for each metre along x and z.
    pub gradient: DVec2,
}

/// Where a figure stands: its model's origin, and the turn of its model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Metres.
    pub position: DVec3,
    /// A turn about +y.
    pub rotation: Quat,
}

/// Limits of planting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeetSettings {
    /// Metres that the pelvis may come down.
    pub most_drop: f32,
    /// Metres that a standing foot may be from where its clip has it; beyond, it is let go.
    pub most_offset: f32,
    /// Radians, the same.
    pub most_turn: f32,
    /// Of who stands still: metres from which on a foot takes a step on the spot.
    pub step_from: f32,
}

impl Default for FeetSettings {
    fn default() -> Self {
        Self {
            most_drop: 0.45,
            most_offset: 0.35,
            most_turn: 1.0,
            step_from: 0.06,
        }
    }
}

/// Both feet of a figure, from frame to frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Feet {
    feet: [Foot; 2],
    pelvis: Spring,
    last: Option<DVec3>,
}

/// Seconds and metres of a step on the spot.
const STEP: f32 = 0.32;
const STEP_HEIGHT: f32 = 0.05;
/// A figure that moves farther in a frame was put there.
const JUMP: f64 = 1.5;
/// A leg may be too short by so much, metres, before its foot is lifted: less than is seen.
const SHORT: f32 = 1e-3;
/// Seconds in which the pelvis comes up again.
const RISE: f32 = 0.2;

/// A foot carried over to the ground: figure's axes are the world's, its origin the figure's.
struct Target {
    ankle: Vec3,
    rotation: Quat,
    points: [Vec3; 2],
}

impl Feet {
    /// Bends the legs of `pose`. `model` are its matrices; they are brought up to date. `firm` says how
    /// firmly each foot stands ([`Locomotion::feet`](crate::gait::Locomotion::feet)), `still` that no clip
    /// steps. `ground` answers in world coordinates (x, z); where it does not, the foot stays as it is.
    pub fn plant(
        &mut self,
        body: &Body,
        settings: &FeetSettings,
        place: &Place,
        step: &Step,
        ground: &mut dyn FnMut(DVec2) -> Option<Footing>,
        pose: &mut Pose,
        model: &mut Vec<Affine3A>,
    ) {
        let moved = self.last.map(|last| place.position - last);
        if !moved.is_none_or(|way| way.length() < JUMP) {
            *self = Self::default();
        }
        self.last = Some(place.position);
        let mut targets = [None, None];
        for (side, target) in targets.iter_mut().enumerate() {
            *target = self.place_foot(side, body, settings, place, step, ground, model);
        }
        let down = self.lower(body, settings, place, step, &targets, model);
        let up = place.rotation.inverse() * Vec3::Y;
        shift(body.skeleton, body.pelvis, up * down, model, pose);
        body.skeleton.local_to_model(pose, model);
        for (side, target) in targets.iter().enumerate() {
            if let Some(target) = target {
                let (way, most) = leg_to(body, side, place, target, model);
                let foot = &mut self.feet[side];
                if let Some(held) = foot.held.as_mut().filter(|_| way.length() > most + SHORT) {
                    foot.lifted |= held.firm;
                    held.firm = false;
                }
                reach(body, side, place, target, step.ground, pose, model);
            }
        }
        body.skeleton.local_to_model(pose, model);
    }

    /// Whether a foot (0 left, 1 right) is held to the ground; not while it swings or steps on the spot.
    #[must_use]
    pub fn stands(&self, side: usize) -> bool {
        let held = self.feet.get(side).and_then(|foot| foot.held);
        held.is_some_and(|held| held.firm)
    }

    fn place_foot(
        &mut self,
        side: usize,
        body: &Body,
        settings: &FeetSettings,
        place: &Place,
        step: &Step,
        ground: &mut dyn FnMut(DVec2) -> Option<Footing>,
        model: &[Affine3A],
    ) -> Option<Target> {
        let other_steps = self.feet[1 - side].stepping.is_some();
        let foot = &mut self.feet[side];
        let ankle = Affine3A::from_quat(place.rotation) * model[body.legs[side].ankle];
        let soles = body.soles[side].points(&ankle);
        // Equal heights: the ball, on which a foot turns.
        let lower = usize::from(soles[1].y <= soles[0].y + 1e-4);
        let mut firm = step.firm[side] > 0.999 && step.ground > 0.999;
        foot.lifted &= firm;
        firm &= !foot.lifted;
        let far = foot.away() > settings.most_offset || foot.yaw.value.abs() > settings.most_turn;
        if firm
            && (far
                || (step.still && !other_steps && foot.stepping.is_none() && off(foot, settings)))
        {
            foot.stepping = Some(0.0);
        }
        let mut lift = 0.0;
        if let Some(time) = &mut foot.stepping {
            *time += step.dt;
            firm = false;
            let part = *time / STEP;
            lift = STEP_HEIGHT * smooth(2.0 * part.min(1.0 - part));
            if part >= 1.0 {
                foot.stepping = None;
            }
        }
        if !firm {
            foot.let_go(step.dt);
        }
        // On the spot it steps over the slope that it stands on.
        let hold = if foot.stepping.is_some() {
            1.0
        } else {
            step.firm[side]
        };
        let pointed = foot.heading(soles, yaw_of(place.rotation));
        let mut target = carry(foot, &ankle, &soles, place, hold, ground)?;
        if firm && let Some(held) = foot.held.filter(|held| held.firm) {
            // One round is exact on a plane; the second takes out what the ground's curvature leaves.
            for _ in 0..2 {
                let point = target.points[lower].as_dvec3() + place.position;
                let back = held.points[lower] - point;
                let turn = wrapped(held.yaw - pointed - foot.yaw.value);
                foot.move_by(back.x as f32, back.z as f32, turn);
                target = carry(foot, &ankle, &soles, place, hold, ground)?;
            }
        }
        foot.held = Some(Held {
            points: target.points.map(|point| point.as_dvec3() + place.position),
            yaw: pointed + foot.yaw.value,
            firm,
        });
        target.ankle.y += lift;
        Some(target)
    }

    /// How far the pelvis has to come down, metres, at most 0.
    fn lower(
        &mut self,
        body: &Body,
        settings: &FeetSettings,
        place: &Place,
        step: &Step,
        targets: &[Option<Target>; 2],
        model: &[Affine3A],
    ) -> f32 {
        let mut needed = 0.0_f32;
        for (side, target) in targets.iter().enumerate() {
            let Some(target) = target else { continue };
            let (way, reach) = leg_to(body, side, place, target, model);
            let level = way.x * way.x + way.z * way.z;
            let down = way.y + (reach * reach - level).max(0.0).sqrt();
            needed = needed.min(step.firm[side] * down.min(0.0));
        }
        let needed = step.ground * needed.max(-settings.most_drop);
        self.pelvis.follow(needed, RISE, step.dt);
        // Down at once, as a leg that cannot reach would slide; up in its own time.
        if self.pelvis.value > needed {
            self.pelvis = Spring {
                value: needed,
                speed: self.pelvis.speed.min(0.0),
            };
        }
        self.pelvis.value
    }
}

/// The way from a hip to where its ankle should be, and how long it may be; figure's axes are the world's.
fn leg_to(
    body: &Body,
    side: usize,
    place: &Place,
    target: &Target,
    model: &[Affine3A],
) -> (Vec3, f32) {
    let leg = &body.legs[side];
    let [hip, knee, ankle] = [leg.hip, leg.knee, leg.ankle]
        .map(|joint| place.rotation * Vec3::from(model[joint].translation));
    let reach = EXACT_REACH * (hip.distance(knee) + knee.distance(ankle));
    (target.ankle - hip, reach)
}

/// Whether a foot is so far off that who stands still puts it back.
fn off(foot: &Foot, settings: &FeetSettings) -> bool {
    foot.away() > settings.step_from || foot.yaw.value.abs() > 5.0 * settings.step_from
}

/// What a figure's legs are.
pub struct Body<'a> {
    /// Its joints.
    pub skeleton: &'a Skeleton,
    /// The joint that carries both legs.
    pub pelvis: usize,
    /// Left, right.
    pub legs: [LegJoints; 2],
    /// Left, right.
    pub soles: [Sole; 2],
}

/// Carries a foot over to the ground, as firmly as it stands.
fn carry(
    foot: &Foot,
    ankle: &Affine3A,
    soles: &[Vec3; 2],
    place: &Place,
    firm: f32,
    ground: &mut dyn FnMut(DVec2) -> Option<Footing>,
) -> Option<Target> {
    let at = Vec3::from(ankle.translation);
    let below = Vec3::new(at.x + foot.x.value, 0.0, at.z + foot.z.value);
    let world = place.position + below.as_dvec3();
    let footing = ground(DVec2::new(world.x, world.z))?;
    let gradient = footing.gradient.as_vec2();
    let normal = Vec3::new(-gradient.x, 1.0, -gradient.y).normalize_or(Vec3::Y);
    let whole = Quat::from_rotation_arc(Vec3::Y, normal);
    let tilt = Quat::IDENTITY.lerp(whole, firm);
    let base = Vec3::new(below.x, (footing.height - place.position.y) as f32, below.z);
    let turn = tilt * turned(foot.yaw.value);
    // Blended legs do not end where their clips' do: what stands is brought down to the floor, and nothing
    // is left below it.
    let lowest = soles[0].y.min(soles[1].y);
    let raise = if lowest < 0.0 {
        -lowest
    } else {
        -lowest * firm
    };
    let carried =
        |point: Vec3| base + turn * Vec3::new(point.x - at.x, point.y + raise, point.z - at.z);
    Some(Target {
        ankle: carried(at),
        rotation: turn * rotation_of(ankle),
        points: soles.map(carried),
    })
}

/// Moves a joint by `way` in the model's frame.
fn shift(skeleton: &Skeleton, joint: usize, way: Vec3, model: &[Affine3A], pose: &mut Pose) {
    if way == Vec3::ZERO {
        return;
    }
    let way = match skeleton.parent(joint) {
        Some(parent) => model[parent].matrix3.inverse() * bevy::math::Vec3A::from(way),
        None => way.into(),
    };
    let mut local = pose.get(joint);
    local.translation += Vec3::from(way);
    pose.set(joint, local);
}

/// Bends a leg so that its foot is at `target`, as far as `part` goes.
fn reach(
    body: &Body,
    side: usize,
    place: &Place,
    target: &Target,
    part: f32,
    pose: &mut Pose,
    model: &[Affine3A],
) {
    let leg = &body.legs[side];
    let back = place.rotation.inverse();
    let [root, middle, end] =
        [leg.hip, leg.knee, leg.ankle].map(|joint| Vec3::from(model[joint].translation));
    let limb = Limb { root, middle, end };
    let wanted = end.lerp(back * target.ankle, part);
    let bend = bend(&limb, wanted, body.soles[side].knee);
    let [hip, knee, ankle] = [leg.hip, leg.knee, leg.ankle].map(|joint| rotation_of(&model[joint]));
    let above = body
        .skeleton
        .parent(leg.hip)
        .map_or(Quat::IDENTITY, |parent| rotation_of(&model[parent]));
    let (hip, knee) = (bend.upper * hip, bend.lower * knee);
    let sole = back * target.rotation;
    let sole = if ankle.dot(sole) < 0.0 { -sole } else { sole };
    let ankle = ankle.lerp(sole, part);
    pose.set_rotation(leg.hip, (above.inverse() * hip).normalize());
    pose.set_rotation(leg.knee, (hip.inverse() * knee).normalize());
    pose.set_rotation(leg.ankle, (knee.inverse() * ankle).normalize());
}
