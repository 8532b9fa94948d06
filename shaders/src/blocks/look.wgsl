// Looks at the blocks that may have vertices: the largest error ratios of what is new in each, which of it appears, and how
// many at which coarsening. A workgroup a block, half a row of cells a thread; it needs no barrier.

#import dolomite::blocks::bindings::{candidate_list, heads, lists, record_at, records, seen}
#import dolomite::blocks::counting::coarsening_of
#import dolomite::blocks::looked::{CENTRE_BITS, LAST_BIT, MIXED_BITS, first_mixed, last_mixed}
#import dolomite::blocks::ratio::{BEFORE, Frame, box_ratio, frame_of, place_along, vertex_ratio}
#import dolomite::blocks::record::{CORNERS, CORNER_COUNT, CELLS, ERRORS, HIGHS, LOWS, WINDOW}
#import dolomite::detail::bindings::detail

// From which error ratio on a vertex is noted as one that appears: passes that look at it again may round otherwise.
const NOTED: f32 = WINDOW * 0.9999;

// From which error ratio on a vertex appears at the coarsenings of counting.wgsl.
struct Thresholds {
    a: vec4<f32>,
    b: vec4<f32>,
    c: vec4<f32>,
    d: vec4<f32>,
}

struct Counts {
    a: vec4<u32>,
    b: vec4<u32>,
    c: vec4<u32>,
    d: vec4<u32>,
}

fn thresholds_from(k: u32) -> vec4<f32> {
    return WINDOW * vec4(coarsening_of(k), coarsening_of(k + 1u), coarsening_of(k + 2u), coarsening_of(k + 3u));
}

fn one_where(above: vec4<bool>) -> vec4<u32> {
    return select(vec4(0u), vec4(1u), above);
}

fn counted(before: Counts, thresholds: Thresholds, ratio: f32) -> Counts {
    let all = vec4(ratio);
    return Counts(
        before.a + one_where(all > thresholds.a),
        before.b + one_where(all > thresholds.b),
        before.c + one_where(all > thresholds.c),
        before.d + one_where(all > thresholds.d),
    );
}

fn ratio_of(frame: Frame, record: u32, number: u32, size: f32, low: vec2<f32>, high: vec2<f32>) -> f32 {
    let error = bitcast<f32>(records[record + ERRORS + number]);
    let lowest = bitcast<f32>(records[record + LOWS + number]);
    let highest = bitcast<f32>(records[record + HIGHS + number]);
    return box_ratio(frame, error, size, vec3(low.x, lowest, low.y), vec3(high.x, highest, high.y));
}

fn add(slot: u32, word: u32, first: u32, second: u32) {
    if first > 0u {
        atomicAdd(&seen[slot].appear[word], first | (second << 16u));
    }
}

@compute @workgroup_size(32)
fn look_at_blocks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let slot = lists[candidate_list() + group.x];
    let record = record_at(slot);
    let frame = frame_of(heads[slot].centre, heads[slot].half);
    let thresholds = Thresholds(thresholds_from(0u), thresholds_from(4u), thresholds_from(8u), thresholds_from(12u));
    var counts = Counts(vec4(0u), vec4(0u), vec4(0u), vec4(0u));
    var there = 0u;
    let row = thread >> 1u;
    let z = BEFORE + 2u * row;

    // Centres, whose boxes reach three half cells: from the corner before a cell to the one after the next.
    let first_centre = 8u * (thread & 1u);
    let centre_low = place_along(frame.z, z - 2u);
    let centre_high = place_along(frame.z, z + 4u);
    let centre_x = BEFORE + 2u * first_centre;
    var low = place_along(frame.x, centre_x - 2u);
    var next = place_along(frame.x, centre_x);
    var after = place_along(frame.x, centre_x + 2u);
    var largest = 0.0;
    let first_number = CORNER_COUNT + row * CELLS + first_centre;
    for (var k = 0u; k < CENTRE_BITS; k++) {
        let high = place_along(frame.x, centre_x + 4u + 2u * k);
        let ratio = ratio_of(frame, record, first_number + k, frame.centre_size, vec2(low, centre_low), vec2(high, centre_high));
        largest = max(largest, ratio);
        counts = counted(counts, thresholds, ratio);
        there |= select(0u, 1u << k, ratio > NOTED);
        low = next;
        next = after;
        after = high;
    }
    if largest > WINDOW {
        let quarter = select(thread & 1u, 3u - (thread & 1u), row >= CELLS / 2u);
        atomicMax(&seen[slot].centres[quarter], bitcast<u32>(largest));
    }

    // Mixed corners, whose boxes reach two cells.
    let mixed_first = first_mixed(thread);
    let mixed_low = place_along(frame.z, z - 4u);
    let mixed_high = place_along(frame.z, z + 4u);
    let mixed_x = BEFORE + 2u * mixed_first;
    low = place_along(frame.x, mixed_x - 4u);
    next = place_along(frame.x, mixed_x);
    largest = 0.0;
    for (var k = 0u; k < MIXED_BITS; k++) {
        let high = place_along(frame.x, mixed_x + 4u + 4u * k);
        let number = row * CORNERS + mixed_first + 2u * k;
        let ratio = ratio_of(frame, record, number, frame.mixed_size, vec2(low, mixed_low), vec2(high, mixed_high));
        largest = max(largest, ratio);
        counts = counted(counts, thresholds, ratio);
        there |= select(0u, 1u << (CENTRE_BITS + k), ratio > NOTED);
        low = next;
        next = high;
    }
    if (row & 1u) == 1u {
        let corner = last_mixed(thread);
        let number = corner.y * CORNERS + corner.x;
        let error = bitcast<f32>(records[record + ERRORS + number]);
        let lowest = bitcast<f32>(records[record + LOWS + number]);
        let highest = bitcast<f32>(records[record + HIGHS + number]);
        let ratio = vertex_ratio(frame, 2u * corner, error, lowest, highest);
        largest = max(largest, ratio);
        counts = counted(counts, thresholds, ratio);
        there |= select(0u, 1u << LAST_BIT, ratio > NOTED);
    }
    if largest > WINDOW {
        atomicMax(&seen[slot].mixed, bitcast<u32>(largest));
    }
    seen[slot].there[thread] = there;
    add(slot, 0u, counts.a.x, counts.a.y);
    add(slot, 1u, counts.a.z, counts.a.w);
    add(slot, 2u, counts.b.x, counts.b.y);
    add(slot, 3u, counts.b.z, counts.b.w);
    add(slot, 4u, counts.c.x, counts.c.y);
    add(slot, 5u, counts.c.z, counts.c.w);
    add(slot, 6u, counts.d.x, counts.d.y);
    add(slot, 7u, counts.d.z, counts.d.w);
}
