//! Every study, one folder each.

pub mod animation;
pub mod beside;
pub mod budget;
pub mod fbx;
pub mod ground;
pub mod light;
pub mod lod;
pub mod material;
pub mod noise;
pub mod rays;
pub mod sweep;
pub mod tessellation;
pub mod tessellation_speed;
pub mod tessellation_stage;

use crate::study::Study;

/// All of them, in the order in which `all` runs them.
pub const STUDIES: &[Study] = &[
    animation::STUDY,
    budget::STUDY,
    ground::STUDY,
    fbx::STUDY,
    light::STUDY,
    lod::STUDY,
    material::STUDY,
    noise::STUDY,
    rays::STUDY,
    sweep::STUDY,
    tessellation::STUDY,
    tessellation_speed::STUDY,
    tessellation_stage::STUDY,
];
