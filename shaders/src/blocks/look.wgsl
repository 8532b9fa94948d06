// Looks at the blocks that may have vertices: the largest error ratios of what is new in each, and how many of it appear at
// which coarsening. A workgroup a block; it needs no barrier.

#import dolomite::blocks::bindings::{candidate_list, heads, lists, record_at, records, seen}
#import dolomite::blocks::counting::coarsening_of
#import dolomite::blocks::ratio::{Frame, frame_of, vertex_ratio}
#import dolomite::blocks::record::{CORNER_COUNT, ERRORS, HIGHS, LOWS, MIXED, WINDOW, mixed_corner, number_at}
#import dolomite::detail::bindings::detail

const GROUP: u32 = 32u;

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

fn ratio_of(frame: Frame, record: u32, number: u32, at: vec2<u32>) -> f32 {
    let error = bitcast<f32>(records[record + ERRORS + number]);
    let low = bitcast<f32>(records[record + LOWS + number]);
    let high = bitcast<f32>(records[record + HIGHS + number]);
    return vertex_ratio(frame, at, error, low, high);
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
    var mixed = 0.0;
    for (var k = thread; k < MIXED; k += GROUP) {
        let corner = mixed_corner(k);
        let ratio = ratio_of(frame, record, corner.y * 17u + corner.x, 2u * corner);
        mixed = max(mixed, ratio);
        counts = counted(counts, thresholds, ratio);
    }
    if mixed > WINDOW {
        atomicMax(&seen[slot].mixed, bitcast<u32>(mixed));
    }
    for (var quarter = 0u; quarter < 4u; quarter++) {
        let first = vec2(select(0u, 8u, quarter == 1u || quarter == 2u), select(0u, 8u, quarter >= 2u));
        var largest = 0.0;
        for (var k = thread; k < 64u; k += GROUP) {
            let cell = first + vec2(k & 7u, k >> 3u);
            let ratio = ratio_of(frame, record, CORNER_COUNT + cell.y * 16u + cell.x, 2u * cell + vec2(1u));
            largest = max(largest, ratio);
            counts = counted(counts, thresholds, ratio);
        }
        if largest > WINDOW {
            atomicMax(&seen[slot].centres[quarter], bitcast<u32>(largest));
        }
    }
    add(slot, 0u, counts.a.x, counts.a.y);
    add(slot, 1u, counts.a.z, counts.a.w);
    add(slot, 2u, counts.b.x, counts.b.y);
    add(slot, 3u, counts.b.z, counts.b.w);
    add(slot, 4u, counts.c.x, counts.c.y);
    add(slot, 5u, counts.c.z, counts.c.w);
    add(slot, 6u, counts.d.x, counts.d.y);
    add(slot, 7u, counts.d.z, counts.d.w);
}
