//! Every study, one folder each.

pub mod agents;
pub mod animation;
pub mod beside;
pub mod bodies;
pub mod budget;
pub mod city;
pub mod far;
pub mod fbx;
pub mod ground;
pub mod light;
pub mod lod;
pub mod material;
pub mod moves;
pub mod noise;
pub mod occlusion;
pub mod paths;
pub mod platforms;
pub mod rays;
pub mod replay;
pub mod scaling;
pub mod shadow;
pub mod sight;
pub mod sweep;
pub mod tessellation;
pub mod tessellation_speed;
pub mod tessellation_stage;
pub mod triggers;
pub mod vegetation;

use crate::study::Study;

/// All of them, in the order in which `all` runs them.
pub const STUDIES: &[Study] = &[
    agents::STUDY,
    animation::STUDY,
    bodies::STUDY,
    budget::STUDY,
    city::STUDY,
    ground::STUDY,
    far::STUDY,
    fbx::STUDY,
    light::STUDY,
    lod::STUDY,
    material::STUDY,
    moves::STUDY,
    noise::STUDY,
    occlusion::STUDY,
    paths::STUDY,
    platforms::STUDY,
    rays::STUDY,
    replay::STUDY,
    scaling::STUDY,
    shadow::STUDY,
    sight::STUDY,
    sweep::STUDY,
    tessellation::STUDY,
    tessellation_speed::STUDY,
    tessellation_stage::STUDY,
    triggers::STUDY,
    vegetation::STUDY,
];
