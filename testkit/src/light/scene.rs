//! From the oracle's scene to an app's, and from a G-buffer back to the oracle's surfaces.

use bevy::asset::RenderAssetUsages;
use bevy::camera::{Exposure, PerspectiveProjection, Projection};
use bevy::math::{DQuat, DVec3};
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use dolomite_deferred::render::Lobe;
use dolomite_deferred::{BlinnPhongMaterial, gbuffer};
use dolomite_light_oracle::scene::{self, Lamp, LampKind, Shape};
use dolomite_light_oracle::shade::Texel;

use super::app;
use super::gbuffer::Pixel;

/// What was made of a scene.
pub struct Spawned {
    /// Its camera; the target holds 32-bit floats.
    pub camera: Entity,
    /// Everything else.
    pub others: Vec<Entity>,
}

fn vec3(v: DVec3) -> Vec3 {
    Vec3::new(v.x as f32, v.y as f32, v.z as f32)
}

fn quat(q: DQuat) -> Quat {
    Quat::from_xyzw(q.x as f32, q.y as f32, q.z as f32, q.w as f32)
}

fn dvec3(v: Vec3) -> DVec3 {
    DVec3::new(v.x.into(), v.y.into(), v.z.into())
}

fn linear(v: DVec3) -> LinearRgba {
    let v = vec3(v);
    LinearRgba::rgb(v.x, v.y, v.z)
}

fn mesh(mesh: &scene::Mesh) -> Mesh {
    let rows = |all: &[DVec3]| all.iter().map(|v| vec3(*v).to_array()).collect::<Vec<_>>();
    let indices = mesh.triangles.iter().flatten().copied().collect();
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::RENDER_WORLD,
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, rows(&mesh.positions))
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, rows(&mesh.normals))
    .with_inserted_indices(Indices::U32(indices))
}

enum Handles {
    Standard(Handle<StandardMaterial>),
    BlinnPhong(Handle<BlinnPhongMaterial>),
}

fn material(app: &mut App, material: &scene::Material) -> Handles {
    match material {
        scene::Material::Standard(m) => {
            let standard = StandardMaterial {
                base_color: linear(m.base_colour).into(),
                metallic: m.metallic as f32,
                perceptual_roughness: m.perceptual_roughness as f32,
                reflectance: m.reflectance as f32,
                emissive: linear(m.emissive),
                ..default()
            };
            Handles::Standard(app.world_mut().resource_mut::<Assets<_>>().add(standard))
        }
        scene::Material::BlinnPhong(m) => {
            let shiny = BlinnPhongMaterial {
                diffuse: linear(m.diffuse),
                specular: linear(m.specular),
                emissive: linear(m.emissive),
                exponent: m.exponent as f32,
                lobe: match m.lobe {
                    scene::Lobe::Blinn => Lobe::Blinn,
                    scene::Lobe::Phong => Lobe::Phong,
                },
                faceted: m.interpolation == scene::Interpolation::FaceNormal,
                ..default()
            };
            Handles::BlinnPhong(app.world_mut().resource_mut::<Assets<_>>().add(shiny))
        }
    }
}

/// Without shadows.
fn lamp(app: &mut App, lamp: &Lamp) -> Entity {
    let color: Color = linear(lamp.colour).into();
    let power = lamp.power as f32;
    let towards = |from: DVec3, direction: DVec3| {
        let direction = vec3(direction);
        let up = if direction.normalize_or_zero().y.abs() > 0.9 {
            Vec3::X
        } else {
            Vec3::Y
        };
        Transform::from_translation(vec3(from)).looking_to(direction, up)
    };
    match lamp.kind {
        LampKind::Directional { direction } => {
            let light = DirectionalLight {
                color,
                illuminance: power,
                ..default()
            };
            app.world_mut()
                .spawn((light, towards(DVec3::ZERO, direction)))
                .id()
        }
        LampKind::Point { position, range } => {
            let light = PointLight {
                color,
                intensity: power,
                range: range as f32,
                radius: 0.0,
                ..default()
            };
            let place = Transform::from_translation(vec3(position));
            app.world_mut().spawn((light, place)).id()
        }
        LampKind::Spot {
            position,
            range,
            direction,
            inner,
            outer,
        } => {
            let light = SpotLight {
                color,
                intensity: power,
                range: range as f32,
                radius: 0.0,
                inner_angle: inner as f32,
                outer_angle: outer as f32,
                ..default()
            };
            app.world_mut()
                .spawn((light, towards(position, direction)))
                .id()
        }
    }
}

/// Makes a scene of triangles; `components` go to its camera. Exact spheres and planes have no triangles and are
/// left out.
pub fn spawn(app: &mut App, scene: &scene::Scene, components: impl Bundle) -> Spawned {
    let meshes: Vec<Handle<Mesh>> = scene
        .meshes
        .iter()
        .map(|m| app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh(m)))
        .collect();
    let materials: Vec<Handles> = scene.materials.iter().map(|m| material(app, m)).collect();
    let mut others = Vec::new();
    for object in &scene.objects {
        let Shape::Mesh(index) = object.shape else {
            continue;
        };
        let (Some(mesh), Some(material)) = (meshes.get(index), materials.get(object.material))
        else {
            continue;
        };
        let place = Transform {
            translation: vec3(object.pose.translation),
            rotation: quat(object.pose.rotation),
            scale: vec3(object.pose.scale),
        };
        let mut entity = app.world_mut().spawn((Mesh3d(mesh.clone()), place));
        match material {
            Handles::Standard(handle) => entity.insert(MeshMaterial3d(handle.clone())),
            Handles::BlinnPhong(handle) => entity.insert(MeshMaterial3d(handle.clone())),
        };
        others.push(entity.id());
    }
    others.extend(scene.lamps.iter().map(|l| lamp(app, l)));
    app.insert_resource(GlobalAmbientLight {
        color: linear(scene.ambient.colour).into(),
        brightness: scene.ambient.brightness as f32,
        ..default()
    });
    app.insert_resource(ClearColor(linear(scene.background).into()));
    let eye = &scene.camera;
    let place = Transform::from_translation(vec3(eye.position)).with_rotation(quat(eye.rotation));
    let camera = app::camera(app, [eye.width, eye.height], place, components);
    let projection = Projection::Perspective(PerspectiveProjection {
        fov: eye.fov_y as f32,
        near: eye.near as f32,
        far: 1e4,
        ..default()
    });
    // 2^-EV100 / 1.2.
    let exposure = Exposure {
        ev100: -bevy::math::ops::log2(1.2 * eye.exposure as f32),
    };
    app.world_mut()
        .entity_mut(camera)
        .insert((projection, exposure));
    Spawned { camera, others }
}

/// The surfaces that the words of a G-buffer say, decoded in f64, for the oracle to shade: what is left between it
/// and a frame is arithmetic. `eye` is the camera that saw them; its matrices are taken as f32 has them.
#[must_use]
pub fn decoded(pixels: &[Pixel], eye: &scene::Camera) -> Vec<Option<Texel>> {
    let unorm = |word: u32, k: u32| f64::from((word >> (8 * k)) & 255) / 255.0;
    // f64 from here on: the words are exact, and what they mean is defined by these equations.
    let color = |word: u32| DVec3::from_array([0, 1, 2].map(|k| power(unorm(word, k), 2.2)));
    let texel = |index: usize, pixel: &Pixel| {
        if pixel.id == 0 {
            return None;
        }
        let (x, y) = (index as u32 % eye.width, index as u32 / eye.width);
        let depth = f64::from(eye.near as f32) / f64::from(pixel.depth);
        let ray = eye.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let position = ray.at(depth);
        let words = pixel.words;
        let normal = normal(words[3]);
        let emissive = dvec3(gbuffer::unpack_emissive(words[1]));
        let material = if pixel.id == 2 {
            scene::Material::BlinnPhong(scene::BlinnPhong {
                diffuse: color(words[0]),
                specular: color(words[2]),
                exponent: power(
                    2.0,
                    16.0 * f64::from((words[0] >> 24 << 8) | (words[2] >> 24)) / 65535.0,
                ),
                emissive,
                lobe: if gbuffer::unpack_flags(words[3]) & gbuffer::PHONG == 0 {
                    scene::Lobe::Blinn
                } else {
                    scene::Lobe::Phong
                },
                ..default()
            })
        } else {
            scene::Material::Standard(scene::Standard {
                base_colour: color(words[0]),
                perceptual_roughness: unorm(words[0], 3),
                reflectance: unorm(words[2], 0),
                metallic: unorm(words[2], 1),
                emissive,
            })
        };
        Some(Texel {
            position,
            normal,
            view: (eye.position - position).normalize(),
            material,
            occlusion: unorm(words[2], 2),
        })
    };
    pixels
        .iter()
        .enumerate()
        .map(|(index, pixel)| {
            let mut texel = texel(index, pixel)?;
            if pixel.id == 2 {
                texel.occlusion = 1.0;
            }
            Some(texel)
        })
        .collect()
}

/// x^y, for x from 0.
#[expect(clippy::disallowed_methods, reason = "an oracle in f64")]
fn power(x: f64, y: f64) -> f64 {
    x.powf(y)
}

/// Octahedral (Meyer 2010), 12 bits a coordinate.
fn normal(word: u32) -> DVec3 {
    let [x, y] = [word, word >> 12].map(|bits| f64::from(bits & 4095) / 4095.0 * 2.0 - 1.0);
    let z = 1.0 - x.abs() - y.abs();
    let t = (-z).clamp(0.0, 1.0);
    let fold = |c: f64| if c >= 0.0 { c - t } else { c + t };
    DVec3::new(fold(x), fold(y), z).normalize()
}
