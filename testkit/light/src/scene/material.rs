//! Materials.

use glam::DVec3;

/// How a surface answers light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Material {
    /// Bevy's `StandardMaterial`.
    Standard(Standard),
    /// Blinn-Phong and its relatives.
    BlinnPhong(BlinnPhong),
}

/// The parameters of Bevy's `StandardMaterial` that direct light depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standard {
    /// Linear, `0..=1` a channel.
    pub base_colour: DVec3,
    /// `0..=1`.
    pub metallic: f64,
    /// `0..=1`; below 0.089 it is 0.089.
    pub perceptual_roughness: f64,
    /// `0..=1`; the reflectance at normal incidence of a dielectric is `0.16 reflectance²`.
    pub reflectance: f64,
    /// Radiance that it emits, linear; exposure does not apply.
    pub emissive: DVec3,
}

/// Phong's family of shading models.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlinnPhong {
    /// Albedo of the diffuse part, `0..=1` a channel.
    pub diffuse: DVec3,
    /// Albedo of the specular part for an eye on the normal, `0..=1` a channel.
    pub specular: DVec3,
    /// 0 and above; the greater, the smaller is the highlight.
    pub exponent: f64,
    /// Radiance that it emits, linear; exposure does not apply.
    pub emissive: DVec3,
    /// What the highlight is made of.
    pub lobe: Lobe,
    /// Where the model is evaluated.
    pub interpolation: Interpolation,
}

/// What is raised to the exponent.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Lobe {
    /// `n·h` (Blinn 1977).
    #[default]
    Blinn,
    /// `r·v`, with the mirrored light `r = 2 (n·l) n − l` (Phong 1975).
    Phong,
}

/// Where light is computed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// At each pixel, with the interpolated normal.
    #[default]
    Pixel,
    /// At each pixel, with the normal of the triangle.
    FaceNormal,
    /// At the corners of the triangle; the radiance is interpolated (Gouraud 1971).
    Vertex,
    /// Once a triangle, at its centroid with its normal: flat shading.
    Face,
}

impl Default for Standard {
    fn default() -> Self {
        Self {
            base_colour: DVec3::ONE,
            metallic: 0.0,
            perceptual_roughness: 0.5,
            reflectance: 0.5,
            emissive: DVec3::ZERO,
        }
    }
}

impl Default for BlinnPhong {
    fn default() -> Self {
        Self {
            diffuse: DVec3::splat(0.5),
            specular: DVec3::splat(0.04),
            exponent: 32.0,
            emissive: DVec3::ZERO,
            lobe: Lobe::Blinn,
            interpolation: Interpolation::Pixel,
        }
    }
}

impl Material {
    /// Radiance that it emits.
    pub fn emissive(&self) -> DVec3 {
        match self {
            Self::Standard(m) => m.emissive,
            Self::BlinnPhong(m) => m.emissive,
        }
    }

    /// Where it is evaluated.
    pub fn interpolation(&self) -> Interpolation {
        match self {
            Self::Standard(_) => Interpolation::Pixel,
            Self::BlinnPhong(m) => m.interpolation,
        }
    }
}
