#define_import_path dolomite::stage::api

// What control, evaluate, amplify and material functions are given. The buffers are declared here
// once; the structs in Rust stand in plugins/tessellation/src/layout.rs.
//
// Space: positions of the stage are relative to an anchor near the camera, metres, axes of the
// world. `evaluate` gives positions in the local space of its entity.

struct StageView {
    // Inward half-spaces of the frustum: inside where dot(n, p) + d >= 0.
    planes: array<vec4<f32>, 6>,
    // How far shadows reach along the light, 0 without shadows.
    sweep: vec4<f32>,
    // The point that detail follows, and the size of a radian there in pixels.
    eye: vec3<f32>,
    pixels_per_radian: f32,
    // World position of the anchor.
    anchor: vec3<f32>,
    // Wanted length of an edge, pixels.
    pixels_per_edge: f32,
    // Seconds, of this frame and of the one before; 0 for kinds that are not animated.
    time: f32,
    previous_time: f32,
    // 1 where the camera is orthographic: distance does not matter.
    orthographic: f32,
    // Number of the camera, 1 and above; see ENTITY_CAMERA.
    camera: f32,
}

struct StageParams {
    view: StageView,
    // Corners, edges and patches of all entities of the kind.
    corners: u32,
    edges: u32,
    patches: u32,
    // Pools.
    max_vertices: u32,
    max_primitives: u32,
    // Where tables begin, in words: corner owners, edge owners, patches.
    corner_table: u32,
    edge_table: u32,
    patch_table: u32,
    // Where control points begin, in vec4; vec4 a point.
    points: u32,
    point_size: u32,
    // Greatest |u| or |v| that a vertex can store.
    uv_range: f32,
    // Vertices of what an amplify function makes of a primitive; 0 without one.
    amplified: u32,
    // 1 where sides may be split.
    split: u32,
    // Layers that the camera of this view sees, one a bit.
    layers: u32,
    pad_b: u32,
    pad_c: u32,
}

// One patch of one entity.
struct Patch {
    // Its place among all of its kind, and its entity's.
    id: u32,
    entity: u32,
    // Its place in the mesh.
    number: u32,
    // Where its control point indices begin in the tables.
    first_index: u32,
    // Added to them.
    first_point: u32,
}

// Levels as control writes them; see Levels in plugins/tessellation/src/level.rs.
struct PatchLevels {
    // Of the sides u = 0, v = 0, u = 1 (triangles: w = 0), v = 1. Isolines: lines, segments of each.
    outer: vec4<f32>,
    // Along u and along v; triangles use the first.
    inner: vec2<f32>,
}

struct Vertex {
    position: vec3<f32>,
    // Need not be of length 1.
    normal: vec3<f32>,
    uv: vec2<f32>,
    // Where it was in the last frame; used by kinds that move inside.
    previous: vec3<f32>,
    // Which material, 0 to 255.
    material: u32,
}

@group(0) @binding(0) var<uniform> stage: StageParams;
// Owners of corners and edges, patches, control point indices.
@group(0) @binding(1) var<storage, read> tables: array<u32>;
// Entities (ENTITY_SIZE vec4 each), then control points.
@group(0) @binding(2) var<storage, read> stage_data: array<vec4<f32>>;

// Three rows of the matrix to the world, three of the last frame's, four of parameters, one that
// begins with the number of the only camera that sees it, or 0, and then holds its layers, 16 bits each;
// both 0: in all.
const ENTITY_SIZE: u32 = 11u;
const ENTITY_CAMERA: u32 = 10u;
// Words of a patch in the tables: entity, number, first index, first point, corners, edges; where
// sides may be split also the corners in their middles and the edges of their second halves.
#ifdef STAGE_SPLIT
const PATCH_WORDS: u32 = 20u;
#else
const PATCH_WORDS: u32 = 12u;
#endif
// In place of a middle: the side is not split.
const WHOLE_SIDE: u32 = 0xffffffffu;

fn load_patch(id: u32) -> Patch {
    let at = stage.patch_table + id * PATCH_WORDS;
    return Patch(id, tables[at], tables[at + 1u], tables[at + 2u], tables[at + 3u]);
}

// Control point k of the patch; its first four numbers, or four more with `part` above 0.
fn patch_point(input: Patch, k: u32, part: u32) -> vec4<f32> {
    let point = input.first_point + tables[input.first_index + k];
    return stage_data[stage.points + point * stage.point_size + part];
}

// Parameters 0 to 3 of the entity.
fn entity_params(input: Patch, k: u32) -> vec4<f32> {
    return stage_data[input.entity * ENTITY_SIZE + 6u + k];
}

// Rows `first` to `first` + 2 of the entity, times a point; relative to the anchor.
fn transformed(input: Patch, first: u32, local: vec3<f32>) -> vec3<f32> {
    let at = input.entity * ENTITY_SIZE + first;
    let x = stage_data[at];
    let y = stage_data[at + 1u];
    let z = stage_data[at + 2u];
    // The anchor goes off the translation first: both are large far from the origin.
    let origin = vec3(x.w, y.w, z.w) - stage.view.anchor;
    return vec3(dot(x.xyz, local), dot(y.xyz, local), dot(z.xyz, local)) + origin;
}

// World position of the entity's origin, metres, as its transform gives it.
fn entity_origin(input: Patch) -> vec3<f32> {
    let at = input.entity * ENTITY_SIZE;
    return vec3(stage_data[at].w, stage_data[at + 1u].w, stage_data[at + 2u].w);
}

// Whether the camera of this view may see the entity.
fn entity_seen(input: Patch) -> bool {
    let seen_by = stage_data[input.entity * ENTITY_SIZE + ENTITY_CAMERA];
    let layers = u32(seen_by.y) | (u32(seen_by.z) << 16u);
    return (seen_by.x == 0.0 || seen_by.x == stage.view.camera) && (layers == 0u || (layers & stage.layers) != 0u);
}

// From the entity's local space to the stage's.
fn stage_position(input: Patch, local: vec3<f32>) -> vec3<f32> {
    return transformed(input, 0u, local);
}

// The same with the entity's place in the last frame.
fn previous_stage_position(input: Patch, local: vec3<f32>) -> vec3<f32> {
    return transformed(input, 3u, local);
}

// A normal of local space in the stage's: by the cofactors of the matrix, so that scaling does not
// tilt it. Of length 1; up where it has no direction.
fn stage_normal(input: Patch, local: vec3<f32>) -> vec3<f32> {
    let at = input.entity * ENTITY_SIZE;
    let x = stage_data[at].xyz;
    let y = stage_data[at + 1u].xyz;
    let z = stage_data[at + 2u].xyz;
    let n = vec3(dot(cross(y, z), local), dot(cross(z, x), local), dot(cross(x, y), local));
    let size = max(max(abs(n.x), abs(n.y)), abs(n.z));
    // Scaled first: the squares of tiny cofactors vanish.
    return select(vec3(0.0, 1.0, 0.0), normalize(n / size), size > 0.0);
}

// Level of an edge between two points of the stage: its length seen from any side, in wanted
// edges. The same for both directions, hence for both patches beside it.
fn edge_level(view: StageView, a: vec3<f32>, b: vec3<f32>) -> f32 {
    let middle = (a + b) * 0.5;
    let reach = select(max(distance(middle, view.eye), 1e-6), 1.0, view.orthographic == 1.0);
    return distance(a, b) * view.pixels_per_radian / (reach * view.pixels_per_edge);
}

// Whether a sphere meets the frustum, or may cast a shadow into it.
fn in_view(view: StageView, centre: vec3<f32>, radius: f32) -> bool {
    var inside = true;
    for (var k = 0u; k < 6u; k++) {
        let plane = view.planes[k];
        // A shadow sweeps the sphere along the light: the farther in of both ends counts.
        let reach = max(dot(plane.xyz, view.sweep.xyz), 0.0);
        inside = inside && dot(plane.xyz, centre) + plane.w + reach >= -radius;
    }
    return inside;
}
