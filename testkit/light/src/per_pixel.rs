//! Single truths at the middle of each pixel, row by row: what a renderer's passes are held against one by one. A pixel
//! that shows no object has none.

use glam::DVec3;

use crate::light::Source;
use crate::occlusion::{Occlusion, occlusion};
use crate::render::{Options, View};
use crate::rows::in_parallel;
use crate::scene::{Lamp, LampKind, Scene};
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

/// The texels of a light's shadow map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowTexels {
    /// On a side of a spot light's map, or of one of the six faces of a point light's, which are those of the cube along
    /// the axes of the world.
    pub side: f64,
    /// Metres on a side of one of a directional light.
    pub metres: f64,
}

/// A light's way to a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Way {
    /// Whether nothing blocks it.
    pub free: bool,
    /// Texels of the shadow map around it within which all that was looked at is so too; 0: none.
    pub alike: f64,
}

/// Ways that are looked at on each circle of [`ways_around`].
const AROUND: u32 = 12;

/// The ways of [`free_ways`] with how far they are from a shadow's edge: around each, on circles in the shadow map of the
/// given `radii` (texels, rising), the ways to the plane of the surface are looked at. A way whose neighbours miss the plane
/// or lie outside of the light's reach is as near to an edge.
pub fn ways_around(
    scene: &Scene,
    lamp: &Lamp,
    map: ShadowTexels,
    radii: &[f64],
) -> Vec<Option<Way>> {
    let source = Source::new(lamp);
    each(scene, |tracer, surface| {
        let source = source?;
        let (position, face) = (surface.position, surface.face);
        let arriving = source.at(position)?;
        if face.dot(arriving.direction) <= 0.0 {
            return None;
        }
        let free = visible(tracer, position, face, &arriving);
        let texel = texel_at(lamp, position, map);
        let as_free = |radius: f64, k: u32| {
            let (sin, cos) = (f64::from(k) / f64::from(AROUND) * std::f64::consts::TAU).sin_cos();
            let beside = position + radius * (cos * texel[0] + sin * texel[1]);
            // Where the light's way through there meets the plane of the surface.
            let (from, along) = match lamp.position() {
                Some(from) => (from, beside - from),
                None => (beside, arriving.direction),
            };
            let steps = face.dot(position - from) / face.dot(along);
            let place = from + steps * along;
            let before = lamp.position().is_none() || steps > 0.0;
            let there = source.at(place).filter(|_| before && place.is_finite());
            there.is_some_and(|there| visible(tracer, place, face, &there) == free)
        };
        let mut alike = 0.0;
        for radius in radii {
            if !(0..AROUND).all(|k| as_free(*radius, k)) {
                break;
            }
            alike = *radius;
        }
        Some(Way { free, alike })
    })
}

/// Along both sides of a texel, in the plane through a place that lies as the shadow map does, metres.
fn texel_at(lamp: &Lamp, place: DVec3, map: ShadowTexels) -> [DVec3; 2] {
    let across = |axis: DVec3, metres: f64| {
        let (a, b) = axis.any_orthonormal_pair();
        [metres * a, metres * b]
    };
    match lamp.kind {
        LampKind::Directional { direction } => across(direction.normalize(), map.metres),
        LampKind::Point { position, .. } => {
            let away = place - position;
            let size = away.abs();
            let axis = if size.max_element() == size.x {
                DVec3::X
            } else if size.max_element() == size.y {
                DVec3::Y
            } else {
                DVec3::Z
            };
            across(axis, 2.0 * size.max_element() / map.side)
        }
        LampKind::Spot {
            position,
            direction,
            outer,
            ..
        } => {
            let axis = direction.normalize();
            let depth = axis.dot(place - position);
            across(axis, 2.0 * depth * outer.tan() / map.side)
        }
    }
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
