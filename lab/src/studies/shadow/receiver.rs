//! One receiver: a plane, something that stands before it and something that touches it, a spot light, a camera; and
//! the truth about each of its pixels.

use bevy::math::{DMat3, DQuat, DVec3};
use dolomite_light_oracle::light::Source;
use dolomite_light_oracle::per_pixel::texels;
use dolomite_light_oracle::random::Random;
use dolomite_light_oracle::scene::{
    Camera, Lamp, LampKind, Material, Object, Pose, Scene, Shape, Standard, cuboid, grid,
};
use dolomite_light_oracle::shade::visible;
use dolomite_light_oracle::trace::Tracer;
use std::f64::consts::TAU;

/// Half angle of the spot's cone, radians.
const OUTER: f64 = 0.5;

/// Texels on a side of a spot's map in an app that sets nothing.
pub const MAP: f64 = 2048.0;

/// Width of the band beside true edges in which a pixel may be wrong, texels.
pub const BAND: f64 = 1.5;

/// A receiver.
pub struct Receiver {
    /// What is drawn.
    pub scene: Scene,
    /// Between the light and the plane's normal, degrees.
    pub incidence: f64,
    /// Metres: half of the plane's side.
    pub size: f64,
    normal: DVec3,
}

/// What is true of a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Truth {
    /// Not of the plane, or out of the light's reach, or so near to an edge that either is right.
    Any,
    /// Lit.
    Lit,
    /// In shadow.
    Dark,
}

fn rounded(v: DVec3) -> DVec3 {
    v.as_vec3().as_dvec3()
}

/// A rotation of +Y to `normal`.
fn stand(normal: DVec3) -> DQuat {
    DQuat::from_rotation_arc(DVec3::Y, normal)
}

impl Receiver {
    /// Number `k` of `count`: incidence goes evenly from 0 to 89 degrees, sizes are spread from 0.1 m to 10 km.
    #[must_use]
    pub fn new(seed: u64, k: usize, count: usize, [width, height]: [u32; 2]) -> Self {
        let mut random = Random::new(seed ^ (k as u64) << 32);
        let incidence = 89.0 * (k as f64 + 0.5) / count as f64;
        let size = random.magnitude(0.1, 1e4);
        let normal = random.direction();
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        let turn = random.between(0.0, TAU);
        #[expect(clippy::disallowed_methods, reason = "scenes in f64")]
        let (across, [sin, cos]) = (
            turn.cos() * tangent + turn.sin() * bitangent,
            [incidence.to_radians().sin(), incidence.to_radians().cos()],
        );
        let to_light = cos * normal + sin * across;
        let mut scene = Scene {
            meshes: vec![grid(1.0, 1).rounded(), cuboid(DVec3::ONE).rounded()],
            materials: vec![Material::Standard(Standard {
                base_colour: DVec3::splat(0.5),
                metallic: 0.0,
                perceptual_roughness: 1.0,
                reflectance: 0.0,
                emissive: DVec3::ZERO,
            })],
            ..Scene::default()
        };
        let mut add = |mesh: usize, translation: DVec3, rotation: DQuat, scale: DVec3| {
            let pose = Pose {
                translation: rounded(translation),
                rotation: rotation.as_quat().as_dquat(),
                scale: rounded(scale),
            };
            scene.objects.push(Object::new(Shape::Mesh(mesh), pose, 0));
        };
        let flat = stand(normal);
        add(0, DVec3::ZERO, flat, DVec3::splat(size));
        // On the way of the light, and one that stands on the plane.
        let tumbled = DQuat::from_axis_angle(random.direction(), random.between(0.0, TAU));
        let before = DVec3::new(0.18, 0.1, 0.24) * size;
        add(1, (1.2 * size) * to_light, tumbled, before);
        let foot = DVec3::new(0.1, 0.15, 0.2) * size;
        let place = 0.35 * size * normal.cross(across) + 0.15 * size * normal;
        add(1, place, flat, foot);
        let position = rounded(4.0 * size * to_light);
        scene.lamps.push(Lamp::new(
            f64::from((1e3 * size * size) as f32),
            LampKind::Spot {
                position,
                range: f64::from((20.0 * size) as f32),
                direction: rounded(-to_light),
                inner: f64::from(0.45_f32),
                outer: f64::from(OUTER as f32),
            },
        ));
        // Off the light's way, so that shadows are not behind what casts them.
        let back = (normal + 0.5 * normal.cross(across) - 0.3 * across).normalize();
        let right = (if back.y.abs() > 0.9 {
            DVec3::X
        } else {
            DVec3::Y
        })
        .cross(back)
        .normalize();
        let rotation = DQuat::from_mat3(&DMat3::from_cols(right, back.cross(right), back));
        scene.camera = Camera {
            position: rounded(3.0 * size * back),
            rotation: rotation.as_quat().as_dquat(),
            fov_y: f64::from(0.7_f32),
            near: f64::from((0.01 * size) as f32),
            width,
            height,
            ..Camera::default()
        };
        Self {
            scene,
            incidence,
            size,
            normal,
        }
    }

    /// Of each pixel, rows from the top.
    #[must_use]
    pub fn truth(&self) -> Vec<Truth> {
        let tracer = Tracer::new(&self.scene);
        let lamp = &self.scene.lamps[0];
        let Some(source) = Source::new(lamp) else {
            return Vec::new();
        };
        let LampKind::Spot {
            position,
            direction,
            ..
        } = lamp.kind
        else {
            return Vec::new();
        };
        #[expect(clippy::disallowed_methods, reason = "the truth is in f64")]
        let texel = 2.0 * OUTER.tan() / MAP;
        let axis = direction.normalize();
        let (right, up) = axis.any_orthonormal_pair();
        // Whether a place of the plane is lit, moved by texels of the map.
        let lit = |place: DVec3, moved: [f64; 2]| {
            let away = place - position;
            let depth = away.dot(axis);
            let ray = away + texel * depth * (moved[0] * right + moved[1] * up);
            let t = -position.dot(self.normal) / ray.dot(self.normal);
            let place = position + t * ray;
            let arriving = source.at(place)?;
            Some(visible(&tracer, place, self.normal, &arriving))
        };
        // Around, at the border of the band and within.
        let around: Vec<[f64; 2]> = (0..24)
            .map(|k| {
                let angle = TAU * f64::from(k) / 24.0;
                #[expect(clippy::disallowed_methods, reason = "the truth is in f64")]
                let (sin, cos) = angle.sin_cos();
                let radius = BAND * [1.0, 0.67, 0.33][k as usize % 3];
                [radius * cos, radius * sin]
            })
            .collect();
        let pixel = |texel: &Option<dolomite_light_oracle::shade::Texel>| {
            let place = texel.as_ref()?.position;
            if place.dot(self.normal).abs() > 1e-6 * self.size {
                return None;
            }
            let own = lit(place, [0.0; 2])?;
            for moved in &around {
                if lit(place, *moved)? != own {
                    return None;
                }
            }
            Some(if own { Truth::Lit } else { Truth::Dark })
        };
        texels(&self.scene)
            .iter()
            .map(|texel| pixel(texel).unwrap_or(Truth::Any))
            .collect()
    }
}
