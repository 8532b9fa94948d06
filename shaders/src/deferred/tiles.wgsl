// Lists the lights of each tile of 16 × 16 pixels, in the order of all lights, so that sums of f32 come out the same
// by every way. Between the nearest and the farthest surface of a tile there are 32 slices, and a bit for each says
// whether a surface lies in it (Harada 2012): a light between a lamp post and the wall behind it is not listed.

#import bevy_render::view::View
#import dolomite::deferred::place::{in_view, ndc_of}
#import dolomite::deferred::types::{SPOT, Light}

struct Lighting {
    lights: u32,
    in_tiles: u32,
    tiles: vec2<u32>,
    room: u32,
    brightest: f32,
    open: u32,
    pad: u32,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> lighting: Lighting;
@group(0) @binding(2) var<storage, read> lights: array<Light>;
@group(0) @binding(3) var<storage, read> listed: array<u32>;
@group(0) @binding(4) var depths: texture_depth_2d;
// Words taken; of each tile where its list begins, how many of its lights cast no shadows, and how many it has; then
// the lists.
@group(0) @binding(5) var<storage, read_write> used: atomic<u32>;
@group(0) @binding(6) var<storage, read_write> tiles: array<u32>;

#ifdef CULLED
// A bit a listed light, 0 where it lies behind what is drawn.
@group(0) @binding(7) var<storage, read> shown: array<u32>;
#endif

// Of a workgroup; each has four pixels.
const THREADS: u32 = 64u;

// A bit a light: which reach the tile.
var<workgroup> reaching: array<atomic<u32>, #{MASK_WORDS}>;
// Bits of depths, which are ordered as the depths are.
var<workgroup> nearest: atomic<u32>;
var<workgroup> farthest: atomic<u32>;
// A bit a slice.
var<workgroup> filled: atomic<u32>;
// Lights of the tile that cast no shadows.
var<workgroup> open: atomic<u32>;
var<workgroup> sums: array<u32, THREADS>;
var<workgroup> first_word: u32;

// The part of a tile that surfaces lie in, in view space.
struct Tile {
    // Planes through its sides, normals inwards.
    sides: array<vec4<f32>, 4>,
    // Distances before the camera.
    near: f32,
    far: f32,
    // A metre's; 0 where all is one slice.
    slices: f32,
    // A sphere around it.
    middle: vec3<f32>,
    radius: f32,
}

// The plane through three points, its normal towards `inside`.
fn plane(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, inside: vec3<f32>) -> vec4<f32> {
    let normal = normalize(cross(b - a, c - a));
    let facing = select(-normal, normal, dot(normal, inside - a) > 0.0);
    return vec4(facing, -dot(facing, a));
}

fn tile_between(tile: vec2<u32>, near_depth: f32, far_depth: f32) -> Tile {
    // A quarter of a pixel more on each side, for rounding.
    let size = view.viewport.zw;
    let low = (vec2<f32>(tile * 16u) - 0.25) / size;
    let high = (vec2<f32>(tile * 16u + 16u) + 0.25) / size;
    let left = vec2(low.x, high.y) * vec2(2.0, -2.0) + vec2(-1.0, 1.0);
    let right = vec2(high.x, low.y) * vec2(2.0, -2.0) + vec2(-1.0, 1.0);
    // Any two depths span the planes of the sides.
    var front: array<vec3<f32>, 4>;
    var back: array<vec3<f32>, 4>;
    var least = vec3(1e30);
    var most = vec3(-1e30);
    for (var i = 0u; i < 4u; i++) {
        let corner = vec2(select(left.x, right.x, i == 1u || i == 2u), select(left.y, right.y, i >= 2u));
        front[i] = in_view(vec3(corner, 1.0), view.view_from_clip);
        back[i] = in_view(vec3(corner, 0.5), view.view_from_clip);
        let a = in_view(vec3(corner, near_depth), view.view_from_clip);
        let b = in_view(vec3(corner, far_depth), view.view_from_clip);
        least = min(least, min(a, b));
        most = max(most, max(a, b));
    }
    let inside = (front[0] + front[2] + back[0] + back[2]) * 0.25;
    var result: Tile;
    for (var i = 0u; i < 4u; i++) {
        result.sides[i] = plane(front[i], front[(i + 1u) % 4u], back[i], inside);
    }
    result.near = -most.z;
    result.far = -least.z;
    let depth = result.far - result.near;
    // Thinner ones would be as thin as distances are rounded.
    result.slices = select(0.0, 32.0 / depth, depth > 1e-3 * abs(result.far) && depth < 1e12);
    result.middle = (least + most) * 0.5;
    result.radius = length(most - least) * 0.5;
    return result;
}

// The slice at a distance before the camera.
fn slice_at(distance: f32, tile: Tile) -> u32 {
    if tile.slices == 0.0 {
        return 0u;
    }
    return u32(clamp((distance - tile.near) * tile.slices, 0.0, 31.0));
}

fn reaches(index: u32, tile: Tile, slices: u32) -> bool {
    let m = view.world_from_view;
    let offset = lights[index].position - view.world_position;
    let middle = vec3(dot(m[0].xyz, offset), dot(m[1].xyz, offset), dot(m[2].xyz, offset));
    // More than the rounding of the sums above.
    let reach = lights[index].range * 1.001 + 1e-6 * length(offset);
    if -middle.z - reach > tile.far || -middle.z + reach < tile.near {
        return false;
    }
    let slack = reach + 4e-6 * abs(tile.far);
    let first = slice_at(-middle.z - slack, tile);
    let last = slice_at(-middle.z + slack, tile);
    if (slices & (0xffffffffu << first) & (0xffffffffu >> (31u - last))) == 0u {
        return false;
    }
    for (var i = 0u; i < 4u; i++) {
        if dot(tile.sides[i].xyz, middle) + tile.sides[i].w < -reach {
            return false;
        }
    }
    let to_tile = tile.middle - middle;
    let distance_squared = dot(to_tile, to_tile);
    let touching = reach + tile.radius;
    if distance_squared > touching * touching {
        return false;
    }
    // A tile with no end has no middle.
    if (lights[index].kind & SPOT) == 0u || !(tile.radius < 1e12) {
        return true;
    }
    // A cone and a sphere (Wronski 2017).
    let direction = lights[index].direction;
    let axis = vec3(dot(m[0].xyz, direction), dot(m[1].xyz, direction), dot(m[2].xyz, direction));
    let along = dot(to_tile, axis);
    let across = sqrt(max(distance_squared - along * along, 0.0));
    let outside = lights[index].cos_outer * across - along * lights[index].sin_outer;
    let radius = tile.radius * 1.001 + 1e-3 * sqrt(distance_squared);
    return outside <= radius && along >= -radius;
}

@compute @workgroup_size(THREADS)
fn list(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let words = (lighting.in_tiles + 31u) / 32u;
    for (var word = thread; word < words; word += THREADS) {
        atomicStore(&reaching[word], 0u);
    }
    if thread == 0u {
        atomicStore(&nearest, 0u);
        atomicStore(&farthest, 0xffffffffu);
        atomicStore(&filled, 0u);
        atomicStore(&open, 0u);
    }
    workgroupBarrier();
    // 0 is the sky, and what lies outside.
    var depth = vec4(0.0);
    for (var k = 0u; k < 4u; k++) {
        let pixel = group.xy * 16u + vec2(thread % 16u, thread / 16u + 4u * k);
        if all(vec2<f32>(pixel) < view.viewport.zw) {
            depth[k] = textureLoad(depths, vec2<i32>(vec2<f32>(pixel) + view.viewport.xy), 0);
        }
        if depth[k] > 0.0 {
            atomicMax(&nearest, bitcast<u32>(depth[k]));
            atomicMin(&farthest, bitcast<u32>(depth[k]));
        }
    }
    workgroupBarrier();
    let near_bits = atomicLoad(&nearest);
    let tile = tile_between(group.xy, bitcast<f32>(near_bits), bitcast<f32>(max(atomicLoad(&farthest), 1u) & 0x7fffffffu));
    for (var k = 0u; k < 4u; k++) {
        if depth[k] > 0.0 {
            let pixel = group.xy * 16u + vec2(thread % 16u, thread / 16u + 4u * k);
            let middle = vec2<f32>(pixel) + 0.5 + view.viewport.xy;
            let distance = -in_view(vec3(ndc_of(middle, view.viewport), depth[k]), view.view_from_clip).z;
            atomicOr(&filled, 1u << slice_at(distance, tile));
        }
    }
    workgroupBarrier();
    let slices = atomicLoad(&filled);
    // Without a surface there is nothing to light.
    let looked_at = select(lighting.in_tiles, 0u, near_bits == 0u);
    for (var i = thread; i < looked_at; i += THREADS) {
#ifdef CULLED
        if (shown[i / 32u] & (1u << (i % 32u))) == 0u {
            continue;
        }
#endif
        if reaches(listed[i], tile, slices) {
            atomicOr(&reaching[i / 32u], 1u << (i % 32u));
        }
    }
    workgroupBarrier();
    // Each thread counts a run of words, and their sums say where it writes.
    let run = (words + THREADS - 1u) / THREADS;
    var own = 0u;
    var own_open = 0u;
    for (var word = thread * run; word < min((thread + 1u) * run, words); word++) {
        let bits = atomicLoad(&reaching[word]);
        own += countOneBits(bits);
        // Those below `open` of the view's list.
        let before = min(max(lighting.open, word * 32u) - word * 32u, 32u);
        own_open += countOneBits(extractBits(bits, 0u, before));
    }
    sums[thread] = own;
    if own_open > 0u {
        atomicAdd(&open, own_open);
    }
    workgroupBarrier();
    for (var step = 1u; step < THREADS; step *= 2u) {
        var before = 0u;
        if thread >= step {
            before = sums[thread - step];
        }
        workgroupBarrier();
        sums[thread] += before;
        workgroupBarrier();
    }
    let total = sums[THREADS - 1u];
    let at = 3u * (group.y * lighting.tiles.x + group.x);
    if thread == 0u {
        let heads = 3u * lighting.tiles.x * lighting.tiles.y;
        // 0 says that there is no list: then a pixel goes through all lights.
        var first = 0u;
        var taken = atomicLoad(&used);
        while total <= lighting.room && taken <= lighting.room - total {
            let exchange = atomicCompareExchangeWeak(&used, taken, taken + total);
            if exchange.exchanged {
                first = 1u + heads + taken;
                break;
            }
            taken = exchange.old_value;
        }
        tiles[1u + at] = first;
        tiles[2u + at] = atomicLoad(&open);
        tiles[3u + at] = total;
        first_word = first;
    }
    workgroupBarrier();
    if first_word == 0u {
        return;
    }
    var next = first_word + sums[thread] - own;
    for (var word = thread * run; word < min((thread + 1u) * run, words); word++) {
        var bits = atomicLoad(&reaching[word]);
        while bits != 0u {
            tiles[next] = listed[word * 32u + firstTrailingBit(bits)];
            next++;
            bits &= bits - 1u;
        }
    }
}
