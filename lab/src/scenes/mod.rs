//! Grounds, cameras over them, and what is true and what is drawn under a place: shared by the studies of
//! the ground.
//!
//! | module | what |
//! |---|---|
//! | [`camera`], [`cameras`] | projection; cameras over a terrain, hostile ones too |
//! | [`terrains`], [`truth`] | the grounds; their heights, and what f32 is off by |
//! | [`mesh`] | what is drawn, and its height at a place |
//! | [`places`] | where errors are looked for |
//! | [`selection`] | our choice under a camera |

#![expect(
    clippy::disallowed_methods,
    reason = "f64 measurements: the last bit of a logarithm or a tangent decides nothing"
)]

pub mod camera;
pub mod cameras;
pub mod mesh;
pub mod places;
pub mod selection;
pub mod terrains;
pub mod truth;
