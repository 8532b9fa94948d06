//! ufbx's small types as glam's.

use crate::model::Trs;
use glam::{DMat4, DQuat, DVec3, DVec4};

pub(crate) fn vec3(v: ufbx::Vec3) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

pub(crate) fn matrix(m: &ufbx::Matrix) -> DMat4 {
    DMat4::from_cols(
        DVec4::new(m.m00, m.m10, m.m20, 0.0),
        DVec4::new(m.m01, m.m11, m.m21, 0.0),
        DVec4::new(m.m02, m.m12, m.m22, 0.0),
        DVec4::new(m.m03, m.m13, m.m23, 1.0),
    )
}

pub(crate) fn trs(t: &ufbx::Transform) -> Trs {
    Trs {
        translation: vec3(t.translation),
        rotation: DQuat::from_xyzw(t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w),
        scale: vec3(t.scale),
    }
}

/// What f32 can hold; what is no number or too large becomes 0, which no renderer chokes on.
pub(crate) fn finite(x: f64) -> f32 {
    let x = x as f32;
    if x.is_finite() { x } else { 0.0 }
}

pub(crate) fn finite3(v: DVec3) -> [f32; 3] {
    [finite(v.x), finite(v.y), finite(v.z)]
}
