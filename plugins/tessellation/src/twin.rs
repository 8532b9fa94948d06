//! The three compute passes in Rust: twins of `levels.wgsl`, `plan.wgsl` and `emit.wgsl`.
//!
//! They run under `MinimalPlugins`, for tests, tools and machines without a GPU. Given the same
//! levels they give the same indices as the shaders, integer for integer, and the same vertices
//! up to f32 rounding of the height function.

use bevy::math::{IVec2, UVec2, Vec2, Vec3};
use dolomite_terrain::{GroundPoint, Terrain};

use crate::cover::Cover;
use crate::layout::{Corner, Edge, MAX_LEVEL, NONE, Patch, PlanResult, Vertex, ViewParams};
use crate::pattern::{self, PatchVertex, Side};

/// Distance below which an edge is not treated as nearer, metres: Bevy's default near plane.
const NEAREST: f32 = 0.1;

/// Ground deeper than this below the sea cannot be seen through the water, metres: the surface
/// above it is flat, so one segment an edge is exact.
pub const OPAQUE_DEPTH: f32 = 12.0;

/// Marks the patches in the frustum and sets the wanted segments of every edge.
pub fn levels(cover: &mut Cover, params: &ViewParams, terrain: &Terrain) {
    for patch in &mut cover.patches {
        let low = relative(&cover.corners[patch.corners[0] as usize], params.anchor);
        let high = relative(&cover.corners[patch.corners[3] as usize], params.anchor);
        let least = patch.min_height.max(params.sea_level);
        let greatest = patch.max_height.max(params.sea_level);
        let min = Vec3::new(low.x, least, low.y);
        let max = Vec3::new(high.x, greatest, high.y);
        patch.visible = visibility(min, max, params);
    }
    for edge in &mut cover.edges {
        let ends = edge.corners.map(|c| {
            let corner = &cover.corners[c as usize];
            let at = relative(corner, params.anchor);
            let height = terrain.sample(point(corner)).value.max(params.sea_level);
            Vec3::new(at.x, height, at.y)
        });
        let deep = edge
            .patches
            .iter()
            .filter(|patch| **patch != NONE)
            .all(|patch| {
                cover.patches[*patch as usize].max_height < params.sea_level - OPAQUE_DEPTH
            });
        edge.wanted = if deep {
            1.0_f32
        } else {
            wanted_segments(ends, params)
        }
        .to_bits();
    }
}

/// Wanted segments of an edge: its length over its distance from the eye, both in space, times
/// the focal length in wanted edge lengths. Independent of the view direction.
fn wanted_segments([a, b]: [Vec3; 2], params: &ViewParams) -> f32 {
    let distance = ((a + b) * 0.5 - Vec3::from(params.eye))
        .length()
        .max(NEAREST);
    let wanted = (b - a).length() * params.segments_per_radian / distance;
    wanted.clamp(1.0, MAX_LEVEL as f32)
}

/// 1 when the box meets the frustum, 2 when only the box swept along the light does, else 0.
fn visibility(min: Vec3, max: Vec3, params: &ViewParams) -> u32 {
    let [x, y, z, _] = params.sweep;
    let sweep = Vec3::new(x, y, z);
    let mut state = 1;
    for &[x, y, z, d] in &params.planes {
        let normal = Vec3::new(x, y, z);
        let farthest = Vec3::select(normal.cmpge(Vec3::ZERO), max, min);
        let inside = normal.dot(farthest) + d;
        if inside < 0.0 {
            state = 2;
            if inside + normal.dot(sweep).max(0.0) < 0.0 {
                return 0;
            }
        }
    }
    if state == 2 && sweep == Vec3::ZERO {
        0
    } else {
        state
    }
}

fn point(corner: &Corner) -> GroundPoint {
    GroundPoint {
        cell: IVec2::from(corner.cell),
        frac: UVec2::from(corner.frac),
    }
}

fn anchor_point(anchor: [i32; 2]) -> GroundPoint {
    GroundPoint {
        cell: IVec2::from(anchor),
        frac: UVec2::ZERO,
    }
}

/// Position of a corner relative to the anchor, metres.
fn relative(corner: &Corner, anchor: [i32; 2]) -> Vec2 {
    point(corner).relative_to(anchor_point(anchor))
}

/// The two edges of each side as segment counts.
fn sides(edges: &[Edge], patch: &Patch) -> [Side; 4] {
    [0, 1, 2, 3].map(|s| {
        let [first, second] = [patch.edges[2 * s], patch.edges[2 * s + 1]];
        Side {
            first: edges[first as usize].level,
            second: if second == NONE {
                0
            } else {
                edges[second as usize].level
            },
        }
    })
}

/// Rounds the levels (lowering all of them evenly until the pools hold the result), gives every
/// vertex and triangle its place, and writes the arguments of the draws.
pub fn plan(cover: &mut Cover, params: &ViewParams) -> PlanResult {
    let visible: Vec<bool> = cover.patches.iter().map(Patch::drawn).collect();
    let any = |patches: &[u32]| patches.iter().any(|&p| p != NONE && visible[p as usize]);
    let mut scale = 1.0_f32;
    let mut lowered = 0;
    loop {
        let mut vertices = 0;
        for corner in &mut cover.corners {
            let used = any(&corner.patches);
            corner.vertex = if used { vertices } else { NONE };
            vertices += u32::from(used);
        }
        for edge in &mut cover.edges {
            let seen = edge
                .patches
                .iter()
                .any(|&p| p != NONE && cover.patches[p as usize].visible == 1);
            let share = if seen { 1.0 } else { SHADOW_DETAIL };
            let wanted = f32::from_bits(edge.wanted) * scale * share;
            let wanted = wanted.ceil().clamp(1.0, MAX_LEVEL as f32);
            edge.level = if any(&edge.patches) { wanted as u32 } else { 0 };
            edge.vertex = vertices;
            vertices += edge.level.saturating_sub(1);
        }
        let mut triangles = 0;
        let mut drawn = 0;
        for patch in &mut cover.patches {
            patch.vertex = vertices;
            patch.triangle = triangles;
            patch.inner = 0;
            if !patch.drawn() {
                continue;
            }
            let sides = sides(&cover.edges, patch);
            let inner = pattern::inner_levels(sides);
            patch.inner = inner[0] | inner[1] << 16;
            vertices += pattern::inner_vertices(inner);
            triangles += pattern::triangle_count(sides, inner);
            drawn += 1;
        }
        let fits = vertices <= params.max_vertices && triangles <= params.max_triangles;
        if fits || lowered == LOWERINGS {
            return PlanResult {
                indexed: [triangles * 3 * u32::from(fits), 1, 0, 0, 0],
                plain: [triangles * 3 * u32::from(fits), 1, 0, 0],
                vertices,
                triangles,
                drawn,
                culled: params.patch_count - drawn,
                lowered,
                pad: [0; 2],
            };
        }
        scale *= 0.8;
        lowered += 1;
    }
}

/// After so many steps of 0.8 the scale is below 1/64: every level is 1 already.
pub const LOWERINGS: u32 = 19;

/// Share of the segments that edges outside the frustum get: they are seen through a shadow map
/// alone.
pub const SHADOW_DETAIL: f32 = 0.25;

/// Vertices and indices of the drawn patches.
pub fn emit(cover: &Cover, params: &ViewParams, terrain: &Terrain, result: &PlanResult) -> Mesh {
    let mut vertices = vec![
        Vertex {
            position: [f32::NAN; 3],
            gradient: 0
        };
        result.vertices as usize
    ];
    let mut put = |index: u32, at: GroundPoint| {
        vertices[index as usize] = vertex(at, params.anchor, terrain);
    };
    for corner in cover.corners.iter().filter(|corner| corner.vertex != NONE) {
        put(corner.vertex, point(corner));
    }
    for edge in &cover.edges {
        let [from, to] = edge.corners.map(|c| point(&cover.corners[c as usize]));
        let length = to.relative_to(from);
        for i in 1..edge.level {
            let t = i as f32 / edge.level as f32;
            put(edge.vertex + i - 1, from.offset((length * t).as_dvec2()));
        }
    }
    let mut indices = Vec::with_capacity(result.triangles as usize * 3);
    for patch in cover.patches.iter().filter(|patch| patch.drawn()) {
        let [a, b] = [patch.inner & 0xffff, patch.inner >> 16];
        let from = point(&cover.corners[patch.corners[0] as usize]);
        let size = point(&cover.corners[patch.corners[3] as usize]).relative_to(from);
        for j in 1..b {
            for i in 1..a {
                let t = Vec2::new(i as f32 / a as f32, j as f32 / b as f32);
                put(
                    patch.vertex + (j - 1) * (a - 1) + i - 1,
                    from.offset((size * t).as_dvec2()),
                );
            }
        }
        let sides = sides(&cover.edges, patch);
        for t in 0..pattern::triangle_count(sides, [a, b]) {
            let corners = pattern::triangle(sides, [a, b], t);
            indices.extend(corners.map(|corner| vertex_index(cover, patch, [a, b], corner)));
        }
    }
    Mesh { vertices, indices }
}

/// What [`emit`] makes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices, positions relative to the view's anchor.
    pub vertices: Vec<Vertex>,
    /// Three a triangle, counter-clockwise seen from +Y.
    pub indices: Vec<u32>,
}

fn vertex(at: GroundPoint, anchor: [i32; 2], terrain: &Terrain) -> Vertex {
    let height = terrain.sample(at);
    let relative = at.relative_to(anchor_point(anchor));
    Vertex {
        position: [relative.x, height.value, relative.y],
        gradient: pack_half(height.gradient),
    }
}

/// Two f16, x in the low half, as WGSL's `pack2x16float` (round to nearest even, saturating
/// where that built-in is undefined).
pub fn pack_half(value: Vec2) -> u32 {
    let [x, y] = [value.x, value.y]
        .map(|v| u32::from(half::f16::from_f32(v.clamp(-65504.0, 65504.0)).to_bits()));
    x | y << 16
}

/// Index of a patch's vertex in the pool.
fn vertex_index(cover: &Cover, patch: &Patch, [a, _]: [u32; 2], corner: PatchVertex) -> u32 {
    match corner {
        PatchVertex::Inner(i, j) => patch.vertex + (j - 1) * (a - 1) + i - 1,
        PatchVertex::Outer(s, i) => {
            let first = &cover.edges[patch.edges[2 * s as usize] as usize];
            let (edge, i) = if i <= first.level {
                (first, i)
            } else {
                (
                    &cover.edges[patch.edges[2 * s as usize + 1] as usize],
                    i - first.level,
                )
            };
            if i == 0 {
                cover.corners[edge.corners[0] as usize].vertex
            } else if i == edge.level {
                cover.corners[edge.corners[1] as usize].vertex
            } else {
                edge.vertex + i - 1
            }
        }
    }
}
