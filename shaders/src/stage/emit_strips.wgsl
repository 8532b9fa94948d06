// Pass 7, a thread half of a side: the triangles that join it to the inner vertices. Not for
// isolines, which have no sides.

#import dolomite::stage::api::stage
#import dolomite::stage::counts::{placed_shape, work}
#import dolomite::stage::ruler::places
#import dolomite::stage::rules::stage_rules
#import dolomite::stage::shape::{corner_count, grid_triangles}
#import dolomite::stage::strip::{Strip, strip_inner, strip_length, strip_of, strip_outer, strips_before}
#import dolomite::stage::triangle::store_triangle
#import dolomite::stage::work::{COLUMNS, offset_word}

// The lowest set bit of a mask, less 1; all ones where none is set.
fn lowest(mask: u32) -> u32 {
    return (mask & (0u - mask)) - 1u;
}

#ifdef STAGE_SPLIT
// One half of the strip along a side of two edges, from triangle `index` of the strip on: both rows
// advance as evenly as they can, see half_strip in plugins/tessellation/src/ruler.rs.
fn emit_half(strip: Strip, second: bool, index: u32, held: u32) {
    let row = strip.along - 2u;
    let start = select(vec2(0u), vec2(strip.first, row / 2u), second);
    let end = select(vec2(strip.first, row / 2u), vec2(strip.segments, row), second);
    let count = end - start;
    let total = count.x + count.y;
    var made = start;
    var error = total / 2u;
    let first = index + start.x + start.y;
    for (var t = 0u; t < total; t++) {
        error += count.x;
        let outwards = error >= total;
        error -= select(0u, total, outwards);
        let a = strip_outer(strip, made.x);
        let c = strip_inner(strip, made.y);
        let b = select(strip_inner(strip, made.y + 1u), strip_outer(strip, made.x + 1u), outwards);
        if first + t < held {
            store_triangle(first + t, vec3(a, b, c));
        }
        made += select(vec2(0u, 1u), vec2(1u, 0u), outwards);
    }
}
#endif

@compute @workgroup_size(256)
fn emit_strips(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let number = (group.x + group.y * COLUMNS) * 256u + thread;
    let rules = stage_rules();
    let sides = max(corner_count(rules.domain), 1u);
    // The second half is the first one's mirror image, from the side's end on.
    let back = (number & 1u) == 1u;
    let id = (number >> 1u) / sides;
    let side = (number >> 1u) - id * sides;
    if id >= stage.patches {
        return;
    }
    let shape = placed_shape(id);
    // Discarded.
    if shape.rows.x == 0u {
        return;
    }
    let at = offset_word(stage, stage.corners + stage.edges + id);
    let first = work[at + 1u];
    let held = min(work[at + 3u], stage.max_primitives);
    let strip = strip_of(rules, id, shape, side, work[at]);

#ifdef STAGE_SPLIT
    if strip.first > 0u {
        emit_half(strip, back, first + grid_triangles(rules.domain, shape.rows) + strips_before(rules.domain, shape, side), held);
        return;
    }
#endif
    let length = strip_length(rules.domain, shape, side);
    let halves = vec2(strip.segments, strip.along) / 2u;
    let half = halves.x + halves.y - 1u;
    // The first half has the middle segments of odd rows as well.
    var count = select(length - half, half, back);
    var index = first + grid_triangles(rules.domain, shape.rows) + strips_before(rules.domain, shape, side);
    var forth = 1u;
    if back {
        index += length - 1u;
        forth = 0u - 1u;
    }
    // Places of the rows' halves that are still to come, see ruler.wgsl; bit 0 is the side's first
    // segment.
    var outer = places(halves.x) | min(halves.x, 1u);
    var inner = places(halves.y);
    var middle = (strip.along & 1u) == 1u;
    if shape.rows.x == 1u {
        // No inner vertices: a fan around the last corner, of the sides that do not end there.
        let fan = !back && side > 0u && side + 1u < sides;
        count = select(0u, 1u, fan);
        index = first + side - 1u;
        middle = false;
    }
    // Steps that the outer and the inner row have made.
    var made = vec2(0u);
    for (var k = 0u; k < count; k++) {
        // The lower place comes first, of equal ones that of the inner row. In the middle the inner
        // row's segment, if it has one.
        let done = (outer | inner) == 0u;
        let inwards = select(lowest(inner) <= lowest(outer), middle, done);
        middle = middle && !done;
        let step = select(vec2(1u, 0u), vec2(0u, 1u), inwards);
        inner = select(inner, inner & (inner - 1u), inwards);
        outer = select(outer & (outer - 1u), outer, inwards);
        let x = select(made.x, strip.segments - made.x - step.x, back);
        let z = select(made.y, strip.along - 2u - made.y - step.y, back);
        let a = strip_outer(strip, x);
        let c = strip_inner(strip, z);
        let b = select(strip_outer(strip, x + 1u), strip_inner(strip, z + 1u), inwards);
        if index < held {
            store_triangle(index, vec3(a, b, c));
        }
        made += step;
        index += forth;
    }
}
