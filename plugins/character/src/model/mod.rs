//! From local transforms to matrices in the model's frame.

use crate::pose::{Joints8, LANES, Pose};
use crate::simd::load;
use crate::skeleton::Skeleton;
use bevy::math::{Affine3A, Mat3A, Vec3A};
use fearless_simd::{Level, dispatch, f32x4, f32x8, prelude::*};

impl Skeleton {
    /// Matrices of all joints in the model's frame; `model` is made as long as the skeleton.
    ///
    /// # Panics
    /// If the pose has another number of joints.
    pub fn local_to_model(&self, pose: &Pose, model: &mut Vec<Affine3A>) {
        self.local_to_model_from(pose, model, Affine3A::IDENTITY);
    }

    /// The same with the roots under `above`, for instance the entity's place in the world.
    ///
    /// # Panics
    /// If the pose has another number of joints.
    pub fn local_to_model_from(&self, pose: &Pose, model: &mut Vec<Affine3A>, above: Affine3A) {
        assert_eq!(pose.len(), self.len(), "a pose of another skeleton");
        model.resize(self.len(), Affine3A::IDENTITY);
        for (block, joints) in pose.blocks().iter().zip(model.chunks_mut(LANES)) {
            let local = dispatch!(Level::new(), simd => matrices(simd, block));
            for (joint, [x, y, z, w]) in joints.iter_mut().zip(local) {
                let column = |c: [f32; 4]| Vec3A::new(c[0], c[1], c[2]);
                *joint = Affine3A {
                    matrix3: Mat3A::from_cols(column(x), column(y), column(z)),
                    translation: column(w),
                };
            }
        }
        for joint in 0..self.len() {
            let parent = self.parent(joint).map_or(above, |parent| model[parent]);
            model[joint] = parent * model[joint];
        }
    }
}

/// Columns of eight local matrices.
#[inline(always)]
fn matrices<S: Simd>(simd: S, block: &Joints8) -> [[[f32; 4]; 4]; LANES] {
    let [x, y, z, w] = load(simd, &block.rotation);
    let [sx, sy, sz] = load(simd, &block.scale);
    let number = |value: f32| f32x8::splat(simd, value);
    let (x2, y2, z2) = (x + x, y + y, z + z);
    let (xx, yy, zz) = (x * x2, y * y2, z * z2);
    let (xy, xz, yz) = (x * y2, x * z2, y * z2);
    let (wx, wy, wz) = (w * x2, w * y2, w * z2);
    let one = number(1.0);
    let zero = number(0.0);
    let translation: [f32x8<S>; 3] = load(simd, &block.translation);
    let columns = [
        [(one - (yy + zz)) * sx, (xy + wz) * sx, (xz - wy) * sx, zero],
        [(xy - wz) * sy, (one - (xx + zz)) * sy, (yz + wx) * sy, zero],
        [(xz + wy) * sz, (yz - wx) * sz, (one - (xx + yy)) * sz, zero],
        [translation[0], translation[1], translation[2], zero],
    ];
    let mut out = [[[0.0; 4]; 4]; LANES];
    for (column, numbers) in columns.iter().enumerate() {
        let halves: [(f32x4<S>, f32x4<S>); 4] =
            core::array::from_fn(|i| simd.split_f32x8(numbers[i]));
        let mut sixteen = [0.0; 16];
        for (half, first) in [(halves.map(|h| h.0), 0), (halves.map(|h| h.1), 4)] {
            simd.store_four_interleaved_f32x4(half, &mut sixteen);
            for (joint, four) in sixteen.chunks_exact(4).enumerate() {
                out[first + joint][column].copy_from_slice(four);
            }
        }
    }
    out
}
