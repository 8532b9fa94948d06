//! Single truths at the middle of each pixel, row by row: what a renderer's passes are held against one by one. A pixel
//! that shows no object has none.

use crate::light::Source;
use crate::occlusion::{Occlusion, occlusion};
use crate::render::{Options, View};
use crate::rows::in_parallel;
use crate::scene::{Lamp, Scene};
use crate::shade::{Texel, visible};
use crate::trace::{Surface, Tracer};

/// What the camera sees: the true G-buffer. Materials that are not evaluated a pixel at a time are given as if they were.
pub fn texels(scene: &Scene) -> Vec<Option<Texel>> {
    each(scene, |_, surface| {
        Some(Texel {
            position: surface.position,
            normal: surface.normal,
            view: (scene.camera.position - surface.position).normalize(),
            material: *scene.materials.get(surface.material)?,
            occlusion: 1.0,
        })
    })
}

/// The share of ambient light that arrives.
pub fn occlusions(scene: &Scene, how: &Occlusion) -> Vec<Option<f64>> {
    each(scene, |tracer, surface| {
        let Surface {
            position,
            normal,
            face,
            ..
        } = *surface;
        Some(occlusion(tracer, position, normal, face, how))
    })
}

/// Whether a light's way to the surface is free, where the light reaches at all: within its range and its cone, and on
/// the side of the triangle that faces it.
pub fn free_ways(scene: &Scene, lamp: &Lamp) -> Vec<Option<bool>> {
    let source = Source::new(lamp);
    each(scene, |tracer, surface| {
        let arriving = source?.at(surface.position)?;
        let faces = surface.face.dot(arriving.direction) > 0.0;
        faces.then(|| visible(tracer, surface.position, surface.face, &arriving))
    })
}

/// `of` for the surface at the middle of each pixel.
fn each<T: Send>(
    scene: &Scene,
    of: impl Fn(&Tracer, &Surface) -> Option<T> + Sync,
) -> Vec<Option<T>> {
    let options = Options::default();
    let view = View::new(scene, &options);
    let camera = &scene.camera;
    in_parallel(camera.height, |y| {
        let pixel = |x: u32| {
            let ray = camera.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
            of(&view.tracer, &view.surface(&ray)?)
        };
        (0..camera.width).map(pixel).collect()
    })
}
