//! Rows of a producer's table of materials.

use bevy::prelude::*;

use crate::layout::{MATERIAL_ROWS, MaterialRow};

/// A material that vertices choose by its number.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, Clone, Debug, PartialEq)]
pub struct GeometryMaterial {
    /// Diffuse colour of dielectrics, specular colour of metals.
    pub base_color: LinearRgba,
    /// Light that it sends out, cd/m².
    pub emissive: LinearRgba,
    /// Perceptual roughness, 0.089 to 1.
    pub roughness: f32,
    /// 0 or 1.
    pub metallic: f32,
    /// Specular strength of dielectrics; 0.5 is 4 % at normal incidence.
    pub reflectance: f32,
    /// Whether the base colour is shown as it is, without light.
    pub unlit: bool,
    /// Whether the camera's distance fog lies over it.
    pub fog: bool,
}

impl Default for GeometryMaterial {
    fn default() -> Self {
        Self {
            base_color: LinearRgba::rgb(0.5, 0.5, 0.5),
            emissive: LinearRgba::BLACK,
            roughness: 0.6,
            metallic: 0.0,
            reflectance: 0.5,
            unlit: false,
            fog: true,
        }
    }
}

/// The table; what is over its rows is passed over.
pub(super) fn rows(materials: &[GeometryMaterial]) -> [MaterialRow; MATERIAL_ROWS] {
    let mut rows = [MaterialRow::default(); MATERIAL_ROWS];
    for (row, material) in rows.iter_mut().zip(materials) {
        let base = material.base_color;
        let shine = material.emissive;
        *row = MaterialRow {
            base_color: [
                base.red,
                base.green,
                base.blue,
                f32::from(u8::from(material.unlit)),
            ],
            emissive: [shine.red, shine.green, shine.blue, material.reflectance],
            surface: [
                material.roughness,
                material.metallic,
                1.0,
                f32::from(u8::from(!material.fog)),
            ],
        };
    }
    rows
}
