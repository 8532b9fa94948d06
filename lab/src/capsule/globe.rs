//! The CPU reference of `assets/shaders/globe.wgsl`: spheres whose levels follow the view.

use bevy::math::{Vec3, Vec4, Vec4Swizzles};
use dolomite_shaders::ShaderFile;
use dolomite_tessellation::layout::StageView;
use dolomite_tessellation::{HostFunctions, HostPatch, HostVertex, Levels};

use super::flat::place;

/// The file in the place of the stage's own functions.
pub const FUNCTIONS: ShaderFile = ShaderFile {
    path: "stage/user.wgsl",
    source: concat!(
        "#define_import_path dolomite::stage::user\n",
        include_str!("../../../assets/shaders/globe.wgsl")
    ),
};

/// See the WGSL file.
#[derive(Clone, Copy, Debug)]
pub struct Globe;

/// A place of an entity in the stage's space, as `stage_position` in `api.wgsl`.
fn stage_position(patch: &HostPatch<'_>, view: &StageView, local: Vec3) -> Vec3 {
    let rows = patch.instance.rows.map(Vec4::from);
    let turned = Vec3::from(rows.map(|row| row.xyz().dot(local)));
    turned + (Vec3::from(rows.map(|row| row.w)) - Vec3::from(view.anchor))
}

/// As `edge_level` in `api.wgsl`.
fn edge_level(view: &StageView, a: Vec3, b: Vec3) -> f32 {
    let middle = (a + b) * 0.5;
    let reach = if view.orthographic == 1.0 {
        1.0
    } else {
        middle.distance(Vec3::from(view.eye)).max(1e-6)
    };
    a.distance(b) * view.pixels_per_radian / (reach * view.pixels_per_edge)
}

/// As `in_view` in `api.wgsl`.
fn in_view(view: &StageView, centre: Vec3, radius: f32) -> bool {
    let sweep = Vec4::from(view.sweep).xyz();
    view.planes.iter().all(|plane| {
        let plane = Vec4::from(*plane);
        let reach = plane.xyz().dot(sweep).max(0.0);
        plane.xyz().dot(centre) + plane.w + reach >= -radius
    })
}

impl HostFunctions for Globe {
    fn control(&self, patch: &HostPatch<'_>, view: &StageView) -> Levels {
        let [a, b, c] = [0, 1, 2].map(|k| stage_position(patch, view, place(patch, k).normalize()));
        let centre = stage_position(patch, view, Vec3::ZERO);
        if !in_view(view, centre, a.distance(centre)) {
            return Levels::uniform(0.0);
        }
        let level = |a, b| 1.11 * edge_level(view, a, b);
        let [u, v, w] = [level(b, c), level(c, a), level(a, b)];
        Levels {
            outer: [u, v, w, 1.0],
            inner: [u.max(v.max(w)); 2],
        }
    }

    fn evaluate(&self, patch: &HostPatch<'_>, at: Vec3) -> HostVertex {
        let [a, b, c] = [0, 1, 2].map(|k| place(patch, k));
        let n = (a * at.x + b * at.y + c * at.z).normalize();
        HostVertex {
            position: n,
            normal: n,
            uv: at.truncate(),
            material: patch.instance.params[0][0] as u32,
        }
    }
}
