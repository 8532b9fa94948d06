//! Poses: local transforms of joints, eight side by side.
//!
//! A joint's place in a pose is block `joint / 8`, lane `joint % 8`. Lanes beyond the last joint hold the
//! identity, so that nothing there is ever NaN or slow.

use bevy::math::{Affine3A, Quat, Vec3};

/// Joints in a block. Eight f32 are one AVX register, or two of SSE2, NEON and WebAssembly.
pub const LANES: usize = 8;

/// One number of eight joints.
pub type Lane = [f32; LANES];

/// Local transforms of eight joints, number by number.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct Joints8 {
    /// x, y, z, metres.
    pub translation: [Lane; 3],
    /// x, y, z, w of unit quaternions.
    pub rotation: [Lane; 4],
    /// x, y, z.
    pub scale: [Lane; 3],
}

impl Joints8 {
    /// Eight identities.
    pub const IDENTITY: Self = Self {
        translation: [[0.0; LANES]; 3],
        rotation: [[0.0; LANES], [0.0; LANES], [0.0; LANES], [1.0; LANES]],
        scale: [[1.0; LANES]; 3],
    };
}

/// The local transform of one joint: scale, then rotation, then translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointTransform {
    /// Metres, in the parent's frame.
    pub translation: Vec3,
    /// Unit quaternion.
    pub rotation: Quat,
    /// Factors along the joint's own axes.
    pub scale: Vec3,
}

impl Default for JointTransform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl JointTransform {
    /// Nothing moved, turned or scaled.
    pub const IDENTITY: Self = Self {
        translation: Vec3::ZERO,
        rotation: Quat::IDENTITY,
        scale: Vec3::ONE,
    };

    /// A joint that is only moved.
    #[must_use]
    pub const fn at(translation: Vec3) -> Self {
        Self {
            translation,
            ..Self::IDENTITY
        }
    }

    /// As a matrix.
    #[must_use]
    pub fn to_affine(self) -> Affine3A {
        Affine3A::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }

    /// Whether every number is finite.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.translation.is_finite() && self.rotation.is_finite() && self.scale.is_finite()
    }
}

/// Local transforms of all joints of a skeleton.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    joints: usize,
    blocks: Vec<Joints8>,
}

impl Pose {
    /// Identities.
    #[must_use]
    pub fn new(joints: usize) -> Self {
        Self {
            joints,
            blocks: vec![Joints8::IDENTITY; joints.div_ceil(LANES)],
        }
    }

    /// Number of joints.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.joints
    }

    /// Whether there are no joints.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.joints == 0
    }

    /// The blocks.
    #[must_use]
    pub fn blocks(&self) -> &[Joints8] {
        &self.blocks
    }

    /// The blocks, to be written. Rotations have to stay unit quaternions.
    pub fn blocks_mut(&mut self) -> &mut [Joints8] {
        &mut self.blocks
    }

    /// Makes room for as many joints, all of them identities if the number is another one.
    pub fn resize(&mut self, joints: usize) {
        if self.joints != joints {
            *self = Self::new(joints);
        }
    }

    /// One joint's transform.
    ///
    /// # Panics
    /// If there is no such joint.
    #[must_use]
    pub fn get(&self, joint: usize) -> JointTransform {
        assert!(joint < self.joints, "joint {joint} of {}", self.joints);
        let (block, lane) = (&self.blocks[joint / LANES], joint % LANES);
        let [x, y, z, w] = block.rotation.map(|numbers| numbers[lane]);
        JointTransform {
            translation: Vec3::from_array(block.translation.map(|numbers| numbers[lane])),
            rotation: Quat::from_xyzw(x, y, z, w),
            scale: Vec3::from_array(block.scale.map(|numbers| numbers[lane])),
        }
    }

    /// Sets one joint's transform.
    ///
    /// # Panics
    /// If there is no such joint.
    pub fn set(&mut self, joint: usize, transform: JointTransform) {
        assert!(joint < self.joints, "joint {joint} of {}", self.joints);
        let (block, lane) = (&mut self.blocks[joint / LANES], joint % LANES);
        for (to, from) in block
            .translation
            .iter_mut()
            .zip(transform.translation.to_array())
        {
            to[lane] = from;
        }
        for (to, from) in block.rotation.iter_mut().zip(transform.rotation.to_array()) {
            to[lane] = from;
        }
        for (to, from) in block.scale.iter_mut().zip(transform.scale.to_array()) {
            to[lane] = from;
        }
    }

    /// Sets one joint's rotation alone.
    ///
    /// # Panics
    /// If there is no such joint.
    pub fn set_rotation(&mut self, joint: usize, rotation: Quat) {
        let old = self.get(joint);
        self.set(joint, JointTransform { rotation, ..old });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_are_kept_apart_and_padding_is_the_identity() {
        let mut pose = Pose::new(11);
        for joint in 0..11 {
            pose.set(joint, JointTransform::at(Vec3::splat(joint as f32)));
        }
        for joint in 0..11 {
            assert_eq!(pose.get(joint).translation, Vec3::splat(joint as f32));
        }
        assert_eq!(pose.blocks().len(), 2);
        let padding = &pose.blocks()[1];
        for lane in 3..LANES {
            assert_eq!(padding.translation[0][lane], 0.0);
            assert_eq!(padding.rotation[3][lane], 1.0);
            assert_eq!(padding.scale[2][lane], 1.0);
        }
    }

    #[test]
    fn no_joint_beyond_the_last() {
        assert!(std::panic::catch_unwind(|| Pose::new(9).get(9)).is_err());
    }
}
