//! Images.

use glam::DVec3;

use crate::image::Image;
use crate::model::SplitSum;
use crate::occlusion::{Occlusion, disc, occlusion};
use crate::random::{Random, hammersley};
use crate::rows::in_parallel;
use crate::scene::Scene;
use crate::shade::Lights;
use crate::trace::{Ray, Sides, Surface, Tracer};

/// What an image takes part of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Whether lights that ask for it are blocked by objects.
    pub shadows: bool,
    /// Whether the ambient light is.
    pub occlusion: Option<Occlusion>,
    /// See [`SplitSum`].
    pub split_sum: SplitSum,
    /// Rays a pixel: 1 is its middle, as a renderer without multisampling has it. More are spread over the pixel, and
    /// over the lens if the camera has one.
    pub samples: u32,
    /// Of the samples.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            shadows: true,
            occlusion: None,
            split_sum: SplitSum::Karis,
            samples: 1,
            seed: 0,
        }
    }
}

/// A scene that is looked at.
pub(crate) struct View<'a> {
    scene: &'a Scene,
    pub(crate) tracer: Tracer,
    lights: Lights,
    options: &'a Options,
}

impl<'a> View<'a> {
    pub(crate) fn new(scene: &'a Scene, options: &'a Options) -> Self {
        let exposure = scene.camera.exposure;
        Self {
            scene,
            tracer: Tracer::new(scene),
            lights: Lights::new(&scene.lamps, &scene.ambient, exposure, options.split_sum),
            options,
        }
    }

    /// What this ray of the camera meets.
    pub(crate) fn surface(&self, ray: &Ray) -> Option<Surface> {
        let near = self.scene.camera.near;
        let hit = self.tracer.hit(ray, near, f64::INFINITY, Sides::Front)?;
        Some(self.tracer.surface(ray, &hit))
    }

    fn radiance(&self, ray: &Ray) -> DVec3 {
        let Some(surface) = self.surface(ray) else {
            return self.scene.background;
        };
        let Some(material) = self.scene.materials.get(surface.material) else {
            return self.scene.background;
        };
        let share = self.options.occlusion.map_or(1.0, |how| {
            let Surface {
                position,
                normal,
                face,
                ..
            } = surface;
            occlusion(&self.tracer, position, normal, face, &how)
        });
        let tracer = self.options.shadows.then_some(&self.tracer);
        self.lights
            .surface(&surface, material, ray.origin, share, tracer)
    }

    fn pixel(&self, x: u32, y: u32) -> DVec3 {
        let camera = &self.scene.camera;
        let [left, top] = [x, y].map(f64::from);
        if self.options.samples <= 1 {
            return self.radiance(&camera.ray(left + 0.5, top + 0.5));
        }
        let place = u64::from(y) << 32 | u64::from(x);
        let mut random = Random::new(Random::new(self.options.seed ^ place).bits());
        let mut shift = || [random.unit(), random.unit()];
        let (on_pixel, on_lens) = (shift(), shift());
        let samples = self.options.samples;
        // The lens takes the set in another order, so that it does not follow the pixel.
        let mut order: Vec<u32> = (0..samples).collect();
        for i in (1..order.len()).rev() {
            order.swap(i, random.below(i + 1));
        }
        let sum: DVec3 = (0..samples)
            .map(|i| {
                let [dx, dy] = hammersley(i, samples, on_pixel);
                let (x, y) = (left + dx, top + dy);
                let ray = camera.lens.map_or_else(
                    || camera.ray(x, y),
                    |lens| {
                        let square = hammersley(order[i as usize], samples, on_lens);
                        camera.lens_ray(x, y, &lens, disc(square))
                    },
                );
                self.radiance(&ray)
            })
            .sum();
        sum / f64::from(samples)
    }
}

/// The image that the scene's camera has of it, on all cores; the values do not depend on how many there are. An image
/// without pixels has none.
pub fn render(scene: &Scene, options: &Options) -> Image {
    let view = View::new(scene, options);
    let (width, height) = (scene.camera.width, scene.camera.height);
    let pixels = in_parallel(height, |y| (0..width).map(|x| view.pixel(x, y)).collect());
    Image {
        width,
        height,
        pixels,
    }
}

/// The mean of `frames` images while a shutter of `seconds` is open, each at the middle of its part of the time, of the
/// scene as `at` has it then ([`Scene::after`] moves objects and camera).
pub fn shutter(
    seconds: f64,
    frames: u32,
    options: &Options,
    at: impl Fn(f64) -> Scene,
) -> Option<Image> {
    let mut mean: Option<Image> = None;
    for k in 0..frames {
        let scene = at(seconds * (f64::from(k) + 0.5) / f64::from(frames));
        let seed = Random::new(options.seed ^ u64::from(k)).bits();
        let image = render(&scene, &Options { seed, ..*options });
        match &mut mean {
            None => mean = Some(image),
            Some(sum) => {
                for (a, b) in sum.pixels.iter_mut().zip(&image.pixels) {
                    *a += *b;
                }
            }
        }
    }
    if let Some(sum) = &mut mean {
        for pixel in &mut sum.pixels {
            *pixel /= f64::from(frames);
        }
    }
    mean
}
