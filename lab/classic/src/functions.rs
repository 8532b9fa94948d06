//! Control and evaluate functions of the classic scene in Rust, and its patches: the CPU reference of
//! `shaders/src/classic/functions.wgsl`.

use std::sync::Arc;

use bevy::math::{Vec2, Vec3};

use super::heights::{ClassicHeights, SIDE};
use dolomite_tessellation::layout::StageView;
use dolomite_tessellation::tables::Instance;
use dolomite_tessellation::{
    HostFunctions, HostPatch, HostVertex, Levels, PatchLayout, PatchMesh, Spacing,
};

/// Patches along a side, of 16 m each.
pub const PATCHES: u32 = 64;

/// Beyond this distance of the eye an edge has one segment, metres.
pub const REACH: f32 = 400.0;

/// Between the ends of an edge: the relief that counts as full, metres.
pub const RELIEF: f32 = 10.0;

/// The greatest level, and that of the static scene.
pub const STATIC_LEVEL: f32 = 32.0;

/// Where the light stands, metres.
pub const LIGHT: Vec3 = Vec3::new(300.0, 500.0, 200.0);

/// Corners as of [`PatchLayout::QUAD`] (x, height, z), then (least, greatest height).
pub const CLASSIC_LAYOUT: PatchLayout = PatchLayout {
    points: 5,
    ..PatchLayout::QUAD
};

/// As OpenGL has it where a program does not say: of all spacings the fewest triangles.
pub const CLASSIC_SPACING: Spacing = Spacing::Equal;

/// How levels are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ClassicLevels {
    /// By distance from the eye and relief, as the scene's definition has it.
    #[default]
    Classic,
    /// By the length of edges on the screen, pixels as the camera's `GeometryCamera` wants them.
    EdgeLength,
    /// The same everywhere, 1 to 64; does not depend on the view.
    Static(f32),
    /// No patches: the level of detail of the ground keeps to what the camera's `TerrainLod` says.
    ErrorBound,
}

impl ClassicLevels {
    /// Parameter 0 of the entity, which the functions read.
    #[must_use]
    pub const fn params(self, cull: bool) -> [f32; 4] {
        let [rule, level] = match self {
            Self::Classic => [0.0, 0.0],
            Self::EdgeLength => [1.0, 0.0],
            Self::Static(level) => [2.0, level],
            Self::ErrorBound => [0.0, 0.0],
        };
        [rule, level, if cull { 1.0 } else { 0.0 }, 0.0]
    }
}

/// The patches of the scene.
///
/// u runs along x and v against z, so that counter-clockwise triangles are seen from above.
///
/// # Panics
/// Never: its numbers are right.
#[must_use]
pub fn patches(heights: &ClassicHeights) -> PatchMesh {
    let step = SIDE / PATCHES as f32;
    let at = |k: u32| k as f32 * step - SIDE * 0.5;
    let side = PATCHES + 1;
    let mut points: Vec<[f32; 4]> = (0..side * side)
        .map(|k| {
            let place = Vec2::new(at(k % side), at(k / side));
            [place.x, heights.height(place), place.y, 0.0]
        })
        .collect();
    let mut indices = Vec::with_capacity((PATCHES * PATCHES * 5) as usize);
    for row in 0..PATCHES {
        for column in 0..PATCHES {
            let corner = |i: u32, j: u32| (row + j) * side + column + i;
            indices.extend([corner(0, 1), corner(1, 1), corner(1, 0), corner(0, 0)]);
            indices.push(points.len() as u32);
            let low = Vec2::new(at(column), at(row));
            let (least, greatest) = heights.range(low, low + step);
            points.push([least, greatest, 0.0, 0.0]);
        }
    }
    PatchMesh::new(CLASSIC_LAYOUT, points, indices).expect("whole patches")
}

/// The functions of the scene.
#[derive(Clone, Debug)]
pub struct ClassicScene {
    /// The surface.
    pub heights: ClassicHeights,
}

/// Control points 0 to 4 of a patch.
fn point(patch: &HostPatch, k: usize) -> [f32; 4] {
    let mesh = patch.mesh;
    mesh.points()[mesh.indices()[patch.number as usize * 5 + k] as usize]
}

/// From the world to the stage: entities of this kind are not turned.
fn shift(instance: &Instance, view: &StageView) -> Vec3 {
    let [x, y, z] = instance.rows.map(|row| row[3]);
    Vec3::new(x, y, z) - Vec3::from(view.anchor)
}

/// Level of an edge between two points of the stage; see the scene's definition. `ground` is the
/// height 0 there.
#[must_use]
pub fn classic_level(a: Vec3, b: Vec3, ground: f32, eye: Vec3) -> f32 {
    let middle = (a + b) * 0.5;
    let away = Vec3::new(middle.x, ground, middle.z).distance(eye);
    let relief = ((a.y - b.y).abs() / RELIEF).clamp(0.0, 1.0);
    let share = 0.6 * away / REACH + 0.4 * (1.0 - relief);
    if away > REACH {
        1.0
    } else {
        STATIC_LEVEL + (1.0 - STATIC_LEVEL) * share
    }
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

/// Whether a box meets the frustum.
fn seen(view: &StageView, low: Vec3, high: Vec3) -> bool {
    view.planes.iter().all(|[x, y, z, d]| {
        let normal = Vec3::new(*x, *y, *z);
        let farthest = Vec3::select(normal.cmpge(Vec3::ZERO), high, low);
        normal.dot(farthest) + d >= 0.0
    })
}

impl HostFunctions for ClassicScene {
    fn control(&self, patch: &HostPatch, view: &StageView) -> Levels {
        let [rule, level, cull, _] = patch.instance.params[0];
        let shift = shift(patch.instance, view);
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| {
            let [x, y, z, _] = point(patch, k);
            Vec3::new(x, y, z) + shift
        });
        if cull > 0.0 {
            let [least, greatest, ..] = point(patch, 4);
            let low = Vec3::new(a.x, least + shift.y, c.z);
            let high = Vec3::new(c.x, greatest + shift.y, a.z);
            if !seen(view, low, high) {
                return Levels::uniform(0.0);
            }
        }
        if rule == 2.0 {
            return Levels::uniform(level);
        }
        let between = |a, b| {
            if rule == 1.0 {
                edge_level(view, a, b)
            } else {
                classic_level(a, b, shift.y, Vec3::from(view.eye))
            }
        };
        let outer = [between(d, a), between(a, b), between(b, c), between(c, d)];
        Levels {
            outer,
            inner: [outer[1].max(outer[3]), outer[0].max(outer[2])],
        }
    }

    fn evaluate(&self, patch: &HostPatch, at: Vec3) -> HostVertex {
        let ([ax, _, az, _], [cx, _, cz, _]) = (point(patch, 0), point(patch, 2));
        let place = Vec2::new(ax + (cx - ax) * at.x, az + (cz - az) * at.y);
        let position = Vec3::new(place.x, self.heights.height(place), place.y);
        let normal = self.heights.normal(place);
        let light = (LIGHT - position).normalize().dot(normal.normalize());
        HostVertex {
            position,
            normal,
            uv: Vec2::new(light.max(0.0), (position.y + 90.0) / 200.0),
            material: 0,
        }
    }
}

impl ClassicScene {
    /// The scene over `heights`, to share.
    #[must_use]
    pub fn shared(heights: &ClassicHeights) -> Arc<dyn HostFunctions> {
        Arc::new(Self {
            heights: heights.clone(),
        })
    }
}
