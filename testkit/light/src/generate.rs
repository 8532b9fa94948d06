//! A random scene for each seed: a floor, bodies on and above it, lamps between them, a camera that sees them.
//!
//! No body has a zero scale, no lamp a bad number, and the camera is in none of the bodies. For the opposite see
//! [`crate::hostile`].

use std::f64::consts::TAU;

use glam::{DMat3, DQuat, DVec3};

use crate::random::Random;
use crate::scene::{
    Ambient, BlinnPhong, Camera, Lamp, LampKind, Lobe, Material, Object, Pose, Scene, Shape,
    Standard, cone, cuboid, grid, icosphere, torus,
};

/// What a random scene is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recipe {
    /// The same seed is the same scene.
    pub seed: u64,
    /// Bodies besides the floor.
    pub objects: usize,
    /// Point and spot lights.
    pub lights: usize,
    /// Directional lights.
    pub suns: usize,
    /// Whether there is ambient light.
    pub ambient: bool,
    /// Share of the materials that are Blinn-Phong, `0..=1`.
    pub blinn_phong: f64,
    /// Share of these whose highlight is Phong's, `0..=1`.
    pub phong: f64,
    /// Share of the materials that emit light, `0..=1`.
    pub emissive: f64,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Default for Recipe {
    fn default() -> Self {
        Self {
            seed: 1,
            objects: 24,
            lights: 16,
            suns: 1,
            ambient: true,
            blinn_phong: 0.0,
            phong: 0.0,
            emissive: 0.1,
            width: 320,
            height: 180,
        }
    }
}

/// Half of the floor's side, in metres.
pub const FLOOR: f64 = 12.0;

/// The scene of a recipe. Every number in it is an f32.
pub fn generate(recipe: &Recipe) -> Scene {
    let random = &mut Random::new(recipe.seed);
    let meshes = vec![
        grid(FLOOR, 8).rounded(),
        cuboid(DVec3::ONE).rounded(),
        icosphere(3).rounded(),
        torus(0.75, 0.25, 32, 16).rounded(),
        cone(24).rounded(),
    ];
    let mut scene = Scene {
        meshes,
        ..Scene::default()
    };
    let floor = Pose::default();
    scene.materials.push(material(recipe, random));
    scene.objects.push(Object::new(Shape::Mesh(0), floor, 0));
    for _ in 0..recipe.objects {
        let shape = Shape::Mesh(1 + random.below(4));
        let size = random.magnitude(0.2, 1.6);
        let stretch = DVec3::from_array([(); 3].map(|()| random.between(0.6, 1.4)));
        let place = DVec3::new(
            random.between(-0.6 * FLOOR, 0.6 * FLOOR),
            random.between(0.0, 3.0),
            random.between(-0.6 * FLOOR, 0.6 * FLOOR),
        );
        let turn = DQuat::from_axis_angle(random.direction(), random.between(0.0, TAU));
        let pose = Pose {
            translation: place,
            rotation: turn,
            scale: size * stretch,
        };
        scene.materials.push(material(recipe, random));
        let material = scene.materials.len() - 1;
        scene
            .objects
            .push(Object::new(shape, rounded(pose), material));
    }
    lamps(recipe, random, &mut scene);
    scene.camera = camera(recipe, random, &scene);
    scene
}

fn colour(random: &mut Random, low: f64, high: f64) -> DVec3 {
    DVec3::from_array([(); 3].map(|()| f32_of(random.between(low, high))))
}

fn material(recipe: &Recipe, random: &mut Random) -> Material {
    let emissive = if random.chance(recipe.emissive) {
        colour(random, 0.0, 0.4)
    } else {
        DVec3::ZERO
    };
    if random.chance(recipe.blinn_phong) {
        let specular = random.between(0.0, 0.5);
        return Material::BlinnPhong(BlinnPhong {
            diffuse: colour(random, 0.02, 1.0 - specular),
            specular: colour(random, 0.5 * specular, specular),
            exponent: f32_of(random.magnitude(1.0, 256.0)),
            emissive,
            // Without a share of them no number is drawn: other scenes of a seed stay what they were.
            lobe: if recipe.phong > 0.0 && random.chance(recipe.phong) {
                Lobe::Phong
            } else {
                Lobe::Blinn
            },
            ..BlinnPhong::default()
        });
    }
    let metallic = match random.below(4) {
        0 => 1.0,
        1 => f32_of(random.unit()),
        _ => 0.0,
    };
    Material::Standard(Standard {
        base_colour: colour(random, 0.02, 0.95),
        metallic,
        perceptual_roughness: f32_of(random.between(0.0, 1.0)),
        reflectance: f32_of(random.between(0.0, 1.0)),
        emissive,
    })
}

fn lamps(recipe: &Recipe, random: &mut Random, scene: &mut Scene) {
    let downwards = |random: &mut Random| loop {
        let d = random.direction();
        if d.y < -0.25 {
            return d.as_vec3().as_dvec3();
        }
    };
    for _ in 0..recipe.suns {
        let direction = downwards(random);
        scene.lamps.push(Lamp {
            colour: colour(random, 0.5, 1.0),
            ..Lamp::new(
                f32_of(random.between(0.2, 1.5)),
                LampKind::Directional { direction },
            )
        });
    }
    // A sphere of radius 4 covers 50 m² of the floor's 576: so many lamps shine on each place.
    let overlap = (recipe.lights as f64 * 50.0 / (4.0 * FLOOR * FLOOR)).max(1.0);
    for _ in 0..recipe.lights {
        let position = DVec3::new(
            random.between(-FLOOR, FLOOR),
            random.between(0.2, 5.0),
            random.between(-FLOOR, FLOOR),
        );
        let position = position.as_vec3().as_dvec3();
        let range = f32_of(random.between(2.0, 6.0));
        let kind = if random.chance(0.4) {
            let outer = random.between(0.15, 1.4);
            LampKind::Spot {
                position,
                range,
                direction: downwards(random),
                inner: f32_of(outer * random.between(0.0, 0.98)),
                outer: f32_of(outer),
            }
        } else {
            LampKind::Point { position, range }
        };
        // Some lux at half of the range.
        let lux = random.magnitude(0.5, 4.0) / overlap;
        let lumens = lux * 0.25 * range * range * 2.0 * TAU;
        scene.lamps.push(Lamp {
            colour: colour(random, 0.2, 1.0),
            ..Lamp::new(f32_of(lumens), kind)
        });
    }
    if recipe.ambient {
        scene.ambient = Ambient {
            colour: colour(random, 0.5, 1.0),
            brightness: f32_of(random.between(0.02, 0.2)),
        };
    }
}

fn camera(recipe: &Recipe, random: &mut Random, scene: &Scene) -> Camera {
    let free = |place: DVec3| {
        scene.objects.iter().skip(1).all(|object| {
            // Every shape lies in the ball of radius √3 about its middle.
            let radius = 3.0_f64.sqrt() * object.pose.scale.max_element();
            object.pose.translation.distance(place) > radius + 0.2
        })
    };
    let position = loop {
        let angle = random.between(0.0, TAU);
        let distance = random.between(5.0, 14.0);
        let place = DVec3::new(
            distance * angle.cos(),
            random.between(1.0, 8.0),
            distance * angle.sin(),
        );
        if free(place) {
            break place.as_vec3().as_dvec3();
        }
    };
    let target = DVec3::new(
        random.between(-3.0, 3.0),
        random.between(0.0, 2.0),
        random.between(-3.0, 3.0),
    );
    let back = (position - target).normalize();
    let right = DVec3::Y.cross(back).normalize();
    let rotation = DQuat::from_mat3(&DMat3::from_cols(right, back.cross(right), back));
    Camera {
        position,
        rotation: rotation.as_quat().as_dquat(),
        fov_y: f32_of(random.between(0.6, 1.3)),
        near: f32_of(0.1),
        width: recipe.width,
        height: recipe.height,
        ..Camera::default()
    }
}

/// The nearest f32.
fn f32_of(x: f64) -> f64 {
    f64::from(x as f32)
}

fn rounded(pose: Pose) -> Pose {
    Pose {
        translation: pose.translation.as_vec3().as_dvec3(),
        rotation: pose.rotation.as_quat().as_dquat(),
        scale: pose.scale.as_vec3().as_dvec3(),
    }
}
