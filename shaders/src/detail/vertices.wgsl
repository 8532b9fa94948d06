#define_import_path dolomite::detail::vertices

// Vertices by the cells that own them, and their numbers. What lies at a cell's corner is found by going up:
// a corner is the parent's centre, the middle of one of its sides, or its corner too.

#import dolomite::detail::types::{APPEARS, NO_CELL, cell_mid}
#import dolomite::detail::bindings::{cells, counts, detail, links, seen, COARSENING, root_count}

// A vertex: middle of one of a cell's sides 0 to 3, its centre; or a corner of the roots by its number.
struct Vertex {
    cell: u32,
    slot: u32,
}

const CENTRE: u32 = 4u;
const ROOT_CORNER: u32 = 5u;

fn coarsening() -> f32 {
    return bitcast<f32>(atomicLoad(&counts[COARSENING]));
}

fn appears() -> f32 {
    return APPEARS * coarsening();
}

// Share of the way to the ground of a vertex with this error ratio.
fn morph_share(error_ratio: f32) -> f32 {
    return clamp((error_ratio / coarsening() - APPEARS) / (1.0 - APPEARS), 0.0, 1.0);
}

// Whether a quarter of a cell, by the first of them, is drawn as a cell of its own.
fn is_drawn(first: u32, quarter: u32) -> bool {
    let child = first + (quarter & 3u);
    return first != 0u && seen[child].stamp == detail.stamp && seen[child].centre > appears();
}

// Bits of the middles that are drawn and belong to the cell: of two cells to the one with the lesser
// coordinate. Where a middle is drawn both cells are kept, unless one is beyond the border.
fn owned(at: u32) -> u32 {
    var bits = 0u;
    for (var side = 0u; side < 4u; side++) {
        let own = seen[at].middles[side] > appears() && (side >= 2u || seen[at].beside[side] == NO_CELL);
        bits |= select(0u, 1u << side, own);
    }
    return bits;
}

// The middle of a side that is drawn.
fn middle_of(cell: u32, side: u32) -> Vertex {
    let k = side & 3u;
    let beside = seen[cell].beside[k];
    if k < 2u && beside != NO_CELL {
        return Vertex(beside, k + 2u);
    }
    return Vertex(cell, k);
}

fn root_corner_number(root: u32, corner: u32) -> u32 {
    let k = corner & 3u;
    let x = root % detail.roots.x + select(0u, 1u, k == 1u || k == 2u);
    let z = root / detail.roots.x + select(0u, 1u, k >= 2u);
    return z * (detail.roots.x + 1u) + x;
}

// The vertex at a corner of a cell that is drawn, or of a root.
fn corner_of(cell: u32, corner: u32) -> Vertex {
    var at = cell;
    // 0 where the corner is the parent's too, else 1 to 3 round from there.
    var turn = 0u;
    var quarter = 0u;
    while turn == 0u && at >= root_count() {
        // Blocks of four are aligned.
        quarter = at & 3u;
        turn = (corner - quarter) & 3u;
        at = links[at].parent;
    }
    if turn == 0u {
        return Vertex(root_corner_number(at, corner), ROOT_CORNER);
    }
    if turn == 2u {
        return Vertex(at, CENTRE);
    }
    return middle_of(at, quarter + select(0u, 1u, turn == 1u));
}

fn vertex_number(vertex: Vertex) -> u32 {
    if vertex.slot == ROOT_CORNER {
        return vertex.cell;
    }
    let before = seen[vertex.cell].own & ((1u << vertex.slot) - 1u);
    return seen[vertex.cell].first + select(1u + countOneBits(before), 0u, vertex.slot == CENTRE);
}

// Height and gradient of the ground at a vertex of a cell.
fn cell_ground(vertex: Vertex) -> vec3<f32> {
    if vertex.slot == CENTRE {
        return cells[vertex.cell].centre.xyz;
    }
    return cell_mid(cells[vertex.cell], vertex.slot);
}

fn cell_error_ratio(vertex: Vertex) -> f32 {
    if vertex.slot == CENTRE {
        return seen[vertex.cell].centre;
    }
    return seen[vertex.cell].middles[vertex.slot];
}
