#define_import_path dolomite::detail::types

// Records of the terrain LOD, byte for byte as plugins/ground/src/detail/{view,horizon,layout}.rs
// (a test compares them). Lengths metres; see there for what is behind the numbers.

// A view: relative to its anchor, axes of the world.
struct DetailView {
    planes: array<vec4<f32>, 6>,
    eye: vec3<f32>,
    scale: f32,
    right: vec3<f32>,
    near: f32,
    up: vec3<f32>,
    cos_corner: f32,
    forward: vec3<f32>,
    orthographic: f32,
    sweep: vec3<f32>,
    shadow_share: f32,
    anchor: vec2<i32>,
    metric: u32,
    inverse_tolerance: f32,
    classic: vec4<f32>,
}

// How a view looks at its horizon, see horizon.wgsl. Relative to the stage's anchor, its height too.
struct HorizonView {
    eye: vec3<f32>,
    // Depth at which the first layer begins, metres.
    nearest: f32,
    // Unit direction of depth.
    ahead: vec2<f32>,
    // Greatest |u| in view; u of a pixel straight ahead.
    reach: f32,
    pixel: f32,
    // From the eye to the corners of the near plane, metres.
    near_reach: f32,
    pad_a: f32,
    pad_b: f32,
    pad_c: f32,
}

// A part of the ground that was edited: from the first to the last lattice line.
struct EditedRect {
    low: vec2<u32>,
    high: vec2<u32>,
    // The smallest half side of a block for which it counts from farther away, and from how many of its cells.
    wide_from: u32,
    wide_cells: u32,
    pad_a: u32,
    pad_b: u32,
}

struct DetailParams {
    view: DetailView,
    // Least corner of the lattice, 32.32 fixed point.
    origin_cell: vec2<i32>,
    origin_frac: vec2<u32>,
    // A lattice step along x and z: whole metres, and steps of 2^-32 m.
    step_x: vec2<u32>,
    step_z: vec2<u32>,
    roots: vec2<u32>,
    // How often a root is halved.
    depth: u32,
    // Blocks that there is room for, and the first slot, which is none.
    capacity: u32,
    // Number of this choice: what carries another is of an older one.
    stamp: u32,
    max_vertices: u32,
    max_triangles: u32,
    // Greatest depth below the sea that a vertex can carry either way.
    depth_range: f32,
    // Height of the sea; -1e30 without. How deep a bed can be seen below it.
    sea: f32,
    opaque_depth: f32,
    // Height of the stage's anchor: positions are stored relative to it.
    anchor_height: f32,
    // Which triangles are left out, see cull.wgsl.
    flags: u32,
    // The cull view: from places in the stage to clip space, and half its size in pixels.
    clip: mat4x4<f32>,
    half_size: vec2<f32>,
    // Blocks that no choice from this one on has looked at may be dropped.
    oldest: u32,
    pad: f32,
    horizon: HorizonView,
    // How many lattice steps wide the outermost columns and rows are whose steps have another length; 0: none are.
    border: u32,
    // Rectangles in `edited`.
    edited_count: u32,
    border_pad_a: u32,
    border_pad_b: u32,
    // How much longer a step is there, 2^-32 m, two's complement: in the first and the last column, the first and the last row.
    first_x: vec2<u32>,
    last_x: vec2<u32>,
    first_z: vec2<u32>,
    last_z: vec2<u32>,
    edited: array<EditedRect, 16>,
}
