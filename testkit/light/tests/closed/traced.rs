//! What rays meet.

use dolomite_light_oracle::random::Random;
use dolomite_light_oracle::scene::{Mesh, Object, Pose, Scene, Shape, cuboid, icosphere};
use dolomite_light_oracle::trace::{Ray, Sides, Tracer};
use dolomite_light_oracle::{Recipe, generate};
use glam::{DQuat, DVec3};

use super::{WHITE, close, exact, placed};

#[test]
fn a_sphere_is_met_where_its_equation_says() {
    // From the distance D past the middle at b: t = D − √(1 − b²). It stays right from far away.
    for (distance, bound) in [(3.0, 1e-15), (1e3, 1e-15), (1e6, 1e-15)] {
        for b in [0.0, 0.3, 0.99] {
            let tracer = Tracer::new(&exact(&[(Shape::Sphere, Pose::default())]));
            let ray = Ray::new(DVec3::new(b, 0.0, distance), DVec3::NEG_Z);
            let hit = tracer.hit(&ray, 0.0, f64::INFINITY, Sides::Front).unwrap();
            let depth = (1.0 - b * b).sqrt();
            close(hit.t, distance - depth, bound);
            let surface = tracer.surface(&ray, &hit);
            assert!((surface.position.length() - 1.0).abs() < 2e-16 * distance.max(2.0));
        }
    }
}

#[test]
fn an_ellipsoid_has_the_normal_of_its_gradient() {
    let half = DVec3::new(2.0, 0.5, 1.0);
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 1.1, -0.3);
    let pose = Pose {
        translation: DVec3::new(5.0, -3.0, 2.0),
        rotation: turn,
        scale: half,
    };
    let tracer = Tracer::new(&exact(&[(Shape::Sphere, pose)]));
    let mut random = Random::new(3);
    let mut hits = 0;
    for _ in 0..2000 {
        let eye = pose.translation + 10.0 * random.direction();
        let target = pose.translation + 1.2 * random.direction();
        let ray = Ray::new(eye, target - eye);
        let Some(hit) = tracer.hit(&ray, 0.0, f64::INFINITY, Sides::Front) else {
            continue;
        };
        hits += 1;
        let surface = tracer.surface(&ray, &hit);
        let local = turn.inverse() * (surface.position - pose.translation);
        assert!(((local / half).length() - 1.0).abs() < 1e-13);
        let gradient = turn * (local / (half * half)).normalize();
        assert!(surface.normal.distance(gradient) < 1e-13);
        assert!(surface.normal.dot(ray.direction) < 0.0);
    }
    assert!(hits > 500, "{hits}");
}

#[test]
fn no_ray_leaves_a_closed_mesh() {
    // Aimed at corners, at edges and at faces of a sphere and a box from inside.
    let mut random = Random::new(9);
    for mesh in [icosphere(2), cuboid(DVec3::new(1.0, 0.7, 1.3))] {
        let scene = Scene {
            meshes: vec![mesh],
            ..exact(&[(
                Shape::Mesh(0),
                placed(DVec3::new(0.1, 0.2, 0.3), DVec3::ONE),
            )])
        };
        let tracer = Tracer::new(&scene);
        let mesh = &scene.meshes[0];
        for _ in 0..50_000 {
            let start = DVec3::new(0.1, 0.2, 0.3) + 0.5 * random.unit() * random.direction();
            let t = mesh.triangles[random.below(mesh.triangles.len())];
            let [a, b, c] = t.map(|k| mesh.positions[k as usize] + DVec3::new(0.1, 0.2, 0.3));
            let x = random.unit();
            let target = match random.below(3) {
                0 => a,
                1 => a.lerp(b, x),
                _ => a.lerp(b, x).lerp(c, random.unit()),
            };
            let ray = Ray::new(start, target - start);
            assert!(tracer.blocked(&ray, 0.0, f64::INFINITY), "{start} {target}");
        }
    }
}

#[test]
fn the_hierarchy_finds_what_a_list_finds() {
    for seed in 0..4 {
        let mut scene = generate(&Recipe {
            seed,
            objects: 12,
            lights: 0,
            ..Recipe::default()
        });
        // Exact shapes among the triangles.
        let ball = placed(DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.8, 1.2, 0.5));
        scene.objects.push(Object::new(Shape::Sphere, ball, 0));
        let whole = Tracer::new(&scene);
        // The hierarchy of one object is the list of its own triangles or leaves; each triangle for itself is a list.
        let single: Vec<Tracer> = singles(&scene);
        let mut random = Random::new(seed);
        let mut hits = 0;
        for _ in 0..300 {
            let origin = DVec3::new(0.0, 2.0, 0.0) + 6.0 * random.direction();
            let ray = Ray::new(origin, random.direction());
            for sides in [Sides::Front, Sides::Both] {
                let first = single
                    .iter()
                    .filter_map(|t| t.hit(&ray, 0.1, 20.0, sides).map(|h| h.t))
                    .min_by(f64::total_cmp);
                let is = whole.hit(&ray, 0.1, 20.0, sides).map(|h| h.t);
                assert_eq!(is, first, "{seed} {ray:?}");
                hits += usize::from(is.is_some());
            }
            let blocked = single.iter().any(|t| t.blocked(&ray, 0.1, 20.0));
            assert_eq!(whole.blocked(&ray, 0.1, 20.0), blocked);
        }
        assert!(hits > 100, "{hits}");
    }
}

/// A tracer for each triangle and each exact shape.
fn singles(scene: &Scene) -> Vec<Tracer> {
    let mut all = Vec::new();
    for object in &scene.objects {
        let Shape::Mesh(mesh) = object.shape else {
            all.push(Tracer::new(&Scene {
                objects: vec![object.clone()],
                materials: vec![WHITE],
                ..Scene::default()
            }));
            continue;
        };
        let mesh = &scene.meshes[mesh];
        for triangle in &mesh.triangles {
            let one = Mesh {
                triangles: vec![*triangle],
                ..mesh.clone()
            };
            all.push(Tracer::new(&Scene {
                meshes: vec![one],
                objects: vec![Object::new(Shape::Mesh(0), object.pose, 0)],
                materials: vec![WHITE],
                ..Scene::default()
            }));
        }
    }
    all
}
