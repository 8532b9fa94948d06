#define_import_path dolomite::detail::types

// Records of the terrain LOD, byte for byte as plugins/ground/src/detail/{view,cell,layout}.rs
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

// A part of the ground that was edited: from the first to the last lattice line, after the choice of that number.
struct EditedRect {
    low: vec2<u32>,
    high: vec2<u32>,
    stamp: u32,
    // Of blocks: the smallest half side for which it counts from farther away, and from how many of their cells.
    wide_from: u32,
    wide_cells: u32,
    pad: u32,
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
    // Cells that there is room for.
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
    // Cells that no choice from this one on has looked at may be dropped.
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

// A cell as it was made, see Cell in cell.rs.
struct Cell {
    // Height and gradient at the centre; in w the lowest height of the drawn surface.
    centre: vec4<f32>,
    // Of the middles of the sides; then error bound and highest height.
    west: vec3<f32>,
    north_x: f32,
    north_yz: vec2<f32>,
    east_xy: vec2<f32>,
    east_z: f32,
    south_x: f32,
    south_yz: vec2<f32>,
    error: f32,
    high: f32,
    quarters_ab: vec2<f32>,
    quarters_cd: vec2<f32>,
    finer: f32,
    // Number of the choice that looked at it last.
    looked: u32,
}

// Where a cell stands among the others.
struct Link {
    // Its centre on the lattice; 0 for no cell.
    centre: vec2<u32>,
    parent: u32,
    // The first of its four quarters; 0 while it has none.
    children: u32,
}

// A cell in a view.
struct ViewCell {
    // Error ratios of the middles of the sides; of kept cells.
    middles: vec4<f32>,
    // Own error ratios: of the triangles at the sides.
    sides: vec4<f32>,
    // The cells of its size beyond the sides and beyond the corners; NO_CELL where this choice did not
    // look at any.
    beside: vec4<u32>,
    across: vec4<u32>,
    // As two triangles, and of everything finer.
    whole: f32,
    finer: f32,
    // Error ratio of the centre; 0 where the cell is not drawn.
    centre: f32,
    // DetailParams.stamp of the choice that looked at it.
    stamp: u32,
    // Number of its first vertex: the centre, then the middles that it owns.
    first: u32,
    // Bits of the middles that it owns.
    own: u32,
    // 1 where it is seen, itself or its shadow.
    seen: u32,
    pad: u32,
}

const NO_CELL: u32 = 0xffffffffu;

// The error ratio at which a vertex appears, still in the plane of the triangle that it cuts.
const APPEARS: f32 = 0.75;

fn cell_mid(cell: Cell, side: u32) -> vec3<f32> {
    switch side {
        case 0u: { return cell.west; }
        case 1u: { return vec3(cell.north_x, cell.north_yz); }
        case 2u: { return vec3(cell.east_xy, cell.east_z); }
        default: { return vec3(cell.south_x, cell.south_yz); }
    }
}

fn cell_quarters(cell: Cell) -> vec4<f32> {
    return vec4(cell.quarters_ab, cell.quarters_cd);
}
