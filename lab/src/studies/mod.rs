//! Every study, one folder each.

pub mod animation;
pub mod budget;
pub mod fbx;
pub mod ground;
pub mod lod;
pub mod material;
pub mod noise;
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
    lod::STUDY,
    material::STUDY,
    noise::STUDY,
    tessellation::STUDY,
    tessellation_speed::STUDY,
    tessellation_stage::STUDY,
];
