//! One step of a mover, and of many.

use super::slide::{GAP, Slide, contact};
use super::world::{Touch, World};
use super::{MoveError, MoveOutcome, MoveSettings, Mover};
use crate::geometry::Feature;
use crate::sweep::UnitSpace;
use crate::volume::{Ellipsoid, Ray};
use bevy::math::DVec3;
use bevy::tasks::{ComputeTaskPool, ParallelSliceMut, TaskPool};

/// How often a mover is moved out of the deepest that it overlaps: creases need a few turns.
const OUT: u32 = 16;

/// Deeper than this, metres, after all that: crushed.
const CRUSHED: f64 = 1e-4;

/// How near the ground is that holds one who did not stand before, in parts of the radius along up: some hundred
/// gaps.
const TOUCHING: f64 = 1e-4;

/// Memory that steps use again.
#[derive(Debug, Default)]
pub struct Scratch {
    slide: Slide,
    trial: Slide,
}

/// Moves a mover by one step.
///
/// What it is asked wrongly it answers in [`MoveOutcome::error`], and the mover stays as it is.
pub fn advance(
    world: &World,
    mover: &mut Mover,
    wish: DVec3,
    settings: &MoveSettings,
    scratch: &mut Scratch,
    outcome: &mut MoveOutcome,
) {
    outcome.contacts.clear();
    *outcome = MoveOutcome {
        contacts: std::mem::take(&mut outcome.contacts),
        ..MoveOutcome::default()
    };
    let space = UnitSpace::new(&Ellipsoid::upright(mover.center, mover.radii));
    let space = space
        .map_err(|_| MoveError::Mover {
            center: mover.center,
            radii: mover.radii,
        })
        .and_then(|space| {
            let way = space.check_way(wish);
            way.map_err(|_| MoveError::Wish(wish))?;
            settings.check(&space)?;
            Ok(space)
        });
    match space {
        Err(error) => outcome.error = Some(error),
        Ok(space) => Step {
            world,
            settings,
            scratch,
            outcome,
            space,
        }
        .run(mover, wish),
    }
}

struct Step<'a> {
    world: &'a World<'a>,
    settings: &'a MoveSettings,
    scratch: &'a mut Scratch,
    outcome: &'a mut MoveOutcome,
    space: UnitSpace,
}

impl Step<'_> {
    fn run(&mut self, mover: &mut Mover, wish: DVec3) {
        let stood = mover
            .stands_on
            .filter(|&body| (body as usize) < self.world.bodies.len());
        self.carry(stood);
        self.push(stood);
        self.out();
        let rises = wish.dot(self.settings.up);
        let walks = stood.is_some() && rises <= 0.0;
        // Who stands does not fall: ground that goes down is found by setting down.
        let wish = if walks {
            wish - self.settings.up * rises
        } else {
            wish
        };
        self.walk(wish, walks);
        let ground = self.ground(walks, rises);
        mover.center = self.space.center;
        mover.stands_on = ground.map(|touch| touch.body);
        self.outcome.grounded = ground.is_some();
        self.outcome.crushed |= !self.out();
        mover.center = self.space.center;
    }

    /// Along with what it stands on.
    fn carry(&mut self, stood: Option<u32>) {
        let Some(index) = stood else { return };
        let body = &self.world.bodies[index as usize];
        if !body.moves() {
            return;
        }
        let way = body.carry(self.space.center) - self.space.center;
        if way.is_finite() {
            self.displace(&self.world.without(index), way);
        }
    }

    /// Away from what runs into it.
    fn push(&mut self, stood: Option<u32>) {
        for index in 0..self.world.bodies.len() {
            let body = &self.world.bodies[index];
            if stood == Some(index as u32) || !body.moves() {
                continue;
            }
            self.outcome.casts += 1;
            let Some(touch) = self.world.run_into(index, &self.space) else {
                continue;
            };
            let way = body.carry(self.space.center) - self.space.center;
            let onward = way.dot(touch.normal) * (1.0 - touch.unit.time);
            self.outcome
                .contacts
                .push(contact(&touch, &self.space, DVec3::ZERO));
            if onward > 0.0 {
                let push = touch.normal * onward;
                let from = self.space.center;
                self.displace(&self.world.without(index as u32), push);
                let pushed = (self.space.center - from).dot(touch.normal);
                self.outcome.crushed |= onward - pushed > CRUSHED;
            }
        }
    }

    /// Slides that are not its own wish.
    fn displace(&mut self, world: &World, way: DVec3) {
        let slide = &mut self.scratch.slide;
        slide.clear();
        slide.run(world, &mut self.space, way, self.settings, false);
        self.outcome.casts += slide.casts;
        self.outcome.contacts.append(&mut slide.contacts);
    }

    /// Out of what it overlaps; whether that was done.
    fn out(&mut self) -> bool {
        for _ in 0..OUT {
            self.outcome.casts += 1;
            // What is nearer than half of the gap is moved to the gap.
            let Some(touch) = self.world.deepest(&self.space, -0.5 * GAP) else {
                return true;
            };
            if touch.unit.depth > 0.0 {
                self.outcome
                    .contacts
                    .push(contact(&touch, &self.space, DVec3::ZERO));
            }
            self.space.center += self.space.axes * touch.unit.normal * (touch.unit.depth + GAP);
        }
        let left = self.world.deepest(&self.space, 0.0);
        // The largest radius: the deepest in radii need not be the deepest in metres, and none is deeper than this says.
        let largest = self.space.half_size().max_element();
        left.is_none_or(|touch| largest * touch.unit.depth <= CRUSHED)
    }

    /// By its wish, over steps if it walks.
    fn walk(&mut self, wish: DVec3, walks: bool) {
        let start = self.space;
        let slide = &mut self.scratch.slide;
        slide.clear();
        slide.run(self.world, &mut self.space, wish, self.settings, true);
        let blocked = slide.contacts.iter().any(|contact| {
            let level = contact.normal.dot(self.settings.up);
            level > -1e-3 && level < self.settings.walkable
        });
        self.outcome.iterations = slide.iterations;
        self.outcome.casts += slide.casts;
        if walks
            && blocked
            && self.settings.step_height > 0.0
            && let Some(higher) = self.over_step(start, wish)
        {
            self.space = higher;
            std::mem::swap(&mut self.scratch.slide, &mut self.scratch.trial);
            self.outcome.iterations = self.scratch.slide.iterations;
        }
        let contacts = &mut self.scratch.slide.contacts;
        self.outcome.contacts.append(contacts);
    }

    /// Up, on and down again, where that leads to ground and farther than `self.space` is.
    fn over_step(&mut self, start: UnitSpace, wish: DVec3) -> Option<UnitSpace> {
        let up = self.settings.up;
        let flat = |way: DVec3| way - up * way.dot(up);
        let reached = flat(self.space.center - start.center).dot(flat(wish));
        let mut space = start;
        let raised = self.fall(&mut space, up * self.settings.step_height).1;
        let trial = &mut self.scratch.trial;
        trial.clear();
        trial.run(self.world, &mut space, flat(wish), self.settings, true);
        self.outcome.casts += trial.casts;
        let (touch, _) = self.fall(&mut space, up * -(raised + self.settings.snap));
        let farther = flat(space.center - start.center).dot(flat(wish));
        let better = farther > reached + 1e-3 * flat(wish).length_squared();
        let touch = touch?;
        // What it is set down on is no higher over its foot than a step, or it would creep up walls edge by edge.
        let foot = (space.axes.transpose() * up).length();
        let on = space.center - space.axes * touch.unit.normal;
        let height = (on - start.center).dot(up) + foot;
        let stands = self.settings.is_walkable(&touch)
            || self.over_ground(&space, &touch, foot + raised + self.settings.snap);
        (better && stands && height <= self.settings.step_height + foot * TOUCHING).then_some(space)
    }

    /// Straight until something is touched, and the length of that.
    fn fall(&mut self, space: &mut UnitSpace, way: DVec3) -> (Option<Touch>, f64) {
        self.outcome.casts += 1;
        let touch = self.world.sweep(space, way);
        let time = touch.map_or(1.0, |touch| {
            let rate = -(space.to_unit * way).dot(touch.unit.normal);
            (touch.unit.time - GAP / rate.max(GAP)).max(0.0)
        });
        space.center += way * time;
        (touch, way.length() * time)
    }

    /// The ground below: set down on it if it stood, or touched if it did not.
    fn ground(&mut self, walks: bool, rises: f64) -> Option<Touch> {
        if rises > 0.0 {
            return None;
        }
        let up = self.settings.up;
        let foot = (self.space.axes.transpose() * up).length();
        let reach = if walks {
            self.settings.snap.max(foot * TOUCHING)
        } else {
            foot * TOUCHING
        };
        let mut space = self.space;
        let (touch, _) = self.fall(&mut space, up * -reach);
        let touch = touch?;
        let stands = self.settings.is_walkable(&touch)
            || (walks && self.over_ground(&self.space.clone(), &touch, foot + reach));
        if !stands {
            return None;
        }
        self.outcome.ground = Some(contact(&touch, &self.space, up * -reach));
        self.space = space;
        Some(touch)
    }

    /// Whether one whose side rests on an edge has ground under its centre: it goes down a step.
    fn over_ground(&mut self, space: &UnitSpace, touch: &Touch, reach: f64) -> bool {
        let up = self.settings.up;
        if touch.unit.feature == Feature::Face || touch.normal.dot(up) <= 0.0 {
            return false;
        }
        self.outcome.casts += 1;
        let below = Ray::between(space.center, space.center - up * reach);
        let found = self.world.normal_along(&below);
        found.is_some_and(|(_, normal)| normal.dot(up) >= self.settings.walkable)
    }
}

/// Moves many, on all cores: the same as one after the other, for movers do not meet each other. Of arrays of
/// different lengths the shortest counts. Each task takes memory for its slides, and outcomes keep theirs.
pub fn advance_all(
    world: &World,
    movers: &mut [Mover],
    wishes: &[DVec3],
    settings: &MoveSettings,
    outcomes: &mut [MoveOutcome],
) {
    // Some 100 µs a task.
    const TASK: usize = 64;
    let count = movers.len().min(wishes.len()).min(outcomes.len());
    let mut pairs: Vec<(&mut Mover, &mut MoveOutcome)> = movers[..count]
        .iter_mut()
        .zip(&mut outcomes[..count])
        .collect();
    let work = |first: usize, part: &mut [(&mut Mover, &mut MoveOutcome)]| {
        let mut scratch = Scratch::default();
        for ((mover, outcome), &wish) in part.iter_mut().zip(&wishes[first..]) {
            advance(world, mover, wish, settings, &mut scratch, outcome);
        }
    };
    if count <= TASK {
        return work(0, &mut pairs);
    }
    let pool = ComputeTaskPool::get_or_init(TaskPool::default);
    pairs.par_chunk_map_mut(pool, TASK, |chunk, part| work(chunk * TASK, part));
}
