//! Skinning from a palette on the CPU. The CPU reference of `character/skin.wgsl`.

use super::figure::CrowdFigure;
use super::palette::Palette;
use bevy::math::{Vec3, Vec4};

/// A matrix without its last row.
pub type Rows = [Vec4; 3];

/// The matrix of one joint: between two frames of the palette.
///
/// # Panics
/// If the figure or the joint lies outside of the palette.
#[must_use]
pub fn joint_rows(palette: &Palette, figure: &CrowdFigure, joint: u32) -> Rows {
    let at = (((figure.pose >> 16) * palette.joints + joint) * 3) as usize;
    let next = at + palette.joints as usize * 3;
    let part = ((figure.pose >> 8) & 255) as f32 / 256.0;
    let rest = 1.0 - part;
    let row = |i: usize| Vec4::from_array(palette.rows[i]);
    core::array::from_fn(|i| row(at + i) * rest + row(next + i) * part)
}

/// The matrix of a vertex: the mean of its joints'.
///
/// # Panics
/// As [`joint_rows`].
#[must_use]
pub fn vertex_rows(
    palette: &Palette,
    figure: &CrowdFigure,
    joints: [u16; 4],
    weights: [f32; 4],
) -> Rows {
    let mut sum = [Vec4::ZERO; 3];
    for (joint, weight) in joints.into_iter().zip(weights) {
        if weight > 0.0 {
            let rows = joint_rows(palette, figure, u32::from(joint));
            for (sum, row) in sum.iter_mut().zip(rows) {
                *sum += row * weight;
            }
        }
    }
    sum
}

/// A vertex of the model.
#[must_use]
pub fn skinned_position(rows: &Rows, position: Vec3) -> Vec3 {
    let p = position.extend(1.0);
    Vec3::from_array(rows.map(|row| row.dot(p)))
}

/// A normal of the model, of unit length; exact where joints are scaled evenly.
#[must_use]
pub fn skinned_normal(rows: &Rows, normal: Vec3) -> Vec3 {
    let n = Vec3::from_array(rows.map(|row| row.truncate().dot(normal)));
    n / n.length_squared().max(1e-30).sqrt()
}
