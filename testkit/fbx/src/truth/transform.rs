//! Where nodes are: FBX's chain of transforms, and the three ways in which it goes down the tree.

use crate::scene::Vec3;
use glam::{DMat4, DQuat, DVec3, EulerRot};

/// A vector of glam's.
pub fn vec3(v: Vec3) -> DVec3 {
    DVec3::from_array(v)
}

/// In which axes turn, the last first, as glam says it: order 0 turns about X, then Y, then Z.
fn axes(order: i32) -> (EulerRot, [usize; 3]) {
    match order {
        1 => (EulerRot::YZX, [1, 2, 0]),
        2 => (EulerRot::XZY, [0, 2, 1]),
        3 => (EulerRot::ZXY, [2, 0, 1]),
        4 => (EulerRot::YXZ, [1, 0, 2]),
        5 => (EulerRot::XYZ, [0, 1, 2]),
        _ => (EulerRot::ZYX, [2, 1, 0]),
    }
}

/// A rotation by three angles, degrees.
pub fn rotation(angles: Vec3, order: i32) -> DQuat {
    let (rot, [a, b, c]) = axes(order);
    // Whole turns are taken away before the sine, so that a thousand of them cost no digits.
    let radians = angles.map(|x| (x % 360.0).to_radians());
    DQuat::from_euler(rot, radians[a], radians[b], radians[c])
}

/// Three angles that make a rotation, degrees.
pub fn angles(rotation: DQuat, order: i32) -> Vec3 {
    let (rot, [a, b, c]) = axes(order);
    let (x, y, z) = rotation.normalize().to_euler(rot);
    let mut out = [0.0; 3];
    (out[a], out[b], out[c]) = (x.to_degrees(), y.to_degrees(), z.to_degrees());
    out
}

/// On the shorter arc from one rotation to another.
pub fn slerp(from: DQuat, to: DQuat, share: f64) -> DQuat {
    let to = if from.dot(to) < 0.0 { -to } else { to };
    let aside = to - from * from.dot(to);
    let sine = aside.length();
    if sine < 1e-15 {
        return from;
    }
    let angle = sine.atan2(from.dot(to)) * share;
    from * angle.cos() + aside * (angle.sin() / sine)
}

/// What a node's own place is made of, animated or not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Local {
    /// From the node to its parent.
    pub matrix: DMat4,
    /// Its rotation alone.
    pub rotation: DQuat,
    /// Its scale alone.
    pub scale: DVec3,
}

/// Turns before and after, offsets and pivots of a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chain {
    /// `PreRotation` and `PostRotation`.
    pub turns: [DQuat; 2],
    /// `RotationOffset` and `RotationPivot`.
    pub about: [DVec3; 2],
    /// `ScalingOffset` and `ScalingPivot`.
    pub from: [DVec3; 2],
}

impl Chain {
    /// T · Roff · Rp · Rpre · R · Rpost⁻¹ · Rp⁻¹ · Soff · Sp · S · Sp⁻¹.
    pub fn local(&self, translation: Vec3, turn: DQuat, scaling: Vec3) -> Local {
        let rotation = self.turns[0] * turn * self.turns[1].inverse();
        let scale = vec3(scaling);
        let matrix = DMat4::from_translation(vec3(translation) + self.about[0] + self.about[1])
            * DMat4::from_quat(rotation)
            * DMat4::from_translation(self.from[0] + self.from[1] - self.about[1])
            * DMat4::from_scale(scale)
            * DMat4::from_translation(-self.from[1]);
        Local {
            matrix,
            rotation,
            scale,
        }
    }
}

/// Where a node is in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// From the node to the world.
    pub matrix: DMat4,
    /// Its rotation and its scale in the world, and its own scale; `None` where they cannot be told apart any more.
    parts: Option<(DQuat, DVec3, DVec3)>,
}

impl Place {
    /// The scene's own.
    pub const ROOT: Self = Self {
        matrix: DMat4::IDENTITY,
        parts: Some((DQuat::IDENTITY, DVec3::ONE, DVec3::ONE)),
    };

    /// Of a node below this one. Rotations and scales go down apart from each other in the ways 0 (RrSs: first all
    /// rotations, then all scales) and 2 (Rrs: the same without the parent's own scale), together in way 1 (RSrs).
    pub fn below(&self, local: &Local, inherit: i32) -> Self {
        let together = || {
            let uniform =
                |s: DVec3| (s - DVec3::splat(s.x)).abs().max_element() < 1e-12 * s.x.abs();
            let parts = self.parts.filter(|parts| uniform(parts.1));
            Self {
                matrix: self.matrix * local.matrix,
                parts: parts.map(|(rotation, scale, _)| {
                    (rotation * local.rotation, scale * local.scale, local.scale)
                }),
            }
        };
        let Some((rotation, scale, own)) = self.parts else {
            return together();
        };
        let scale = match inherit {
            0 => scale,
            2 => scale / own,
            _ => return together(),
        } * local.scale;
        let rotation = rotation * local.rotation;
        let place = self.matrix.transform_point3(local.matrix.w_axis.truncate());
        Self {
            matrix: DMat4::from_scale_rotation_translation(scale, rotation, place),
            parts: Some((rotation, scale, local.scale)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_axis_turns_first() {
        let turns = [
            DQuat::from_rotation_x,
            DQuat::from_rotation_y,
            DQuat::from_rotation_z,
        ];
        let orders = [
            [0, 1, 2],
            [0, 2, 1],
            [1, 2, 0],
            [1, 0, 2],
            [2, 0, 1],
            [2, 1, 0],
        ];
        let by = [20.0_f64, -50.0, 110.0];
        for (number, [first, second, third]) in (0..).zip(orders) {
            let turn = |axis: usize| turns[axis](by[axis].to_radians());
            let wanted = turn(third) * turn(second) * turn(first);
            let made = rotation(by, number);
            assert!(made.dot(wanted).abs() > 1.0 - 1e-14, "order {number}");
            let again = rotation(angles(made, number), number);
            assert!(again.dot(wanted).abs() > 1.0 - 1e-14, "order {number}");
        }
    }

    #[test]
    fn pivots_stay_where_they_are() {
        let pivot = DVec3::new(1.0, 2.0, 3.0);
        let chain = Chain {
            turns: [DQuat::IDENTITY; 2],
            about: [DVec3::ZERO, pivot],
            from: [DVec3::ZERO, pivot],
        };
        let local = chain.local([0.0; 3], DQuat::from_rotation_y(1.0), [2.0, 3.0, 0.5]);
        assert!((local.matrix.transform_point3(pivot) - pivot).length() < 1e-14);
    }
}
