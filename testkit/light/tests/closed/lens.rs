//! Lens and shutter.

use std::f64::consts::PI;

use dolomite_light_oracle::occlusion::disc;
use dolomite_light_oracle::random::hammersley;
use dolomite_light_oracle::render::shutter;
use dolomite_light_oracle::scene::{
    BlinnPhong, Camera, Lens, Material, Object, Scene, Shape, cuboid,
};
use dolomite_light_oracle::trace::{Sides, Tracer};
use dolomite_light_oracle::{Options, render};
use glam::DVec3;

use super::{close, exact, placed};

fn camera() -> Camera {
    Camera {
        fov_y: 0.8,
        width: 320,
        height: 180,
        ..Camera::default()
    }
}

#[test]
fn a_point_out_of_focus_is_a_disc_of_the_radius_of_its_cone() {
    let camera = camera();
    let lens = Lens {
        radius: 0.05,
        focus: 4.0,
    };
    for depth in [1.0, 3.9, 4.0, 20.0] {
        for angle in [0.0, 1.0, 4.0_f64] {
            let rim = [angle.cos(), angle.sin()];
            let there = camera.lens_ray(200.0, 50.0, &lens, rim).at(depth);
            let ([x, y], _) = camera.project(there).unwrap();
            let spread = f64::hypot(x - 200.0, y - 50.0);
            let exact = lens.radius * (depth - 4.0_f64).abs() / (4.0 * depth) * 180.0
                / (2.0 * 0.4_f64.tan());
            if depth == 4.0 {
                assert!(spread < 1e-11);
            } else {
                // The difference of two places of some hundred pixels.
                assert!((spread - exact).abs() < 1e-11, "{spread} {exact}");
            }
            let is = camera.circle_of_confusion(&lens, depth);
            assert!((is - exact).abs() <= 1e-13 * exact);
        }
    }
}

/// A board that glows, from x = −100 to 0 at a depth.
fn board(depth: f64) -> Scene {
    let glow = Material::BlinnPhong(BlinnPhong {
        diffuse: DVec3::ZERO,
        specular: DVec3::ZERO,
        emissive: DVec3::ONE,
        ..BlinnPhong::default()
    });
    let place = placed(DVec3::new(-100.0, 0.0, -depth), DVec3::ONE);
    Scene {
        meshes: vec![cuboid(DVec3::new(100.0, 100.0, 1e-9))],
        materials: vec![glow],
        camera: camera(),
        ..exact(&[(Shape::Mesh(0), place)])
    }
}

#[test]
fn an_edge_out_of_focus_is_the_segment_of_a_circle() {
    // At u radii from the edge a pixel sees the share (acos u − u √(1 − u²)) / π of the lens before the board.
    let scene = board(2.0);
    let tracer = Tracer::new(&scene);
    let lens = Lens {
        radius: 0.1,
        focus: 6.0,
    };
    let radius = scene.camera.circle_of_confusion(&lens, 2.0);
    for u in [-0.9, -0.4, 0.0, 0.3, 0.8_f64] {
        let x = 160.0 + u * radius;
        let rays = 8192;
        let hits = (0..rays).filter(|i| {
            let on_lens = disc(hammersley(*i, rays, [0.3, 0.7]));
            let ray = scene.camera.lens_ray(x, 90.0, &lens, on_lens);
            tracer.hit(&ray, 0.1, 1e9, Sides::Front).is_some()
        });
        let is = hits.count() as f64 / f64::from(rays);
        let exact = (u.acos() - u * (1.0 - u * u).sqrt()) / PI;
        // Hammersley's set keeps the area of a segment to less than this (measured: 4.5e-4).
        assert!((is - exact).abs() < 1.5e-3, "{u}: {is} {exact}");
    }
}

#[test]
fn an_image_through_a_lens_is_sharp_in_the_plane_of_focus_alone() {
    let mut scene = board(3.0);
    scene.camera.width = 33;
    scene.camera.height = 3;
    let softness = |scene: &Scene| {
        let options = Options {
            samples: 256,
            ..Options::default()
        };
        let image = render(scene, &options);
        // Pixels of the middle row that are neither dark nor bright.
        (0..33)
            .filter(|x| (0.02..0.98).contains(&image.at(*x, 1).x))
            .count()
    };
    scene.camera.lens = Some(Lens {
        radius: 0.5,
        focus: 3.0,
    });
    assert!(softness(&scene) <= 1);
    scene.camera.lens = Some(Lens {
        radius: 0.5,
        focus: 1.5,
    });
    let radius = scene
        .camera
        .circle_of_confusion(&scene.camera.lens.unwrap(), 3.0);
    scene.camera.height = 3;
    assert!(
        softness(&scene) as f64 >= (2.0 * radius * 0.7).floor(),
        "{radius}"
    );
}

#[test]
fn a_bar_that_moves_while_the_shutter_is_open_is_a_ramp() {
    // The edge moves by 0.5 m to +x: a pixel at x between 0 and 0.5 is covered for 1 − x / 0.5 of the time.
    let mut scene = board(2.0);
    scene.camera.width = 65;
    scene.camera.height = 1;
    scene.camera.fov_y = 0.02;
    scene.objects[0].velocity = DVec3::new(5.0, 0.0, 0.0);
    let frames = 200;
    let image = shutter(0.1, frames, &Options::default(), |t| scene.after(t)).unwrap();
    let mut ramps = 0;
    for x in 0..65 {
        let ray = scene.camera.ray(f64::from(x) + 0.5, 0.5);
        let there = ray.at(2.0).x;
        let share = (1.0 - there / 0.5).clamp(0.0, 1.0);
        ramps += usize::from(share > 0.0 && share < 1.0);
        let is = image.at(x, 0).x;
        assert!(
            (is - share).abs() <= 0.5 / f64::from(frames) + 1e-12,
            "{is} {share}"
        );
    }
    assert!(ramps > 5, "{ramps}");
    assert!(shutter(0.1, 0, &Options::default(), |t| scene.after(t)).is_none());
}

#[test]
fn velocity_moves_objects_and_camera() {
    let mut scene = board(2.0);
    scene.camera.velocity = DVec3::new(0.0, 2.0, 0.0);
    scene.objects[0].velocity = DVec3::new(4.0, 0.0, 0.0);
    scene
        .objects
        .push(Object::new(Shape::Sphere, placed(DVec3::X, DVec3::ONE), 0));
    let later = scene.after(0.5);
    close(later.camera.position.y, 1.0, 1e-15);
    close(later.objects[0].pose.translation.x, -98.0, 1e-15);
    assert_eq!(later.objects[1], scene.objects[1]);
}
