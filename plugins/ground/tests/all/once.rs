//! Ground that is shaded once a pixel, beside the same ground shaded in its draws.

use bevy::prelude::*;
use bevy::render::RenderApp;
use dolomite_geometry::render::Producers;

use crate::app::seen::{Seen, hills};

fn pixels(image: &Image) -> impl Iterator<Item = [u8; 4]> {
    let data = image.data.as_ref().expect("pixels");
    data.as_chunks::<4>().0.iter().copied()
}

/// Hills with a cube of Bevy's in them, and another behind a summit; `once` as the ground is drawn.
fn picture(once: bool) -> Option<Image> {
    let place = Transform::from_xyz(0.0, 70.0, 300.0);
    let place = place.looking_at(Vec3::new(0.0, 0.0, -100.0), Vec3::Y);
    let mut seen = Seen::new(&hills(), place, Some(u32::MAX))?;
    let render = seen.app.get_sub_app_mut(RenderApp).expect("renders");
    let mut producers = render.world_mut().resource_mut::<Producers>();
    let mut ground = 0;
    for producer in producers.iter_mut() {
        ground += u32::from(producer.traits.shaded_once);
        producer.traits.shaded_once &= once;
    }
    assert!(ground > 0, "the ground asks for it");
    let world = seen.app.world_mut();
    let cube = world
        .resource_mut::<Assets<Mesh>>()
        .add(Cuboid::new(30.0, 60.0, 30.0));
    let red = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(StandardMaterial::from_color(Color::srgb(0.8, 0.1, 0.1)));
    for at in [
        Vec3::new(-60.0, 30.0, 100.0),
        Vec3::new(70.0, -10.0, -300.0),
    ] {
        let cube = (Mesh3d(cube.clone()), MeshMaterial3d(red.clone()));
        world.spawn((cube, Transform::from_translation(at)));
    }
    seen.rest();
    Some(seen.picture())
}

#[test]
fn gpu_ground_is_the_same_shaded_once_a_pixel() {
    let Some(once) = picture(true) else {
        return;
    };
    let whole = picture(false).expect("drawn before");
    let (mut sum, mut most, mut red, mut sky) = (0.0, 0, 0, 0);
    for (a, b) in pixels(&once).zip(pixels(&whole)) {
        let apart = (0..3).map(|k| a[k].abs_diff(b[k])).max().unwrap_or(0);
        sum += f64::from(apart);
        most = apart.max(most);
        let is_red = |p: [u8; 4]| u32::from(p[0]) > 2 * u32::from(p[1]) + 20;
        let is_sky = |p: [u8; 4]| p[..3] == [0; 3];
        // The cubes cover the ground, and are covered by it, as they were; what is not ground stays untouched.
        assert_eq!(is_red(a), is_red(b), "{a:?} {b:?}");
        assert_eq!(is_sky(a), is_sky(b), "{a:?} {b:?}");
        red += u32::from(is_red(a));
        sky += u32::from(is_sky(a));
    }
    let mean = sum / f64::from(once.width() * once.height());
    println!("mean {mean}, most {most}, {red} red, {sky} sky");
    assert!(red > 300 && sky > 1000, "{red} {sky}");
    // Normals of 16 bits a coordinate in place of f32, and what a pixel spans by the normal in place of the triangle's plane, by
    // which noise fades that is finer than a pixel: twice what was found, 0.40 and 14. But not nothing: else both are drawn
    // alike.
    assert!(mean > 0.0 && mean < 0.8 && most < 28, "{mean} {most}");
}
