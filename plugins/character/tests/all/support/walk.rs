//! A figure led over a ground, and what its feet do there.
#![allow(dead_code, reason = "two programs of tests use a part of it each")]
#![expect(
    clippy::disallowed_methods,
    reason = "the ground and the way over it, in f64"
)]

use bevy::math::{Affine3A, DVec2, DVec3, Quat};
use dolomite_character::feet::{Footing, Place};
use dolomite_character::gait::Motion;
use dolomite_character::{Figure, FigureState, Input, Pose, Workspace};

/// A figure that is led over a ground.
pub struct Walk<'a> {
    figure: &'a Figure,
    pub state: FigureState,
    work: Workspace,
    pose: Pose,
    pub model: Vec<Affine3A>,
    pub position: DVec3,
    yaw: f64,
    ground: &'a dyn Fn(DVec2) -> Footing,
    /// Feet are put onto the ground; without, they are where the clips have them.
    pub planted: bool,
}

/// Where a foot stands.
#[derive(Clone, Copy)]
struct Contact {
    /// Heel or ball.
    point: usize,
    place: DVec3,
}

/// What was seen.
#[derive(Debug, Default)]
pub struct Seen {
    /// Greatest way of a standing point from where it came to stand, metres.
    pub slide: f64,
    /// Deepest below and highest above the ground of a standing point, metres.
    pub below: f64,
    pub above: f64,
    /// Times that a foot came to stand.
    pub contacts: usize,
}

impl Seen {
    pub fn take(&mut self, other: &Self) {
        self.slide = self.slide.max(other.slide);
        self.below = self.below.max(other.below);
        self.above = self.above.max(other.above);
        self.contacts += other.contacts;
    }
}

pub const DT: f64 = 1.0 / 60.0;

impl<'a> Walk<'a> {
    pub fn new(figure: &'a Figure, ground: &'a dyn Fn(DVec2) -> Footing) -> Self {
        Self {
            figure,
            state: FigureState::default(),
            work: Workspace::default(),
            pose: Pose::default(),
            model: Vec::new(),
            position: DVec3::new(12.0, 0.0, -7.0),
            yaw: 0.0,
            ground,
            planted: true,
        }
    }

    pub fn frame(&mut self, speed: f64, turn: f64) {
        self.yaw += turn * DT;
        let way = DVec2::new(self.yaw.sin(), self.yaw.cos());
        self.position.x += way.x * speed * DT;
        self.position.z += way.y * speed * DT;
        let here = (self.ground)(DVec2::new(self.position.x, self.position.z));
        self.position.y = here.height;
        let input = Input {
            dt: DT as f32,
            motion: Motion {
                speed: speed as f32,
                turn_rate: turn as f32,
                ..Default::default()
            },
            place: self.place(),
        };
        let Self {
            figure,
            state,
            work,
            pose,
            model,
            ..
        } = self;
        figure.advance(state, &input, work);
        let mut answer = |xz: DVec2| Some((self.ground)(xz));
        let ground = self
            .planted
            .then_some(&mut answer as &mut dyn FnMut(DVec2) -> Option<Footing>);
        figure.pose(state, &input, ground, work, pose, model);
    }

    pub fn place(&self) -> Place {
        Place {
            position: self.position,
            rotation: Quat::from_rotation_y(self.yaw as f32),
        }
    }

    pub fn sole(&self, side: usize) -> [DVec3; 2] {
        let place = self.place();
        let sole = self.figure.sole(side, &self.model).expect("it has legs");
        sole.map(|point| place.position + (place.rotation * point).as_dvec3())
    }

    /// Metres above the ground.
    fn clearance(&self, point: DVec3) -> f64 {
        point.y - (self.ground)(DVec2::new(point.x, point.z)).height
    }

    /// Walks for a while and watches the feet.
    pub fn watch(&mut self, seconds: f64, speed: f64, turn: f64) -> Seen {
        let mut seen = Seen::default();
        let mut contacts: [Option<Contact>; 2] = [None; 2];
        for _ in 0..(seconds / DT) as usize {
            self.frame(speed, turn);
            let firm = self.state.locomotion.feet(&self.figure.gait);
            let stands = |side| match self.planted {
                true => self.state.feet.stands(side),
                false => firm[side] > 0.999,
            };
            for (side, known) in contacts.iter_mut().enumerate() {
                if !stands(side) {
                    *known = None;
                    continue;
                }
                let points = self.sole(side);
                let heights = points.map(|point| self.clearance(point));
                let lower = usize::from(heights[1] <= heights[0] + 1e-3);
                match *known {
                    Some(contact) if contact.point == lower => {
                        seen.slide = seen.slide.max(points[lower].distance(contact.place));
                    }
                    _ => {
                        seen.contacts += 1;
                        *known = Some(Contact {
                            point: lower,
                            place: points[lower],
                        });
                    }
                }
                seen.below = seen.below.max(-heights[lower]);
                seen.above = seen.above.max(heights[lower]);
            }
        }
        seen
    }
}

/// A plane of so many degrees that rises towards `direction`, radians from +z to +x.
pub fn plane(degrees: f64, direction: f64) -> impl Fn(DVec2) -> Footing {
    let rise = degrees.to_radians().tan();
    let gradient = DVec2::new(direction.sin(), direction.cos()) * rise;
    move |xz| Footing {
        height: gradient.dot(xz),
        gradient,
    }
}
