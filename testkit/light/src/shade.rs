//! The sum over the lights at a point.

use glam::DVec3;

use crate::image::{Image, ImageError};
use crate::light::{Arriving, Source, sources};
use crate::model::{Response, SplitSum};
use crate::rows::in_parallel;
use crate::scene::{Ambient, Interpolation, Lamp, Material};
use crate::trace::{Ray, Surface, Tracer};

/// How far a shadow ray starts from its surface, in parts of the largest coordinate (at least a metre): a hundred
/// thousand times the rounding of a hit, and a millionth of a millimetre at a metre.
const LIFT: f64 = 1e-9;

/// The lights of a scene and what they are seen with.
#[derive(Debug, Clone)]
pub struct Lights {
    sources: Vec<Source>,
    ambient: DVec3,
    exposure: f64,
    split_sum: SplitSum,
}

/// A point of a surface, as a G-buffer has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Texel {
    /// Metres.
    pub position: DVec3,
    /// Unit normal.
    pub normal: DVec3,
    /// Unit vector to the eye.
    pub view: DVec3,
    /// What it is made of.
    pub material: Material,
    /// Share of the ambient light that arrives, `0..=1`.
    pub occlusion: f64,
}

impl Lights {
    /// Leaves out what is no light.
    pub fn new(lamps: &[Lamp], ambient: &Ambient, exposure: f64, split_sum: SplitSum) -> Self {
        let ambient = ambient.colour * ambient.brightness;
        let good = ambient.is_finite() && ambient.min_element() >= 0.0;
        Self {
            sources: sources(lamps),
            ambient: if good { ambient } else { DVec3::ZERO },
            exposure,
            split_sum,
        }
    }

    /// Radiance towards the eye. `visible` says whether light arrives.
    pub fn radiance(&self, texel: &Texel, visible: impl Fn(&Source, &Arriving) -> bool) -> DVec3 {
        let response = Response::new(&texel.material, texel.normal, texel.view, self.split_sum);
        let mut sum = DVec3::ZERO;
        for source in &self.sources {
            let Some(arriving) = source.at(texel.position) else {
                continue;
            };
            let reflected = response.reflected(arriving.direction);
            if reflected != DVec3::ZERO && visible(source, &arriving) {
                sum += reflected * arriving.illuminance;
            }
        }
        if self.ambient != DVec3::ZERO {
            sum += response.ambient() * self.ambient * texel.occlusion;
        }
        self.exposure * sum + texel.material.emissive()
    }

    /// Radiance of a surface that `eye` sees, with hard shadows if there is a tracer.
    pub fn surface(
        &self,
        surface: &Surface,
        material: &Material,
        eye: DVec3,
        occlusion: f64,
        tracer: Option<&Tracer>,
    ) -> DVec3 {
        let at = |position: DVec3, normal: DVec3| {
            let texel = Texel {
                position,
                normal,
                view: (eye - position).normalize(),
                material: *material,
                occlusion,
            };
            self.radiance(&texel, |source, arriving| {
                !source.shadows
                    || tracer.is_none_or(|t| visible(t, position, surface.face, arriving))
            })
        };
        let whole = |normal| at(surface.position, normal);
        let Some((corners, normals, [v, w])) = surface.triangle else {
            return whole(surface.normal);
        };
        match material.interpolation() {
            Interpolation::Pixel => whole(surface.normal),
            Interpolation::FaceNormal => whole(surface.face),
            Interpolation::Vertex => {
                let [a, b, c] = [0, 1, 2].map(|k| at(corners[k], normals[k]));
                (1.0 - v - w) * a + v * b + w * c
            }
            Interpolation::Face => at(corners.iter().sum::<DVec3>() / 3.0, surface.face),
        }
    }
}

/// Whether nothing lies between a point of a surface and a light.
pub fn visible(tracer: &Tracer, position: DVec3, face: DVec3, arriving: &Arriving) -> bool {
    let lift = LIFT * position.abs().max_element().max(1.0);
    let side = lift.copysign(face.dot(arriving.direction));
    let ray = Ray::new(position + side * face, arriving.direction);
    !tracer.blocked(&ray, 0.0, arriving.distance)
}

/// An image of which each pixel's surface is given, as by a decoded G-buffer; without one it is the background. No light
/// is blocked.
///
/// # Errors
/// As [`Image::new`].
pub fn shade(
    lights: &Lights,
    width: u32,
    height: u32,
    background: DVec3,
    texels: &[Option<Texel>],
) -> Result<Image, ImageError> {
    // Refused before anything is computed.
    Image::new(width, height, vec![DVec3::ZERO; texels.len()])?;
    let pixel = |texel: &Option<Texel>| {
        texel.map_or(background, |texel| lights.radiance(&texel, |_, _| true))
    };
    let rows = in_parallel(height, |y| {
        let start = y as usize * width as usize;
        let row = &texels[start..start + width as usize];
        row.iter().map(pixel).collect()
    });
    Image::new(width, height, rows)
}
