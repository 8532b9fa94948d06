//! Pictures of what a frame is made of: their shader, and what they show of a scene that is known.
use crate::support;

use dolomite_inspector::picture::variants;
use dolomite_shaders::compose;

#[test]
fn every_variant_of_the_shader_is_valid() {
    let all = variants(&[]);
    // Each way twice, and those that follow the samples of a camera four times.
    assert_eq!(all.len(), 2 * 8 + 4 * 3, "{all:?}");
    for defines in all {
        let module = compose("inspector/picture.wgsl", &defines)
            .unwrap_or_else(|error| panic!("{defines:?}: {error}"));
        let entries: Vec<_> = module
            .entry_points
            .iter()
            .map(|e| e.name.as_str())
            .collect();
        assert_eq!(entries, ["vertex", "fragment"]);
        let look = module
            .types
            .iter()
            .find(|(_, kind)| kind.name.as_deref() == Some("Look"));
        let Some((_, kind)) = look else {
            continue;
        };
        let naga::TypeInner::Struct { span, .. } = kind.inner else {
            panic!("Look is a structure");
        };
        assert_eq!(
            span, 80,
            "three vectors, five numbers and a level, as in Rust"
        );
    }
}

/// One that the shader does not know would leave the picture black.
#[test]
fn every_definition_is_known_to_the_shader() {
    let text = |defines: &[&str]| {
        let module = compose("inspector/picture.wgsl", defines);
        module.map(|module| format!("{module:?}"))
    };
    let nothing = text(&[]).expect("it is whole without any");
    assert_eq!(text(&["NOTHING"]).ok(), Some(nothing));
    for defines in variants(&[]) {
        let whole = text(&defines).unwrap_or_else(|error| panic!("{defines:?}: {error}"));
        for at in 0..defines.len() {
            let mut other = defines.clone();
            other[at] = "NOTHING";
            // Some do not go without each other.
            let is_same = text(&other).is_ok_and(|other| other == whole);
            assert!(!is_same, "{} of {defines:?}", defines[at]);
        }
    }
}

#[test]
fn without_a_renderer_pictures_are_listed_and_refused() {
    let (mut app, _) = support::app();
    let list = support::say(&mut app, "views").unwrap();
    assert!(
        list.contains("base_colour") && list.contains("motion"),
        "{list}"
    );
    let fault = support::say(&mut app, "views depth on").unwrap_err();
    assert!(fault.contains("no renderer"), "{fault}");
    // Numbers that the shader would divide by 0 are refused.
    for wrong in ["far 0", "near -1", "fastest NaN", "most inf"] {
        support::say(&mut app, &format!("set FramePicture.{wrong}")).expect_err(wrong);
    }
}

mod gpu {
    use crate::drawn::{self, HEIGHT, Target, WIDTH, frames, picture, pipelines};
    use crate::support::say;

    use bevy::camera::{RenderTarget, Viewport};
    use bevy::core_pipeline::prepass::{
        DeferredPrepass, DepthPrepass, MotionVectorPrepass, NormalPrepass,
    };
    use bevy::math::ops;
    use bevy::pbr::DefaultOpaqueRendererMethod;
    use bevy::prelude::*;
    use bevy::render::render_resource::TextureFormat;
    use dolomite_inspector::InspectorPlugin;
    use dolomite_inspector::picture::colours::{distance_grey, encoded_of, motion_colour};
    use dolomite_inspector::picture::{FramePicture, PicturePasses};

    /// How far the wall is.
    const AWAY: f32 = 5.0;
    const FOV: f32 = 1.0;

    /// A wall over the left half of the picture, and nothing over the right one.
    fn app(deferred: bool) -> Option<App> {
        let mut app = drawn::app()?;
        app.add_plugins(InspectorPlugin)
            .insert_resource(ClearColor(Color::srgb(0.1, 0.5, 0.2)));
        if deferred {
            app.insert_resource(DefaultOpaqueRendererMethod::deferred());
        }
        app.finish();
        app.cleanup();
        let target = RenderTarget::Image(app.world().resource::<Target>().0.clone().into());
        let projection = Projection::Perspective(PerspectiveProjection {
            fov: FOV,
            ..default()
        });
        let world = app.world_mut();
        let mut camera = world.spawn((Camera3d::default(), target, projection));
        if deferred {
            camera.insert((DepthPrepass, DeferredPrepass, Msaa::Off));
        }
        let mesh = world
            .resource_mut::<Assets<Mesh>>()
            .add(Rectangle::new(40.0, 40.0));
        let material = world
            .resource_mut::<Assets<StandardMaterial>>()
            .add(StandardMaterial {
                base_color: Color::linear_rgb(0.8, 0.2, 0.1),
                perceptual_roughness: 0.6,
                metallic: 0.25,
                reflectance: 0.4,
                emissive: LinearRgba::rgb(3.0, 0.0, 0.0),
                ..default()
            });
        world.spawn((
            Mesh3d(mesh),
            MeshMaterial3d(material),
            // Its right edge is in the middle of the picture.
            Transform::from_xyz(-20.0, 0.0, -AWAY),
        ));
        frames(&mut app, 10);
        Some(app)
    }

    /// The pixels in the middle of both halves.
    fn halves(pixels: &[[u8; 4]]) -> [[u8; 4]; 2] {
        [WIDTH / 4, 3 * WIDTH / 4].map(|x| pixels[(HEIGHT / 2 * WIDTH + x) as usize])
    }

    /// Shows a picture, by the console.
    fn shown(app: &mut App, name: &str) -> [[u8; 4]; 2] {
        say(app, &format!("views {name} on")).expect("it is shown");
        // Textures of a prepass that was lent are there one frame later, and pipelines are made.
        frames(app, 6);
        halves(&picture(app))
    }

    fn assert_near(what: &str, pixel: [u8; 4], expected: Vec3, levels: f32) {
        for (channel, expected) in pixel.into_iter().zip((expected * 255.0).to_array()) {
            let off = (f32::from(channel) - expected).abs();
            assert!(
                off <= levels,
                "{what}: {pixel:?} for {expected}, off by {off}"
            );
        }
    }

    fn passes(app: &App) -> u64 {
        app.world().resource::<PicturePasses>().count()
    }

    #[test]
    fn channels_of_the_g_buffer_are_what_the_material_says() {
        let Some(mut app) = app(true) else { return };
        let before = picture(&mut app);
        assert_eq!(passes(&app), 0, "off, no pass");
        assert_eq!(pipelines(&app, "dolomite_picture"), 0, "off, no pipeline");
        let black = [0, 0, 0, 255];

        // Bytes of the G-buffer are off by 1/510 at gamma 2.2, which is up to a level more where sRGB is steeper.
        let [wall, sky] = shown(&mut app, "base_colour");
        let base = Vec3::new(0.8, 0.2, 0.1).to_array().map(encoded_of);
        assert_near("base colour", wall, Vec3::from_array(base), 2.0);
        assert_eq!(sky, black);
        assert!(passes(&app) > 0, "the count counts");
        assert_eq!(pipelines(&app, "dolomite_picture"), 1);

        // A byte is kept, and rounded once more on its way through the target.
        for (name, value) in [
            ("roughness", 0.6),
            ("metallic", 0.25),
            ("reflectance", 0.4),
            ("baked_occlusion", 1.0),
        ] {
            let [wall, sky] = shown(&mut app, name);
            assert_near(name, wall, Vec3::splat(value), 1.0);
            assert_eq!(sky, black, "{name}");
        }
        // Twelve bits a coordinate: 0.06 degrees.
        let [wall, _] = shown(&mut app, "normals");
        assert_near("normals", wall, Vec3::new(0.5, 0.5, 1.0), 1.0);
        // Not unlit, fog, shadows.
        let [wall, _] = shown(&mut app, "flags");
        assert_near("flags", wall, Vec3::new(0.0, 1.0, 1.0), 0.0);
        // RGB9E5 keeps 3, times the exposure of the camera, off by 1/512.
        let [wall, _] = shown(&mut app, "emitted");
        assert!(wall[0] > 0 && wall[1] == 0 && wall[2] == 0, "{wall:?}");

        let was = app.world().resource::<FramePicture>().clone();
        say(&mut app, "views emitted off").unwrap();
        assert_eq!(app.world().resource::<FramePicture>().shown, "");
        frames(&mut app, 3);
        let passed = passes(&app);
        assert_eq!(picture(&mut app), before, "off, the frame is as it was");
        assert_eq!(passes(&app), passed, "off, no pass");
        assert_eq!(was.shown, "emitted");
    }

    #[test]
    fn distances_and_motion_are_as_far_as_the_camera_goes() {
        let Some(mut app) = app(true) else { return };
        let prepasses = |app: &mut App| {
            let world = app.world_mut();
            world
                .query_filtered::<(Has<DepthPrepass>, Has<MotionVectorPrepass>), With<Camera3d>>()
                .single(world)
                .unwrap()
        };
        assert_eq!(prepasses(&mut app), (true, false));
        let [wall, sky] = shown(&mut app, "depth");
        let usual = FramePicture::default();
        let expected = distance_grey(AWAY, usual.near, usual.far);
        assert_near("depth", wall, Vec3::splat(expected), 1.0);
        assert_eq!(sky, [0, 0, 32, 255]);
        say(&mut app, "set FramePicture.near 4").unwrap();
        say(&mut app, "set FramePicture.far 8").unwrap();
        frames(&mut app, 3);
        let [wall, _] = halves(&picture(&mut app));
        let expected = distance_grey(AWAY, 4.0, 8.0);
        assert_near("depth in a range", wall, Vec3::splat(expected), 1.0);
        // What the camera has of itself stays.
        say(&mut app, "views depth off").unwrap();
        frames(&mut app, 3);
        assert_eq!(prepasses(&mut app), (true, false));

        let [wall, _] = shown(&mut app, "motion");
        assert_near("at rest", wall, Vec3::splat(0.5), 1.0);
        assert_eq!(prepasses(&mut app), (true, true), "lent");
        // The camera goes right and up, and so the wall left and down.
        let step = Vec2::new(0.08, 0.04);
        app.add_systems(
            Update,
            move |mut cameras: Query<&mut Transform, With<Camera3d>>| {
                for mut camera in &mut cameras {
                    camera.translation += step.extend(0.0);
                }
            },
        );
        frames(&mut app, 3);
        let focal = 0.5 * HEIGHT as f32 / ops::tan(0.5 * FOV);
        let moved = step * Vec2::new(-1.0, 1.0) * focal / AWAY;
        assert!(moved.x < -5.0 && moved.y > 2.0, "{moved}");
        let [wall, _] = halves(&picture(&mut app));
        // Half floats keep a share of the picture to 2^-11 of itself.
        let expected = motion_colour(moved, usual.fastest);
        assert_near("in motion", wall, expected, 1.0);
        say(&mut app, "views motion off").unwrap();
        frames(&mut app, 3);
        assert_eq!(prepasses(&mut app), (true, false), "taken back");
    }

    /// Two cameras with images of their own, of which one sees half of it: a picture is shown over each, as that one sees
    /// it, and nothing beside its part.
    #[test]
    fn every_camera_shows_the_picture_as_it_sees_it() {
        let Some(mut app) = app(true) else { return };
        let image = Image::new_target_texture(WIDTH, HEIGHT, TextureFormat::Rgba8UnormSrgb, None);
        let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        let half = UVec2::new(WIDTH / 2, HEIGHT);
        app.world_mut().spawn((
            Camera3d::default(),
            Camera {
                viewport: Some(Viewport {
                    physical_size: half,
                    ..default()
                }),
                ..default()
            },
            (DepthPrepass, DeferredPrepass, Msaa::Off),
            RenderTarget::Image(image.clone().into()),
            // Three metres farther away, before the middle of the wall's left part.
            Transform::from_xyz(-10.0, 0.0, 3.0),
        ));
        let usual = FramePicture::default();
        let [wall, _] = shown(&mut app, "depth");
        let expected = distance_grey(AWAY, usual.near, usual.far);
        assert_near("the first", wall, Vec3::splat(expected), 1.0);
        app.insert_resource(Target(image));
        let other = picture(&mut app);
        let [wall, beside] = halves(&other);
        let expected = distance_grey(AWAY + 3.0, usual.near, usual.far);
        assert_near("the second", wall, Vec3::splat(expected), 1.0);
        say(&mut app, "views depth off").unwrap();
        frames(&mut app, 3);
        let frame = halves(&picture(&mut app));
        assert!(frame[0] != wall && frame[1] == beside, "beside its part");
    }

    /// Forward, with four samples a pixel: a stranger's camera as it comes.
    #[test]
    fn any_camera_has_depth_and_normals_and_is_told_that_it_has_no_g_buffer() {
        let Some(mut app) = app(false) else { return };
        let before = picture(&mut app);
        let fault = say(&mut app, "views base_colour on").unwrap_err();
        assert!(fault.contains("DeferredPrepass"), "{fault}");
        assert_eq!(app.world().resource::<FramePicture>().shown, "");
        let [wall, _] = shown(&mut app, "depth");
        let usual = FramePicture::default();
        let expected = distance_grey(AWAY, usual.near, usual.far);
        assert_near("depth", wall, Vec3::splat(expected), 1.0);
        let [wall, _] = shown(&mut app, "normals");
        // Ten bits a coordinate.
        assert_near("normals", wall, Vec3::new(0.5, 0.5, 1.0), 1.0);
        // A camera that comes meanwhile is equipped as well.
        let camera = app
            .world_mut()
            .spawn((
                Camera3d::default(),
                Camera {
                    order: 1,
                    is_active: false,
                    ..default()
                },
            ))
            .id();
        frames(&mut app, 2);
        assert!(app.world().get::<NormalPrepass>(camera).is_some());
        say(&mut app, "views normals off").unwrap();
        frames(&mut app, 3);
        assert!(app.world().get::<NormalPrepass>(camera).is_none());
        assert_eq!(picture(&mut app), before);
        // One whose name nobody has shows the frame.
        app.world_mut().resource_mut::<FramePicture>().shown = "nothing".to_owned();
        frames(&mut app, 3);
        assert_eq!(picture(&mut app), before);
    }
}
