#define_import_path dolomite::tessellation::types

// Records of terrain tessellation, byte for byte as plugins/tessellation/src/layout.rs (a test
// compares them). Ground positions are 32.32 fixed-point metres (x, z); lengths are metres.

// An absent patch, edge or corner.
const NONE: u32 = 0xffffffffu;
// Most segments of one edge, as in OpenGL and Vulkan.
const MAX_LEVEL: u32 = 64u;

struct Corner {
    cell: vec2<i32>,
    frac: vec2<u32>,
    // The patches around it, NONE where absent.
    patches: vec4<u32>,
    // Written by plan: its vertex, NONE when no patch around it is drawn.
    vertex: u32,
    pad_a: u32,
    pad_b: u32,
    pad_c: u32,
}

struct Edge {
    // Ends, in ascending x or z.
    corners: vec2<u32>,
    // The patches beside it, NONE where absent.
    patches: vec2<u32>,
    // Written by levels: wanted number of segments, 1 to 64.
    wanted: f32,
    // Written by plan: number of segments; 0 when no patch beside it is drawn.
    level: u32,
    // Written by plan: first inner vertex.
    vertex: u32,
    pad: u32,
}

struct Patch {
    // (x, z) = (0,0), (1,0), (0,1), (1,1).
    corners: vec4<u32>,
    // Two edges a side (0: least z, 1: greatest z, 2: least x, 3: greatest x); the second is
    // NONE where the neighbour is not finer.
    edges: array<u32, 8>,
    // Conservative heights, metres.
    min_height: f32,
    max_height: f32,
    // Written by levels: 1 when it meets the frustum, 2 when only its shadow may, else 0.
    visible: u32,
    // Written by plan: first inner vertex, first triangle, inner segments (x low half, z high).
    vertex: u32,
    triangle: u32,
    inner: u32,
    pad_a: u32,
    pad_b: u32,
}

struct ViewParams {
    // Inward half-spaces: inside where dot(n, p) + d >= 0, p relative to the anchor.
    planes: array<vec4<f32>, 6>,
    // How far shadows reach from the highest ground down to the lowest, along the light; 0
    // without shadows. Ground outside the frustum is kept where it shades what is inside.
    sweep: vec4<f32>,
    // The point that detail follows, relative to the anchor.
    eye: vec3<f32>,
    // Focal length in pixels over wanted pixels an edge.
    segments_per_radian: f32,
    // Whole metres (x, z) that positions are relative to.
    anchor: vec2<i32>,
    corner_count: u32,
    edge_count: u32,
    patch_count: u32,
    max_vertices: u32,
    max_triangles: u32,
    // Metres; -1e30 without a sea.
    sea_level: f32,
}

struct PlanResult {
    // index count, 1, 0, 0, 0: draw_indexed_indirect.
    indexed: array<u32, 5>,
    // vertex count, 1, 0, 0: draw_indirect.
    plain: array<u32, 4>,
    vertices: u32,
    triangles: u32,
    drawn: u32,
    culled: u32,
    lowered: u32,
    pad_a: u32,
    pad_b: u32,
}
