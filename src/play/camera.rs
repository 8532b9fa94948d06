//! The free camera: where it is, where it looks, how it flies.
//!
//! Position in f64, so that slow flight far from the origin does not stick; Bevy's `Transform`
//! receives it rounded. Yaw 0 looks north (−z) and grows to the left, pitch grows upwards.

use bevy::math::{DVec3, ops};
use bevy::prelude::*;
use dolomite::terrain::GroundRect;

use super::Switches;
use crate::input::PlayerInput;
use crate::scene::{CurrentScene, PITCH_LIMIT, Pose};
use crate::settings::{FOV_RANGE, Settings};

/// Time in which the velocity of the camera goes 63 % of the way to the wanted one, seconds.
const RESPONSE: f32 = 0.12;

/// Field of view after one wheel step over that before.
const ZOOM_STEP: f32 = 0.9;

/// How far beyond the extent of the ground the camera may fly, metres.
const MARGIN: f64 = 500.0;

/// Greatest height of the camera, metres: the sky is computed as it is seen from the ground.
const CEILING: f64 = 20_000.0;

/// A camera that follows looks at this height above the feet and from this far away, metres, and goes
/// 63 % of the way to another height in this time, seconds.
const EYES: f64 = 1.5;
const AWAY: f64 = 4.5;
const RISE: f32 = 0.15;

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

/// Whom cameras that follow look at: the first one's `Transform` is at its feet.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[require(Transform)]
pub struct CameraTarget;

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
    targets: Query<&Transform, With<CameraTarget>>,
    mut cameras: Query<&mut FreeCamera>,
) {
    let followed = targets.iter().next().filter(|_| switches.follow);
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
            Some(target) => follow(&mut next, target.translation, time.delta_secs()),
            None => next.followed = None,
        }
        let pose = scene.lifted(contained(next.pose, scene.terrain.extent()));
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
}
