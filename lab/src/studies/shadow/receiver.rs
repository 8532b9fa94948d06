//! A surface that a shadow falls on: at any angle to the light, near or far from it, with a body that blocks it.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use bevy::math::{DMat3, DQuat, DVec3, ops};
use dolomite_light_oracle::Scene;
use dolomite_light_oracle::per_pixel::ShadowTexels;
use dolomite_light_oracle::random::Random;
use dolomite_light_oracle::scene::{
    Camera, Lamp, LampKind, Material, Object, Pose, Shape, Standard, cuboid, grid, icosphere,
};

/// Kinds of lights, by turns.
pub const KINDS: [&str; 3] = ["point", "spot", "directional"];

/// A receiver, its light and who looks.
pub struct Receiver {
    /// The light is the only one.
    pub scene: Scene,
    /// Index into [`KINDS`].
    pub kind: usize,
    /// Between the light's way and the normal, degrees.
    pub incidence: f64,
    /// How far from the camera the map of a directional light reaches, metres.
    pub far: f64,
}

/// Texels on a side of the maps of point lights and of the others: Bevy's defaults.
pub const SIDES: [f64; 2] = [1024.0, 2048.0];

/// Pixels on a side of a frame.
pub const PIXELS: u32 = 48;

impl Receiver {
    /// The `index`-th of a seed. Every number of it is an f32.
    pub fn new(seed: u32, index: usize) -> Self {
        let random = &mut Random::new(u64::from(seed) << 32 | index as u64);
        let kind = index % KINDS.len();
        let incidence = random.between(0.0, 89.0);
        let distance = random.magnitude(0.5, 50.0);
        let normal = random.direction();
        let (tangent, _) = normal.any_orthonormal_pair();
        let turned = DQuat::from_axis_angle(normal, random.between(0.0, TAU)) * tangent;
        let to_light = DQuat::from_axis_angle(turned, incidence.to_radians()) * normal;
        let middle = f32s(random.direction() * random.between(0.0, 10.0));
        let light = f32s(middle + distance * to_light);
        let floor = pose(middle, DQuat::from_rotation_arc(DVec3::Y, normal), distance);
        let size = distance * random.magnitude(0.03, 0.2);
        // A third stands on the floor.
        let height = if random.chance(1.0 / 3.0) {
            0.0
        } else {
            distance * random.between(0.02, 0.4)
        };
        let place = middle + (height + 0.9 * size) * normal;
        let ball = random.chance(0.3);
        let turn = DQuat::from_axis_angle(random.direction(), random.between(0.0, TAU));
        let body = pose(
            place,
            if height > 0.0 { turn } else { floor.rotation },
            size,
        );
        let outer = f32_of(random.between(0.3, 0.8));
        let direction = f32s(-to_light);
        let range = f32_of(8.0 * distance);
        let power = f32_of(4.0 * PI * distance * distance);
        let lamp = match kind {
            0 => Lamp::new(
                power,
                LampKind::Point {
                    position: light,
                    range,
                },
            ),
            1 => {
                let position = light;
                let inner = f32_of(0.9 * outer);
                let spot = LampKind::Spot {
                    position,
                    range,
                    direction,
                    inner,
                    outer,
                };
                Lamp::new(power, spot)
            }
            _ => Lamp::new(1.0, LampKind::Directional { direction }),
        };
        let dist = 0.7 * distance;
        let far = 4.0 * dist;
        let texel = match kind {
            0 => 2.0 * distance / SIDES[0],
            1 => 2.0 * distance * f64::from(ops::tan(outer as f32)) / SIDES[1],
            // About what Bevy rounds up the length of the view to.
            _ => far.ceil() / SIDES[1],
        };
        // From half a texel a pixel, where edges fill the picture, to where it is all of the body.
        let wide = f64::from(PIXELS) * texel * random.magnitude(0.5, 30.0);
        let along = if kind == 2 { -to_light } else { place - light };
        let camera = camera(random, (place, along), (middle, normal), dist, wide);
        let shapes = vec![
            grid(1.0, 1).rounded(),
            cuboid(DVec3::ONE).rounded(),
            icosphere(3).rounded(),
        ];
        Self {
            scene: Scene {
                meshes: shapes,
                materials: vec![Material::Standard(Standard {
                    base_colour: DVec3::splat(0.5),
                    metallic: 0.0,
                    perceptual_roughness: 1.0,
                    reflectance: 0.0,
                    emissive: DVec3::ZERO,
                })],
                objects: vec![
                    Object::new(Shape::Mesh(0), floor, 0),
                    Object::new(Shape::Mesh(if ball { 2 } else { 1 }), body, 0),
                ],
                lamps: vec![lamp],
                camera,
                ..Scene::default()
            },
            kind,
            incidence,
            far,
        }
    }

    /// Texels of its map; `metres` is what the app says of a directional light's.
    pub fn texels(&self, metres: f64) -> ShadowTexels {
        ShadowTexels {
            side: SIDES[usize::from(self.kind > 0)],
            metres,
        }
    }
}

/// Looks at where the shadow of a body falls, from above the floor; `along` is the way of the light.
fn camera(
    random: &mut Random,
    (body, along): (DVec3, DVec3),
    (middle, normal): (DVec3, DVec3),
    distance: f64,
    wide: f64,
) -> Camera {
    let steps = normal.dot(middle - body) / normal.dot(along);
    let shadow = body + steps * along;
    // At grazing light the shadow leaves the floor.
    let shadow = if shadow.distance(middle) > 0.5 * distance {
        middle
    } else {
        shadow
    };
    let back = loop {
        let way = random.direction();
        if way.dot(normal) > 0.3 {
            break way;
        }
    };
    let position = f32s(shadow + distance * back);
    let right = back.any_orthonormal_pair().0;
    let rotation = DQuat::from_mat3(&DMat3::from_cols(right, back.cross(right), back));
    let half = ops::atan2((0.5 * wide) as f32, distance as f32);
    Camera {
        position,
        rotation: rotation.as_quat().as_dquat(),
        fov_y: f32_of((2.0 * f64::from(half)).min(0.9 * FRAC_PI_2)),
        near: f32_of(0.02),
        width: PIXELS,
        height: PIXELS,
        ..Camera::default()
    }
}

fn f32_of(x: f64) -> f64 {
    f64::from(x as f32)
}

fn f32s(v: DVec3) -> DVec3 {
    v.as_vec3().as_dvec3()
}

fn pose(translation: DVec3, rotation: DQuat, size: f64) -> Pose {
    Pose {
        translation: f32s(translation),
        rotation: rotation.as_quat().as_dquat(),
        scale: DVec3::splat(f32_of(size)),
    }
}
