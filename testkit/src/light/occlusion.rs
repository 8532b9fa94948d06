//! Ambient occlusion of a frame: what it is of the light, and what the passes that look for it see.

use bevy::math::{DVec3, UVec2, Vec2, Vec3};
use dolomite_deferred::gbuffer;
use dolomite_deferred::occlusion::reference::{Projection, Screen};
use dolomite_light_oracle::scene::{Ambient, Camera, Material, Scene, Standard};

use super::app::Picture;
use super::gbuffer::Pixel;

/// The base colour of every surface of [`in_ambient_light`].
pub const GREY: f64 = 0.5;

/// The scene in white light from everywhere and no other, all of one grey.
#[must_use]
pub fn in_ambient_light(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.lamps.clear();
    for material in &mut scene.materials {
        *material = Material::Standard(Standard {
            base_colour: DVec3::splat(GREY),
            metallic: 0.0,
            perceptual_roughness: 1.0,
            reflectance: 0.0,
            emissive: DVec3::ZERO,
        });
    }
    scene.ambient = Ambient {
        colour: DVec3::ONE,
        brightness: 1.0,
    };
    scene
}

/// What light from everywhere becomes of a share that arrives, where it is reflected more than once (Jimenez, Wu, Pesce,
/// Jarabo 2016, of whose fit Bevy's shader has the rounded numbers).
#[must_use]
pub fn reflected_often(share: f64, albedo: f64) -> f64 {
    let a = 2.0404 * albedo - 0.3324;
    let b = -4.7951 * albedo + 0.6417;
    let c = 2.7552 * albedo + 0.6903;
    share.max(((share * a + b) * share + c) * share)
}

/// The share of the light from everywhere of each pixel, from two frames of [`in_ambient_light`]: with and without
/// occlusion. `None` where nothing is seen.
#[must_use]
pub fn shares(with: &Picture, without: &Picture) -> Vec<Option<f64>> {
    let both = with.pixels.iter().zip(&without.pixels);
    both.map(|(with, without)| {
        (without[0] > 0.0).then(|| {
            let ratio = f64::from(with[0]) / f64::from(without[0]);
            let (mut low, mut high) = (0.0, 1.0);
            // It rises with the share.
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if reflected_often(middle, GREY) < ratio {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            0.5 * (low + high)
        })
    })
    .collect()
}

/// What the passes see, decoded from a G-buffer.
#[derive(Debug, Clone)]
pub struct Seen {
    /// Pixels.
    pub size: UVec2,
    /// Metres along the camera's axis; 0 where there is nothing.
    pub depths: Vec<f32>,
    /// In view space.
    pub normals: Vec<Vec3>,
    /// Of the camera.
    pub projection: Projection,
}

impl Seen {
    /// By this camera.
    #[must_use]
    pub fn new(pixels: &[Pixel], eye: &Camera) -> Self {
        let to_view = eye.rotation.inverse();
        let view = |normal: Vec3| {
            let normal = DVec3::new(normal.x.into(), normal.y.into(), normal.z.into());
            let [x, y, z] = (to_view * normal).to_array().map(|x| x as f32);
            Vec3::new(x, y, z)
        };
        let depth = |pixel: &Pixel| {
            if pixel.depth > 0.0 {
                eye.near as f32 / pixel.depth
            } else {
                0.0
            }
        };
        let upper = bevy::math::ops::tan(0.5 * eye.fov_y as f32);
        let aspect = eye.width as f32 / eye.height as f32;
        Self {
            size: UVec2::new(eye.width, eye.height),
            depths: pixels.iter().map(depth).collect(),
            normals: pixels
                .iter()
                .map(|pixel| view(gbuffer::unpack_normal(pixel.words[3])))
                .collect(),
            projection: Projection {
                tangents: Vec2::new(upper * aspect, upper),
                orthographic: false,
            },
        }
    }

    /// For the passes on the CPU.
    #[must_use]
    pub fn screen(&self) -> Screen<'_> {
        Screen {
            size: self.size,
            depths: &self.depths,
            normals: &self.normals,
            projection: self.projection,
        }
    }
}
