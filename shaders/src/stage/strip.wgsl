#define_import_path dolomite::stage::strip

// The strip of triangles between a side of a patch and the inner vertices beside it, by the pool's
// vertices.

#import dolomite::stage::types::{Rules, Shape, TRIANGLES}
#import dolomite::stage::api::{stage, tables, PATCH_WORDS}
#import dolomite::stage::counts::work
#import dolomite::stage::shape::{along_side, corner_count}
#import dolomite::stage::work::{EDGE_NUMBER, REVERSED, offset_word}

struct Strip {
    // Segments of the side, and inner ones parallel to it.
    segments: u32,
    along: u32,
    // The side's first and last vertex; vertex i between them is at between + i * step.
    corners: vec2<u32>,
    between: u32,
    step: u32,
    // Vertex i of the inner row is at row + i * row_step; the last one of a ring is its first.
    row: u32,
    row_step: u32,
    wrap: u32,
    wrapped: u32,
#ifdef STAGE_SPLIT
    // Of a side along two edges: segments of the first (0 where there is one edge), the corner
    // between them, and where vertex first + i of the second is: at beyond + i * beyond_step.
    first: u32,
    middle: u32,
    beyond: u32,
    beyond_step: u32,
#endif
}

const NEVER: u32 = 0xffffffffu;
const BACK: u32 = 0xffffffffu;

fn pool_vertex(item: u32) -> u32 {
    return work[offset_word(stage, item)];
}

// The strip of a side; `inner` is the patch's first inner vertex. Where there is none, the row is the
// patch's last corner.
fn strip_of(rules: Rules, id: u32, shape: Shape, side: u32, inner: u32) -> Strip {
    let corners = corner_count(rules.domain);
    let own = stage.patch_table + id * PATCH_WORDS + 4u;
    let edge = tables[own + 4u + side];
    let reversed = (edge & REVERSED) != 0u;
    let first = pool_vertex(stage.corners + (edge & EDGE_NUMBER));
    var strip: Strip;
    strip.segments = shape.sides[side];
    strip.along = along_side(rules.domain, shape.rows, side);
    strip.corners = vec2(
        pool_vertex(tables[own + select(side, corners, side == 0u) - 1u]),
        pool_vertex(tables[own + side]),
    );
    var count = strip.segments;
#ifdef STAGE_SPLIT
    strip.first = shape.first[side];
    if strip.first > 0u {
        count = strip.first;
        strip.middle = pool_vertex(tables[own + 8u + side]);
        let second = tables[own + 12u + side];
        let turned = (second & REVERSED) != 0u;
        let rest = select(0u, strip.segments - strip.first, turned);
        strip.beyond = pool_vertex(stage.corners + (second & EDGE_NUMBER)) + rest - 1u;
        strip.beyond_step = select(1u, BACK, turned);
    }
#endif
    strip.between = first + select(0u, count, reversed) - 1u;
    strip.step = select(1u, BACK, reversed);
    strip.wrap = NEVER;
    if rules.domain == TRIANGLES {
        let m = strip.along - 2u;
        strip.row = inner + side * m;
        strip.row_step = 1u;
        strip.wrap = select(NEVER, m, side == 2u);
        strip.wrapped = inner;
    } else {
        let columns = shape.rows.x - 1u;
        let top = inner + (shape.rows.y - 2u) * columns;
        let right = inner + columns - 1u;
        strip.row = select(select(top, inner, side == 1u), select(right, top + columns - 1u, side == 3u), side >= 2u);
        strip.row_step = select(select(0u - columns, 1u, side == 1u), select(columns, BACK, side == 3u), side >= 2u);
    }
    if shape.rows.x == 1u {
        strip.row = pool_vertex(tables[own + corners - 1u]);
        strip.wrap = NEVER;
    }
    return strip;
}

// Triangles of the strip.
fn strip_length(domain: u32, shape: Shape, side: u32) -> u32 {
    return shape.sides[side] + along_side(domain, shape.rows, side) - 2u;
}

// Triangles of the strips before that of `side`.
fn strips_before(domain: u32, shape: Shape, side: u32) -> u32 {
    return select(0u, strip_length(domain, shape, 0u), side > 0u)
        + select(0u, strip_length(domain, shape, 1u), side > 1u)
        + select(0u, strip_length(domain, shape, 2u), side > 2u);
}

// Vertex i of the side.
fn strip_outer(strip: Strip, i: u32) -> u32 {
    var between = strip.between + i * strip.step;
#ifdef STAGE_SPLIT
    if strip.first > 0u && i >= strip.first {
        between = select(strip.beyond + (i - strip.first) * strip.beyond_step, strip.middle, i == strip.first);
    }
#endif
    let inside = select(between, strip.corners.y, i == strip.segments);
    return select(inside, strip.corners.x, i == 0u);
}

// Vertex i of the inner row.
fn strip_inner(strip: Strip, i: u32) -> u32 {
    return select(strip.row + i * strip.row_step, strip.wrapped, i == strip.wrap);
}
