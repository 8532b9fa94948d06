//! The free camera: where it is, where it looks, how it flies.
//!
//! Position in f64, so that slow flight far from the origin does not stick; Bevy's `Transform`
//! receives it rounded. Yaw 0 looks north (−z) and grows to the left, pitch grows upwards.

use bevy::math::{DVec2, DVec3, ops};
use bevy::prelude::*;

use dolomite_terrain::{Ground, GroundRect};

use super::input::PlayerInput;
use super::player::Figure;
use super::scenes::CurrentScene;
use super::settings::{FOV_RANGE, Settings};
use super::simulation::Switches;

/// Furthest that the view tips up or down, radians: 89 degrees, so that "up" stays defined.
pub const PITCH_LIMIT: f32 = 89.0 * std::f32::consts::PI / 180.0;

/// Least height of the camera above ground and sea, metres.
pub const CLEARANCE: f64 = 1.0;

/// Time in which the velocity of the camera goes 63 % of the way to the wanted one, seconds.
const RESPONSE: f32 = 0.12;

/// Field of view after one wheel step over that before.
const ZOOM_STEP: f32 = 0.9;

/// How far beyond the extent of the ground the camera may fly, metres.
const MARGIN: f64 = 500.0;

/// Greatest height of the camera, metres: the sky is computed as it is seen from the ground.
const CEILING: f64 = 20_000.0;

/// Where [`Pose::behind`] stands: metres back, metres above the ground under the figure, and the
/// pitch, radians. A figure of 1.8 m then fills a fifth of the height of the default view, at its
/// lower edge, and leaves the rest to the mountain.
const BEHIND: f64 = 9.0;
const OVER: f64 = 2.4;
const LOOKING_UP: f32 = 9.0 * std::f32::consts::PI / 180.0;

/// A camera that follows looks at this height above the feet and from this far away, metres, and goes
/// 63 % of the way to another height in this time, seconds.
const EYES: f64 = 1.5;
const AWAY: f64 = 4.5;
const RISE: f32 = 0.15;

/// Where a camera stands and looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// World position, metres.
    pub position: DVec3,
    /// Turn about +y, radians; 0 looks to −z, a quarter turn to −x.
    pub yaw: f32,
    /// Tip upwards, radians, −[`PITCH_LIMIT`] to [`PITCH_LIMIT`].
    pub pitch: f32,
}

impl Pose {
    /// The rotation of the camera.
    pub fn rotation(&self) -> Quat {
        Quat::from_euler(EulerRot::YXZ, self.yaw, self.pitch, 0.0)
    }

    /// A pose at `position` that looks at `target`.
    pub fn looking_at(position: DVec3, target: DVec3) -> Self {
        let to = (target - position).as_vec3();
        let level = Vec2::new(to.x, to.z).length();
        Self {
            position,
            yaw: ops::atan2(-to.x, -to.z),
            pitch: ops::atan2(to.y, level).clamp(-PITCH_LIMIT, PITCH_LIMIT),
        }
    }

    /// A pose behind someone who stands at `place` (x, z) and looks along `yaw` (radians), so that
    /// they and what lies ahead of them are in the picture.
    pub fn behind(place: DVec2, yaw: f32, ground: &impl Ground) -> Self {
        let (sin, cos) = ops::sin_cos(yaw);
        let back = DVec2::new(f64::from(sin), f64::from(cos)) * BEHIND;
        let at = place + back;
        Self {
            position: DVec3::new(at.x, ground.height(place) + OVER, at.y),
            yaw,
            pitch: LOOKING_UP,
        }
    }

    /// The same pose, lifted where it must be so that it is [`CLEARANCE`] above ground and sea.
    pub fn above(mut self, ground: &impl Ground, sea: Option<f32>) -> Self {
        let floor = ground
            .height(DVec2::new(self.position.x, self.position.z))
            .max(sea.map_or(f64::NEG_INFINITY, f64::from));
        self.position.y = self.position.y.max(floor + CLEARANCE);
        self
    }
}

/// The camera that the player flies.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[require(Transform)]
pub struct FreeCamera {
    /// Where it is and looks.
    pub pose: Pose,
    /// Velocity, metres a second.
    pub velocity: Vec3,
    /// Vertical field of view, degrees, in [`FOV_RANGE`].
    pub fov: f32,
    /// Height of the feet that it follows, as smooth as it follows them, metres; `None` while it flies.
    pub followed: Option<f64>,
}

/// The set in which cameras move (schedule `Update`).
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CameraSystems;

/// Moves [`FreeCamera`]s by [`PlayerInput`]. Needs no renderer.
pub struct CameraPlugin;

impl Plugin for CameraPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Update, (steer, place).chain().in_set(CameraSystems));
    }
}

/// Turns, zooms and flies the cameras, and keeps them above the ground.
pub fn steer(
    time: Res<Time>,
    input: Res<PlayerInput>,
    settings: Res<Settings>,
    switches: Res<Switches>,
    scene: Res<CurrentScene>,
    figures: Query<&Transform, With<Figure>>,
    mut cameras: Query<&mut FreeCamera>,
) {
    let followed = figures.iter().next().filter(|_| switches.follow);
    let input = match followed {
        // What else flies the camera walks the figure.
        Some(_) => PlayerInput {
            fly: Vec3::ZERO,
            ..*input
        },
        None => *input,
    };
    for mut camera in &mut cameras {
        let mut next = steered(*camera, &input, &settings, time.delta_secs());
        match followed {
            Some(figure) => follow(&mut next, figure.translation, time.delta_secs()),
            None => next.followed = None,
        }
        let mut pose = contained(next.pose, scene.terrain.extent());
        // The classic scene's path is what it is, through a hill as well.
        if scene.classic.is_none() {
            pose = pose.above(&scene.terrain, scene.terrain.sea_level());
        }
        camera.set_if_neq(FreeCamera { pose, ..next });
    }
}

/// Puts the camera where someone at `feet` is before it, as it looks.
fn follow(camera: &mut FreeCamera, feet: Vec3, seconds: f32) {
    let feet = feet.as_dvec3();
    // Every stone underfoot would shake the picture.
    let height = match camera.followed {
        Some(height) if (height - feet.y).abs() > 1e-3 => {
            height + (feet.y - height) * f64::from(1.0 - ops::exp(-seconds / RISE))
        }
        _ => feet.y,
    };
    let head = DVec3::new(feet.x, height + EYES, feet.z);
    let ahead = (camera.pose.rotation() * Vec3::NEG_Z).as_dvec3();
    camera.pose.position = head - ahead * AWAY;
    camera.velocity = Vec3::ZERO;
    camera.followed = Some(height);
}

/// The camera one time step later, without regard to the ground.
fn steered(
    camera: FreeCamera,
    input: &PlayerInput,
    settings: &Settings,
    seconds: f32,
) -> FreeCamera {
    let FreeCamera {
        mut pose,
        velocity,
        fov,
        followed,
    } = camera;
    // The narrower the view, the finer the turn: a pixel of mouse is a pixel of picture.
    let fineness = fov / settings.fov.max(1.0);
    pose.yaw = (pose.yaw - input.look.x * fineness).rem_euclid(std::f32::consts::TAU);
    pose.pitch = (pose.pitch + input.look.y * fineness).clamp(-PITCH_LIMIT, PITCH_LIMIT);

    // Forward follows the view, up and down do not tip with it.
    let forward = pose.rotation() * Vec3::NEG_Z;
    let right = Quat::from_rotation_y(pose.yaw) * Vec3::X;
    let wish = right * input.fly.x + Vec3::Y * input.fly.y + forward * input.fly.z;
    let speed = settings.fly_speed
        * if input.fast {
            settings.fast_factor
        } else {
            1.0
        };
    let wanted = wish.clamp_length_max(1.0) * speed;
    let mut velocity = velocity.lerp(wanted, 1.0 - ops::exp(-seconds / RESPONSE));
    // A millimetre a second is rest; without this the camera would never be still.
    if wanted == Vec3::ZERO && velocity.length() < 1e-3 {
        velocity = Vec3::ZERO;
    }
    pose.position += (velocity * seconds).as_dvec3();

    FreeCamera {
        pose,
        velocity,
        followed,
        fov: (fov * ops::powf(ZOOM_STEP, input.zoom)).clamp(FOV_RANGE.0, FOV_RANGE.1),
    }
}

fn contained(mut pose: Pose, extent: GroundRect) -> Pose {
    let margin = DVec3::new(MARGIN, 0.0, MARGIN);
    let low = DVec3::new(extent.min.x, f64::NEG_INFINITY, extent.min.y) - margin;
    let high = DVec3::new(extent.max.x, CEILING, extent.max.y) + margin;
    pose.position = pose.position.clamp(low, high);
    pose
}

/// Writes pose and field of view to the components that Bevy reads.
fn place(
    mut cameras: Query<(&FreeCamera, &mut Transform, Option<&mut Projection>), Changed<FreeCamera>>,
) {
    for (camera, mut transform, projection) in &mut cameras {
        *transform = Transform {
            translation: camera.pose.position.as_vec3(),
            rotation: camera.pose.rotation(),
            scale: Vec3::ONE,
        };
        if let Some(mut projection) = projection
            && let Projection::Perspective(perspective) = &mut *projection
        {
            perspective.fov = camera.fov.to_radians();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level() -> FreeCamera {
        FreeCamera {
            pose: Pose {
                position: DVec3::new(0.0, 100.0, 0.0),
                yaw: 0.0,
                pitch: 0.0,
            },
            velocity: Vec3::ZERO,
            fov: 55.0,
            followed: None,
        }
    }

    fn run(camera: FreeCamera, input: PlayerInput, seconds: f32) -> FreeCamera {
        steered(camera, &input, &Settings::default(), seconds)
    }

    #[test]
    fn pitch_stops_at_89_degrees_both_ways() {
        for (look, limit) in [(100.0, PITCH_LIMIT), (-100.0, -PITCH_LIMIT)] {
            let input = PlayerInput {
                look: Vec2::new(0.0, look),
                ..default()
            };
            assert_eq!(run(level(), input, 0.01).pose.pitch, limit);
        }
    }

    #[test]
    fn looking_right_turns_east_and_w_flies_there() {
        let input = PlayerInput {
            look: Vec2::new(std::f32::consts::FRAC_PI_2, 0.0),
            fly: Vec3::Z,
            ..default()
        };
        let camera = run(level(), input, 0.1);
        let moved = camera.pose.position - level().pose.position;
        assert!(moved.x > 1.0 && moved.z.abs() < 1e-3, "{moved}");
    }

    #[test]
    fn zoom_stays_in_range_and_a_still_camera_comes_to_rest() {
        for zoom in [500.0, -500.0] {
            let input = PlayerInput { zoom, ..default() };
            let fov = run(level(), input, 0.01).fov;
            assert!(fov == FOV_RANGE.0 || fov == FOV_RANGE.1);
        }
        let mut camera = run(
            level(),
            PlayerInput {
                fly: Vec3::X,
                ..default()
            },
            0.5,
        );
        assert!(camera.velocity.length() > 1.0);
        for _ in 0..300 {
            camera = run(camera, PlayerInput::default(), 1.0 / 60.0);
        }
        assert_eq!(camera.velocity, Vec3::ZERO);
        assert_eq!(run(camera, PlayerInput::default(), 1.0 / 60.0), camera);
    }

    #[test]
    fn from_behind_the_figure_is_ahead_and_below_the_middle() {
        struct Flat;
        impl Ground for Flat {
            fn sample(&self, _: DVec2) -> dolomite_terrain::GroundSample {
                dolomite_terrain::GroundSample {
                    height: 7.0,
                    ..default()
                }
            }
        }
        let place = DVec2::new(100.0, -50.0);
        for yaw in [0.0, 1.0, 3.0, 5.0] {
            let pose = Pose::behind(place, yaw, &Flat);
            let middle = DVec3::new(place.x, 7.0 + 0.9, place.y);
            let seen = pose.rotation().inverse() * (middle - pose.position).as_vec3();
            assert!(seen.x.abs() < 1e-4 && seen.z < -8.0, "{seen}");
            // Below the middle, and within the lower half of the default view of 55 degrees.
            let down = -seen.y / -seen.z;
            assert!(down > 0.0 && down < 0.52, "{seen}");
        }
    }

    #[test]
    fn looking_at_a_point_points_there() {
        let from = DVec3::new(10.0, 20.0, 30.0);
        for to in [
            DVec3::new(-50.0, 0.0, 10.0),
            DVec3::new(60.0, 90.0, 31.0),
            DVec3::new(10.0, 20.0, 200.0),
        ] {
            let pose = Pose::looking_at(from, to);
            let ahead = pose.rotation() * Vec3::NEG_Z;
            let wanted = (to - from).as_vec3().normalize();
            // Two f32 rotations and two arc tangents: a few units in the last place.
            assert!(ahead.distance(wanted) < 1e-5, "{ahead} {wanted}");
        }
    }
}
