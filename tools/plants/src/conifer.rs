//! A spruce: whorls of branches about a straight trunk, twigs to both sides of each.

use glam::{Quat, Vec3};

use crate::model::{Leaf, Model, Ring};
use crate::plant::Plant;
use crate::random::Random;

const HEIGHT: f32 = 12.0;
const BARK: Vec3 = Vec3::new(0.075, 0.050, 0.036);
const NEEDLES_OLD: Vec3 = Vec3::new(0.016, 0.040, 0.016);
const NEEDLES_NEW: Vec3 = Vec3::new(0.052, 0.098, 0.036);

/// Length of a branch at a height: a cone whose sides are a little hollow, less at the foot, where light is scarce.
fn length_at(height: f32) -> f32 {
    let up = height / HEIGHT;
    let cone = 3.0 * (1.0 - up) * (1.08 - 0.35 * up);
    cone * (0.55 + 0.45 * ((up - 0.06) / 0.12).clamp(0.0, 1.0))
}

/// The tree of a seed.
#[must_use]
pub fn conifer(seed: u32) -> Plant {
    let mut random = Random::new(seed);
    let mut solid = Model::default();
    let mut leaves = Vec::new();
    let trunk: Vec<Ring> = (0..=12)
        .map(|k| {
            let up = k as f32 / 12.0;
            let flare = (1.0 - up * 14.0).max(0.0);
            Ring {
                middle: Vec3::new(0.0, up * HEIGHT * 0.985 - 0.4 * flare, 0.0),
                radius: 0.19 * (1.0 - up) * (1.0 + 0.7 * flare) + 0.006,
                colour: BARK * (0.5 + 0.3 * (1.0 - up)),
            }
        })
        .collect();
    solid.tube(&trunk, 8);
    let mut height = 0.75;
    let mut turn = 0.0;
    while height < HEIGHT * 0.985 {
        let length = length_at(height);
        let count = 5 + (length > 1.2) as u32 + (length > 2.0) as u32;
        turn += 2.4;
        for k in 0..count {
            let around = turn
                + std::f32::consts::TAU * (k as f32 + random.within(-0.22, 0.22)) / count as f32;
            let foot = height + random.within(-0.12, 0.12);
            let length = length * random.within(0.78, 1.1);
            branch(&mut leaves, &mut random, foot, around, length);
        }
        height += 0.25 + 0.075 * length;
    }
    // The leading shoot.
    for k in 0..5 {
        let around = Quat::from_rotation_y(std::f32::consts::TAU * k as f32 / 5.0);
        let out = around * Vec3::X;
        leaves.push(Leaf {
            foot: Vec3::Y * (HEIGHT * 0.955),
            along: Vec3::Y * 0.62 + out * 0.07,
            across: around * Vec3::Z * 0.075,
            normal: (out + 0.6 * Vec3::Y).normalize(),
            colour: [NEEDLES_OLD * 1.5, NEEDLES_NEW * 1.1],
        });
    }
    for k in (1..leaves.len()).rev() {
        leaves.swap(k, (random.unit() * (k + 1) as f32) as usize);
    }
    Plant {
        solid,
        leaves,
        solid_shares: [1.0, 0.5, 0.25, 0.12],
        leaf_shares: [1.0, 0.40, 0.16, 0.065],
    }
}

fn branch(leaves: &mut Vec<Leaf>, random: &mut Random, height: f32, around: f32, length: f32) {
    let turned = Quat::from_rotation_y(around);
    let (out, side) = (turned * Vec3::X, turned * Vec3::Z);
    // Low branches hang and lift their ends, high ones rise.
    let up = height / HEIGHT;
    let slope = -0.38 + 0.85 * up * up;
    let at = |t: f32| {
        Vec3::Y * (height + length * (slope * t + 0.20 * t * t * (1.0 - up)))
            + out * (0.10 + length * t)
    };
    let twigs = 3 + (length / 0.24) as u32;
    for k in 0..=twigs {
        let t = 0.10 + 0.90 * k as f32 / twigs as f32;
        let (here, ahead) = (at(t), at(t + 0.05));
        let heading = (ahead - here).normalize_or(out);
        let last = k == twigs;
        let reach = if last {
            0.34
        } else {
            (0.26 + 0.42 * length.min(1.6) * (1.0 - 0.72 * t)) * random.within(0.8, 1.15)
        };
        let ends: &[f32] = if last { &[0.0] } else { &[-1.0, 1.0] };
        for sign in ends {
            let droop = random.within(-0.34, 0.02);
            let along = (heading * 0.85 + side * (*sign * 0.85) + Vec3::Y * droop).normalize();
            let flat = along.cross(Vec3::Y).normalize_or(side);
            let across = (flat + Vec3::Y * random.within(-0.55, 0.55)).normalize();
            // Towards the trunk it is dark.
            let light = 0.34 + 0.66 * t;
            let tint = Vec3::new(
                random.within(0.85, 1.2),
                random.within(0.92, 1.08),
                random.within(0.8, 1.15),
            );
            let whole = (out * 0.8 + Vec3::Y * 0.75).normalize();
            let plane = along.cross(across);
            let plane = if plane.y < 0.0 { -plane } else { plane };
            leaves.push(Leaf {
                foot: here - along * 0.06,
                along: along * reach,
                across: across * (0.085 + 0.11 * reach),
                normal: (whole + 0.55 * plane).normalize(),
                colour: [
                    NEEDLES_OLD * tint * light,
                    NEEDLES_OLD.lerp(NEEDLES_NEW, 0.35 + 0.6 * t) * tint * light,
                ],
            });
        }
    }
}
