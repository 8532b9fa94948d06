//! Where a shadow ends.

use dolomite_light_oracle::model::SplitSum;
use dolomite_light_oracle::per_pixel::{self, ShadowTexels};
use dolomite_light_oracle::scene::{Ambient, Camera, Lamp, LampKind, Mesh, Scene, Shape};
use dolomite_light_oracle::shade::Lights;
use dolomite_light_oracle::trace::{Ray, Sides, Tracer};
use glam::{DQuat, DVec3};

use super::{WHITE, candela, close, exact, placed};

/// Where `blocked` begins between `free` and `in_shadow`.
fn edge(mut free: f64, mut in_shadow: f64, blocked: impl Fn(f64) -> bool) -> f64 {
    assert!(!blocked(free) && blocked(in_shadow));
    for _ in 0..200 {
        let middle = 0.5 * (free + in_shadow);
        if blocked(middle) {
            in_shadow = middle;
        } else {
            free = middle;
        }
    }
    free
}

/// A quad from x = 1 to 3 at height 2.
fn board() -> Scene {
    let corner = |x: f64, z: f64| DVec3::new(x, 2.0, z);
    Scene {
        meshes: vec![Mesh {
            positions: vec![
                corner(1.0, -4.0),
                corner(1.0, 4.0),
                corner(3.0, 4.0),
                corner(3.0, -4.0),
            ],
            normals: Vec::new(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }],
        ..exact(&[(Shape::Mesh(0), placed(DVec3::ZERO, DVec3::ONE))])
    }
}

#[test]
fn the_edge_of_a_board_falls_by_similar_triangles() {
    // Light at height 5 above x = 0, edges at x = 1 and 3 at height 2: 5/3 and 5.
    let tracer = Tracer::new(&board());
    let light = DVec3::new(0.0, 5.0, 0.0);
    let blocked = |x: f64| {
        let floor = DVec3::new(x, 0.0, 0.1);
        tracer.blocked(&Ray::new(floor, light - floor), 0.0, 1.0)
    };
    close(edge(0.0, 3.0, blocked), 5.0 / 3.0, 1e-12);
    close(edge(9.0, 3.0, blocked), 5.0, 1e-12);
}

#[test]
fn an_image_has_the_same_edge() {
    let mut scene = board();
    let floor = exact(&[(Shape::Plane, placed(DVec3::ZERO, DVec3::ONE))]);
    scene.objects.extend(floor.objects);
    let tracer = Tracer::new(&scene);
    let light = candela(DVec3::new(0.0, 5.0, 0.0), 100.0);
    let lights = Lights::new(&[light], &Ambient::default(), 1.0, SplitSum::Karis);
    let dark = |x: f64| {
        let eye = DVec3::new(x, 1.0, 0.1);
        let ray = Ray::new(eye, DVec3::NEG_Y);
        let hit = tracer.hit(&ray, 0.0, 10.0, Sides::Front).unwrap();
        let surface = tracer.surface(&ray, &hit);
        lights.surface(&surface, &WHITE, eye, 1.0, Some(&tracer)) == DVec3::ZERO
    };
    // A shadow ray starts 1e-9 of the largest coordinate above the floor, where the shadow is narrower: by 1/3 of that at
    // the first edge, by 1 at the second one, and a share x of it is 5/3 and 5 times that.
    close(edge(0.0, 3.0, dark), 5.0 / 3.0, 2e-9);
    close(edge(9.0, 3.0, dark), 5.0, 2e-9);
}

#[test]
fn the_shadow_of_a_sphere_ends_at_its_cone_of_tangents() {
    // Light at height 6, a sphere of radius 1 at height 2 below it: sin β = 1/4, on the floor 6 tan β.
    let tracer = Tracer::new(&exact(&[(
        Shape::Sphere,
        placed(DVec3::new(0.0, 2.0, 0.0), DVec3::ONE),
    )]));
    let light = DVec3::new(0.0, 6.0, 0.0);
    let radius = edge(4.0, 0.0, |x| {
        let floor = DVec3::new(x, 0.0, 0.0);
        tracer.blocked(&Ray::new(floor, light - floor), 0.0, 1.0)
    });
    let sin: f64 = 0.25;
    // At its rim the ray only just enters the sphere: half of the digits of a square root of a difference would be lost
    // if the distance from the middle were taken from the discriminant.
    close(radius, 6.0 * sin / (1.0 - sin * sin).sqrt(), 1e-12);
}

#[test]
fn the_sun_makes_an_ellipse_of_a_sphere() {
    // At the elevation e the shadow of the unit sphere has the half axes 1 and 1 / sin e.
    let tracer = Tracer::new(&exact(&[(
        Shape::Sphere,
        placed(DVec3::new(0.0, 3.0, 0.0), DVec3::ONE),
    )]));
    let e: f64 = 0.7;
    let sun = DVec3::new(e.cos(), e.sin(), 0.0);
    let blocked =
        |x: f64, z: f64| tracer.blocked(&Ray::new(DVec3::new(x, 0.0, z), sun), 0.0, f64::INFINITY);
    let middle = -3.0 / e.tan();
    let along = edge(9.0, 0.0, |x| blocked(middle + x, 0.0));
    let across = edge(9.0, 0.0, |z| blocked(middle, z));
    close(along, 1.0 / e.sin(), 1e-12);
    close(across, 1.0, 1e-12);
}

#[test]
fn a_light_that_asks_for_no_shadow_has_none() {
    let tracer = Tracer::new(&board());
    let plane = exact(&[(Shape::Plane, placed(DVec3::ZERO, DVec3::ONE))]);
    let floor = Tracer::new(&plane);
    let eye = DVec3::new(3.0, 1.0, 0.0);
    let ray = Ray::new(eye, DVec3::NEG_Y);
    let hit = floor.hit(&ray, 0.0, 10.0, Sides::Front).unwrap();
    let surface = floor.surface(&ray, &hit);
    let with = |shadows: bool| {
        let kind = LampKind::Directional {
            direction: DVec3::new(0.0, -1.0, 0.0),
        };
        let light = Lamp {
            shadows,
            ..Lamp::new(1.0, kind)
        };
        let lights = Lights::new(&[light], &Ambient::default(), 1.0, SplitSum::Karis);
        // Seen from below the board, at x = 2.
        let mut below = surface;
        below.position.x = 2.0;
        lights.surface(&below, &WHITE, eye, 1.0, Some(&tracer)).x
    };
    assert_eq!(with(true), 0.0);
    close(with(false), 1.0 / std::f64::consts::PI, 1e-14);
}

#[test]
fn what_lies_beyond_the_light_casts_no_shadow_on_this_side() {
    // The board is at height 2, from x = 1 to 3.
    let tracer = Tracer::new(&board());
    let plane = exact(&[(Shape::Plane, placed(DVec3::ZERO, DVec3::ONE))]);
    let floor = Tracer::new(&plane);
    let ray = Ray::new(DVec3::new(2.0, 1.0, 0.1), DVec3::NEG_Y);
    let hit = floor.hit(&ray, 0.0, 10.0, Sides::Front).unwrap();
    let surface = floor.surface(&ray, &hit);
    for (height, lit) in [(1.5, true), (1.999, true), (2.001, false), (3.0, false)] {
        let light = candela(DVec3::new(2.0, height, 0.1), 100.0);
        let lights = Lights::new(&[light], &Ambient::default(), 1.0, SplitSum::Karis);
        let is = lights.surface(&surface, &WHITE, ray.origin, 1.0, Some(&tracer));
        assert_eq!(is.x > 0.0, lit, "{height}");
    }
}

#[test]
fn ways_know_how_far_the_edge_is() {
    let mut scene = board();
    let floor = exact(&[(Shape::Plane, placed(DVec3::ZERO, DVec3::ONE))]);
    scene.objects.extend(floor.objects);
    // Below the board, looking down at where its shadow ends.
    scene.camera = Camera {
        position: DVec3::Y,
        rotation: DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2),
        fov_y: 0.1,
        width: 48,
        height: 8,
        ..Camera::default()
    };
    let map = ShadowTexels {
        side: 512.0,
        metres: 0.01,
    };
    let point = candela(DVec3::new(0.0, 5.0, 0.0), 100.0);
    let sun = Lamp::new(
        1.0,
        LampKind::Directional {
            direction: DVec3::NEG_Y,
        },
    );
    let spot = Lamp {
        kind: LampKind::Spot {
            position: DVec3::new(0.0, 5.0, 0.0),
            range: 100.0,
            direction: DVec3::NEG_Y,
            inner: 0.5,
            outer: std::f64::consts::FRAC_PI_4,
        },
        ..point
    };
    let radii: Vec<f64> = (1..=24).map(|k| 0.5 * f64::from(k)).collect();
    // The edge, and metres of a texel on the floor: of both maps 2 · 5 / 512.
    for (lamp, edge, metres) in [
        (sun, 1.0, 0.01),
        (point, 5.0 / 3.0, 10.0 / 512.0),
        (spot, 5.0 / 3.0, 10.0 / 512.0),
    ] {
        scene.camera.position.x = edge;
        let texels = per_pixel::texels(&scene);
        let ways = per_pixel::ways_around(&scene, &lamp, map, &radii);
        let (mut near, mut clear) = (0, 0);
        for (way, texel) in ways.iter().zip(&texels) {
            let (Some(way), Some(texel)) = (way, texel) else {
                continue;
            };
            let x = texel.position.x;
            // In texels of the map: what lies along the floor is as long there.
            let away = (x - edge).abs() / metres;
            assert_eq!(way.free, x < edge, "{x}");
            let next = radii.iter().copied().find(|radius| *radius > way.alike);
            // Twelve ways of a circle: one of them is within 15° of the edge's direction.
            let most = away / 15.0_f64.to_radians().cos();
            assert!(way.alike <= most + 1e-9, "{} {away}", way.alike);
            assert!(
                next.is_none_or(|next| next >= away - 1e-9),
                "{x}: {next:?} {away}"
            );
            near += usize::from(next.is_some());
            clear += usize::from(next.is_none());
        }
        assert!(near > 20 && clear > 20, "{near} {clear}");
    }
}
