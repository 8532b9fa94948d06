//! Where the model stands: camera, lights, floor, and the picture of `--shot`.

use bevy::camera::primitives::Aabb;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::input::mouse::{AccumulatedMouseMotion, AccumulatedMouseScroll, MouseScrollUnit};
use bevy::light::CascadeShadowConfigBuilder;
use bevy::math::Vec3A;
use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk};

use super::{Arguments, Model, Shown, State};

/// Camera, lights, floor.
pub struct StagePlugin;

impl Plugin for StagePlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(ClearColor(Color::srgb(0.20, 0.22, 0.25)))
            .insert_resource(GlobalAmbientLight {
                color: Color::srgb(0.85, 0.92, 1.0),
                brightness: 500.0,
                ..default()
            })
            .add_systems(Startup, build)
            .add_systems(Update, (frame, turn, picture));
    }
}

/// The camera's place about the model; angles in radians, lengths in metres.
#[derive(Component, Clone, Copy, PartialEq)]
struct Orbit {
    centre: Vec3,
    distance: f32,
    yaw: f32,
    pitch: f32,
    /// Diagonal of what is shown.
    size: f32,
}

#[derive(Component)]
struct Floor;

#[derive(Component)]
struct Key;

/// Frames that a model is looked for in its scene: bounds of meshes come a frame after it.
const PATIENCE: u32 = 10;

/// Frames before a picture: pipelines are compiled meanwhile.
const FRAMES: u32 = 40;

fn build(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((
        Camera3d::default(),
        Tonemapping::AgX,
        Orbit {
            centre: Vec3::Y,
            distance: 4.0,
            yaw: 0.5,
            pitch: 0.2,
            size: 2.0,
        },
    ));
    commands.spawn((
        Key,
        DirectionalLight {
            illuminance: 7_000.0,
            shadow_maps_enabled: true,
            ..default()
        },
        Transform::from_xyz(1.2, 2.0, 1.6).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    commands.spawn((
        DirectionalLight {
            color: Color::srgb(0.8, 0.88, 1.0),
            illuminance: 2_200.0,
            ..default()
        },
        Transform::from_xyz(-1.6, 0.8, -1.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    commands.spawn((
        Floor,
        Mesh3d(meshes.add(Circle::new(1.0).mesh().resolution(96))),
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color: Color::srgb(0.32, 0.33, 0.35),
            perceptual_roughness: 0.95,
            ..default()
        })),
        Visibility::Hidden,
    ));
}

/// Moves camera, floor and shadows to a model that has come.
fn frame(
    mut commands: Commands,
    shown: Res<Shown>,
    mut waited: Local<u32>,
    models: Query<Entity, With<Model>>,
    children: Query<&Children>,
    bounds: Query<(&GlobalTransform, &Aabb)>,
    mut orbit: Single<&mut Orbit>,
    floor: Single<(&mut Transform, &mut Visibility), With<Floor>>,
    key: Single<Entity, With<Key>>,
) {
    if shown.state != State::Ready {
        *waited = 0;
        return;
    }
    *waited += 1;
    if *waited > PATIENCE {
        return;
    }
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for model in &models {
        for below in children.iter_descendants(model) {
            let Ok((place, aabb)) = bounds.get(below) else {
                continue;
            };
            for corner in 0..8 {
                let side = |axis: u32| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
                let corner = aabb.half_extents * Vec3A::new(side(0), side(1), side(2));
                let at = place.transform_point(Vec3::from(aabb.center + corner));
                (low, high) = (low.min(at), high.max(at));
            }
        }
    }
    if !(low.is_finite() && high.is_finite()) {
        return;
    }
    let size = (high - low).length().max(1e-3);
    **orbit = Orbit {
        centre: 0.5 * (low + high),
        distance: 1.25 * size,
        size,
        ..**orbit
    };
    let (mut place, mut visibility) = floor.into_inner();
    let under = Vec3::new(
        0.5 * (low.x + high.x),
        low.y - 1e-3 * size,
        0.5 * (low.z + high.z),
    );
    *place = Transform {
        translation: under,
        rotation: Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2),
        scale: Vec3::splat(1.5 * size),
    };
    *visibility = Visibility::Visible;
    let cascades = CascadeShadowConfigBuilder {
        minimum_distance: 0.01 * size,
        first_cascade_far_bound: 1.2 * size,
        maximum_distance: 5.0 * size,
        ..default()
    };
    commands.entity(*key).insert(cascades.build());
}

/// Drag to go round, right-drag to move aside, the wheel to come closer, Home to begin anew.
fn turn(
    buttons: Res<ButtonInput<MouseButton>>,
    motion: Res<AccumulatedMouseMotion>,
    scroll: Res<AccumulatedMouseScroll>,
    camera: Single<(&mut Orbit, &mut Transform, &mut Projection)>,
) {
    let (mut orbit, mut transform, mut projection) = camera.into_inner();
    let mut next = *orbit;
    if buttons.pressed(MouseButton::Left) {
        next.yaw -= 0.006 * motion.delta.x;
        next.pitch = (next.pitch + 0.006 * motion.delta.y).clamp(-1.5, 1.5);
    }
    if buttons.pressed(MouseButton::Right) {
        let aside = transform.rotation * Vec3::new(-motion.delta.x, motion.delta.y, 0.0);
        next.centre += aside * 0.0012 * next.distance;
    }
    let steps = match scroll.unit {
        MouseScrollUnit::Line => scroll.delta.y,
        MouseScrollUnit::Pixel => scroll.delta.y / 40.0,
    };
    let nearest = 0.02 * next.size;
    next.distance = (next.distance * (1.0 - 0.1 * steps)).clamp(nearest, 20.0 * next.size);
    orbit.set_if_neq(next);
    let rotation = Quat::from_euler(EulerRot::YXZ, next.yaw, -next.pitch, 0.0);
    let at = Transform::from_translation(next.centre + rotation * Vec3::Z * next.distance)
        .with_rotation(rotation);
    transform.set_if_neq(at);
    if let Projection::Perspective(lens) = &mut *projection
        && (lens.near - 0.01 * next.size).abs() > 1e-4 * next.size
    {
        lens.near = 0.01 * next.size;
        lens.far = 100.0 * next.size;
    }
}

fn picture(
    mut commands: Commands,
    arguments: Res<Arguments>,
    shown: Res<Shown>,
    mut frames: Local<u32>,
    mut exit: MessageWriter<AppExit>,
) {
    let Some(path) = &arguments.shot else { return };
    if let State::Failed(_) = shown.state {
        exit.write(AppExit::from_code(1));
        return;
    }
    *frames += u32::from(shown.state == State::Ready);
    if *frames == FRAMES {
        commands
            .spawn(Screenshot::primary_window())
            .observe(save_to_disk(path.clone()))
            .observe(
                |_: On<ScreenshotCaptured>, mut exit: MessageWriter<AppExit>| {
                    exit.write(AppExit::Success);
                },
            );
    }
}
