#define_import_path dolomite::terrain::clip

// A map of which tiles about a place are there, finer ones nearer. CPU reference: plugins/terrain/src/height_map/stream;
// its heads of levels are laid out as `head` there says.

#import dolomite::terrain::layer::{Layer, BILINEAR}
#import dolomite::terrain::bindings::terrain_data
#import dolomite::terrain::cubic::{cubic_slopes, cubic_weights}

const LEVEL_WORDS: u32 = 8u;
const TILE: u32 = 128u;
const TILE_COUNT: u32 = 16384u;

// Places that are no farther from a sample than this share of the distance of samples are taken to be on it. Whoever asks for places on
// samples alone sets it, so that rounding of a place does not tell apart what levels say of it: blocks that were made by different
// levels have the same bits where they meet.
var<private> clip_near: f32 = 0.0;

// For lattices on samples: the coordinates of 2^17 of them are rounded by 2^-15 at most.
const ON_SAMPLES: f32 = 1.0 / 16384.0;

struct ClipLevel {
    // Columns and rows of the whole level.
    samples: vec2<i32>,
    // First and last that may be read.
    low: vec2<i32>,
    high: vec2<i32>,
    // Tiles that are there along each axis.
    slots: vec2<u32>,
    // Words of terrain_data.
    heights: u32,
    slopes: u32,
    deviations: u32,
}

fn clip_level(layer: Layer, level: u32) -> ClipLevel {
    let at = layer.data + level * LEVEL_WORDS;
    let slots = vec2(terrain_data[at + 4u], terrain_data[at + 5u]);
    let slopes = layer.data + terrain_data[at + 7u];
    // The last sample may stand beyond the border.
    let samples = ((layer.size + vec2((1u << level) - 2u)) >> vec2(level)) + vec2(1u);
    return ClipLevel(
        vec2<i32>(samples),
        vec2<i32>(vec2(terrain_data[at], terrain_data[at + 1u])),
        vec2<i32>(vec2(terrain_data[at + 2u], terrain_data[at + 3u])),
        slots,
        layer.data + terrain_data[at + 6u],
        slopes,
        slopes + slots.x * slots.y * TILE_COUNT,
    );
}

// Whether all samples may be read from `low` to `high`, both cut to the map.
fn clip_holds(clip: ClipLevel, low: vec2<i32>, high: vec2<i32>) -> bool {
    let most = clip.samples - vec2(1);
    return all(clamp(low, vec2(0), most) >= clip.low) && all(clamp(high, vec2(0), most) <= clip.high);
}

// Where a sample of a level stands among those that are there.
fn clip_place(clip: ClipLevel, at: vec2<i32>) -> u32 {
    let cut = vec2<u32>(clamp(at, vec2(0), clip.samples - vec2(1)));
    let tile = cut / TILE % clip.slots;
    let within = cut % TILE;
    return (tile.y * clip.slots.x + tile.x) * TILE_COUNT + within.y * TILE + within.x;
}

fn clip_sample(clip: ClipLevel, at: vec2<i32>) -> f32 {
    return bitcast<f32>(terrain_data[clip.heights + clip_place(clip, at)]);
}

fn clip_slope(clip: ClipLevel, at: vec2<i32>) -> vec2<f32> {
    return unpack2x16float(terrain_data[clip.slopes + clip_place(clip, at)]);
}

fn clip_deviation(clip: ClipLevel, at: vec2<i32>) -> f32 {
    return bitcast<f32>(terrain_data[clip.deviations + clip_place(clip, at)]);
}

// Height and gradient from the finest level that has all samples about a cell of the map; `part` is where in it.
fn clip_height(layer: Layer, place: vec2<i32>, part: vec2<f32>) -> vec3<f32> {
    let next = part > vec2(1.0 - clip_near);
    let at = place + select(vec2(0), vec2(1), next);
    let within = select(part, vec2(0.0), next | (part < vec2(clip_near)));
    let before = select(1, 0, layer.kind == BILINEAR);
    var level = 0u;
    var clip = clip_level(layer, 0u);
    // The last one is always there as a whole.
    while level + 1u < layer.octaves {
        let cell = at >> vec2(level);
        if clip_holds(clip, cell - vec2(before), cell + vec2(1 + before)) {
            break;
        }
        level++;
        clip = clip_level(layer, level);
    }
    let cell = at >> vec2(level);
    let rest = at & vec2((1 << level) - 1);
    let f = (vec2<f32>(rest) + within) / f32(1u << level);
    let middle = clip_sample(clip, cell);
    var height = middle;
    var gradient = vec2(0.0);
    if layer.kind == BILINEAR {
        let east = clip_sample(clip, cell + vec2(1, 0)) - middle;
        let south = clip_sample(clip, cell + vec2(0, 1)) - middle;
        let far = clip_sample(clip, cell + vec2(1, 1)) - middle;
        let twist = (far - south) - east;
        height += f.x * east + f.y * (south + f.x * twist);
        gradient = vec2(east + f.y * twist, south + f.x * twist);
    } else {
        let wx = cubic_weights(f.x);
        let sx = cubic_slopes(f.x);
        let wz = cubic_weights(f.y);
        let sz = cubic_slopes(f.y);
        var value = 0.0;
        for (var dj = 0; dj < 4; dj++) {
            let row = vec4(
                clip_sample(clip, cell + vec2(-1, dj - 1)),
                clip_sample(clip, cell + vec2(0, dj - 1)),
                clip_sample(clip, cell + vec2(1, dj - 1)),
                clip_sample(clip, cell + vec2(2, dj - 1)),
            ) - middle;
            let across = dot(wx, row);
            value += wz[dj] * across;
            gradient += vec2(wz[dj] * dot(sx, row), sz[dj] * across);
        }
        height += value;
    }
    if level > 0u {
        // Of the finest samples, whatever level this is.
        let north = mix(clip_slope(clip, cell), clip_slope(clip, cell + vec2(1, 0)), f.x);
        let south = mix(clip_slope(clip, cell + vec2(0, 1)), clip_slope(clip, cell + vec2(1, 1)), f.x);
        gradient = mix(north, south, f.y);
    }
    return vec3(height, gradient * layer.scale);
}

// A rectangle that begins or ends so close to a sample, in samples of the map, takes it to be its border: windows reach a whole one
// farther, and rounding would else add a row of them here and not on the CPU.
const WITHIN: f32 = 1.0 / 64.0;

// What samples `apart` may miss over a rectangle, all in samples of the map.
fn clip_missed(layer: Layer, low: vec2<f32>, high: vec2<f32>, apart: f32) -> f32 {
    for (var level = 1u; level < layer.octaves; level++) {
        let step = f32(1u << level);
        // Windows reach a sample farther than two steps.
        if 1.001 * step < apart {
            continue;
        }
        let clip = clip_level(layer, level);
        let first = vec2<i32>(floor((low + WITHIN) / step));
        let last = max(vec2<i32>(ceil((high - WITHIN) / step)) - vec2(1), first);
        if !clip_holds(clip, first, last) {
            continue;
        }
        var largest = 0.0;
        for (var z = first.y; z <= last.y; z++) {
            for (var x = first.x; x <= last.x; x++) {
                largest = max(largest, clip_deviation(clip, vec2(x, z)));
            }
        }
        return 2.0 * largest;
    }
    // From the lowest to the highest height.
    return layer.erosion;
}
