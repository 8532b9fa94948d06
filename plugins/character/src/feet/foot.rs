//! One foot: its sole, and where it is held.

use crate::gait::{LegJoints, Spring, wrapped};
use crate::skeleton::Skeleton;
use bevy::math::{Affine3A, DVec3, Vec2, Vec3, ops};

/// The two points that a sole stands on, in the ankle joint's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sole {
    /// Under the end of the heel.
    pub heel: Vec3,
    /// Under the ball.
    pub ball: Vec3,
    /// Where the knee bends to, in the model's frame.
    pub knee: Vec3,
}

impl Sole {
    /// From the skeleton at rest, which stands on y = 0 and looks along +z.
    #[must_use]
    pub fn new(skeleton: &Skeleton, leg: &LegJoints) -> Self {
        let model = skeleton.rest_model();
        let (ankle, ball) = (model[leg.ankle].translation, model[leg.ball].translation);
        let below = model[leg.ankle].inverse();
        let local = |point: Vec3| below.transform_point3(point);
        Self {
            heel: local(Vec3::new(ankle.x, 0.0, ankle.z - leg.heel)),
            ball: local(Vec3::new(ball.x, 0.0, ball.z)),
            knee: Vec3::Z,
        }
    }

    /// Heel and ball under an ankle.
    pub(super) fn points(&self, ankle: &Affine3A) -> [Vec3; 2] {
        [self.heel, self.ball].map(|point| ankle.transform_point3(point))
    }
}

/// What is remembered of a foot.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Foot {
    /// How far the foot is from where its clip has it: x, z, metres, world axes.
    pub x: Spring,
    pub z: Spring,
    /// How far it is turned from how its clip has it, radians.
    pub yaw: Spring,
    /// Where heel and ball were, and the foot's direction, a frame ago.
    pub held: Option<Held>,
    /// Seconds that a step on the spot goes on.
    pub stepping: Option<f32>,
    /// The leg was too short to stay: it is in the air until its clip has swung it.
    pub lifted: bool,
    /// Where its clip pointed it when it was last flat enough to point anywhere, from where the figure
    /// looks, radians to the left.
    pub pointed: f32,
}

/// A sole in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Held {
    pub points: [DVec3; 2],
    pub yaw: f32,
    /// Whether it stood.
    pub firm: bool,
}

/// A sole whose length seen from above is a smaller part of its own stands too steeply to point anywhere.
const FLAT: f32 = 0.8;

/// Seconds in which a foot in the air comes back to where its clip has it.
const RETURN: f32 = 0.18;

impl Foot {
    /// In the air: comes back.
    pub fn let_go(&mut self, dt: f32) {
        for spring in [&mut self.x, &mut self.z, &mut self.yaw] {
            spring.follow(0.0, RETURN, dt);
        }
    }

    /// On the ground: moved by `x`, `z` and `yaw`, and at rest.
    pub fn move_by(&mut self, x: f32, z: f32, yaw: f32) {
        self.x = Spring::at(self.x.value + x);
        self.z = Spring::at(self.z.value + z);
        self.yaw = Spring::at(self.yaw.value + yaw);
    }

    /// The direction in which a foot with these heel and ball points, radians about +y, by its sole and
    /// not by its joint, whose axes may be any. On the toes it keeps the direction that it had, since
    /// that of an upright sole is a matter of roundings.
    pub fn heading(&mut self, [heel, ball]: [Vec3; 2], looks: f32) -> f32 {
        let along = ball - heel;
        if Vec2::new(along.x, along.z).length() > FLAT * along.length() {
            self.pointed = wrapped(ops::atan2(along.x, along.z) - looks);
        }
        looks + self.pointed
    }

    /// How far it is from where it would like to be, metres.
    pub fn away(&self) -> f32 {
        Vec3::new(self.x.value, 0.0, self.z.value).length()
    }
}
