//! From speed, turning and ground to clips, times and weights.

use super::data::{Gait, MoveClip};
use super::phase::firmness;
use super::spring::Spring;
use crate::blend::Fade;
use crate::clip::Clip;
use bevy::math::Vec2;
use bevy::reflect::prelude::*;

/// What a figure does, as gameplay says it: the input.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Metres a second over the ground plane, along the way it looks; backwards is negative.
    pub speed: f32,
    /// Radians a second, to the left.
    pub turn_rate: f32,
    /// Rise of the ground for each metre to the left (x) and forwards (y).
    pub slope: Vec2,
    /// Whether no foot reaches the ground.
    pub airborne: bool,
    /// Metres a second upwards.
    pub climb: f32,
}

impl Motion {
    /// What is no number becomes 0.
    fn valid(self) -> Self {
        let number = |x: f32| if x.is_finite() { x } else { 0.0 };
        Self {
            speed: number(self.speed),
            turn_rate: number(self.turn_rate),
            slope: Vec2::new(number(self.slope.x), number(self.slope.y)),
            airborne: self.airborne,
            climb: number(self.climb),
        }
    }
}

/// What a frame does with the feet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Seconds.
    pub dt: f32,
    /// How firmly each foot stands, in [0, 1].
    pub firm: [f32; 2],
    /// How much of the figure is on the ground, in [0, 1]; in the air feet follow their clips.
    pub ground: f32,
    /// Whether no clip steps.
    pub still: bool,
}

/// What a figure is about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LocomotionState {
    /// Stands, walks, runs, turns.
    #[default]
    Ground,
    /// Took off.
    Jump,
    /// Is in the air.
    Fall,
    /// Came down.
    Land,
}

/// A clip at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Voice {
    /// Number of the clip.
    pub clip: usize,
    /// Seconds.
    pub time: f32,
    /// All voices' weights sum to 1.
    pub weight: f32,
}

/// A state that was entered; the same state again is another one.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Entered {
    state: LocomotionState,
    /// Of [`Locomotion::clock`], seconds.
    since: f64,
}

/// A one-shot that is laid over the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlay {
    /// Number of the one-shot.
    pub one_shot: usize,
    /// Seconds.
    pub time: f32,
    /// Its weight, in [0, 1].
    pub weight: f32,
}

/// What [`Fade`] of one-shots leads to.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shot {
    /// `None`: nothing is laid over.
    one_shot: Option<usize>,
    since: f64,
}

/// A figure's gait under way.
#[derive(Clone, Debug, PartialEq)]
pub struct Locomotion {
    /// Where it is in its step: 0 when the left foot lands, 1/2 when the right one does.
    pub phase: f32,
    /// Smoothed speed, m/s.
    pub speed: Spring,
    /// Smoothed turning, rad/s.
    pub turning: Spring,
    clock: f64,
    state: Fade<Entered>,
    shot: Fade<Shot>,
    /// What is laid over while no other one-shot is.
    held: Shot,
}

/// Nothing is laid over.
const NO_SHOT: Shot = Shot {
    one_shot: None,
    since: 0.0,
};

impl Default for Locomotion {
    fn default() -> Self {
        Self {
            phase: 0.0,
            speed: Spring::default(),
            turning: Spring::default(),
            clock: 0.0,
            state: Fade::new(Entered {
                state: LocomotionState::Ground,
                since: 0.0,
            }),
            shot: Fade::new(NO_SHOT),
            held: NO_SHOT,
        }
    }
}

/// Seconds that speed and turning lag behind their inputs.
const LAG: f32 = 0.2;
/// Seconds of a fade into the air, out of it, and of one-shots.
const TO_AIR: f32 = 0.15;
const TO_GROUND: f32 = 0.25;
const SHOT: f32 = 0.25;
/// Below this part of the slowest stride's speed steps become shorter, above it quicker.
const FULL_STRIDE: f32 = 0.6;
/// No figure steps faster than this: turns of the phase a second.
const FASTEST: f32 = 4.0;

/// Clips that step with less weight than this do not count as steps.
const STANDS: f32 = 0.02;

/// Weights of the ground's clips.
struct Ground {
    idle: f32,
    strides: [(usize, f32); 2],
    /// Which turn, and its weight.
    turn: (usize, f32),
}

impl Locomotion {
    /// Goes on by `dt` seconds.
    pub fn advance(&mut self, gait: &Gait, clips: &[Clip], motion: &Motion, dt: f32) {
        let motion = motion.valid();
        let dt = if dt > 0.0 && dt.is_finite() { dt } else { 0.0 };
        self.clock += f64::from(dt);
        self.speed.follow(motion.speed, LAG, dt);
        self.turning.follow(motion.turn_rate, LAG, dt);
        let rate = self.phase_rate(gait, &motion);
        self.phase = (self.phase + rate * dt).rem_euclid(1.0);
        // `rem_euclid` rounds a tiny negative number to 1.
        if self.phase >= 1.0 {
            self.phase = 0.0;
        }
        self.change_state(gait, clips, &motion);
        self.state.advance(dt);
        self.end_shot(gait, clips);
        self.shot.advance(dt);
    }

    /// What it is about now.
    #[must_use]
    pub fn state(&self) -> LocomotionState {
        self.state.target().state
    }

    /// Lays a one-shot over the rest for as long as it is asked for; when it is over its last pose stays. `None` lays
    /// it down. One that is [played](Self::play) meanwhile is seen to its end first.
    pub fn hold(&mut self, one_shot: Option<usize>) {
        if one_shot == self.held.one_shot {
            return;
        }
        let rests = self.shot.target() == self.held;
        self.held = Shot {
            one_shot,
            since: self.clock,
        };
        if rests {
            self.shot.go(self.held, SHOT);
        }
    }

    /// Ends at once what is [played](Self::play): what is held is seen instead.
    pub fn cut(&mut self) {
        self.shot.go(self.held, SHOT);
    }

    /// Lays a one-shot over the rest once; the same again begins anew, while the old one fades.
    pub fn play(&mut self, one_shot: usize) {
        let target = Shot {
            one_shot: Some(one_shot),
            since: self.clock,
        };
        self.shot.go(target, SHOT);
    }

    fn enter(&mut self, state: LocomotionState, fade: f32) {
        let since = self.clock;
        self.state.go(Entered { state, since }, fade);
    }

    fn change_state(&mut self, gait: &Gait, clips: &[Clip], motion: &Motion) {
        use LocomotionState::{Fall, Ground, Jump, Land};
        let now = self.state.target();
        let age = (self.clock - now.since) as f32;
        let over = |clip: Option<usize>, early: f32| {
            clip.is_none_or(|clip| age >= clips[clip].duration() - early)
        };
        let [jump, fall, land] = gait.air;
        match now.state {
            Ground | Land if motion.airborne => {
                if motion.climb > 0.0 && jump.is_some() {
                    self.enter(Jump, TO_AIR);
                } else if fall.is_some() {
                    self.enter(Fall, TO_GROUND);
                }
            }
            Jump if motion.airborne => {
                if over(jump, TO_GROUND) && fall.is_some() {
                    self.enter(Fall, TO_GROUND);
                }
            }
            // Steps over a kerb are no landings.
            Jump | Fall if !motion.airborne => {
                let moves = motion.speed.abs() > 0.5;
                if land.is_some() && age > 0.2 && !moves {
                    self.enter(Land, TO_AIR);
                } else {
                    self.enter(Ground, TO_GROUND);
                }
            }
            Land if over(land, TO_GROUND) || motion.speed.abs() > 0.5 => {
                self.enter(Ground, TO_GROUND)
            }
            Ground | Jump | Fall | Land => {}
        }
    }

    fn end_shot(&mut self, gait: &Gait, clips: &[Clip]) {
        let shot = self.shot.target();
        let Some(one_shot) = shot.one_shot.filter(|_| shot != self.held) else {
            return;
        };
        let length = gait
            .one_shots
            .get(one_shot)
            .map_or(0.0, |(clip, _)| clips[*clip].duration());
        if (self.clock - shot.since) as f32 >= length - SHOT {
            self.shot.go(self.held, SHOT);
        }
    }

    fn ground(&self, gait: &Gait) -> Ground {
        let speed = self.speed.value.abs();
        let mut strides = [(0, 0.0); 2];
        let mut moving = 0.0;
        if let Some(slowest) = gait.strides.first() {
            moving = (speed / (FULL_STRIDE * slowest.rate)).min(1.0);
            let above = gait.strides.partition_point(|stride| stride.rate <= speed);
            strides = match (above.checked_sub(1), gait.strides.get(above)) {
                (Some(slow), Some(next)) => {
                    let part =
                        (speed - gait.strides[slow].rate) / (next.rate - gait.strides[slow].rate);
                    [(slow, moving * (1.0 - part)), (above, moving * part)]
                }
                (Some(fastest), None) => [(fastest, moving), (0, 0.0)],
                (None, _) => [(0, moving), (0, 0.0)],
            };
        }
        let side = usize::from(self.turning.value < 0.0);
        let turning = gait.turns[side].map_or(0.0, |turn| {
            (self.turning.value.abs() / (FULL_STRIDE * turn.rate)).min(1.0) * (1.0 - moving)
        });
        Ground {
            idle: 1.0 - moving - turning,
            strides,
            turn: (side, turning),
        }
    }

    /// Turns of the phase a second: as many as make the blended step as long as the way.
    fn phase_rate(&self, gait: &Gait, motion: &Motion) -> f32 {
        let ground = self.ground(gait);
        // While it comes to rest it still finishes its step.
        let further = |input: f32, smooth: f32| {
            if input.abs() >= smooth.abs() {
                input
            } else {
                smooth
            }
        };
        let mut rate = 0.0;
        let mut weight = 0.0;
        // Metres in a turn of the phase. A step of a stride with weight w is w times as long.
        let reach: f32 = ground
            .strides
            .iter()
            .map(|(i, w)| w * gait.strides.get(*i).map_or(0.0, |s| s.reach))
            .sum();
        let moving: f32 = ground.strides.iter().map(|(_, w)| w).sum();
        if reach > 1e-6 {
            rate += moving * further(motion.speed, self.speed.value) / reach;
            weight += moving;
        }
        let (side, turning) = ground.turn;
        if let Some(turn) = gait.turns[side].filter(|_| turning > 1e-6) {
            let way = further(motion.turn_rate, self.turning.value).abs();
            rate += turning * way / (turning * turn.reach);
            weight += turning;
        }
        if weight > 0.0 {
            (rate / weight).clamp(-FASTEST, FASTEST)
        } else {
            0.0
        }
    }

    /// Calls `each` with all clips that have a weight. The weights sum to 1.
    pub fn voices(&self, gait: &Gait, clips: &[Clip], mut each: impl FnMut(Voice)) {
        let ground = self.ground(gait);
        self.state.weights(|entered, weight| {
            let age = (self.clock - entered.since) as f32;
            let mut once = |clip: usize| {
                each(Voice {
                    clip,
                    time: age,
                    weight,
                });
            };
            match (entered.state, gait.air) {
                (LocomotionState::Jump, [Some(clip), ..])
                | (LocomotionState::Land, [.., Some(clip)]) => {
                    once(clip);
                }
                (LocomotionState::Fall, [_, Some(clip), _]) => each(Voice {
                    clip,
                    time: clips[clip].looped(age),
                    weight,
                }),
                _ => self.ground_voices(gait, clips, &ground, weight, &mut each),
            }
        });
    }

    fn ground_voices(
        &self,
        gait: &Gait,
        clips: &[Clip],
        ground: &Ground,
        weight: f32,
        each: &mut impl FnMut(Voice),
    ) {
        if ground.idle > 0.0 {
            let length = f64::from(clips[gait.idle].duration());
            let time = if length > 0.0 {
                self.clock % length
            } else {
                0.0
            };
            each(Voice {
                clip: gait.idle,
                time: time as f32,
                weight: weight * ground.idle,
            });
        }
        let mut step = |moving: &MoveClip, part: f32| {
            if part > 0.0 {
                each(Voice {
                    clip: moving.clip,
                    time: moving.warp.apply(self.phase) * moving.duration,
                    weight: weight * part,
                });
            }
        };
        for (index, part) in ground.strides {
            if let Some(stride) = gait.strides.get(index) {
                step(stride, part);
            }
        }
        if let Some(turn) = &gait.turns[ground.turn.0] {
            step(turn, ground.turn.1);
        }
    }

    /// Calls `each` with all one-shots that have a weight.
    pub fn overlays(&self, mut each: impl FnMut(Overlay)) {
        self.shot.weights(|shot, weight| {
            if let Some(one_shot) = shot.one_shot {
                each(Overlay {
                    one_shot,
                    time: (self.clock - shot.since) as f32,
                    weight,
                });
            }
        });
    }

    /// What the feet are to do in a frame of `dt` seconds.
    #[must_use]
    pub fn step(&self, gait: &Gait, dt: f32) -> Step {
        let ground = self.ground(gait);
        let stepping = ground.turn.1 + ground.strides.iter().map(|(_, part)| part).sum::<f32>();
        let own = 1.0 - self.whole(gait);
        Step {
            dt,
            firm: self.feet(gait).map(|firm| firm * own),
            ground: self.on_ground() * own,
            still: stepping < STANDS,
        }
    }

    /// How much of the legs belongs to one-shots of the whole body, whose feet are where their clips have them.
    fn whole(&self, gait: &Gait) -> f32 {
        let mut sum = 0.0;
        self.overlays(|over| {
            if let Some((_, None)) = gait.one_shots.get(over.one_shot) {
                sum += over.weight;
            }
        });
        sum.min(1.0)
    }

    /// How much of it is on the ground.
    fn on_ground(&self) -> f32 {
        let mut on_ground = 0.0;
        self.state.weights(|entered, weight| {
            if matches!(
                entered.state,
                LocomotionState::Ground | LocomotionState::Land
            ) {
                on_ground += weight;
            }
        });
        on_ground
    }

    /// How firmly the feet stand, left and right: 1 in stance, 0 in the middle of a swing or in the air.
    #[must_use]
    pub fn feet(&self, gait: &Gait) -> [f32; 2] {
        let ground = self.ground(gait);
        let on_ground = self.on_ground();
        let mut total = ground.turn.1;
        let mut stance = gait.turns[ground.turn.0]
            .map_or([0.0; 2], |turn| turn.stance.map(|s| s * ground.turn.1));
        for (index, part) in ground.strides {
            if let Some(stride) = gait.strides.get(index) {
                total += part;
                stance[0] += stride.stance[0] * part;
                stance[1] += stride.stance[1] * part;
            }
        }
        [0, 1].map(|side| {
            // Who hardly steps stands.
            if total < STANDS {
                return on_ground;
            }
            on_ground * firmness(self.phase - 0.5 * side as f32, stance[side] / total)
        })
    }
}
