//! Random and hostile scenes, and images of them.

#![expect(clippy::disallowed_methods, reason = "f64 of an oracle")]

use dolomite_light_oracle::hostile::{Place, add_degenerate, bad_lamps};
use dolomite_light_oracle::image::Image;
use dolomite_light_oracle::light::Source;
use dolomite_light_oracle::model::SplitSum;
use dolomite_light_oracle::occlusion::Occlusion;
use dolomite_light_oracle::per_pixel::{free_ways, occlusions, texels};
use dolomite_light_oracle::random::Random;
use dolomite_light_oracle::scene::{
    Ambient, BlinnPhong, Interpolation, Lamp, LampKind, Material, Mesh, Object, Pose, Scene, Shape,
};
use dolomite_light_oracle::shade::{Lights, shade};
use dolomite_light_oracle::trace::{Ray, Sides, Tracer};
use dolomite_light_oracle::{Options, Recipe, generate, render};
use glam::DVec3;

fn small(seed: u64) -> Scene {
    generate(&Recipe {
        seed,
        objects: 16,
        lights: 12,
        blinn_phong: 0.3,
        width: 64,
        height: 36,
        ..Recipe::default()
    })
}

const UNSHADOWED: Options = Options {
    shadows: false,
    occlusion: None,
    split_sum: SplitSum::Karis,
    samples: 1,
    seed: 0,
};

/// The largest difference, relative to the brighter channel and not below 1e-3.
fn difference(a: &Image, b: &Image) -> f64 {
    let of = |(a, b): (&DVec3, &DVec3)| (*a - *b).abs().max_element() / b.max_element().max(1e-3);
    a.pixels.iter().zip(&b.pixels).map(of).fold(0.0, f64::max)
}

#[test]
fn every_seed_is_a_scene_of_its_own_with_light_in_it() {
    let mut images: Vec<Image> = Vec::new();
    for seed in 0..30 {
        let scene = small(seed);
        assert_eq!(scene, small(seed));
        let image = render(&scene, &Options::default());
        assert!(
            image
                .pixels
                .iter()
                .all(|p| p.is_finite() && p.min_element() >= 0.0)
        );
        let seen = texels(&scene);
        let share = seen.iter().flatten().count() as f64 / seen.len() as f64;
        assert!(share > 0.2, "{seed}: {share} of the pixels show something");
        let lit = image
            .pixels
            .iter()
            .filter(|p| p.max_element() > 0.01)
            .count();
        assert!(lit > seen.len() / 10, "{seed}: {lit} lit pixels");
        let bright = image
            .pixels
            .iter()
            .filter(|p| p.max_element() > 8.0)
            .count();
        assert!(bright < seen.len() / 50, "{seed}: {bright} pixels above 8");
        assert!(images.iter().all(|other| *other != image));
        images.push(image);
    }
}

#[test]
fn every_number_of_a_scene_is_an_f32() {
    let same = |x: f64| f64::from(x as f32) == x;
    let vector = |v: DVec3| v.to_array().into_iter().all(same);
    for seed in 0..8 {
        let scene = small(seed);
        for mesh in &scene.meshes {
            assert!(
                mesh.positions
                    .iter()
                    .chain(&mesh.normals)
                    .all(|v| vector(*v))
            );
        }
        for object in &scene.objects {
            let Pose {
                translation,
                rotation,
                scale,
            } = object.pose;
            assert!(vector(translation) && vector(scale));
            assert!(rotation.to_array().into_iter().all(same));
            assert!(scale.min_element() > 0.1);
        }
        for lamp in &scene.lamps {
            assert!(vector(lamp.colour) && same(lamp.power));
            match lamp.kind {
                LampKind::Directional { direction } => assert!(vector(direction)),
                LampKind::Point { position, range } => assert!(vector(position) && same(range)),
                LampKind::Spot {
                    position,
                    range,
                    direction,
                    inner,
                    outer,
                } => {
                    assert!(vector(position) && vector(direction));
                    assert!(same(range) && same(inner) && same(outer) && inner < outer);
                }
            }
            assert!(Source::new(lamp).is_some());
        }
        assert!(vector(scene.camera.position) && same(scene.camera.fov_y));
        assert!(same(scene.camera.near) && same(scene.ambient.brightness));
    }
}

#[test]
fn a_given_g_buffer_is_shaded_as_the_scene_is() {
    for seed in 0..6 {
        let scene = small(seed);
        let image = render(&scene, &UNSHADOWED);
        let lights = Lights::new(&scene.lamps, &scene.ambient, 1.0, SplitSum::Karis);
        let given = texels(&scene);
        let shaded = shade(&lights, 64, 36, scene.background, &given).unwrap();
        assert_eq!(shaded, image);
        assert!(shade(&lights, 64, 35, scene.background, &given).is_err());
    }
}

#[test]
fn light_adds_up() {
    let scene = small(3);
    let options = Options {
        samples: 1,
        ..Options::default()
    };
    let whole = render(&scene, &options);
    let mut sum = vec![DVec3::ZERO; whole.pixels.len()];
    let dark = Scene {
        lamps: Vec::new(),
        ambient: Ambient::default(),
        materials: scene.materials.iter().map(unlit).collect(),
        ..scene.clone()
    };
    let emitted = Scene {
        materials: scene.materials.clone(),
        ..dark.clone()
    };
    let everywhere = Scene {
        ambient: scene.ambient,
        ..dark.clone()
    };
    let mut alone = vec![emitted, everywhere];
    // Two halves of the lights.
    let (first, second) = scene.lamps.split_at(scene.lamps.len() / 2);
    alone.extend([first, second].map(|lamps| Scene {
        lamps: lamps.to_vec(),
        ..dark.clone()
    }));
    for one in &alone {
        for (sum, p) in sum.iter_mut().zip(render(one, &options).pixels) {
            *sum += p;
        }
    }
    let sum = Image::new(whole.width, whole.height, sum).unwrap();
    assert!(difference(&sum, &whole) < 1e-13);
}

/// Without what it emits.
fn unlit(material: &Material) -> Material {
    let mut material = *material;
    match &mut material {
        Material::Standard(m) => m.emissive = DVec3::ZERO,
        Material::BlinnPhong(m) => m.emissive = DVec3::ZERO,
    }
    material
}

#[test]
fn a_scene_far_away_looks_the_same() {
    // At 10⁶ m an f64 has 1e-10 m; a highlight turns that into 1e-8 of its radiance at most.
    for seed in 0..4 {
        let scene = small(seed);
        let here = render(&scene, &UNSHADOWED);
        let there = render(&scene.shifted(DVec3::new(1e6, -1e6, 1e6)), &UNSHADOWED);
        // A pixel on the edge of a body may see the body or not.
        let off = here.pixels.iter().zip(&there.pixels);
        let edges = off.filter(|(a, b)| (**a - **b).abs().max_element() > 1e-6);
        assert!(edges.count() <= 1, "{seed}");
    }
}

#[test]
fn a_bad_light_is_none_or_a_good_one() {
    let scene = Scene {
        materials: small(5).materials.iter().map(unlit).collect(),
        ..small(5)
    };
    let given = texels(&scene);
    // Within a metre of what is seen.
    let seen = given.iter().flatten().nth(100).unwrap();
    let all = bad_lamps(seen.position + seen.normal);
    assert!(all.len() > 20);
    for bad in &all {
        assert_eq!(Source::new(&bad.lamp).is_some(), bad.kept, "{bad:?}");
        let lights = Lights::new(&[bad.lamp], &Ambient::default(), 1.0, SplitSum::Karis);
        let image = shade(&lights, 64, 36, DVec3::ZERO, &given).unwrap();
        assert!(image.pixels.iter().all(|p| p.is_finite()), "{bad:?}");
        let lit = image.pixels.iter().any(|p| p.max_element() > 0.0);
        assert_eq!(lit, bad.kept, "{bad:?}");
    }
}

#[test]
fn geometry_without_area_changes_nothing() {
    for seed in 0..3 {
        let scene = small(seed);
        let mut worse = scene.clone();
        add_degenerate(&mut worse);
        assert!(worse.objects.len() > scene.objects.len());
        let (a, b) = (&Options::default(), &Options::default());
        assert_eq!(render(&worse, a), render(&scene, b));
    }
}

#[test]
fn hostile_lights_are_where_they_are_said_to_be() {
    let scene = Scene {
        materials: small(2).materials.iter().map(unlit).collect(),
        ..small(2)
    };
    let given = texels(&scene);
    let camera = &scene.camera;
    let mut random = Random::new(1);
    for place in Place::ALL {
        let mut lit = 0;
        for _ in 0..60 {
            let lamp = place.lamp(camera, &mut random);
            let (position, range) = match lamp.kind {
                LampKind::Point { position, range }
                | LampKind::Spot {
                    position, range, ..
                } => (position, range),
                LampKind::Directional { .. } => panic!("{lamp:?}"),
            };
            let depth = -(camera.rotation.inverse() * (position - camera.position)).z;
            let fits = match place {
                Place::HoldsCamera => position.distance(camera.position) < range,
                Place::CutsNear => (depth - camera.near).abs() < range,
                Place::SubPixel => {
                    let pixel = 2.0 * (0.5 * camera.fov_y).tan() / f64::from(camera.height);
                    2.0 * range < pixel * depth
                }
                Place::Behind => depth < 0.0 && -depth < range,
                Place::AtCamera => position.distance(camera.position) == 0.0,
                Place::Needle | Place::Wide => matches!(lamp.kind, LampKind::Spot { .. }),
            };
            assert!(fits, "{place:?} {lamp:?}");
            assert!(Source::new(&lamp).is_some());
            let lights = Lights::new(&[lamp], &Ambient::default(), 1.0, SplitSum::Karis);
            let image = shade(&lights, 64, 36, DVec3::ZERO, &given).unwrap();
            assert!(image.pixels.iter().all(|p| p.is_finite()));
            lit += usize::from(image.pixels.iter().any(|p| p.max_element() > 0.0));
        }
        // A light below a pixel rarely touches anything.
        let rare = matches!(place, Place::SubPixel | Place::Needle | Place::CutsNear);
        assert!(rare || lit > 10, "{place:?}: {lit}");
    }
}

#[test]
fn light_is_computed_where_the_material_says() {
    let corners = [
        DVec3::ZERO,
        DVec3::new(0.0, 0.0, 3.0),
        DVec3::new(3.0, 0.0, 0.0),
    ];
    let tilted = |p: DVec3| (DVec3::Y + 0.4 * p).normalize();
    let scene = |interpolation: Interpolation| Scene {
        meshes: vec![Mesh {
            positions: corners.to_vec(),
            normals: corners.map(tilted).to_vec(),
            triangles: vec![[0, 1, 2]],
        }],
        objects: vec![Object::new(Shape::Mesh(0), Pose::default(), 0)],
        materials: vec![Material::BlinnPhong(BlinnPhong {
            interpolation,
            ..BlinnPhong::default()
        })],
        ..Scene::default()
    };
    let light = Lamp {
        shadows: false,
        ..Lamp::new(
            100.0,
            LampKind::Point {
                position: DVec3::new(0.5, 1.0, 0.5),
                range: 10.0,
            },
        )
    };
    let lights = Lights::new(&[light], &Ambient::default(), 1.0, SplitSum::Karis);
    let eye = DVec3::new(1.0, 4.0, 1.0);
    let at = |interpolation: Interpolation, target: DVec3| {
        let scene = scene(interpolation);
        let tracer = Tracer::new(&scene);
        let ray = Ray::new(eye, target - eye);
        let hit = tracer.hit(&ray, 0.0, 10.0, Sides::Front).unwrap();
        let surface = tracer.surface(&ray, &hit);
        lights
            .surface(&surface, &scene.materials[0], eye, 1.0, None)
            .x
    };
    let (a, b) = (DVec3::new(0.2, 0.0, 0.2), DVec3::new(0.6, 0.0, 1.0));
    let middle = 0.5 * (a + b);
    let curve = |i| at(i, middle) - 0.5 * (at(i, a) + at(i, b));
    // Gouraud is linear, and less bright below the light; flat shading is one value; the others follow the light.
    assert!(curve(Interpolation::Vertex).abs() < 1e-14);
    assert_eq!(at(Interpolation::Face, a), at(Interpolation::Face, b));
    assert!(curve(Interpolation::Pixel).abs() > 1e-3);
    assert!(curve(Interpolation::FaceNormal).abs() > 1e-3);
    assert!(at(Interpolation::Vertex, middle) < at(Interpolation::Pixel, middle));
    assert_ne!(
        at(Interpolation::FaceNormal, a),
        at(Interpolation::Pixel, a)
    );
}

#[test]
fn a_pixel_is_dark_where_the_way_to_the_light_is_not_free() {
    let (mut free, mut blocked) = (0, 0);
    for (seed, lamp) in [(0, 0), (1, 0), (2, 1), (3, 2)] {
        let scene = small(seed);
        let lamp = scene.lamps[lamp];
        let alone = Scene {
            lamps: vec![lamp],
            ambient: Ambient::default(),
            materials: scene.materials.iter().map(unlit).collect(),
            ..scene.clone()
        };
        let image = render(&alone, &Options::default());
        for (pixel, way) in image.pixels.iter().zip(free_ways(&alone, &lamp)) {
            match way {
                Some(true) => free += usize::from(pixel.max_element() > 0.0),
                Some(false) => {
                    blocked += 1;
                    assert_eq!(*pixel, DVec3::ZERO);
                }
                None => {}
            }
        }
    }
    assert!(free > 500 && blocked > 100, "{free} {blocked}");
}

#[test]
fn occlusion_of_each_pixel_is_what_dims_the_ambient_light() {
    let scene = Scene {
        lamps: Vec::new(),
        materials: small(6).materials.iter().map(unlit).collect(),
        ..small(6)
    };
    let how = Occlusion {
        rays: 64,
        ..Occlusion::default()
    };
    let bright = render(&scene, &UNSHADOWED);
    let dimmed = render(
        &scene,
        &Options {
            occlusion: Some(how),
            ..UNSHADOWED
        },
    );
    let shares = occlusions(&scene, &how);
    let mut below = 0;
    for ((bright, dimmed), share) in bright.pixels.iter().zip(&dimmed.pixels).zip(shares) {
        let share = share.unwrap_or(1.0);
        below += usize::from(share < 0.9);
        assert!((*bright * share - *dimmed).abs().max_element() < 1e-15);
    }
    assert!(below > 50, "{below}");
}

#[test]
fn exposure_is_a_factor_of_all_light_but_the_emissive_one() {
    let scene = small(1);
    let mut dim = scene.clone();
    dim.camera.exposure = 0.25;
    let emitted = Scene {
        lamps: Vec::new(),
        ambient: Ambient::default(),
        ..scene.clone()
    };
    let images = [scene, dim, emitted].map(|scene| render(&scene, &UNSHADOWED).pixels);
    let [bright, dim, emitted] = images;
    assert!(emitted.iter().any(|p| p.max_element() > 0.0));
    for ((bright, dim), emitted) in bright.iter().zip(&dim).zip(&emitted) {
        let exact = 0.25 * (*bright - *emitted) + *emitted;
        assert!((exact - *dim).abs().max_element() < 1e-14);
    }
}

#[test]
fn what_is_nearer_than_the_near_plane_is_not_seen() {
    let mut scene = small(1);
    let depths = |scene: &Scene| -> Vec<f64> {
        let camera = &scene.camera;
        let forward = camera.rotation * DVec3::NEG_Z;
        let seen = texels(scene).into_iter().flatten();
        seen.map(|t| (t.position - camera.position).dot(forward))
            .collect()
    };
    let least = |scene: &Scene| depths(scene).into_iter().fold(f64::INFINITY, f64::min);
    let before = least(&scene);
    scene.camera.near = before + 1.0;
    let after = least(&scene);
    assert!(
        after >= scene.camera.near - 1e-12 && after.is_finite(),
        "{before} {after}"
    );
}
