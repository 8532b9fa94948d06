//! What a scene does not need costs nothing: in an app that renders, the plugin without its components
//! adds no image, no pipeline and no pass; by day there is nothing of the night.
use crate::support::renders;

use bevy::camera::RenderTarget;
use bevy::color::Luminance;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::{PipelineCache, PollType, TextureFormat};
use bevy::render::renderer::RenderDevice;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use dolomite_sky::{Sky, SkyPlugin, Sun};
use dolomite_tessellation::render::{GeometryCensus, GeometryStats, census};

/// An app that renders, with the plugin or without.
fn app(with_plugin: bool) -> Option<App> {
    renders::app(|app| {
        app.insert_resource(GlobalAmbientLight::NONE);
        if with_plugin {
            app.add_plugins(SkyPlugin);
        }
    })
}

#[derive(Component, Clone)]
struct Target(Handle<Image>);

/// Of a picture, pixels: a star covers some ten of them, all of them a twentieth.
const SIDE: u32 = 256;

/// A camera that looks up by so many degrees, towards the azimuth 130.
fn camera(app: &mut App, up: f32, components: impl Bundle) -> Entity {
    let target = Image::new_target_texture(SIDE, SIDE, TextureFormat::Rgba8UnormSrgb, None);
    let target = app.world_mut().resource_mut::<Assets<Image>>().add(target);
    let turn = Quat::from_rotation_y(-130_f32.to_radians());
    let camera = (
        Camera3d::default(),
        Msaa::Off,
        RenderTarget::Image(target.clone().into()),
        Target(target),
        Transform::from_xyz(0.0, 50.0, 0.0)
            .with_rotation(turn * Quat::from_rotation_x(up.to_radians())),
        components,
    );
    app.world_mut().spawn(camera).id()
}

fn sun(app: &mut App, elevation: f32) -> Entity {
    let sun = Sun {
        azimuth: 310.0,
        elevation,
    };
    app.world_mut().spawn(sun).id()
}

fn frame(app: &mut App) {
    app.update();
    assert_eq!(app.should_exit(), None, "rendering stopped");
    let device = app.world().resource::<RenderDevice>();
    device.poll(PollType::wait_indefinitely()).expect("drawn");
}

/// (images, pipelines of the whole app, what the stage holds) after some frames.
fn after_frames(app: &mut App) -> (usize, usize, GeometryCensus) {
    for _ in 0..12 {
        frame(app);
    }
    let world = app.sub_app(RenderApp).world();
    (
        app.world().resource::<Assets<Image>>().len(),
        world.resource::<PipelineCache>().pipelines().count(),
        census(world),
    )
}

#[derive(Resource, Default)]
struct Captured(Option<Image>);

/// What a camera sees, linear luminance from 0 to 1 for each pixel.
fn picture(app: &mut App, camera: Entity) -> Vec<f32> {
    app.init_resource::<Captured>();
    let target = app.world().get::<Target>(camera).expect("ours").0.clone();
    app.world_mut().spawn(Screenshot::image(target)).observe(
        |shot: On<ScreenshotCaptured>, mut captured: ResMut<Captured>| {
            captured.0 = Some(shot.image.clone());
        },
    );
    for _ in 0..60 {
        frame(app);
        if let Some(picture) = app.world_mut().resource_mut::<Captured>().0.take() {
            let picture = picture.try_into_dynamic().expect("a picture").into_rgb8();
            return picture
                .pixels()
                .map(|pixel| {
                    let [r, g, b] = pixel.0.map(|byte| f32::from(byte) / 255.0);
                    Color::srgb(r, g, b).luminance()
                })
                .collect();
        }
    }
    panic!("no picture came back")
}

fn mean(picture: &[f32]) -> f32 {
    picture.iter().sum::<f32>() / picture.len() as f32
}

fn most(picture: &[f32]) -> f32 {
    picture.iter().copied().fold(0.0, f32::max)
}

#[test]
fn an_app_without_a_sky_pays_nothing() {
    let (Some(mut bare), Some(mut with)) = (app(false), app(true)) else {
        return;
    };
    camera(&mut bare, 0.0, bevy::camera::Hdr);
    camera(&mut with, 0.0, bevy::camera::Hdr);
    let expected = after_frames(&mut bare);
    assert_eq!(expected.2, GeometryCensus::default());
    assert_eq!(after_frames(&mut with), expected, "nothing of ours");
    // The count can fail.
    let camera = camera(&mut with, 0.0, Sky::default());
    sun(&mut with, 30.0);
    let (images, pipelines, stage) = after_frames(&mut with);
    // Three maps and what the second camera draws to.
    assert_eq!(images, expected.0 + 4);
    assert!(pipelines > expected.1, "{pipelines}");
    assert_eq!(
        stage,
        GeometryCensus::default(),
        "by day there is nothing of the night"
    );
    assert!(mean(&picture(&mut with, camera)) > 0.1);
}

#[test]
fn of_two_cameras_the_one_with_a_sky_sees_it() {
    let Some(mut app) = app(true) else { return };
    let seeing = camera(&mut app, 10.0, Sky::default());
    let blind = camera(&mut app, 10.0, ());
    sun(&mut app, 20.0);
    after_frames(&mut app);
    let seen = mean(&picture(&mut app, seeing));
    // Bevy's own clear colour.
    let clear = ClearColor::default().0.luminance();
    let not_seen = picture(&mut app, blind);
    assert!(
        not_seen.iter().all(|pixel| (pixel - clear).abs() < 0.01),
        "{}",
        mean(&not_seen)
    );
    assert!(seen > 2.0 * clear, "{seen} {clear}");
}

#[test]
fn night_is_drawn_without_a_g_buffer_and_rests_with_the_camera() {
    let Some(mut app) = app(true) else { return };
    // The moon stands opposite to the sun, where the camera looks.
    let camera = camera(
        &mut app,
        25.0,
        Sky {
            moon_size: 20.0,
            ..Sky::default()
        },
    );
    let sun = sun(&mut app, -25.0);
    let (_, _, stage) = after_frames(&mut app);
    assert_eq!((stage.kinds, stage.views), (2, 2), "stars and moon");
    for _ in 0..3 {
        frame(&mut app);
        let stats = app.world().resource::<GeometryStats>();
        assert_eq!(stats.dispatches, 0, "nothing moves");
        assert!(stats.primitives > 100, "{stats:?}");
    }
    let night = picture(&mut app, camera);
    // 20 times half a degree fill the middle ninth of the 45 degrees that are seen.
    let side = SIDE as usize;
    let moon = night[side / 2 * side + side / 2];
    assert!(moon > 0.3 && moon > 5.0 * night[0], "{moon} {}", night[0]);
    // Stars alone: some pixels stand out of the sky.
    app.world_mut()
        .get_mut::<Sky>(camera)
        .expect("a sky")
        .moon_size = 0.0;
    let (_, _, stage) = after_frames(&mut app);
    assert_eq!(stage.kinds, 1);
    let stars = picture(&mut app, camera);
    app.world_mut().get_mut::<Sky>(camera).expect("a sky").stars = 0.0;
    let (_, _, stage) = after_frames(&mut app);
    assert_eq!(stage.kinds, 0);
    let without = picture(&mut app, camera);
    assert!(
        most(&stars) > 1.5 * most(&without),
        "{} {}",
        most(&stars),
        most(&without)
    );
    // Where no star stands, the sky shines through unchanged.
    let same = stars.iter().zip(&without).filter(|(a, b)| a == b).count();
    assert!(same > stars.len() / 4, "{same}");

    // Morning: nothing is left.
    let mut place = app.world_mut().get_mut::<Sun>(sun).expect("a sun");
    place.elevation = 30.0;
    let (_, _, stage) = after_frames(&mut app);
    assert_eq!((stage.kinds, stage.views), (0, 0));
}

#[test]
fn the_plugin_may_come_before_bevys_and_again_behind_them_gpu() {
    let app = renders::app_of(|app| {
        app.insert_resource(GlobalAmbientLight::NONE)
            .add_plugins(SkyPlugin);
        renders::bevys(app);
        app.add_plugins(SkyPlugin);
    });
    let Some(mut app) = app else { return };
    let camera = camera(
        &mut app,
        25.0,
        Sky {
            moon_size: 20.0,
            ..Sky::default()
        },
    );
    sun(&mut app, -25.0);
    let (_, _, stage) = after_frames(&mut app);
    assert_eq!((stage.kinds, stage.views), (2, 2), "stars and moon, once");
    let night = picture(&mut app, camera);
    let side = SIDE as usize;
    let moon = night[side / 2 * side + side / 2];
    assert!(moon > 0.3 && moon > 5.0 * night[0], "{moon} {}", night[0]);
}

#[test]
fn far_from_the_origin_the_night_is_the_same() {
    let Some(mut app) = app(true) else { return };
    let camera = camera(
        &mut app,
        25.0,
        Sky {
            moon_size: 20.0,
            ..Sky::default()
        },
    );
    sun(&mut app, -25.0);
    after_frames(&mut app);
    let here = picture(&mut app, camera);
    let mut place = app.world_mut().get_mut::<Transform>(camera).expect("there");
    place.translation = Vec3::new(4e6, 50.0, -3e6);
    after_frames(&mut app);
    let there = picture(&mut app, camera);
    // The dome is rounded to half a metre at 90 km: five millionths of a radian, of a pixel's
    // three thousandths. Edges may move by that.
    let apart: f32 = here.iter().zip(&there).map(|(a, b)| (a - b).abs()).sum();
    let apart = apart / here.len() as f32;
    assert!(apart < 1e-3, "{apart}");
    assert!(most(&there) > 0.3, "{}", most(&there));
}
