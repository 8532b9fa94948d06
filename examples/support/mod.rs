//! What the examples share: a window, a camera that circles its subject, a picture of it.
//!
//! `--shot FILE.png` saves a picture once the scene stands, and ends the app.

use bevy::anti_alias::smaa::Smaa;
use bevy::camera::{Exposure, Hdr};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::pbr::DefaultOpaqueRendererMethod;
use bevy::post_process::bloom::Bloom;
use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk};
use bevy::window::WindowResolution;
use dolomite::tessellation::GeometryCamera;
use dolomite::tessellation::render::GeometryStats;

/// Frames before the picture: shaders are compiled, textures are there.
const FRAMES: u32 = 60;

/// An app with a window; drag or use the arrow keys to go round, the wheel or +/− to come closer.
pub fn app(title: &str) -> App {
    let mut app = App::new();
    app.insert_resource(DefaultOpaqueRendererMethod::deferred())
        .insert_resource(ClearColor(Color::BLACK))
        .add_plugins(DefaultPlugins.set(WindowPlugin {
            primary_window: Some(Window {
                title: title.into(),
                resolution: WindowResolution::new(960, 540),
                ..default()
            }),
            ..default()
        }))
        .add_systems(Update, (circle, show_counts, picture));
    app
}

/// Where the camera stands: round `centre` at `distance`, angles in radians.
#[derive(Component, Clone, Copy)]
pub struct Circle {
    pub centre: Vec3,
    pub distance: f32,
    pub yaw: f32,
    pub pitch: f32,
}

/// The camera of an example; its exposure in EV at ISO 100.
pub fn camera(circle: Circle, pixels_per_edge: f32, ev100: f32) -> impl Bundle {
    (
        Camera3d::default(),
        Hdr,
        Msaa::Off,
        Exposure { ev100 },
        Tonemapping::AgX,
        Bloom::NATURAL,
        Smaa::default(),
        GeometryCamera {
            pixels_per_edge,
            ..default()
        },
        circle,
    )
}

/// A light from above with shadows, in lux, and the sky's, in cd/m².
pub fn light(sun: f32, sky: f32) -> impl Bundle {
    (
        DirectionalLight {
            illuminance: sun,
            shadow_maps_enabled: true,
            ..default()
        },
        Sky(sky),
        Transform::from_xyz(3.0, 4.0, 2.0).looking_at(Vec3::ZERO, Vec3::Y),
    )
}

/// Brightness of the sky, cd/m².
#[derive(Component)]
pub struct Sky(f32);

fn circle(
    time: Res<Time>,
    keys: Res<ButtonInput<KeyCode>>,
    mut cameras: Query<(&mut Circle, &mut Transform)>,
    lights: Query<&Sky, Added<Sky>>,
    mut ambient: ResMut<GlobalAmbientLight>,
) {
    for light in &lights {
        ambient.brightness = light.0;
    }
    let held = |less, more| f32::from(keys.pressed(more)) - f32::from(keys.pressed(less));
    let step = time.delta_secs();
    for (mut circle, mut transform) in &mut cameras {
        let turn = held(KeyCode::ArrowLeft, KeyCode::ArrowRight) * step;
        let tilt = held(KeyCode::ArrowDown, KeyCode::ArrowUp) * step;
        let closer = held(KeyCode::Minus, KeyCode::Equal) * step;
        if turn != 0.0 || tilt != 0.0 || closer != 0.0 {
            circle.yaw += turn;
            circle.pitch = (circle.pitch + tilt).clamp(-1.5, 1.5);
            circle.distance *= 1.0 - closer;
        }
        let rotation = Quat::from_euler(EulerRot::YXZ, circle.yaw, -circle.pitch, 0.0);
        let at = Transform::from_translation(circle.centre + rotation * Vec3::Z * circle.distance)
            .looking_at(circle.centre, Vec3::Y);
        transform.set_if_neq(at);
    }
}

fn show_counts(
    stats: Res<GeometryStats>,
    mut window: Single<&mut Window>,
    mut shown: Local<String>,
) {
    let counts = format!(
        "{} triangles and segments, {} vertices, {} dispatches",
        stats.primitives, stats.vertices, stats.dispatches
    );
    if *shown != counts {
        window.title = format!(
            "{} — {counts}",
            window.title.split(" — ").next().unwrap_or("")
        );
        *shown = counts;
    }
}

fn picture(mut commands: Commands, stats: Res<GeometryStats>, mut frame: Local<u32>) {
    let mut arguments = std::env::args().skip_while(|argument| argument != "--shot");
    let Some(path) = arguments.nth(1) else {
        return;
    };
    // Compiling may take long: only frames that show something count.
    *frame += u32::from(stats.primitives > 0);
    if *frame == FRAMES {
        println!("{stats:?}");
        commands
            .spawn(Screenshot::primary_window())
            .observe(save_to_disk(path))
            .observe(
                |_: On<ScreenshotCaptured>, mut exit: MessageWriter<AppExit>| {
                    exit.write(AppExit::Success);
                },
            );
    }
}
