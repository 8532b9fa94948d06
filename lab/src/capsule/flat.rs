//! The CPU reference of `shaders/src/stage/user.wgsl`, which tests and the lab run the stage with: flat patches.

use bevy::math::Vec3;
use dolomite_tessellation::layout::StageView;
use dolomite_tessellation::{Domain, HostFunctions, HostPatch, HostVertex, Levels};

/// Levels are the sums of the fourth numbers of an edge's ends (entities whose parameter 0.x is below 0), or
/// the same everywhere (those where it is above).
#[derive(Clone, Copy, Debug)]
pub struct Flat;

/// Control point `k` of a patch.
#[must_use]
pub fn point(patch: &HostPatch<'_>, k: u32) -> [f32; 4] {
    let own = patch.number * patch.mesh.layout().points + k;
    patch.mesh.points()[patch.mesh.indices()[own as usize] as usize]
}

/// Its first three numbers.
#[must_use]
pub fn place(patch: &HostPatch<'_>, k: u32) -> Vec3 {
    let [x, y, z, _] = point(patch, k);
    Vec3::new(x, y, z)
}

impl HostFunctions for Flat {
    fn control(&self, patch: &HostPatch<'_>, _: &StageView) -> Levels {
        let rule = patch.instance.params[0][0];
        if rule > 0.0 {
            return Levels::uniform(rule);
        }
        let level = |a: u32, b: u32| point(patch, a)[3] + point(patch, b)[3];
        if patch.mesh.layout().domain == Domain::Triangles {
            let [u, v, w] = [level(1, 2), level(2, 0), level(0, 1)];
            return Levels {
                outer: [u, v, w, 1.0],
                inner: [u.max(v.max(w)); 2],
            };
        }
        let [u_low, v_low, u_high, v_high] = [level(3, 0), level(0, 1), level(1, 2), level(2, 3)];
        Levels {
            outer: [u_low, v_low, u_high, v_high],
            inner: [v_low.max(v_high), u_low.max(u_high)],
        }
    }

    fn evaluate(&self, patch: &HostPatch<'_>, at: Vec3) -> HostVertex {
        let [a, b, c] = [0, 1, 2].map(|k| place(patch, k));
        let position = if patch.mesh.layout().domain == Domain::Triangles {
            a * at.x + b * at.y + c * at.z
        } else {
            let d = place(patch, 3);
            a + (b - a) * at.x + (d - a) * at.y + (a - b + c - d) * (at.x * at.y)
        };
        HostVertex {
            position,
            normal: (b - a).cross(c - a),
            uv: at.truncate(),
            material: 0,
        }
    }
}
