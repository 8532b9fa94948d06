//! The walking figure, whose feet stand on the ground of the CPU reference. What it looks like is
//! [`hero`](crate::view::hero)'s concern.
//!
//! It walks in fixed steps and is drawn between the last two. Its place on the ground is f64;
//! the drawn feet are put on the ground under the drawn (f32) place, so rounding moves them along
//! the ground and never off it. Where the renderer has answered lately which triangle lies there, they
//! stand on the triangle; the walk itself knows the true ground alone, so that it is the same with and
//! without a renderer.

use bevy::math::{DVec2, ops};
use bevy::prelude::*;

use dolomite::character::CharacterMotion;
use dolomite::character::gait::Motion;
use dolomite::terrain::{Ground, GroundProbe, GroundSample, ProbeBatch, Terrain};

use super::Switches;
use super::camera::{CameraTarget, FreeCamera};
use super::jump::Jump;
use crate::input::PlayerInput;
use crate::scene::CurrentScene;
use crate::scene::reload::ReloadSystems;
use crate::settings::Settings;

/// Deepest water that the figure walks into, metres.
pub const WADING_DEPTH: f64 = 1.0;

/// Least distance of the figure from the edge of the ground, metres.
pub const EDGE: f64 = 2.0;

/// Time in which the facing goes 63 % of the way to the walked direction, seconds.
const TURN_TIME: f32 = 0.12;

/// How fast the velocity changes at most, m/s²: from standing to a run in half a second.
const ACCELERATION: f32 = 9.0;

/// Oldest answer of the renderer that the feet stand on, frames.
const OLDEST_DRAWN: u32 = 3;

/// The figure. Its `Transform` is at its feet, upright, and looks along its +z, as models of people do;
/// its [`CharacterMotion`] says what it does.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[require(Transform, Visibility, GroundProbe, CharacterMotion, CameraTarget)]
pub struct Figure {
    /// State after the last fixed step.
    pub now: Stance,
    /// State one fixed step before.
    pub before: Stance,
    /// A leap is wanted, and the fixed step has not seen it yet.
    pub leap: bool,
}

/// Where the figure stands and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stance {
    /// Place on the ground, (x, z), metres.
    pub place: DVec2,
    /// Facing, radians about +y; 0 faces −z.
    pub yaw: f32,
    /// Velocity along the surface, (x, z), metres a second.
    pub velocity: Vec2,
    /// Whether and how it is off the ground.
    pub jump: Jump,
}

impl Figure {
    /// A figure that stands at `place`, or on the nearest ground it may stand on.
    pub fn at(place: DVec2, terrain: &Terrain) -> Self {
        let place = nearest_stand(place, terrain);
        let stance = Stance {
            place,
            yaw: 0.0,
            velocity: Vec2::ZERO,
            jump: Jump::None,
        };
        Self {
            now: stance,
            before: stance,
            leap: false,
        }
    }

    /// The same figure, facing along `yaw`, radians.
    pub fn facing(mut self, yaw: f32) -> Self {
        self.now.yaw = yaw;
        self.before.yaw = yaw;
        self
    }
}

/// The set in which the figure walks (schedule `FixedUpdate`).
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FigureSystems;

/// Walks [`Figure`]s by [`PlayerInput`]. Needs no renderer.
pub struct FigurePlugin;

impl Plugin for FigurePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(FixedUpdate, walk.in_set(FigureSystems))
            .add_systems(
                PreUpdate,
                settle
                    .run_if(resource_changed::<CurrentScene>)
                    .after(ReloadSystems),
            )
            .add_systems(
                RunFixedMainLoop,
                (
                    // A wish of one frame must not be lost in frames without a fixed step.
                    ask_for_leaps.in_set(RunFixedMainLoopSystems::BeforeFixedMainLoop),
                    place_between_steps.in_set(RunFixedMainLoopSystems::AfterFixedMainLoop),
                ),
            );
    }
}

fn ask_for_leaps(
    input: Res<PlayerInput>,
    switches: Res<Switches>,
    mut figures: Query<&mut Figure>,
) {
    if input.jump || (switches.follow && input.fly.y > 0.0) {
        for mut figure in &mut figures {
            figure.leap = true;
        }
    }
}

/// One fixed step of every figure; "away" is away from the first camera.
fn walk(
    time: Res<Time>,
    input: Res<PlayerInput>,
    settings: Res<Settings>,
    switches: Res<Switches>,
    scene: Res<CurrentScene>,
    camera: Query<&FreeCamera>,
    mut figures: Query<&mut Figure>,
) {
    let yaw = camera.iter().next().map_or(0.0, |camera| camera.pose.yaw);
    let (sin, cos) = ops::sin_cos(yaw);
    let flown = match switches.follow {
        true => Vec2::new(input.fly.x, input.fly.z),
        false => Vec2::ZERO,
    };
    let wish = (input.walk + flown).clamp_length_max(1.0);
    // Camera right is (cos, −sin) on the ground (x, z), camera forward (−sin, −cos).
    let direction = Vec2::new(cos * wish.x - sin * wish.y, -sin * wish.x - cos * wish.y);
    let speed = if input.fast {
        settings.run_speed
    } else {
        settings.walk_speed
    };
    for mut figure in &mut figures {
        let now = stepped(
            figure.now,
            direction * speed,
            figure.leap,
            time.delta_secs(),
            &scene.terrain,
        );
        figure.set_if_neq(Figure {
            before: figure.now,
            now,
            leap: false,
        });
    }
}

/// The stance one step of `seconds` later; `wanted` is the velocity (x, z) along the surface that the
/// player wants, metres a second.
fn stepped(stance: Stance, wanted: Vec2, leap: bool, seconds: f32, terrain: &Terrain) -> Stance {
    // Who bends the knees for a leap stands.
    let wanted = match stance.jump {
        Jump::Bending { .. } => Vec2::ZERO,
        Jump::None | Jump::On { .. } | Jump::Air { .. } => wanted,
    };
    let change = (wanted - stance.velocity).clamp_length_max(ACCELERATION * seconds);
    let velocity = stance.velocity + change;
    let here = terrain.sample_f64(stance.place);
    let place = walked(
        stance.place,
        &here,
        (velocity * seconds).as_dvec2(),
        terrain,
    );
    let yaw = if wanted == Vec2::ZERO {
        stance.yaw
    } else {
        let goal = ops::atan2(-wanted.x, -wanted.y);
        stance.yaw + turn(stance.yaw, goal) * part(seconds, TURN_TIME)
    };
    let rise = match stance.jump {
        Jump::None | Jump::Bending { .. } => 0.0,
        Jump::On { .. } | Jump::Air { .. } => terrain.height(place) - here.height,
    };
    Stance {
        place,
        yaw,
        velocity,
        jump: stance.jump.stepped(leap, velocity.length(), rise, seconds),
    }
}

/// The shorter way from one facing to another, −π to π.
fn turn(from: f32, to: f32) -> f32 {
    (to - from + std::f32::consts::PI).rem_euclid(std::f32::consts::TAU) - std::f32::consts::PI
}

/// What a figure does, as far as its last step of `seconds` shows.
fn motion(figure: &Figure, seconds: f32) -> Motion {
    let Figure { now, before, .. } = figure;
    let way = (now.place - before.place).as_vec2() / seconds;
    let (sin, cos) = ops::sin_cos(now.yaw);
    let climb = now.jump.climb();
    Motion {
        speed: way.dot(Vec2::new(-sin, -cos)),
        turn_rate: turn(before.yaw, now.yaw) / seconds,
        climb: climb.unwrap_or(0.0),
        airborne: climb.is_some(),
        ..default()
    }
}

/// Part of the way that an exponential approach with time constant `time` covers in `seconds`.
fn part(seconds: f32, time: f32) -> f32 {
    1.0 - ops::exp(-seconds / time)
}

/// Where a step along the surface ends: straight, else along the shore, else where it began.
fn walked(from: DVec2, here: &GroundSample, step: DVec2, terrain: &Terrain) -> DVec2 {
    let length = step.length();
    if length == 0.0 {
        return from;
    }
    // Going up or down a slope s covers 1/sqrt(1 + s²) of the step on the plane.
    let slope = here.gradient.dot(step / length);
    let straight = step / (1.0 + slope * slope).sqrt();
    let shore = DVec2::new(-here.gradient.y, here.gradient.x).normalize_or_zero();
    let along = shore * straight.dot(shore);
    [straight, along]
        .into_iter()
        .map(|step| inside(from + step, terrain))
        .find(|to| may_step(from, *to, terrain))
        .unwrap_or(from)
}

pub(super) fn inside(place: DVec2, terrain: &Terrain) -> DVec2 {
    let extent = terrain.extent();
    // A ground narrower than twice the edge leaves its middle.
    let edge = DVec2::splat(EDGE).min((extent.max - extent.min) * 0.5);
    place.clamp(extent.min + edge, extent.max - edge)
}

/// Whether the figure may go there: not into deep water, unless it leaves deeper water.
fn may_step(from: DVec2, to: DVec2, terrain: &Terrain) -> bool {
    let depth = depth(to, terrain);
    depth <= WADING_DEPTH || depth < self::depth(from, terrain)
}

/// Depth of the water at a place, metres; negative on land, −∞ without a sea.
pub fn depth(place: DVec2, terrain: &Terrain) -> f64 {
    match terrain.sea_level() {
        Some(sea) => f64::from(sea) - terrain.height(place),
        None => f64::NEG_INFINITY,
    }
}

/// Puts a figure back on ground that was edited, if it stands in a part that was.
pub(super) fn settle_within(
    figure: &mut Mut<Figure>,
    terrain: &Terrain,
    within: impl Fn(DVec2) -> bool,
) {
    if !within(figure.now.place) {
        return;
    }
    let place = nearest_stand(figure.now.place, terrain);
    if place != figure.now.place {
        **figure = Figure::at(place, terrain);
    }
}

/// The nearest place, on rings around `wanted` that widen by an eighth, where the figure may
/// stand; `wanted` itself (inside the extent) when all is deep water.
fn nearest_stand(wanted: DVec2, terrain: &Terrain) -> DVec2 {
    /// Places tried on each ring.
    const AROUND: u32 = 48;
    let wanted = inside(wanted, terrain);
    if depth(wanted, terrain) <= WADING_DEPTH {
        return wanted;
    }
    let extent = terrain.extent();
    let widest = (extent.max - extent.min).length() as f32;
    let mut radius = 4.0;
    while radius < widest {
        for k in 0..AROUND {
            let (sin, cos) = ops::sin_cos(std::f32::consts::TAU * k as f32 / AROUND as f32);
            let place = inside(
                wanted + DVec2::new(f64::from(cos), f64::from(sin)) * f64::from(radius),
                terrain,
            );
            if depth(place, terrain) <= WADING_DEPTH {
                return place;
            }
        }
        radius *= 1.125;
    }
    wanted
}

/// Puts figures between their last two steps, feet on the ground, and says what they do.
fn place_between_steps(
    time: Res<Time<Fixed>>,
    scene: Res<CurrentScene>,
    probes: Option<Res<ProbeBatch>>,
    mut figures: Query<(&Figure, &GroundProbe, &mut Transform, &mut CharacterMotion)>,
) {
    // The frame that is being made; without the plugin that answers there is nothing to be fresh.
    let frame = probes.map_or(0, |probes| probes.frame().wrapping_add(1));
    let seconds = time.timestep().as_secs_f32();
    for (figure, probe, mut transform, mut doing) in &mut figures {
        let ground = |place: DVec2| {
            let truth = scene.terrain.sample_f64(place);
            probe
                .answer(place, truth, frame, OLDEST_DRAWN)
                .sample
                .height
        };
        let drawn = drawn(figure, time.overstep_fraction(), ground);
        transform.set_if_neq(drawn);
        doing.set_if_neq(CharacterMotion(motion(figure, seconds)));
    }
}

/// The transform of the feet, `overstep` (0 to 1) of the way from the step before to the last, on the
/// height that `ground` has at a place.
fn drawn(figure: &Figure, overstep: f32, ground: impl Fn(DVec2) -> f64) -> Transform {
    let Figure { now, before, .. } = figure;
    let share = f64::from(overstep);
    let place = before.place.lerp(now.place, share).as_vec2();
    let lift = before.jump.lift() * (1.0 - share) + now.jump.lift() * share;
    let height = (ground(place.as_dvec2()) + lift) as f32;
    let yaw = before.yaw + (now.yaw - before.yaw) * overstep;
    Transform {
        translation: Vec3::new(place.x, height, place.y),
        // Facing 0 is −z, and the figure looks along its +z.
        rotation: Quat::from_rotation_y(yaw + std::f32::consts::PI),
        scale: Vec3::ONE,
    }
}

/// Puts figures back on the ground after the ground has changed.
fn settle(scene: Res<CurrentScene>, mut figures: Query<&mut Figure>) {
    for mut figure in &mut figures {
        let place = nearest_stand(figure.now.place, &scene.terrain);
        if place != figure.now.place {
            *figure = Figure::at(place, &scene.terrain);
        }
    }
}
