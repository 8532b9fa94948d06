//! The walking figure: a capsule whose feet stand on the ground of the CPU twin.
//!
//! It walks in fixed steps and is drawn between the last two. Its place on the ground is f64;
//! the drawn feet are put on the ground under the drawn (f32) place, so rounding moves them along
//! the ground and never off it. Where the renderer has answered lately which triangle lies there, they
//! stand on the triangle; the walk itself knows the true ground alone, so that it is the same with and
//! without a renderer.

use bevy::math::{DVec2, ops};
use bevy::prelude::*;

use dolomite_terrain::{Ground, GroundProbe, GroundSample, ProbeBatch, Terrain};

use super::camera::FreeCamera;
use super::input::PlayerInput;
use super::scenes::CurrentScene;
use super::settings::Settings;

/// Deepest water that the figure walks into, metres.
pub const WADING_DEPTH: f64 = 1.0;

/// Least distance of the figure from the edge of the ground, metres.
pub const EDGE: f64 = 2.0;

/// Part of the slope's tilt that the figure takes over: it leans, but does not lie.
const LEAN: f32 = 0.45;

/// Time in which the lean goes 63 % of the way to its goal, seconds.
const LEAN_TIME: f32 = 0.18;

/// Time in which the facing goes 63 % of the way to the walked direction, seconds.
const TURN_TIME: f32 = 0.10;

/// Oldest answer of the renderer that the feet stand on, frames.
const OLDEST_DRAWN: u32 = 3;

/// The figure. Its `Transform` is at its feet.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[require(Transform, Visibility, GroundProbe)]
pub struct Figure {
    /// State after the last fixed step.
    pub now: Stance,
    /// State one fixed step before.
    pub before: Stance,
}

/// Where the figure stands and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stance {
    /// Place on the ground, (x, z), metres.
    pub place: DVec2,
    /// Facing, radians about +y; 0 faces −z.
    pub yaw: f32,
    /// Direction of the body, a unit vector.
    pub up: Vec3,
}

impl Figure {
    /// A figure that stands at `place`, or on the nearest ground it may stand on.
    pub fn at(place: DVec2, terrain: &Terrain) -> Self {
        let place = nearest_stand(place, terrain);
        let stance = Stance {
            place,
            yaw: 0.0,
            up: leaning(&terrain.sample_f64(place)),
        };
        Self {
            now: stance,
            before: stance,
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
                RunFixedMainLoop,
                place_between_steps.in_set(RunFixedMainLoopSystems::AfterFixedMainLoop),
            );
    }
}

/// One fixed step of every figure; "away" is away from the first camera.
fn walk(
    time: Res<Time>,
    input: Res<PlayerInput>,
    settings: Res<Settings>,
    scene: Res<CurrentScene>,
    camera: Query<&FreeCamera>,
    mut figures: Query<&mut Figure>,
) {
    let yaw = camera.iter().next().map_or(0.0, |camera| camera.pose.yaw);
    let (sin, cos) = ops::sin_cos(yaw);
    let wish = input.walk.clamp_length_max(1.0);
    // Camera right is (cos, −sin) on the ground (x, z), camera forward (−sin, −cos).
    let direction = Vec2::new(cos * wish.x - sin * wish.y, -sin * wish.x - cos * wish.y);
    let speed = settings.walk_speed
        * if input.fast {
            settings.fast_factor
        } else {
            1.0
        };
    for mut figure in &mut figures {
        let now = stepped(
            figure.now,
            direction * speed,
            time.delta_secs(),
            &scene.terrain,
        );
        figure.set_if_neq(Figure {
            before: figure.now,
            now,
        });
    }
}

/// The stance one step of `seconds` later, walking with `velocity` (x, z) in metres a second
/// along the surface.
fn stepped(stance: Stance, velocity: Vec2, seconds: f32, terrain: &Terrain) -> Stance {
    let here = terrain.sample_f64(stance.place);
    let place = walked(
        stance.place,
        &here,
        (velocity * seconds).as_dvec2(),
        terrain,
    );
    let yaw = if velocity == Vec2::ZERO {
        stance.yaw
    } else {
        let goal = ops::atan2(-velocity.x, -velocity.y);
        let turn = (goal - stance.yaw + std::f32::consts::PI).rem_euclid(std::f32::consts::TAU)
            - std::f32::consts::PI;
        stance.yaw + turn * part(seconds, TURN_TIME)
    };
    let goal = leaning(&terrain.sample_f64(place));
    let mut up = stance
        .up
        .lerp(goal, part(seconds, LEAN_TIME))
        .normalize_or(Vec3::Y);
    // Arrived: a standing figure must stop changing.
    if up.distance_squared(goal) < 1e-10 {
        up = goal;
    }
    Stance { place, yaw, up }
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

fn inside(place: DVec2, terrain: &Terrain) -> DVec2 {
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

/// The direction of a body that leans with the slope.
fn leaning(ground: &GroundSample) -> Vec3 {
    Vec3::Y
        .lerp(ground.normal().as_vec3(), LEAN)
        .normalize_or(Vec3::Y)
}

/// Draws figures between their last two steps, feet on the ground.
fn place_between_steps(
    time: Res<Time<Fixed>>,
    scene: Res<CurrentScene>,
    probes: Option<Res<ProbeBatch>>,
    mut figures: Query<(&Figure, &GroundProbe, &mut Transform)>,
) {
    // The frame that is being made; without the plugin that answers there is nothing to be fresh.
    let frame = probes.map_or(0, |probes| probes.frame().wrapping_add(1));
    for (figure, probe, mut transform) in &mut figures {
        let ground = |place: DVec2| {
            let truth = scene.terrain.sample_f64(place);
            probe
                .answer(place, truth, frame, OLDEST_DRAWN)
                .sample
                .height
        };
        let drawn = drawn(figure, time.overstep_fraction(), ground);
        transform.set_if_neq(drawn);
    }
}

/// The transform of the feet, `overstep` (0 to 1) of the way from the step before to the last, on the
/// height that `ground` has at a place.
fn drawn(figure: &Figure, overstep: f32, ground: impl Fn(DVec2) -> f64) -> Transform {
    let Figure { now, before } = figure;
    let place = before.place.lerp(now.place, f64::from(overstep)).as_vec2();
    let height = ground(place.as_dvec2()) as f32;
    // Equal ends would still be rounded differently for each overstep: a standing figure stands.
    let up = if before.up == now.up {
        now.up
    } else {
        before.up.lerp(now.up, overstep).normalize_or(Vec3::Y)
    };
    let yaw = before.yaw + (now.yaw - before.yaw) * overstep;
    Transform {
        translation: Vec3::new(place.x, height, place.y),
        rotation: Quat::from_rotation_arc(Vec3::Y, up) * Quat::from_rotation_y(yaw),
        scale: Vec3::ONE,
    }
}

/// Puts the figure back on the ground after the ground has changed.
pub fn settle(figure: &mut Figure, terrain: &Terrain) {
    let place = nearest_stand(figure.now.place, terrain);
    if place != figure.now.place {
        *figure = Figure::at(place, terrain);
    }
}
