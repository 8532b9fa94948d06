// Pieces of work: each drawn triangle with each tile of roots that it reaches into. A thread a triangle; those that
// reach into many tiles are gone through by all threads of the workgroup.

#import dolomite::geometry::head::{INDEXED, OTHERS}
#import dolomite::vegetation::bindings::{counts, params, head, pieces}
#import dolomite::vegetation::edges::{is_beside, to_metres}
#import dolomite::vegetation::seen::is_outside
#import dolomite::vegetation::triangle::{Triangle, least_of, most_of, triangle_at}
#import dolomite::vegetation::types::{PIECES, Ring}

const GROUP: u32 = 64u;
// Tiles that one thread goes through by itself.
const FEW: u32 = 12u;

var<workgroup> large: array<u32, 64>;
var<workgroup> large_count: atomic<u32>;

// The tiles of a ring that a triangle's box reaches into.
struct Tiles {
    begin: vec2<i32>,
    size: vec2<u32>,
}

// Log2 of the side of a tile, steps.
fn tile_side(pitch: i32, level: u32) -> u32 {
    return u32(pitch + 15) + level;
}

fn tiles_of(layer: u32, ring: u32, t: Triangle) -> Tiles {
    let at = params.layers[layer].rings[ring];
    let side = vec2(tile_side(params.layers[layer].pitch, at.level));
    let begin = max((least_of(t) - at.least) >> side, vec2(0));
    let to = min((most_of(t) - at.least) >> side, vec2(at.tiles - 1));
    return Tiles(begin, vec2<u32>(max(to - begin + 1, vec2(0))));
}

fn put(first: u32, t: Triangle, layer: u32, ring: u32, tile: vec2<i32>) {
    let at = params.layers[layer].rings[ring];
    if all(tile >= at.inner_from) && all(tile < at.inner_to) {
        return;
    }
    let shift = tile_side(params.layers[layer].pitch, at.level);
    let least = at.least + (tile << vec2(shift));
    let most = least + (1 << shift) - 1;
    if is_beside(t.a, t.b, least, most) || is_beside(t.b, t.c, least, most) || is_beside(t.c, t.a, least, most) {
        return;
    }
    let low = min(min(t.heights.x, t.heights.y), t.heights.z);
    let high = max(max(t.heights.x, t.heights.y), t.heights.z);
    let above = params.layers[layer].above;
    if high + above < params.layers[layer].height_from || low + above > params.layers[layer].height_to {
        return;
    }
    let begin = to_metres(least);
    let to = to_metres(most);
    let away = max(max(begin - params.eye.xz, params.eye.xz - to), vec2(0.0));
    if length(away) > params.layers[layer].reach.w {
        return;
    }
    let tallest = params.layers[layer].tallest;
    let middle = vec3(0.5 * (begin.x + to.x), 0.5 * (low + high), 0.5 * (begin.y + to.y));
    let half = vec3(0.5 * (to.x - begin.x), 0.5 * (high - low), 0.5 * (to.y - begin.y)) + vec3(tallest);
    if is_outside(middle, half) {
        return;
    }
    let place = atomicAdd(&counts[PIECES], 1u);
    if place < params.piece_room {
        pieces[place] = vec2(first, layer | (ring << 3u) | (u32(tile.x) << 6u) | (u32(tile.y) << 19u));
    }
}

fn put_number(first: u32, t: Triangle, layer: u32, ring: u32, tiles: Tiles, number: u32) {
    put(first, t, layer, ring, tiles.begin + bitcast<vec2<i32>>(vec2(number % tiles.size.x, number / tiles.size.x)));
}

@compute @workgroup_size(64)
fn divide(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let number = (group.y * groups.x + group.x) * GROUP + thread;
    let seen = head[INDEXED] / 3u;
    let others = head[OTHERS] / 3u;
    if thread == 0u {
        atomicStore(&large_count, 0u);
    }
    workgroupBarrier();
    if number < seen + others {
        let first = select(head[OTHERS + 2u] + 3u * (number - seen), 3u * number, number < seen);
        let t = triangle_at(first);
        var count = 0u;
        for (var layer = 0u; t.exists && layer < params.layer_count; layer++) {
            for (var ring = 0u; ring < params.layers[layer].ring_count; ring++) {
                let size = tiles_of(layer, ring, t).size;
                count += size.x * size.y;
            }
        }
        if count > FEW {
            large[atomicAdd(&large_count, 1u)] = first;
        } else if count > 0u {
            for (var layer = 0u; layer < params.layer_count; layer++) {
                for (var ring = 0u; ring < params.layers[layer].ring_count; ring++) {
                    let tiles = tiles_of(layer, ring, t);
                    for (var k = 0u; k < tiles.size.x * tiles.size.y; k++) {
                        put_number(first, t, layer, ring, tiles, k);
                    }
                }
            }
        }
    }
    workgroupBarrier();
    let more = atomicLoad(&large_count);
    for (var n = 0u; n < more; n++) {
        let first = large[n];
        let t = triangle_at(first);
        for (var layer = 0u; layer < params.layer_count; layer++) {
            for (var ring = 0u; ring < params.layers[layer].ring_count; ring++) {
                let tiles = tiles_of(layer, ring, t);
                for (var k = thread; k < tiles.size.x * tiles.size.y; k += GROUP) {
                    put_number(first, t, layer, ring, tiles, k);
                }
            }
        }
    }
}
