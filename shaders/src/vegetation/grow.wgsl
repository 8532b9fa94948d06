// Records of the roots of each piece that stand and may be seen. Sixteen threads a piece.

#import dolomite::vegetation::bindings::{corner_normal, corner_position, counts, params, pieces}
#import dolomite::vegetation::density::{clump_share, ramp}
#import dolomite::vegetation::edges::{holds, to_metres, weights}
#import dolomite::vegetation::law::{drawn_share, entered}
#import dolomite::vegetation::place::{clump_of, first_root, local_place, threshold}
#import dolomite::vegetation::seen::is_outside
#import dolomite::vegetation::triangle::{Triangle, least_of, most_of, triangle_at}
#import dolomite::vegetation::types::{CUT, LOOKED, NO_CLUMPS, PIECES, RECORDS, STANDING, pack_record}

@group(1) @binding(0) var<storage, read_write> records: array<vec4<u32>>;

const GROUP: u32 = 64u;
const THREADS: u32 = 16u;
// Squares a side of a tile.
const SIDE: i32 = 8;

var<workgroup> looked_count: atomic<u32>;
var<workgroup> standing_count: atomic<u32>;

// A corner at the height of the ground there, which below water is not where it is drawn.
fn with_height(corner: vec3<f32>, height: f32) -> vec3<f32> {
    return vec3(corner.x, height, corner.z);
}

// Whether a root stands and may be seen: its record goes to the list of its level of detail. Gives whether it stands.
fn grow_root(t: Triangle, layer: u32, level: u32, square: vec2<i32>) -> bool {
    let pitch = params.layers[layer].pitch;
    let root = first_root(params.layers[layer].seed, square, level);
    let place = local_place(root, pitch, params.anchor);
    if !holds(t.a, t.b, t.c, place) {
        return false;
    }
    let at = to_metres(place);
    // The plane of the corners as they are drawn, not as they are rounded to steps.
    let pa = with_height(corner_position(t.corners.x), t.heights.x);
    let ab = with_height(corner_position(t.corners.y), t.heights.y) - pa;
    let ac = with_height(corner_position(t.corners.z), t.heights.z) - pa;
    let across = ab.x * ac.z - ab.z * ac.x;
    let slope = vec2(ab.y * ac.z - ac.y * ab.z, ac.y * ab.x - ab.y * ac.x) / across;
    let low = min(min(t.heights.x, t.heights.y), t.heights.z);
    let high = max(max(t.heights.x, t.heights.y), t.heights.z);
    let height = clamp(pa.y + dot(slope, at - pa.xz), low, high);
    let above = height + params.layers[layer].above;
    var density = params.layers[layer].full
        * ramp(above, params.layers[layer].height_from, params.layers[layer].height_to, params.layers[layer].height_steep)
        * ramp(length(slope), params.layers[layer].slope_from, params.layers[layer].slope_to, params.layers[layer].slope_steep);
    // The cheap test comes first: no clump raises the density.
    if root.rank >= threshold(density) {
        return false;
    }
    var clump = root.hash;
    if params.layers[layer].clump_size != NO_CLUMPS {
        clump = clump_of(root, params.layers[layer].clump_seed, params.layers[layer].clump_size).hash;
        density *= clump_share(params.layers[layer], clump);
        if root.rank >= threshold(density) {
            return false;
        }
    }
    let rank = f32(root.rank) * 5.9604644775390625e-8;
    let middle = vec3(at.x, height, at.y);
    let distance = length(middle - params.eye);
    let share = drawn_share(params.layers[layer].reach, distance);
    // Where the pool is too small, of those that would be drawn.
    let cut = density * bitcast<f32>(atomicLoad(&counts[CUT]));
    if !(rank < cut * min(share, 1.0)) {
        return true;
    }
    let tallest = params.layers[layer].tallest;
    if is_outside(middle, vec3(tallest)) {
        return true;
    }
    let pixels = tallest * params.pixels_per_radian / max(distance, 1e-3);
    let coarser = vec2<u32>(vec2(pixels) < params.layers[layer].lods);
    let list = params.layers[layer].list + coarser.x + coarser.y;
    let slot = atomicAdd(&counts[RECORDS + list], 1u);
    if slot < params.rooms[list >> 2u][list & 3u] {
        let parts = weights(t.a, t.b, t.c, place);
        let normal = parts.x * corner_normal(t.corners.x) + parts.y * corner_normal(t.corners.y) + parts.z * corner_normal(t.corners.z);
        let come = entered(rank / (cut * share));
        records[params.bases[list >> 2u][list & 3u] + slot] = pack_record(place, height, normalize(normal), root.hash >> 16u, layer, clump >> 27u, come);
    }
    return true;
}

@compute @workgroup_size(64)
fn grow(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    if thread == 0u {
        atomicStore(&looked_count, 0u);
        atomicStore(&standing_count, 0u);
    }
    workgroupBarrier();
    let number = (group.y * groups.x + group.x) * (GROUP / THREADS) + thread / THREADS;
    let count = min(atomicLoad(&counts[PIECES]), params.piece_room);
    if number < count {
        let piece = pieces[number];
        let layer = piece.y & 7u;
        let ring = (piece.y >> 3u) & 7u;
        let tile = bitcast<vec2<i32>>(vec2((piece.y >> 6u) & 8191u, piece.y >> 19u));
        let t = triangle_at(piece.x);
        let at = params.layers[layer].rings[ring];
        let side = u32(params.layers[layer].pitch + 12) + at.level;
        let least = at.least + ((tile * SIDE) << vec2(side));
        let begin = max((least_of(t) - least) >> vec2(side), vec2(0));
        let to = min((most_of(t) - least) >> vec2(side), vec2(SIDE - 1));
        let size = vec2<u32>(max(to - begin + 1, vec2(0)));
        var looked = 0u;
        var standing = 0u;
        for (var k = thread % THREADS; k < size.x * size.y; k += THREADS) {
            let square = at.square + tile * SIDE + begin + bitcast<vec2<i32>>(vec2(k % size.x, k / size.x));
            looked++;
            standing += select(0u, 1u, grow_root(t, layer, at.level, square));
        }
        atomicAdd(&looked_count, looked);
        atomicAdd(&standing_count, standing);
    }
    workgroupBarrier();
    if thread == 0u {
        atomicAdd(&counts[LOOKED], atomicLoad(&looked_count));
        atomicAdd(&counts[STANDING], atomicLoad(&standing_count));
    }
}
