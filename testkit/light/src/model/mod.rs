//! Shading models: what leaves a surface for what arrives.

pub mod blinn_phong;
pub mod directional_albedo;
pub mod microfacets;
pub mod standard;

use glam::DVec3;

use crate::scene::Material;

/// How the share of light that a rough surface reflects is found, where Bevy's material asks for it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum SplitSum {
    /// The polynomial of Bevy without its feature `dfg_lut`: [`standard::karis`].
    #[default]
    Karis,
    /// The integral itself: [`directional_albedo::split_sum`]. Some ten microseconds a point.
    Integral,
}

/// A material, seen at a point from a direction, made ready to be asked for many lights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Response {
    /// Bevy's.
    Standard(standard::Response),
    /// Phong's family.
    BlinnPhong(blinn_phong::Response),
}

impl Response {
    /// `n` and `v` are unit vectors.
    pub fn new(material: &Material, n: DVec3, v: DVec3, split_sum: SplitSum) -> Self {
        match material {
            Material::Standard(m) => Self::Standard(standard::Response::new(m, n, v, split_sum)),
            Material::BlinnPhong(m) => Self::BlinnPhong(blinn_phong::Response::new(m, n, v)),
        }
    }

    /// `f(v, l) (n·l)⁺`, in 1/sr a channel: times the illuminance, what leaves towards the eye.
    pub fn reflected(&self, l: DVec3) -> DVec3 {
        match self {
            Self::Standard(r) => r.reflected(l),
            Self::BlinnPhong(r) => r.reflected(l),
        }
    }

    /// What leaves towards the eye for light of luminance 1 from everywhere.
    pub fn ambient(&self) -> DVec3 {
        match self {
            Self::Standard(r) => r.ambient(),
            Self::BlinnPhong(r) => r.ambient(),
        }
    }
}
